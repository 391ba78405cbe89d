//! The values of elements that give an object a parameter: `<float>`, `<rgb>`, ...

use glam::DVec3;

use super::attributes::Attributes;
use super::property::Value;
use super::within::Within;
use super::{spectrum, value};
use crate::mitsuba::error::LoadError;

/// Reads the value of an element from its attributes.
pub type Parse = fn(&mut Attributes, &Within) -> Result<Value, LoadError>;

/// The elements, and how the value of each is read.
pub const PARAMETERS: [(&str, Parse); 10] = [
    ("blackbody", spectrum::blackbody),
    ("boolean", |attributes, _| {
        Ok(Value::Boolean(attributes.parse("value", value::boolean)?))
    }),
    ("float", |attributes, _| {
        Ok(Value::Float(attributes.parse("value", value::float)?))
    }),
    ("integer", |attributes, _| {
        Ok(Value::Integer(attributes.parse("value", value::integer)?))
    }),
    ("point", vector),
    ("rgb", |attributes, _| {
        attributes.text_optional("intent");
        Ok(Value::Rgb(attributes.parse("value", value::one_or_three)?))
    }),
    ("spectrum", spectrum::spectrum),
    ("srgb", spectrum::srgb),
    ("string", |attributes, _| {
        Ok(Value::Text(attributes.text("value")?.0))
    }),
    ("vector", vector),
];

/// `value` with one or three numbers, or `x`, `y` and `z`.
fn vector(attributes: &mut Attributes, _: &Within) -> Result<Value, LoadError> {
    if let Some(vector) = attributes.parse_optional("value", value::one_or_three)? {
        return Ok(Value::Vector(vector));
    }
    let x = attributes.parse("x", value::float)?;
    let y = attributes.parse("y", value::float)?;
    let z = attributes.parse("z", value::float)?;
    Ok(Value::Vector(DVec3::new(x, y, z)))
}
