//! `envmap`: radiance from all directions, given by an image.

use glam::DMat4;

use super::parameters::is_similarity;
use crate::film::Decode;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::image_file::image;
use crate::mitsuba::xml::Object;
use crate::scene::EmitterDescription;

pub fn envmap(builder: &Builder, object: &Object) -> Result<EmitterDescription, LoadError> {
    let is_valid = |x: f64| x >= 0.0 && x <= f64::from(f32::MAX);
    let scale = object.float_in("scale", 1.0, "0 or above", is_valid)?;
    let to_world = match object.transform("to_world")? {
        None => DMat4::IDENTITY,
        Some((matrix, _)) if is_similarity(matrix) => matrix,
        Some((_, property)) => {
            let feature = "a stretched or sheared environment map; its transform may only rotate \
                           and reflect";
            return Err(property.not_modelled(feature));
        }
    };
    object.ignore(&["mis_compensation", "cache"]);
    let is_radiance = |x: f32| x >= 0.0 && x.is_finite();
    let range = "0 or above, and finite";
    let image = image(builder, object, Decode::Srgb, range, is_radiance)?;
    Ok(EmitterDescription::Environment {
        width: image.width,
        pixels: image.pixels,
        scale: scale as f32,
        to_world,
    })
}
