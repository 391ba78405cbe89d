//! `directional`: parallel light.

use glam::{DMat4, DVec3};

use super::parameters::{emission, vector_or_transform};
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{Cause, LoadError, Located};
use crate::mitsuba::xml::Object;
use crate::scene::EmitterDescription;

pub fn directional(_: &Builder, object: &Object) -> Result<EmitterDescription, LoadError> {
    let of_transform = |m: DMat4| m.transform_vector3(DVec3::Z);
    let direction = vector_or_transform(object, "direction", of_transform)?
        .try_normalize()
        .ok_or_else(|| object.error(Cause::zero_vector("direction")))?;
    Ok(EmitterDescription::Directional {
        direction,
        irradiance: emission(object, "irradiance")?,
    })
}
