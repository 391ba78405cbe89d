//! Colours: `<rgb>`, `<float>`, or `<spectrum>` with one value.

use glam::DVec3;

use super::error::LoadError;
use super::object::Object;
use super::property::{Property, Value};
use crate::math::Rgb;

/// The colour in linear sRGB of a spectrum that is 1 at all wavelengths: light of equal energy is not
/// the white (D65) of sRGB. Row sums of the matrix from XYZ to linear sRGB of IEC 61966-2-1, as
/// Mitsuba 3 applies it to a `<spectrum>` that is emitted.
const EQUAL_ENERGY: DVec3 = DVec3::new(1.204_794, 0.948_291, 0.908_916);

/// What a colour measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Fraction of light.
    Reflectance,
    /// Radiance, intensity, irradiance.
    Emission,
    /// Index of refraction of a metal, or its imaginary part.
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

/// The colour that a parameter gives.
pub fn of_property(property: &Property, quantity: Quantity) -> Result<Rgb, LoadError> {
    let color = match property.value {
        Value::Float(grey) => DVec3::splat(grey),
        Value::Integer(grey) => DVec3::splat(grey as f64),
        Value::Spectrum(value) if quantity == Quantity::Emission => EQUAL_ENERGY * value,
        Value::Spectrum(value) => DVec3::splat(value),
        Value::Rgb(rgb) => rgb,
        _ => return Err(property.wrong_type("a colour: rgb, float or spectrum")),
    };
    let most = match quantity {
        Quantity::Reflectance => 1.0,
        Quantity::Emission | Quantity::Index => f64::from(f32::MAX),
    };
    if color.min_element() >= 0.0 && color.max_element() <= most {
        return Ok(color.as_vec3a());
    }
    let range = match quantity {
        Quantity::Reflectance => "between 0 and 1",
        Quantity::Emission | Quantity::Index => "0 or above, and not too large for a number",
    };
    let found = format!("({}, {}, {})", color.x, color.y, color.z);
    Err(property.out_of_range(found, range))
}
