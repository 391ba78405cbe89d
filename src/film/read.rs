//! Reading images: OpenEXR, PNG, JPEG and Radiance HDR.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader};
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::attribute::AttributeValue as ExrValue;
use exr::prelude::{AnyChannel, FlatSamples, ReadChannels, ReadLayers};
use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader};

use super::image::{AnnotatedImage, AttributeValue, Image};

/// Maximum number of pixels of an image: 16384 x 8192. It limits the memory for the size that a file
/// claims.
const MAX_PIXELS: usize = 1 << 27;
/// Bytes of a pixel while it is decoded: as in the file, and twice in f32.
const PIXEL_BYTES: usize = 4 + 2 * 3 * 4;
/// Maximum number of bytes that a decoder may allocate.
const MAX_BYTES: u64 = 1 << 31;
/// Maximum number of pixels per byte of an OpenEXR file: deflate, its best compression, expands a byte
/// to at most 1032 bytes, and a pixel has at least two.
const MAX_EXR_PIXELS_PER_BYTE: u64 = 1032 / 2;
/// Maximum number of pixels per byte of another file: a PNG has up to 8 in each of 1032 bytes. A JPEG
/// has at most 512, since each block of 64 takes a bit, and an HDR image of one colour some hundreds.
/// Their decoders fill in missing data, so without this limit they would allocate any size claimed.
const MAX_PIXELS_PER_BYTE: u64 = 8 * 1032;

/// Encoding of an integer image (PNG, JPEG). Floating-point images are always linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decode {
    /// The transfer function of sRGB (IEC 61966-2-1).
    Srgb,
    /// Linear values.
    Raw,
}

/// Why an image cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadImageError {
    /// The file is missing or cannot be read.
    #[error("cannot read the image: {0}")]
    Io(#[from] io::Error),
    /// The image has too many pixels for memory, or more than the file can hold.
    #[error("the image claims {width} x {height} pixels, more than {limit} in all")]
    TooLarge {
        /// Pixels in a row.
        width: usize,
        /// Pixels in a column.
        height: usize,
        /// Maximum number of pixels.
        limit: usize,
    },
    /// There is not enough memory for the image.
    #[error(
        "the image of {width} x {height} pixels needs {bytes} bytes of memory, which there are not"
    )]
    Memory {
        /// Pixels in a row.
        width: usize,
        /// Pixels in a column.
        height: usize,
        /// Memory that decoding takes.
        bytes: usize,
    },
    /// The file is invalid, or its format is not that of its extension.
    #[error("not a usable image (PNG, JPEG, OpenEXR or Radiance HDR): {0}")]
    Format(String),
}

/// Reads an image. The format follows from the contents, for OpenEXR from the extension. An alpha
/// channel is ignored; grey becomes RGB.
///
/// # Errors
/// If the file cannot be read, is invalid, or claims too large a size.
pub fn read_image(path: &Path, decode: Decode) -> Result<Image, ReadImageError> {
    read(path, decode, Extent::Image).map(|annotated| annotated.image)
}

/// Reads an image with the layers and attributes that [`super::write_exr`] writes.
///
/// # Errors
/// As for [`read_image`].
pub fn read_annotated(path: &Path, decode: Decode) -> Result<AnnotatedImage, ReadImageError> {
    read(path, decode, Extent::All)
}

/// Which contents of a file are read.
#[derive(Clone, Copy, PartialEq)]
enum Extent {
    Image,
    All,
}

fn read(path: &Path, decode: Decode, extent: Extent) -> Result<AnnotatedImage, ReadImageError> {
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(io::Error::other("it is not a file").into());
    }
    let extension = path.extension().and_then(OsStr::to_str).unwrap_or("");
    if extension.eq_ignore_ascii_case("exr") {
        let limit = max_pixels(metadata.len(), MAX_EXR_PIXELS_PER_BYTE);
        return read_exr(path, limit, extent);
    }
    let limit = max_pixels(metadata.len(), MAX_PIXELS_PER_BYTE);
    Ok(AnnotatedImage {
        image: read_other(path, decode, limit)?,
        layers: BTreeMap::new(),
        attributes: BTreeMap::new(),
    })
}

/// Maximum number of pixels that a file can hold and memory allows.
fn max_pixels(file_bytes: u64, per_byte: u64) -> usize {
    let possible = file_bytes.saturating_mul(per_byte);
    MAX_PIXELS.min(usize::try_from(possible).unwrap_or(MAX_PIXELS))
}

fn read_exr(path: &Path, limit: usize, extent: Extent) -> Result<AnnotatedImage, ReadImageError> {
    let broken = |error: exr::error::Error| ReadImageError::Format(error.to_string());
    let header = MetaData::read_from_file(path, false).map_err(broken)?;
    for layer in &header.headers {
        check_size(layer.layer_size.width(), layer.layer_size.height(), limit)?;
    }
    let file = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(broken)?;
    let layer = &file.layer_data;
    let (width, height) = (layer.size.width(), layer.size.height());
    let channels = Channels {
        list: &layer.channel_data.list,
        pixels: width * height,
    };
    let mut annotated = AnnotatedImage {
        image: Image {
            width,
            height,
            pixels: channels.image()?,
        },
        layers: BTreeMap::new(),
        attributes: BTreeMap::new(),
    };
    if extent == Extent::All {
        annotated.layers = channels.layers();
        let others = layer.attributes.other.iter();
        let others = others.chain(&file.attributes.other);
        annotated.attributes = others
            .filter_map(|(name, value)| Some((name.to_string(), attribute(value)?)))
            .collect();
    }
    Ok(annotated)
}

