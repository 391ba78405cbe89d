//! PNG previews.

use std::io;
use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};

use super::file::{WriteError, replace_file};
use super::image::Image;

/// Writes a preview: 8 bits per channel, encoded as sRGB, values clamped to [0, 1].
///
/// # Errors
/// If the file cannot be written.
pub fn write_png(path: &Path, image: &Image) -> Result<(), WriteError> {
    let bytes = srgb_bytes(image, 1.0);
    let (width, height) = (image.width as u32, image.height as u32);
    replace_file(path, |writer| {
        PngEncoder::new(writer)
            .write_image(&bytes, width, height, ExtendedColorType::Rgb8)
            .map_err(|error| match error {
                ImageError::IoError(error) => error,
                other => io::Error::other(other),
            })
    })
}

/// The image times `exposure`, as clamped sRGB with three bytes per pixel.
pub fn srgb_bytes(image: &Image, exposure: f64) -> Vec<u8> {
    let values = image.pixels.iter().flatten();
    values
        .map(|&v| encode_srgb((f64::from(v) * exposure) as f32))
        .collect()
}

/// The transfer function of sRGB (IEC 61966-2-1, section 5.2), to the nearest of 256 steps; NaN
/// becomes black.
pub(crate) fn encode_srgb(linear: f32) -> u8 {
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    // The conversion saturates, and NaN becomes 0.
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::encode_srgb;

    #[test]
    fn srgb_is_encoded_rounded_and_clamped() {
        // Middle grey: 0.2140411 is the linear value of 127.5/255 by the standard's inverse.
        for (linear, expected) in [
            (0.0, 0),
            (0.002, 7),
            (0.214_041, 127),
            (0.214_042, 128),
            (1.0, 255),
            (7.0, 255),
            (-1.0, 0),
            (f32::INFINITY, 255),
            (f32::NAN, 0),
        ] {
            assert_eq!(encode_srgb(linear), expected, "{linear}");
        }
    }
}
