//! `bitmap`: an image.

use super::loaded::LoadedTexture;
use super::to_uv::to_uv;
use crate::film::Decode;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::image_file::ImageFile;
use crate::mitsuba::xml::Object;
use crate::scene::Texture;
use crate::scene::texture::{Bitmap, Interpolation, Wrap};

pub fn bitmap<'a>(
    builder: &mut Builder<'a>,
    object: &'a Object,
) -> Result<LoadedTexture, LoadError> {
    let decode = decode(object)?;
    from_file(builder, object, decode)
}

/// The image that `filename` names, with the parameters of `bitmap` other than those that concern its encoding.
pub fn from_file<'a>(
    builder: &mut Builder<'a>,
    object: &'a Object,
    decode: Decode,
) -> Result<LoadedTexture, LoadError> {
    let interpolation = interpolation(builder, object)?;
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
    object.ignore(&["format", "accel", "cache"]);
    let file = ImageFile::read(builder, object, decode)?;
    if let Some(error) = file.invalid_pixel("finite", f32::is_finite) {
        return Err(error);
    }
    let is_reflectance = |x: f32| (0.0..=1.0).contains(&x);
    let out_of_range = file.invalid_pixel("between 0 and 1", is_reflectance);
    let negative = file.invalid_pixel("0 or above", |x| x >= 0.0);
    let image = file.image;
    let (width, height) = (image.width, image.height);
    let bitmap = Bitmap::new(width, height, image.pixels, interpolation, wrap, to_uv)
        .ok_or_else(|| object.missing("an image with pixels"))?;
    Ok(LoadedTexture {
        texture: Texture::Bitmap(bitmap),
        out_of_range,
        negative,
    })
}

/// `raw`, or the `gamma` of version 0.x: 1 for linear values, -1 for the encoding of the file.
fn decode(object: &Object) -> Result<Decode, LoadError> {
    let raw = object.boolean("raw", false)?;
    let gamma = object.float_in("gamma", -1.0, "finite", f64::is_finite)?;
    match object.find("gamma") {
        Some(property) if object.find("raw").is_some() => {
            Err(property.conflict("give either `raw` or `gamma`, not both"))
        }
        Some(property) if gamma != 1.0 && gamma != -1.0 => {
            let feature = "a `gamma` other than 1 (linear values) and -1 (that of sRGB)";
            Err(property.not_modelled(feature))
        }
        _ if raw || gamma == 1.0 => Ok(Decode::Raw),
        _ => Ok(Decode::Srgb),
    }
}

/// The filters of version 0.x with levels of detail differ from bilinear interpolation only where the image is
/// coarser than its texture.
fn interpolation(builder: &mut Builder, object: &Object) -> Result<Interpolation, LoadError> {
    object.ignore(&["max_anisotropy"]);
    let with_levels = ["trilinear", "ewa"];
    if let Some((name, property)) = object.text("filter_type")?
        && with_levels
            .iter()
            .any(|known| known.eq_ignore_ascii_case(name))
    {
        let text = format!(
            "`filter_type` \"{name}\" is read as \"bilinear\": a texture that is finer than the pixels of \
             the film is not blurred, but averaged over the samples of a pixel"
        );
        builder.warnings.push(property.warning(text));
        return Ok(Interpolation::Bilinear);
    }
    object.choice(
        "filter_type",
        Interpolation::Bilinear,
        &[
            ("bilinear", Interpolation::Bilinear),
            ("nearest", Interpolation::Nearest),
        ],
    )
}
