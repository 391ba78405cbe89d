//! Colours: `<rgb>`, `<float>`, or `<spectrum>` with one value.

use glam::DVec3;

use super::error::LoadError;
use super::xml::{Object, Property, Value};
use crate::math::Rgb;

/// The linear sRGB colour of a spectrum that is 1 at all wavelengths (illuminant E), which differs
/// from the white point of sRGB (D65): row sums of the matrix from XYZ to linear sRGB of IEC
/// 61966-2-1. Mitsuba 3 uses it for an emitted `<spectrum>`.
const EQUAL_ENERGY: DVec3 = DVec3::new(1.204_794, 0.948_291, 0.908_916);

/// The physical quantity that a colour describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The reflected or transmitted fraction of light.
    Reflectance,
    /// Radiance, intensity or irradiance.
    Emission,
    /// Real or imaginary part of the refractive index of a metal.
    Index,
}

/// The colour `name` of an object; `default` if it is not given.
pub fn color(
    object: &Object,
    name: &str,
    quantity: Quantity,
    default: f32,
) -> Result<Rgb, LoadError> {
    match object.find(name) {
        Some(property) => of_property(property, quantity),
        None => Ok(Rgb::splat(default)),
    }
}

/// The colour of a parameter.
pub fn of_property(property: &Property, quantity: Quantity) -> Result<Rgb, LoadError> {
    let color = match property.value {
        Value::Float(grey) => DVec3::splat(grey),
        Value::Integer(grey) => DVec3::splat(grey as f64),
        Value::Spectrum(value) if quantity == Quantity::Emission => EQUAL_ENERGY * value,
        Value::Spectrum(value) => DVec3::splat(value),
        Value::Rgb(rgb) => rgb,
        _ => return Err(property.wrong_type("a colour: rgb, float or spectrum")),
    };
    let max = match quantity {
        Quantity::Reflectance => 1.0,
        Quantity::Emission | Quantity::Index => f64::from(f32::MAX),
    };
    if color.min_element() >= 0.0 && color.max_element() <= max {
        return Ok(color.as_vec3a());
    }
    let range = match quantity {
        Quantity::Reflectance => "between 0 and 1",
        Quantity::Emission | Quantity::Index => "0 or above, and not too large for an f32",
    };
    let found = format!("({}, {}, {})", color.x, color.y, color.z);
    Err(property.out_of_range(found, range))
}
