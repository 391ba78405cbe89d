//! `texture`: bitmap and checkerboard, wherever a reflectance is taken.

use glam::{Affine2, DMat4, Mat2, Vec2};

use super::color::{self, Quantity};
use super::error::{Cause, LoadError};
use super::object::Object;
use super::property::Value;
use super::scene::Builder;
use crate::film::{Decode, Image, read_image};
use crate::scene::Texture;
use crate::scene::texture::{Bitmap, Interpolation, Wrap};

/// The reflectance `name` of a material, as the index of a texture.
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
    Ok(push(builder, Texture::Constant(color)))
}

/// The texture at `index`, as an index among the textures.
pub fn texture(builder: &mut Builder, index: usize) -> Result<u32, LoadError> {
    if let Some(&texture) = builder.texture_of.get(&index) {
        return Ok(texture);
    }
    let object = builder.object(index);
    let texture = match object.plugin.as_str() {
        "bitmap" => bitmap(builder, object)?,
        "checkerboard" => Texture::Checkerboard {
            color0: color::color(object, "color0", Quantity::Reflectance, 0.4)?,
            color1: color::color(object, "color1", Quantity::Reflectance, 0.2)?,
            to_uv: to_uv(object)?,
        },
        _ => return Err(object.unknown_plugin(&["bitmap", "checkerboard"])),
    };
    builder.finish(object)?;
    let texture = push(builder, texture);
    builder.texture_of.insert(index, texture);
    Ok(texture)
}

fn push(builder: &mut Builder, texture: Texture) -> u32 {
    builder.textures.push(texture);
    (builder.textures.len() - 1) as u32
}

fn bitmap(builder: &Builder, object: &Object) -> Result<Texture, LoadError> {
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
    let range = "between 0 and 1";
    let image = image(builder, object, decode, range, is_reflectance)?;
    let (width, height) = (image.width, image.height);
    Bitmap::new(width, height, image.pixels, interpolation, wrap, to_uv)
        .map(Texture::Bitmap)
        .ok_or_else(|| object.missing("an image with pixels"))
}

/// The image that `filename` names, all of whose values must satisfy `is_valid`.
pub fn image(
    builder: &Builder,
    object: &Object,
    decode: Decode,
    range: &'static str,
    is_valid: impl Fn(f32) -> bool,
) -> Result<Image, LoadError> {
    let (Some(name), Some(property)) = (object.text("filename")?, object.find("filename")) else {
        return Err(object.missing("the string `filename`"));
    };
    let path = builder.tree.locate(name, &property.place);
    let image = match read_image(&path, decode) {
        Ok(image) => image,
        Err(error) => return Err(property.error(Cause::Image { path, error })),
    };
    let invalid = image
        .pixels
        .iter()
        .position(|p| !p.iter().all(|&x| is_valid(x)));
    match invalid {
        None => Ok(image),
        Some(i) => Err(property.error(Cause::ImageValue {
            path,
            pixel: [i % image.width, i / image.width],
            value: image.pixels[i],
            range,
        })),
    }
}

/// The upper left 2 x 2 entries of a transform, and its translation: what is left of it in the plane.
fn to_uv(object: &Object) -> Result<Affine2, LoadError> {
    let m: DMat4 = object.transform("to_uv")?;
    let column = |i: usize| Vec2::new(m.col(i).x as f32, m.col(i).y as f32);
    let linear = Mat2::from_cols(column(0), column(1));
    Ok(Affine2::from_mat2_translation(linear, column(3)))
}
