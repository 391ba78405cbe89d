//! The values of elements that give an object a parameter: `<float>`, `<rgb>`, ...

use glam::DVec3;

use super::attributes::Attributes;
use super::property::Value;
use super::value;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::source::Place;

/// Reads the value of an element from its attributes.
pub type Parse = fn(&mut Attributes) -> Result<Value, LoadError>;

/// The elements, and how the value of each is read.
pub const PARAMETERS: [(&str, Parse); 8] = [
    ("boolean", |attributes| {
        Ok(Value::Boolean(attributes.parse("value", value::boolean)?))
    }),
    ("float", |attributes| {
        Ok(Value::Float(attributes.parse("value", value::float)?))
    }),
    ("integer", |attributes| {
        Ok(Value::Integer(attributes.parse("value", value::integer)?))
    }),
    ("point", vector),
    ("rgb", |attributes| {
        Ok(Value::Rgb(attributes.parse("value", value::one_or_three)?))
    }),
    ("spectrum", spectrum),
    ("string", |attributes| {
        Ok(Value::Text(attributes.text("value")?.0))
    }),
    ("vector", vector),
];

/// `value` with one or three numbers, or `x`, `y` and `z`.
fn vector(attributes: &mut Attributes) -> Result<Value, LoadError> {
    if let Some(vector) = attributes.parse_optional("value", value::one_or_three)? {
        return Ok(Value::Vector(vector));
    }
    let x = attributes.parse("x", value::float)?;
    let y = attributes.parse("y", value::float)?;
    let z = attributes.parse("z", value::float)?;
    Ok(Value::Vector(DVec3::new(x, y, z)))
}

/// One value for all wavelengths.
fn spectrum(attributes: &mut Attributes) -> Result<Value, LoadError> {
    const ADVICE: &str = "spectra by wavelength; give <rgb value=\"red, green, blue\">, or a \
                          <spectrum> with one value";
    let not_modelled = |place: &Place| place.not_modelled(ADVICE);
    for name in ["type", "filename"] {
        if let Some((_, place)) = attributes.text_optional(name) {
            return Err(not_modelled(&place));
        }
    }
    let (text, place) = attributes.text("value")?;
    if text.contains(':') || value::tokens(&text).len() > 1 {
        return Err(not_modelled(&place));
    }
    let number = value::float(&text).map_err(|cause| place.error(cause))?;
    Ok(Value::Spectrum(number))
}
