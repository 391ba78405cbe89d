//! OpenEXR files.

use std::io::{self, BufWriter};
use std::path::Path;

use exr::meta::attribute::{AttributeValue as ExrValue, Text};
use exr::prelude::{Encoding, Layer, LayerAttributes, SpecificChannels, WritableImage};

use super::file::{WriteError, replace_file};
use super::read::Image;

/// What an image file can say about how it was made.
#[derive(Clone, Debug, PartialEq)]
pub enum AttributeValue {
    /// Stored as `string`, in UTF-8.
    Text(String),
    /// Stored as `double`.
    Number(f64),
}

/// Writes linear RGB in 32-bit floats, losslessly compressed, with `attributes`. Their names must
/// not be those of OpenEXR's standard attributes: give them a prefix.
///
/// # Errors
/// If the file cannot be written, or a name is empty, longer than 255 bytes or a standard one.
pub fn write_exr(
    path: &Path,
    image: &Image,
    attributes: &[(String, AttributeValue)],
) -> Result<(), WriteError> {
    replace_file(path, |writer| {
        encode(writer, image, attributes).map_err(|error| match error {
            exr::error::Error::Io(error) => error,
            other => io::Error::other(other),
        })
    })
}

fn encode(
    writer: &mut BufWriter<std::fs::File>,
    image: &Image,
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
    let pixel = |at: exr::math::Vec2<usize>| {
        let [r, g, b] = image.pixels[at.y() * width + at.x()];
        (r, g, b)
    };
    let channels = SpecificChannels::rgb(pixel);
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

/// OpenEXR's strings are bytes; their encoding is UTF-8 by convention.
fn text(string: &str) -> Text {
    Text::from_slice_unchecked(string.as_bytes())
}
