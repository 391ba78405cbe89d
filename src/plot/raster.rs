//! Conversion of SVG to PNG.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use super::PlotError;

/// The family of the font below.
const FAMILY: &str = "Ubuntu";

/// Renders an SVG document at `scale` pixels per unit and returns the bytes of a PNG file. Text of
/// the family `sans-serif` uses a font that comes with the program, so the result does not depend
/// on the fonts of the system.
///
/// # Errors
/// If `svg` is not an SVG document or has no size.
pub fn rasterize(svg: &str, scale: f32) -> Result<Vec<u8>, PlotError> {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    fonts.set_sans_serif_family(FAMILY);
    let options = Options {
        fontdb: Arc::new(fonts),
        font_family: FAMILY.into(),
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options).map_err(PlotError::new)?;
    let size = tree
        .size()
        .to_int_size()
        .scale_by(scale)
        .ok_or_else(|| PlotError::new("it has no size"))?;
    let mut pixels = Pixmap::new(size.width(), size.height())
        .ok_or_else(|| PlotError::new("it is too large"))?;
    resvg::render(
        &tree,
        Transform::from_scale(scale, scale),
        &mut pixels.as_mut(),
    );
    pixels.encode_png().map_err(PlotError::new)
}

#[cfg(test)]
mod tests {
    use super::rasterize;

    fn pixels(svg: &str) -> image::RgbaImage {
        let png = rasterize(svg, 2.0).unwrap();
        image::load_from_memory(&png).unwrap().into_rgba8()
    }

    #[test]
    fn shapes_and_text_are_drawn() {
        let head = "<svg xmlns='http://www.w3.org/2000/svg' width='60' height='20'>";
        let rect = pixels(&format!(
            "{head}<rect width='30' height='20' fill='red'/></svg>"
        ));
        assert_eq!(rect.dimensions(), (120, 40));
        assert_eq!(rect.get_pixel(10, 10).0, [255, 0, 0, 255]);
        assert_eq!(rect.get_pixel(100, 10).0, [0; 4]);
        let text = pixels(&format!(
            "{head}<text y='15' font-family='sans-serif'>text</text></svg>"
        ));
        assert!(text.pixels().filter(|p| p.0[3] > 128).count() > 100);
    }

    #[test]
    fn invalid_svg_is_an_error() {
        assert!(rasterize("hello", 1.0).is_err());
    }
}
