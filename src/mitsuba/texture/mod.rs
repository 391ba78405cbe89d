//! `texture`: textures, and reflectances that may be textures.

mod bitmap;
mod checkerboard;
mod loaded;
mod to_uv;

use super::builder::Builder;
use super::color::{self, Quantity};
use super::error::LoadError;
use super::xml::{Object, Value};
use crate::film::Decode;
use crate::scene::Texture;
use loaded::LoadedTexture;

type Constructor = for<'a> fn(&mut Builder<'a>, &'a Object) -> Result<LoadedTexture, LoadError>;

/// The textures.
const PLUGINS: [(&str, Constructor); 2] = [
    ("bitmap", bitmap::bitmap),
    ("checkerboard", checkerboard::checkerboard),
];

/// The values that a texture may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// From 0 to 1.
    UnitInterval,
    /// Any finite values that are not negative.
    NonNegative,
    /// Any finite values.
    Any,
}

/// The texture at `index`, as an index of [`Builder::textures`].
pub fn texture(builder: &mut Builder, index: usize, range: Range) -> Result<u32, LoadError> {
    let texture = match builder.texture_of.get(&index) {
        Some(&texture) => texture,
        None => new_texture(builder, index)?,
    };
    let error = match range {
        Range::UnitInterval => builder.out_of_range.remove(&texture),
        Range::NonNegative => builder.negative.remove(&texture),
        Range::Any => None,
    };
    error.map_or(Ok(texture), Err)
}

fn new_texture(builder: &mut Builder, index: usize) -> Result<u32, LoadError> {
    let object = builder.object(index);
    let loaded = object.find_plugin(&PLUGINS)?(builder, object)?;
    builder.finish(object)?;
    let texture = add(builder, loaded);
    builder.texture_of.insert(index, texture);
    Ok(texture)
}

fn add(builder: &mut Builder, loaded: LoadedTexture) -> u32 {
    let texture = builder.add_texture(loaded.texture);
    if let Some(error) = loaded.out_of_range {
        builder.out_of_range.insert(texture, error);
    }
    if let Some(error) = loaded.negative {
        builder.negative.insert(texture, error);
    }
    texture
}

/// The image that the parameter `filename` of `object` names, as an index of [`Builder::textures`]. Its values
/// may be any finite ones.
pub fn bitmap_file<'a>(
    builder: &mut Builder<'a>,
    object: &'a Object,
    decode: Decode,
) -> Result<u32, LoadError> {
    let loaded = bitmap::from_file(builder, object, decode)?;
    Ok(add(builder, loaded))
}

/// The nested texture `name`, as an index of [`Builder::textures`].
pub fn required_texture(
    builder: &mut Builder,
    object: &Object,
    name: &str,
    range: Range,
) -> Result<u32, LoadError> {
    match object
        .find(name)
        .map(|property| (property, &property.value))
    {
        Some((_, Value::Object(index))) => texture(builder, *index, range),
        Some((property, _)) => Err(property.wrong_type("a texture")),
        None => Err(object.missing(&format!("the texture `{name}`"))),
    }
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
        return texture(builder, index, Range::UnitInterval);
    }
    let color = color::color(object, name, Quantity::Reflectance, default)?;
    Ok(builder.add_texture(Texture::Constant(color)))
}
