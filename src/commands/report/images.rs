//! The linear images of a report: those of a scene's renders, in half floats.

use std::ffi::OsStr;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use half::f16;
use metrolight::film::{AnnotatedImage, AttributeValue, Decode, Image, read_annotated};
use serde::Serialize;

use super::folder::Folder;
use crate::commands::numbers::short;
use crate::commands::warn;

/// Most pixels of all images of a page together: 8 bytes each, 32 MiB of text. Beyond it all images
/// are shown smaller.
const MOST_PIXELS: usize = 1 << 22;

/// The name of the truth that `converge` renders.
const REFERENCE: &str = "reference";

/// Attributes of images that Metrolight renders begin with this.
const OURS: &str = "metrolight.";

/// Images of single techniques are not shown one by one: there are too many, and the sheets have them.
const OF_A_TECHNIQUE: &str = "metrolight.technique.s";

/// An image that was found.
pub struct Found {
    /// Its file name, without extension.
    pub stem: String,
    pub image: Image,
    /// How it was made: names without their common beginning, and values.
    pub attributes: Vec<(String, String)>,
}

/// Reads the images: the reference, those of `variants`, which are file names without extension, in
/// their order, and all others that say how Metrolight made them. What is no image is warned of.
pub fn find(folder: &Folder, variants: &[String]) -> Vec<Found> {
    let place = |stem: &str| {
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
        let path = folder.path.join(name);
        let image = match read_annotated(&path, Decode::Srgb) {
            Ok(image) => image,
            Err(error) => {
                warn([format!("{} is left out: {error}", path.display())]);
                continue;
            }
        };
        let stem = stem(name);
        let place = place(&stem);
        if place.is_some() || is_ours(&image) {
            found.push((place.unwrap_or(usize::MAX), shown(stem, image)));
        }
    }
    // Stable: others stay in the order of their names.
    found.sort_by_key(|(place, _)| *place);
    found.into_iter().map(|(_, found)| found).collect()
}

fn stem(name: &Path) -> String {
    name.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

fn is_ours(image: &AnnotatedImage) -> bool {
    let mut names = image.attributes.keys();
    names.any(|name| name.starts_with(OURS)) && !image.attributes.contains_key(OF_A_TECHNIQUE)
}

fn shown(stem: String, image: AnnotatedImage) -> Found {
    let attributes = image.attributes.iter().filter_map(|(name, value)| {
        let value = match value {
            AttributeValue::Text(text) => text.clone(),
            AttributeValue::Number(number) => short(*number),
        };
        Some((name.strip_prefix(OURS)?.to_owned(), value))
    });
    Found {
        stem,
        attributes: attributes.collect(),
        image: image.image,
    }
}

/// An image as the page's script takes it.
#[derive(Serialize)]
pub struct Embedded<'a> {
    name: &'a str,
    width: usize,
    height: usize,
    /// What a half float of 1 stands for.
    unit: f64,
    /// Half floats, R, G and B of each pixel, little-endian, in base64.
    pixels: String,
}

/// Into how many pixels by how many one pixel of the page's images is joined, so that all have no more
/// than `limit` together.
pub fn joined(images: &[Found], limit: usize) -> usize {
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

/// All images for the page, and how many pixels by how many are joined into one.
pub fn embed(images: &[Found]) -> (Vec<Embedded<'_>>, usize) {
    let n = joined(images, MOST_PIXELS);
    let embedded = images
        .iter()
        .map(|found| Embedded::new(&found.stem, &shrunk(&found.image, n)));
    (embedded.collect(), n)
}

impl<'a> Embedded<'a> {
    /// Half floats have 11 bits: a relative rounding error of at most 2^-11, 0.05%, which is below what
    /// the map of errors shows. They do so from 6e-5 to 65504 times the unit, the power of two at the
    /// image's mean: what is darker is exact to 3e-8 of the mean, what is brighter becomes 65504 units.
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
        let most = f64::from(f16::MAX);
        let half = |&v: &f32| match f64::from(v) / unit {
            scaled if v.is_finite() => f16::from_f64(scaled.clamp(-most, most)),
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

/// The image with `n` by `n` pixels joined into their mean; at the right and at the bottom fewer may be
/// left.
fn shrunk(image: &Image, n: usize) -> Image {
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
    fn half_floats_keep_three_digits_whatever_the_scale_of_light() {
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
    fn fireflies_and_what_is_no_number_stay_what_they_are() {
        let mut values = [1.0; 1 << 18];
        (values[0], values[1], values[2]) = (1e9, f32::NAN, f32::INFINITY);
        let embedded = Embedded::new("", &image(1 << 9, &values));
        let bytes = STANDARD.decode(&embedded.pixels).unwrap();
        let half = |i: usize| f16::from_le_bytes([bytes[6 * i], bytes[6 * i + 1]]);
        assert_eq!(half(0), f16::MAX);
        assert!(half(1).is_nan() && half(2).is_infinite());
    }

    #[test]
    fn pixels_are_joined_until_all_fit() {
        let small = shrunk(&image(3, &[1.0, 3.0, 5.0, 5.0, 7.0, 9.0]), 2);
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
