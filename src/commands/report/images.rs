//! The linear images of a report, in half floats.

use std::ffi::OsStr;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use half::f16;
use metrolight::film::{AnnotatedImage, AttributeValue, Decode, Image, read_annotated};
use serde::Serialize;

use super::folder::Folder;
use crate::commands::mixture::mixtures;
use crate::commands::numbers::short;
use crate::commands::warn;

/// Maximum number of pixels of all images of a page together: 8 bytes each, 32 MiB of text. Larger
/// images are downsampled.
const MAX_PIXELS: usize = 1 << 22;

/// The stem of the reference that `converge` renders.
const REFERENCE: &str = "reference";

/// Prefix of the attributes of images that Metrolight renders.
const PREFIX: &str = "metrolight.";

/// Prefix of the attributes of images of single techniques. They are not shown: there are many, and the
/// contact sheets show them.
const TECHNIQUE: &str = "metrolight.technique.";

/// An image in the directory.
pub struct Found {
    /// File name without extension.
    pub stem: String,
    pub image: Image,
    /// Attributes of the render: names without [`PREFIX`], and values.
    pub attributes: Vec<(String, String)>,
}

/// Reads the images: the reference, those of `variants` (file names without extension) in their order,
/// and all others that have attributes of a Metrolight render. Prints a warning for unreadable files.
pub fn find(folder: &Folder, variants: &[String]) -> Vec<Found> {
    let order = |stem: &str| {
        let variant = variants.iter().position(|variant| variant == stem);
        match variant {
            _ if stem == REFERENCE => Some(0),
            Some(i) => Some(i + 1),
            None => None,
        }
    };
    let mut found = Vec::new();
    for name in &folder.names {
        let extension = name.extension().and_then(OsStr::to_str).unwrap_or("");
        if !extension.eq_ignore_ascii_case("exr") {
            continue;
        }
        let path = folder.locate(name);
        let image = match read_annotated(&path, Decode::Srgb) {
            Ok(image) => image,
            Err(error) => {
                warn([format!("{} is left out: {error}", path.display())]);
                continue;
            }
        };
        warn(mixtures(&path, &image));
        let stem = stem(name);
        let order = order(&stem);
        if order.is_some() || is_render(&image) {
            found.push((order.unwrap_or(usize::MAX), with_attributes(stem, image)));
        }
    }
    // The sort is stable: other images stay in the order of their names.
    found.sort_by_key(|(order, _)| *order);
    found.into_iter().map(|(_, found)| found).collect()
}

fn stem(name: &Path) -> String {
    name.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// True if Metrolight rendered the image, and it is not the image of a single technique.
fn is_render(image: &AnnotatedImage) -> bool {
    let has = |prefix: &str| {
        let mut names = image.attributes.keys();
        names.any(|name| name.starts_with(prefix))
    };
    has(PREFIX) && !has(TECHNIQUE)
}

fn with_attributes(stem: String, image: AnnotatedImage) -> Found {
    let attributes = image.attributes.iter().filter_map(|(name, value)| {
        let value = match value {
            AttributeValue::Text(text) => text.clone(),
            AttributeValue::Number(number) => short(*number),
        };
        Some((name.strip_prefix(PREFIX)?.to_owned(), value))
    });
    Found {
        stem,
        attributes: attributes.collect(),
        image: image.image,
    }
}

/// An image in the format of the page's script.
#[derive(Serialize)]
pub struct Embedded<'a> {
    name: &'a str,
    width: usize,
    height: usize,
    /// Value of a half float of 1.
    unit: f64,
    /// R, G and B of each pixel as little-endian half floats, in base64.
    pixels: String,
}

/// The smallest n for which all images, with n by n pixels joined into one, have no more than `limit`
/// pixels together.
fn joined(images: &[Found], limit: usize) -> usize {
    let pixels = |n: usize| -> usize {
        let sizes = images.iter().map(|found| &found.image);
        sizes
            .map(|image| image.width.div_ceil(n) * image.height.div_ceil(n))
            .sum()
    };
    let longest = images.iter().map(|f| f.image.width.max(f.image.height));
    let longest = longest.max().unwrap_or(1);
    (1..longest)
        .find(|&n| pixels(n) <= limit)
        .unwrap_or(longest)
}

/// All images for the page, and the n of the n by n pixels that are joined into one.
pub fn embed(images: &[Found]) -> (Vec<Embedded<'_>>, usize) {
    let n = joined(images, MAX_PIXELS);
    let embedded = images
        .iter()
        .map(|found| Embedded::new(&found.stem, &downsampled(&found.image, n)));
    (embedded.collect(), n)
}

