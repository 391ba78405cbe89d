//! Raster images inside SVG documents.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::{PlotError, false_color};

/// A raster image in sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Three bytes per pixel, in rows from top to bottom.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// `values` in [0, 1] as false colours, in rows of `width` pixels from top to bottom.
    pub fn in_false_colors(width: usize, values: &[f64]) -> Self {
        Self {
            width,
            height: values.len() / width,
            rgb: values.iter().flat_map(|&v| false_color(v)).collect(),
        }
    }

    /// The picture as a PNG file in a data URI, for the `href` of an SVG or HTML image.
    ///
    /// # Errors
    /// If the length of `rgb` does not match the size.
    pub fn data_uri(&self) -> Result<String, PlotError> {
        let mut png = Vec::new();
        let (width, height) = (self.width as u32, self.height as u32);
        if self.rgb.len() != 3 * self.width * self.height {
            return Err(PlotError::new(
                "the number of pixels does not match the size of the picture",
            ));
        }
        PngEncoder::new(&mut png)
            .write_image(&self.rgb, width, height, ExtendedColorType::Rgb8)
            .map_err(PlotError::new)?;
        Ok(format!("data:image/png;base64,{}", STANDARD.encode(png)))
    }

    /// The picture as an SVG element of the given width, with its top left corner at `(x, y)`,
    /// without interpolation between pixels.
    pub(super) fn element(&self, [x, y, width]: [f64; 3]) -> Result<String, PlotError> {
        let height = width * self.height as f64 / self.width as f64;
        Ok(format!(
            "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
             image-rendering=\"optimizeSpeed\" href=\"{}\"/>\n",
            self.data_uri()?
        ))
    }
}

/// Text in an SVG document with font size `size`. Its baseline begins at `(x, y)` or is centred
/// there.
pub(super) fn text([x, y, size]: [f64; 3], centred: bool, text: &str) -> String {
    let anchor = if centred {
        " text-anchor=\"middle\""
    } else {
        ""
    };
    format!(
        "<text x=\"{x}\" y=\"{y}\" font-family=\"sans-serif\" font-size=\"{size}\"{anchor}>{}</text>\n",
        escaped(text)
    )
}

/// An SVG document with a white background.
pub(super) fn document([width, height]: [f64; 2], body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{body}</svg>\n"
    )
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

/// Minimum width of a picture with a colour scale, so that its title and scale fit, in pixels.
const MIN_WIDTH: f64 = 480.0;

/// Height of a line of text, in pixels.
const LINE: f64 = 18.0;

/// Draws `picture`, which is in false colours, as an SVG document: `lines` of text above it, and
/// below it the colour scale from 0 to 1. `marks` are positions on the scale and their labels.
///
/// # Errors
/// If the data of the picture does not match its size.
pub fn draw_with_scale(
    lines: &[&str],
    picture: &Picture,
    marks: &[(f64, String)],
) -> Result<String, PlotError> {
    let margin = 12.0;
    // Small pictures are enlarged by an integer factor.
    let factor = (MIN_WIDTH / picture.width as f64).ceil().max(1.0);
    let (width, height) = (
        factor * picture.width as f64,
        factor * picture.height as f64,
    );
    let mut body = String::new();
    for (line, number) in lines.iter().zip(1..) {
        let size = if number == 1 { 15.0 } else { 12.0 };
        body += &text([margin, LINE * f64::from(number), size], false, line);
    }
    let top = LINE * lines.len() as f64 + 0.5 * LINE;
    body += &picture.element([margin, top, width])?;
    let scale_top = top + height + 10.0;
    let steps = 64;
    let colors: Vec<f64> = (0..steps)
        .map(|i| f64::from(i) / f64::from(steps - 1))
        .collect();
    for (i, color) in colors.iter().enumerate() {
        let [r, g, b] = false_color(*color);
        // Steps overlap a little, so that no gap is visible between them.
        let (x, step) = (
            width * i as f64 / f64::from(steps),
            width / f64::from(steps),
        );
        let step = if i + 1 < colors.len() {
            step + 1.0
        } else {
            step
        };
        body += &format!(
            "<rect x=\"{}\" y=\"{scale_top}\" width=\"{step}\" height=\"12\" fill=\"rgb({r},{g},{b})\"/>\n",
            margin + x
        );
    }
    for (position, label) in marks {
        // Labels at the ends stay inside the document.
        let x = margin + (width * position).clamp(18.0, width - 18.0);
        body += &text([x, scale_top + 28.0, 12.0], true, label);
    }
    Ok(document([width + 2.0 * margin, scale_top + 40.0], &body))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rasterized(svg: &str) -> image::RgbImage {
        let png = super::super::rasterize(svg, 1.0).unwrap();
        image::load_from_memory(&png).unwrap().into_rgb8()
    }

    #[test]
    fn pixels_and_scale_are_drawn_in_place() {
        let picture = Picture::in_false_colors(2, &[0.0, 1.0, f64::NAN, 0.5]);
        assert_eq!((picture.width, picture.height), (2, 2));
        let marks = [(0.0, "0".to_owned()), (1.0, "1 < 2".to_owned())];
        let image = rasterized(&draw_with_scale(&["a & b"], &picture, &marks).unwrap());
        assert_eq!(image.dimensions(), (504, 557));
        // Each pixel is 240 wide, starting at (12, 27); the scale begins at y = 517.
        for (x, y, value) in [
            (20, 40, 0.0),
            (490, 40, 1.0),
            (245, 400, f64::NAN),
            (258, 500, 0.5),
            (13, 520, 0.0),
            (490, 520, 1.0),
        ] {
            assert_eq!(image.get_pixel(x, y).0, false_color(value), "{x} {y}");
        }
        let dark = |row: u32| (0..504).any(|x| image.get_pixel(x, row).0[0] < 128);
        assert!((8..20).any(dark) && (535..557).any(dark));
    }

    #[test]
    fn data_that_does_not_match_the_size_is_an_error() {
        let picture = Picture {
            width: 2,
            height: 2,
            rgb: vec![0; 11],
        };
        assert!(picture.data_uri().is_err());
    }
}
