//! Pictures inside SVG documents.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::{PlotError, false_color};

/// A picture in the colours of a screen.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: usize,
    /// Pixels in a column.
    pub height: usize,
    /// sRGB, three bytes for each pixel, in rows from the top.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// `values` from 0 to 1 in false colours, in rows of `width` from the top.
    pub fn in_false_colors(width: usize, values: &[f64]) -> Self {
        Self {
            width,
            height: values.len() / width,
            rgb: values.iter().flat_map(|&v| false_color(v)).collect(),
        }
    }

    /// The picture as a PNG file within a URI, as the `href` of an SVG or HTML image takes it.
    ///
    /// # Errors
    /// If `rgb` has another length than the size says.
    pub fn data_uri(&self) -> Result<String, PlotError> {
        let mut png = Vec::new();
        let (width, height) = (self.width as u32, self.height as u32);
        if self.rgb.len() != 3 * self.width * self.height {
            return Err(PlotError::new(
                "a picture has not as many pixels as its size says",
            ));
        }
        PngEncoder::new(&mut png)
            .write_image(&self.rgb, width, height, ExtendedColorType::Rgb8)
            .map_err(PlotError::new)?;
        Ok(format!("data:image/png;base64,{}", STANDARD.encode(png)))
    }

    /// The picture as an SVG element with its top left corner at `(x, y)`, `width` wide, every pixel a
    /// sharp square.
    pub(super) fn element(&self, [x, y, width]: [f64; 3]) -> Result<String, PlotError> {
        let height = width * self.height as f64 / self.width as f64;
        Ok(format!(
            "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
             image-rendering=\"optimizeSpeed\" href=\"{}\"/>\n",
            self.data_uri()?
        ))
    }
}

/// Text of an SVG document, `size` units high, its baseline beginning at `(x, y)`, or centred there.
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

/// An SVG document on white paper.
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

/// The least width of a picture with a scale: its title and its scale need room.
const LEAST_WIDTH: f64 = 480.0;

/// Height of a line of text.
const LINE: f64 = 18.0;

/// Draws `picture`, which is in false colours, as an SVG document with `lines` of text over it, and
/// under it the colours from 0 to 1 with `marks`: places in that range, and what they stand for.
///
/// # Errors
/// If the picture is not one.
pub fn draw_with_scale(
    lines: &[&str],
    picture: &Picture,
    marks: &[(f64, String)],
) -> Result<String, PlotError> {
    let margin = 12.0;
    // Small pictures grow by a whole number.
    let factor = (LEAST_WIDTH / picture.width as f64).ceil().max(1.0);
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
        // A little wider than a step, so that no gap shows between two.
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
    for (place, label) in marks {
        // Labels at the ends stay within the paper.
        let x = margin + (width * place).clamp(18.0, width - 18.0);
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
    fn pixels_and_scale_are_where_they_belong() {
        let picture = Picture::in_false_colors(2, &[0.0, 1.0, f64::NAN, 0.5]);
        assert_eq!((picture.width, picture.height), (2, 2));
        let marks = [(0.0, "0".to_owned()), (1.0, "1 < 2".to_owned())];
        let image = rasterized(&draw_with_scale(&["a & b"], &picture, &marks).unwrap());
        assert_eq!(image.dimensions(), (504, 557));
        // Each pixel is 240 wide, from (12, 27) on; the scale begins at y = 517.
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
    fn a_picture_of_another_size_is_an_error() {
        let picture = Picture {
            width: 2,
            height: 2,
            rgb: vec![0; 11],
        };
        assert!(picture.data_uri().is_err());
    }
}
