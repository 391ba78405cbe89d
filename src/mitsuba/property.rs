//! A parameter of an object: its value, where it stands, and what can be wrong with it.

use std::cell::Cell;
use std::fmt;

use glam::{DMat4, DVec3};

use super::error::{Cause, LoadError};
use super::source::Place;

/// The value of a parameter.
#[derive(Clone, Debug)]
pub enum Value {
    /// `<float>`.
    Float(f64),
    /// `<integer>`.
    Integer(i64),
    /// `<boolean>`.
    Boolean(bool),
    /// `<string>`.
    Text(String),
    /// `<rgb>`.
    Rgb(DVec3),
    /// `<spectrum>` with the same value at all wavelengths.
    Spectrum(f64),
    /// `<point>` or `<vector>`.
    Vector(DVec3),
    /// `<transform>`.
    Transform(DMat4),
    /// `<ref>` before it is resolved.
    Reference(String),
    /// An object, nested or referenced: its index.
    Object(usize),
}

impl Value {
    /// A number; a whole one will do.
    pub fn as_float(&self) -> Option<f64> {
        match self {
            Value::Float(x) => Some(*x),
            Value::Integer(i) => Some(*i as f64),
            _ => None,
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Value::Float(_) => "a float",
            Value::Integer(_) => "an integer",
            Value::Boolean(_) => "a boolean",
            Value::Text(_) => "a string",
            Value::Rgb(_) => "an rgb",
            Value::Spectrum(_) => "a spectrum",
            Value::Vector(_) => "a point or vector",
            Value::Transform(_) => "a transform",
            Value::Reference(_) => "a reference",
            Value::Object(_) => "an object",
        }
    }
}

/// A parameter, or with an empty name a nested object that needs none.
#[derive(Debug)]
pub struct Property {
    /// In Mitsuba 3's spelling.
    pub name: String,
    /// Value.
    pub value: Value,
    /// Where it stands.
    pub place: Place,
    /// Somebody asked for it.
    pub used: Cell<bool>,
}

impl Property {
    /// A fault of this parameter.
    pub fn error(&self, cause: Cause) -> LoadError {
        LoadError::at(&self.place, cause)
    }

    /// It should have been something else.
    pub fn wrong_type(&self, expected: &str) -> LoadError {
        self.error(Cause::WrongType {
            name: self.name.clone(),
            expected: expected.to_owned(),
            found: self.value.kind().to_owned(),
        })
    }

    /// Its value is not in `range`.
    pub fn out_of_range(&self, found: impl fmt::Display, range: &str) -> LoadError {
        self.error(Cause::OutOfRange {
            name: self.name.clone(),
            found: found.to_string(),
            range: range.to_owned(),
        })
    }
}