impl<'a> Embedded<'a> {
    /// Half floats have 11 significant bits: a relative rounding error of at most 2^-11 (0.05%), which
    /// is below the scale of errors. This holds from 6e-5 to 65504 units; the unit is the power of two
    /// below the image's mean. The absolute error of smaller values is below 3e-8 of the mean, and
    /// larger values become 65504 units.
    fn new(name: &'a str, image: &Image) -> Self {
        let values = || image.pixels.iter().flatten();
        let finite = values()
            .filter(|v| v.is_finite())
            .map(|&v| f64::from(v).abs());
        let (sum, count) = finite.fold((0.0, 0u64), |(sum, count), v| (sum + v, count + 1));
        let mean = sum / count.max(1) as f64;
        let unit = if mean > 0.0 {
            mean.log2().floor().exp2()
        } else {
            1.0
        };
        let max = f64::from(f16::MAX);
        let half = |&v: &f32| match f64::from(v) / unit {
            scaled if v.is_finite() => f16::from_f64(scaled.clamp(-max, max)),
            scaled => f16::from_f64(scaled),
        };
        let bytes: Vec<u8> = values().flat_map(|v| half(v).to_le_bytes()).collect();
        Self {
            name,
            width: image.width,
            height: image.height,
            unit,
            pixels: STANDARD.encode(bytes),
        }
    }
}

/// The image with `n` by `n` pixels joined into their mean; at the right and bottom edge there may be
/// fewer.
fn downsampled(image: &Image, n: usize) -> Image {
    let (width, height) = (image.width.div_ceil(n), image.height.div_ceil(n));
    let pixel = |i: usize| {
        let [column, row] = [i % width * n, i / width * n];
        let columns = column..(column + n).min(image.width);
        let rows = row..(row + n).min(image.height);
        let count = (columns.len() * rows.len()) as f64;
        let mut sum = [0.0; 3];
        for row in rows {
            for pixel in &image.pixels[row * image.width..][columns.clone()] {
                for (sum, &value) in sum.iter_mut().zip(pixel) {
                    *sum += f64::from(value);
                }
            }
        }
        sum.map(|sum| (sum / count) as f32)
    };
    Image {
        width,
        height,
        pixels: (0..width * height).map(pixel).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: usize, values: &[f32]) -> Image {
        Image {
            width,
            height: values.len() / width,
            pixels: values.iter().map(|&v| [v; 3]).collect(),
        }
    }

    #[test]
    fn half_floats_keep_three_digits_at_any_scale() {
        for scale in [1e-12f32, 1.0, 1e9] {
            let values = [0.001, 1.2345, 3.0, 0.0].map(|v| v * scale);
            let image = image(2, &values);
            let embedded = Embedded::new("", &image);
            let bytes = STANDARD.decode(&embedded.pixels).unwrap();
            assert_eq!(bytes.len(), 2 * 3 * 4);
            for (pair, value) in bytes.chunks(6).zip(values) {
                let read = f16::from_le_bytes([pair[0], pair[1]]).to_f64() * embedded.unit;
                assert!((read - f64::from(value)).abs() <= f64::from(value) / 2048.0);
            }
        }
    }

    #[test]
    fn large_values_are_clamped_and_non_finite_values_kept() {
        let mut values = [1.0; 1 << 18];
        (values[0], values[1], values[2]) = (1e9, f32::NAN, f32::INFINITY);
        let embedded = Embedded::new("", &image(1 << 9, &values));
        let bytes = STANDARD.decode(&embedded.pixels).unwrap();
        let half = |i: usize| f16::from_le_bytes([bytes[6 * i], bytes[6 * i + 1]]);
        assert_eq!(half(0), f16::MAX);
        assert!(half(1).is_nan() && half(2).is_infinite());
    }

    #[test]
    fn pixels_are_joined_until_all_images_fit() {
        let small = downsampled(&image(3, &[1.0, 3.0, 5.0, 5.0, 7.0, 9.0]), 2);
        assert_eq!(small, image(2, &[4.0, 7.0]));
        let found = |width, height| Found {
            stem: String::new(),
            image: image(width, &vec![0.0; width * height]),
            attributes: Vec::new(),
        };
        let images = [found(100, 10), found(7, 7)];
        for (limit, n) in [(1049, 1), (1048, 2), (266, 2), (265, 3), (2, 100), (0, 100)] {
            assert_eq!(joined(&images, limit), n, "{limit}");
        }
    }
}
