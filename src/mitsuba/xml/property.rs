//! A parameter of an object: its value, its place, and the errors it can cause.

use std::cell::Cell;
use std::fmt;

use glam::{DMat4, DVec3};

use crate::mitsuba::error::{Cause, LoadError, Located};
use crate::mitsuba::source::Place;

/// Values by wavelength.
#[derive(Clone, Debug)]
pub enum Spectrum {
    /// One value for all wavelengths.
    Uniform(f64),
    /// Wavelengths in nanometres, increasing, and values; two or more.
    Samples(Vec<[f64; 2]>),
}

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
    /// `<spectrum>`.
    Spectrum(Spectrum),
    /// `<point>` or `<vector>`.
    Vector(DVec3),
    /// `<transform>`.
    Transform(DMat4),
    /// `<ref>` before it is resolved.
    Reference(String),
    /// The index of a nested or referenced object.
    Object(usize),
}

impl Value {
    /// The value of a float or an integer.
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

/// A parameter, or a nested object, whose name may be empty.
#[derive(Debug)]
pub struct Property {
    /// In the spelling of Mitsuba 3.
    pub name: String,
    /// The value.
    pub value: Value,
    /// Its element.
    pub place: Place,
    /// Set once the parameter has been read: unread parameters are errors.
    pub used: Cell<bool>,
}

impl Property {
    /// The value is not of the `expected` type.
    pub fn wrong_type(&self, expected: &str) -> LoadError {
        self.error(Cause::WrongType {
            name: self.name.clone(),
            expected: expected.to_owned(),
            found: self.value.kind().to_owned(),
        })
    }

    /// The value is not in `range`.
    pub fn out_of_range(&self, found: impl fmt::Display, range: &str) -> LoadError {
        self.error(Cause::OutOfRange {
            name: self.name.clone(),
            found: found.to_string(),
            range: range.to_owned(),
        })
    }

    /// The name `found`, of a `what`, is none of `known`.
    pub fn unknown_name<'a>(
        &self,
        what: &str,
        found: &str,
        known: impl Iterator<Item = &'a str>,
    ) -> LoadError {
        self.error(Cause::UnknownName {
            what: what.to_owned(),
            found: found.to_owned(),
            known: known.map(str::to_owned).collect(),
        })
    }
}

impl Located for Property {
    fn place(&self) -> &Place {
        &self.place
    }
}
