//! Colours: `<rgb>`, `<float>` or `<spectrum>`.

use glam::DVec3;

use super::error::LoadError;
use super::spectrum::{Viewing, to_rgb};
use super::xml::{Object, Property, Spectrum, Value};
use crate::math::Rgb;

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
        Value::Spectrum(ref spectrum) => of_spectrum(spectrum, quantity),
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

/// Colours of spectra by wavelength are clamped to the gamut, as in Mitsuba 3: they exceed it where a spectrum
/// is narrow, or a reflectance is 1.
fn of_spectrum(spectrum: &Spectrum, quantity: Quantity) -> DVec3 {
    let viewing = match quantity {
        Quantity::Emission => Viewing::Emitted,
        Quantity::Reflectance | Quantity::Index => Viewing::UnderD65,
    };
    let rgb = to_rgb(spectrum, viewing);
    match (spectrum, quantity) {
        (Spectrum::Uniform(_), _) => rgb,
        (Spectrum::Samples(_), Quantity::Reflectance) => rgb.clamp(DVec3::ZERO, DVec3::ONE),
        (Spectrum::Samples(_), _) => rgb.max(DVec3::ZERO),
    }
}
