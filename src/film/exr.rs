//! Writing OpenEXR files.

use std::io::{self, BufWriter};
use std::path::Path;

use exr::meta::attribute::{AttributeValue as ExrValue, Text};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, WritableImage,
};

use super::file::{StagedFile, WriteError};
use super::image::{AttributeValue, Image};

/// Name of a layer, and three values for each pixel, in rows from the top.
pub type ExrLayer<'a> = (&'a str, &'a [[f32; 3]]);

/// Writes linear RGB in 32-bit floats, losslessly compressed, with `attributes`. Their names must
/// differ from OpenEXR's standard attributes: give them a prefix. Each of `layers` is written to
/// channels NAME.R, NAME.G and NAME.B.
///
/// # Errors
/// If the file cannot be written, or a name is empty, longer than 255 bytes or a standard one.
pub fn write_exr(
    path: &Path,
    image: &Image,
    layers: &[ExrLayer],
    attributes: &[(String, AttributeValue)],
) -> Result<(), WriteError> {
    stage_exr(path, image, layers, attributes)?.commit()
}

/// As [`write_exr`], and leaves it to the caller to commit the file.
///
/// # Errors
/// As for [`write_exr`].
pub fn stage_exr(
    path: &Path,
    image: &Image,
    layers: &[ExrLayer],
    attributes: &[(String, AttributeValue)],
) -> Result<StagedFile, WriteError> {
    StagedFile::write(path, |writer| {
        encode(writer, image, layers, attributes).map_err(|error| match error {
            exr::error::Error::Io(error) => error,
            other => io::Error::other(other),
        })
    })
}

fn encode(
    writer: &mut BufWriter<std::fs::File>,
    image: &Image,
    layers: &[ExrLayer],
    attributes: &[(String, AttributeValue)],
) -> exr::error::UnitResult {
    let (width, height) = (image.width, image.height);
    let mut layer_attributes = LayerAttributes {
        software_name: Some(text("Metrolight")),
        ..LayerAttributes::default()
    };
    for (name, value) in attributes {
        let value = match value {
            AttributeValue::Text(string) => ExrValue::Text(text(string)),
            AttributeValue::Number(number) => ExrValue::F64(*number),
        };
        layer_attributes.other.insert(text(name), value);
    }
    let named = |&(name, pixels): &ExrLayer| {
        [0, 1, 2].map(|c| {
            let name = format!("{name}.{}", ["R", "G", "B"][c]);
            channel(&name, pixels, c)
        })
    };
    let own = [0, 1, 2].map(|c| channel(["R", "G", "B"][c], &image.pixels, c));
    let channels = own.into_iter().chain(layers.iter().flat_map(named));
    let channels = AnyChannels::sort(channels.collect());
    let layer = Layer::new(
        (width, height),
        layer_attributes,
        Encoding::SMALL_LOSSLESS,
        channels,
    );
    exr::image::Image::from_layer(layer)
        .write()
        .to_buffered(writer)
}

/// Component `c` of all `pixels`.
fn channel(name: &str, pixels: &[[f32; 3]], c: usize) -> AnyChannel<FlatSamples> {
    let samples = pixels.iter().map(|pixel| pixel[c]).collect();
    AnyChannel::new(text(name), FlatSamples::F32(samples))
}

/// Strings of OpenEXR are bytes, by convention in UTF-8.
fn text(string: &str) -> Text {
    Text::from_slice_unchecked(string.as_bytes())
}
