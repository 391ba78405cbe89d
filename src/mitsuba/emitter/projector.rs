//! `projector`: a point that lights a square, the same everywhere in it.

use super::parameters::{emission, rigid_to_world};
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::field_of_view::horizontal_fov;
use crate::mitsuba::xml::Object;
use crate::scene::EmitterDescription;

/// Without an image the light has the shape of one pixel.
const ASPECT: f64 = 1.0;

pub fn projector(_: &Builder, object: &Object) -> Result<EmitterDescription, LoadError> {
    let is_valid = |x: f64| x >= 0.0 && x <= f64::from(f32::MAX);
    let scale = object.float_in("scale", 1.0, "0 or above", is_valid)?;
    Ok(EmitterDescription::Projector {
        to_world: rigid_to_world(object)?,
        fov: horizontal_fov(object, ASPECT)?,
        irradiance: emission(object, "irradiance")? * scale as f32,
    })
}
