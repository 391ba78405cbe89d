//! `area`: a surface that emits equally in all directions. It is nested in the shape.

use super::parameters::emission;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::texture;
use crate::mitsuba::xml::{Object, Value};
use crate::scene::{EmitterDescription, Radiance};

pub fn radiance(builder: &mut Builder, object: &Object) -> Result<Radiance, LoadError> {
    match object.find("radiance").map(|property| &property.value) {
        Some(&Value::Object(index)) => {
            let texture = texture::texture(builder, index, texture::Range::NonNegative)?;
            Ok(Radiance::Texture(texture))
        }
        _ => emission(object, "radiance").map(Radiance::Constant),
    }
}

/// An area emitter anywhere else is an error.
pub fn outside_a_shape(_: &Builder, object: &Object) -> Result<EmitterDescription, LoadError> {
    Err(object.conflict("an area emitter must be nested in the shape that emits"))
}
