//! `checkerboard`: two alternating colours.

use super::loaded::LoadedTexture;
use super::to_uv::to_uv;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::color::{Quantity, color};
use crate::mitsuba::error::LoadError;
use crate::mitsuba::xml::Object;
use crate::scene::Texture;

pub fn checkerboard(_: &mut Builder, object: &Object) -> Result<LoadedTexture, LoadError> {
    let texture = Texture::Checkerboard {
        color0: color(object, "color0", Quantity::Reflectance, 0.4)?,
        color1: color(object, "color1", Quantity::Reflectance, 0.2)?,
        to_uv: to_uv(object)?,
    };
    Ok(LoadedTexture {
        texture,
        out_of_range: None,
        negative: None,
    })
}
