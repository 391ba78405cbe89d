//! `area`: a surface that emits equally in all directions. It is nested in the shape.

use super::parameters::emission;
use crate::math::Rgb;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::xml::Object;
use crate::scene::EmitterDescription;

pub fn radiance(object: &Object) -> Result<Rgb, LoadError> {
    emission(object, "radiance")
}

/// An area emitter anywhere else is an error.
pub fn outside_a_shape(_: &Builder, object: &Object) -> Result<EmitterDescription, LoadError> {
    Err(object.conflict("an area emitter must be nested in the shape that emits"))
}
