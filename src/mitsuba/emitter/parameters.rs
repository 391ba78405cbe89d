//! Parameters that several emitters have.

use glam::{DMat4, DVec3};

use crate::math::Rgb;
use crate::mitsuba::color::{self, Quantity};
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::xml::{Object, Value};

/// The radiance, intensity or irradiance `name`.
pub fn emission(object: &Object, name: &str) -> Result<Rgb, LoadError> {
    match object.find(name) {
        Some(property) if matches!(property.value, Value::Object(_)) => {
            Err(property.not_modelled("light that varies over an emitter; give a colour"))
        }
        _ => color::color(object, name, Quantity::Emission, 1.0),
    }
}

/// The vector `name`, or `of_transform` of the transform `to_world`.
pub fn vector_or_transform(
    object: &Object,
    name: &str,
    of_transform: impl Fn(DMat4) -> DVec3,
) -> Result<DVec3, LoadError> {
    match (object.vector(name)?, object.transform("to_world")?) {
        (Some(vector), None) => Ok(vector),
        (None, given) => Ok(of_transform(given.map_or(DMat4::IDENTITY, |(m, _)| m))),
        (Some(_), Some((_, property))) => {
            Err(property.conflict(format!("give either `{name}` or `to_world`, not both")))
        }
    }
}