/// The channels of an OpenEXR file.
struct Channels<'a> {
    list: &'a [AnyChannel<FlatSamples>],
    /// Width times height.
    pixels: usize,
}

impl Channels<'_> {
    /// R, G and B, or Y.
    fn image(&self) -> Result<Vec<[f32; 3]>, ReadImageError> {
        if let Some(rgb) = self.rgb("") {
            return Ok(rgb);
        }
        if let Some(y) = self.channel("Y") {
            return Ok(y.into_iter().map(|y| [y; 3]).collect());
        }
        let names: Vec<String> = self.list.iter().map(|c| c.name.to_string()).collect();
        Err(ReadImageError::Format(format!(
            "its channels are {}; expected R, G and B, or Y",
            names.join(", ")
        )))
    }

    /// All of NAME.R, NAME.G and NAME.B.
    fn layers(&self) -> BTreeMap<String, Vec<[f32; 3]>> {
        let names = self.list.iter().map(|channel| channel.name.to_string());
        let names = names.filter_map(|name| Some(name.strip_suffix(".R")?.to_owned()));
        names
            .filter_map(|name| Some((name.clone(), self.rgb(&format!("{name}."))?)))
            .collect()
    }

    fn rgb(&self, prefix: &str) -> Option<Vec<[f32; 3]>> {
        let channel = |letter: &str| self.channel(&format!("{prefix}{letter}"));
        let rgb = channel("R")?.into_iter().zip(channel("G")?);
        let rgb = rgb.zip(channel("B")?);
        Some(rgb.map(|((r, g), b)| [r, g, b]).collect())
    }

    fn channel(&self, name: &str) -> Option<Vec<f32>> {
        let found = self.list.iter().find(|c| c.name.eq_case_insensitive(name));
        found
            .filter(|c| c.sampling.width() == 1 && c.sampling.height() == 1)
            .map(|c| samples(&c.sample_data))
            .filter(|samples| samples.len() == self.pixels)
    }
}

fn attribute(value: &ExrValue) -> Option<AttributeValue> {
    match value {
        ExrValue::Text(text) => Some(AttributeValue::Text(text.to_string())),
        ExrValue::F64(number) => Some(AttributeValue::Number(*number)),
        ExrValue::F32(number) => Some(AttributeValue::Number(f64::from(*number))),
        ExrValue::I32(number) => Some(AttributeValue::Number(f64::from(*number))),
        _ => None,
    }
}

fn samples(samples: &FlatSamples) -> Vec<f32> {
    samples.values_as_f32().collect()
}

fn read_other(path: &Path, decode: Decode, limit: usize) -> Result<Image, ReadImageError> {
    let mut file = BufReader::new(File::open(path)?);
    let decoded = if file.fill_buf()?.starts_with(b"#?") {
        // Some programs, such as Mitsuba, do not write the first line that the format requires.
        let decoder = HdrDecoder::new_nonstrict(file).map_err(broken)?;
        let (width, height) = decoder.dimensions();
        check_size(width as usize, height as usize, limit)?;
        DynamicImage::from_decoder(decoder).map_err(broken)?
    } else {
        let mut reader = ImageReader::new(file).with_guessed_format()?;
        let mut limits = image::Limits::default();
        limits.max_alloc = Some(MAX_BYTES);
        reader.limits(limits);
        let decoder = reader.into_decoder().map_err(broken)?;
        let (width, height) = decoder.dimensions();
        check_size(width as usize, height as usize, limit)?;
        DynamicImage::from_decoder(decoder).map_err(broken)?
    };
    let is_float = matches!(
        decoded,
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_)
    );
    let to_linear = match decode {
        Decode::Srgb if !is_float => srgb_to_linear,
        _ => std::convert::identity,
    };
    let rgb = decoded.into_rgb32f();
    Ok(Image {
        width: rgb.width() as usize,
        height: rgb.height() as usize,
        pixels: rgb.pixels().map(|p| p.0.map(to_linear)).collect(),
    })
}

fn broken(error: ImageError) -> ReadImageError {
    ReadImageError::Format(error.to_string())
}

fn check_size(width: usize, height: usize, limit: usize) -> Result<(), ReadImageError> {
    let pixels = width.checked_mul(height);
    let Some(pixels) = pixels.filter(|&pixels| pixels > 0 && pixels <= limit) else {
        return Err(ReadImageError::TooLarge {
            width,
            height,
            limit,
        });
    };
    // The decoders abort or panic without memory.
    let bytes = pixels.saturating_mul(PIXEL_BYTES);
    match Vec::<u8>::new().try_reserve_exact(bytes) {
        Ok(()) => Ok(()),
        Err(_) => Err(ReadImageError::Memory {
            width,
            height,
            bytes,
        }),
    }
}

/// The inverse of the transfer function of sRGB (IEC 61966-2-1).
fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}
