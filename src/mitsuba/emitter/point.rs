//! `point`: a point that emits equally in all directions.

use glam::{DMat4, DVec3};

use super::parameters::{emission, vector_or_transform};
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::xml::Object;
use crate::scene::EmitterDescription;

pub fn point(_: &Builder, object: &Object) -> Result<EmitterDescription, LoadError> {
    let of_transform = |m: DMat4| m.transform_point3(DVec3::ZERO);
    Ok(EmitterDescription::Point {
        position: vector_or_transform(object, "position", of_transform)?,
        intensity: emission(object, "intensity")?,
    })
}
