//! Refractive indices.

use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::xml::{Object, Property, Value};
use crate::scene::bsdf::ior::{ior, ior_names};

/// Maximum refractive index; the minimum is its inverse.
const MAX_IOR: f64 = 1000.0;

/// `int_ior` over `ext_ior`. `inside` names the medium inside by default.
pub fn relative_ior(object: &Object, inside: &str) -> Result<f32, LoadError> {
    let index = |name: &str, default: &str| match object.find(name) {
        Some(property) => refractive_index(property),
        None => ior(default).ok_or_else(|| object.missing(&format!("`{name}`"))),
    };
    Ok(index("int_ior", inside)? / index("ext_ior", "air")?)
}

/// As [`relative_ior`], for rough interfaces. Like Mitsuba it rejects equal indices, for which the
/// interface has no effect.
pub fn differing_ior(object: &Object, inside: &str) -> Result<f32, LoadError> {
    match relative_ior(object, inside)? {
        1.0 => Err(object.conflict("`int_ior` and `ext_ior` must differ for a rough surface")),
        eta => Ok(eta),
    }
}

/// A number, or the name of a medium.
pub fn refractive_index(property: &Property) -> Result<f32, LoadError> {
    if let Value::Text(name) = &property.value {
        let found = ior(&name.to_lowercase());
        return found.ok_or_else(|| property.unknown_name("medium", name, ior_names()));
    }
    let number = property.value.as_float();
    let number = number.ok_or_else(|| property.wrong_type("a number or the name of a medium"))?;
    if number >= MAX_IOR.recip() && number <= MAX_IOR {
        return Ok(number as f32);
    }
    let range = format!("between {} and {MAX_IOR}", MAX_IOR.recip());
    Err(property.out_of_range(number, &range))
}
