//! `bitmap`: an image.

use super::to_uv::to_uv;
use crate::film::Decode;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::image_file::image;
use crate::mitsuba::xml::Object;
use crate::scene::Texture;
use crate::scene::texture::{Bitmap, Interpolation, Wrap};

pub fn bitmap(builder: &Builder, object: &Object) -> Result<Texture, LoadError> {
    let decode = match object.boolean("raw", false)? {
        true => Decode::Raw,
        false => Decode::Srgb,
    };
    let interpolation = object.choice(
        "filter_type",
        Interpolation::Bilinear,
        &[
            ("bilinear", Interpolation::Bilinear),
            ("nearest", Interpolation::Nearest),
        ],
    )?;
    let wrap = object.choice(
        "wrap_mode",
        Wrap::Repeat,
        &[
            ("repeat", Wrap::Repeat),
            ("mirror", Wrap::Mirror),
            ("clamp", Wrap::Clamp),
        ],
    )?;
    let to_uv = to_uv(object)?;
    object.ignore(&["format", "accel"]);
    let is_reflectance = |x: f32| (0.0..=1.0).contains(&x);
    let image = image(builder, object, decode, "between 0 and 1", is_reflectance)?;
    let (width, height) = (image.width, image.height);
    Bitmap::new(width, height, image.pixels, interpolation, wrap, to_uv)
        .map(Texture::Bitmap)
        .ok_or_else(|| object.missing("an image with pixels"))
}
