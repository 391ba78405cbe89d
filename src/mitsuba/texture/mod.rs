//! `texture`: textures, and reflectances that may be textures.

mod bitmap;
mod checkerboard;
mod to_uv;

use super::builder::Builder;
use super::color::{self, Quantity};
use super::error::LoadError;
use super::xml::{Object, Value};
use crate::scene::Texture;

type Constructor = fn(&Builder, &Object) -> Result<Texture, LoadError>;

/// The textures.
const PLUGINS: [(&str, Constructor); 2] = [
    ("bitmap", bitmap::bitmap),
    ("checkerboard", checkerboard::checkerboard),
];

/// The texture at `index`, as an index of [`Builder::textures`].
pub fn texture(builder: &mut Builder, index: usize) -> Result<u32, LoadError> {
    if let Some(&texture) = builder.texture_of.get(&index) {
        return Ok(texture);
    }
    let object = builder.object(index);
    let texture = object.find_plugin(&PLUGINS)?(builder, object)?;
    builder.finish(object)?;
    let texture = builder.add_texture(texture);
    builder.texture_of.insert(index, texture);
    Ok(texture)
}

/// The reflectance `name` of a material, as an index of [`Builder::textures`].
pub fn reflectance(
    builder: &mut Builder,
    object: &Object,
    name: &str,
    default: f32,
) -> Result<u32, LoadError> {
    if let Some(property) = object.find(name)
        && let Value::Object(index) = property.value
    {
        return texture(builder, index);
    }
    let color = color::color(object, name, Quantity::Reflectance, default)?;
    Ok(builder.add_texture(Texture::Constant(color)))
}
