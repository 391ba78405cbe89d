//! PNG previews.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use png::{BitDepth, ColorType, Decoder, Encoder, EncodingError};

use super::file::{StagedFile, WriteError};
use super::image::Image;

/// Writes a preview: 8 bits per channel, encoded as sRGB, values clamped to [0, 1].
///
/// # Errors
/// If the file cannot be written.
pub fn write_png(path: &Path, image: &Image) -> Result<(), WriteError> {
    stage_png(path, image, &[])?.commit()
}

/// As [`write_png`], with `texts`, each with its keyword, and leaves it to the caller to commit the file.
///
/// # Errors
/// If the file cannot be written, or a keyword is not 1 to 79 Latin letters.
pub fn stage_png(
    path: &Path,
    image: &Image,
    texts: &[(&str, &str)],
) -> Result<StagedFile, WriteError> {
    let bytes = srgb_bytes(image, 1.0);
    let (width, height) = (image.width as u32, image.height as u32);
    StagedFile::write(path, |output| {
        let encode = || {
            let mut encoder = Encoder::new(output, width, height);
            encoder.set_color(ColorType::Rgb);
            encoder.set_depth(BitDepth::Eight);
            for &(keyword, text) in texts {
                encoder.add_text_chunk(keyword.into(), text.into())?;
            }
            let mut writer = encoder.write_header()?;
            writer.write_image_data(&bytes)?;
            writer.finish()
        };
        encode().map_err(|error| match error {
            EncodingError::IoError(error) => error,
            other => io::Error::other(other),
        })
    })
}

/// The text that `path`, a PNG file, has under a keyword. `None` if it has none or is not a PNG file.
pub fn png_text(path: &Path, keyword: &str) -> Option<String> {
    let decoder = Decoder::new(BufReader::new(File::open(path).ok()?));
    let reader = decoder.read_info().ok()?;
    let mut texts = reader.info().uncompressed_latin1_text.iter();
    let found = texts.find(|text| text.keyword == keyword)?;
    Some(found.text.clone())
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
