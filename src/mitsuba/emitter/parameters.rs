//! Parameters that several emitters have.

use glam::{DMat3, DMat4, DVec3, DVec4};

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

/// A texture that is not modelled.
pub fn no_texture(object: &Object, name: &str) -> Result<(), LoadError> {
    match object.find(name) {
        Some(property) => Err(property.not_modelled("an image in the light of a point")),
        None => Ok(()),
    }
}

/// `to_world`, which may translate, rotate and reflect.
pub fn rigid_to_world(object: &Object) -> Result<DMat4, LoadError> {
    match object.transform("to_world")? {
        None => Ok(DMat4::IDENTITY),
        Some((m, _)) if m.row(3) == DVec4::W && is_similarity(m) && is_unscaled(m) => Ok(m),
        Some((_, property)) => {
            let feature = "scale and shear in the transform of this emitter; it may only translate, \
                           rotate and reflect";
            Err(property.not_modelled(feature))
        }
    }
}

fn is_unscaled(m: DMat4) -> bool {
    (m.x_axis.truncate().length() - 1.0).abs() < 1e-3
}

/// True if the linear part is a rotation, with or without reflection and uniform scale.
pub fn is_similarity(m: DMat4) -> bool {
    let m = DMat3::from_mat4(m);
    let gram = m.transpose() * m;
    let scale = gram.x_axis.x;
    scale > 0.0 && (gram / scale).abs_diff_eq(DMat3::IDENTITY, 1e-3)
}
