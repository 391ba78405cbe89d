//! Objects of a scene file (shapes, materials, ...) and their parameters. Whoever builds something
//! from an object asks for the parameters it knows; what nobody asked for is an error.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;

use glam::{DMat4, DVec3};

use super::error::{Cause, LoadError};
use super::property::{Property, Value};
use super::source::Place;

/// What kind of object an element stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tag {
    /// The whole.
    Scene,
    /// A material.
    Bsdf,
    /// A light.
    Emitter,
    /// An image to be.
    Film,
    /// A method.
    Integrator,
    /// A source of randomness.
    Sampler,
    /// A camera.
    Sensor,
    /// A surface.
    Shape,
    /// A colour over a surface.
    Texture,
    /// A reconstruction filter.
    Rfilter,
}

impl Tag {
    /// All, with the names of their elements.
    pub const ALL: [(&'static str, Tag); 10] = [
        ("bsdf", Tag::Bsdf),
        ("emitter", Tag::Emitter),
        ("film", Tag::Film),
        ("integrator", Tag::Integrator),
        ("rfilter", Tag::Rfilter),
        ("sampler", Tag::Sampler),
        ("scene", Tag::Scene),
        ("sensor", Tag::Sensor),
        ("shape", Tag::Shape),
        ("texture", Tag::Texture),
    ];

    /// The element's name.
    pub fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(_, tag)| *tag == self)
            .map_or("", |(name, _)| name)
    }
}

/// An object of a scene file.
#[derive(Debug)]
pub struct Object {
    /// Kind.
    pub tag: Tag,
    /// Its type: `sphere`, `diffuse`, ...
    pub plugin: String,
    /// Its id, if it has one.
    pub id: Option<String>,
    /// Its start tag.
    pub place: Place,
    /// In the order of the file.
    pub properties: Vec<Property>,
    /// Names of parameters that somebody asked for.
    asked: RefCell<BTreeSet<String>>,
}

impl Object {
    /// An object that has no parameters yet.
    pub fn new(tag: Tag, plugin: String, id: Option<String>, place: Place) -> Self {
        Self {
            tag,
            plugin,
            id,
            place,
            properties: Vec::new(),
            asked: RefCell::default(),
        }
    }

    /// Takes a parameter or, with an empty name, a nested object.
    pub fn add(&mut self, name: String, value: Value, place: Place) -> Result<(), LoadError> {
        if let Some(first) = self
            .properties
            .iter()
            .find(|p| !name.is_empty() && p.name == name)
        {
            let first = first.place.clone();
            return Err(LoadError::at(
                &place,
                Cause::DuplicateParameter { name, first },
            ));
        }
        self.properties.push(Property {
            name,
            value,
            place,
            used: Cell::new(false),
        });
        Ok(())
    }

    /// How messages call it: `sphere`, or `scene` for the scene.
    pub fn title(&self) -> String {
        match self.tag {
            Tag::Scene => "the scene".to_owned(),
            tag => format!("{} `{}`", tag.name(), self.plugin),
        }
    }

    /// A fault of the object as a whole.
    pub fn error(&self, cause: Cause) -> LoadError {
        LoadError::at(&self.place, cause)
    }

    /// Its type is none of `known`.
    pub fn unknown_plugin(&self, known: &[&str]) -> LoadError {
        self.error(Cause::UnknownPlugin {
            kind: self.tag.name().to_owned(),
            found: self.plugin.clone(),
            known: known.iter().map(|&name| name.to_owned()).collect(),
        })
    }

    /// A parameter that it needs is missing.
    pub fn missing(&self, parameter: &str) -> LoadError {
        self.error(Cause::MissingParameter {
            owner: self.title(),
            parameter: parameter.to_owned(),
        })
    }

    /// The parameter `name`, if it is given.
    pub fn find(&self, name: &str) -> Option<&Property> {
        self.asked.borrow_mut().insert(name.to_owned());
        let property = self.properties.iter().find(|p| p.name == name)?;
        property.used.set(true);
        Some(property)
    }

    /// Takes a parameter out.
    pub fn remove(&mut self, name: &str) -> Option<Property> {
        let index = self.properties.iter().position(|p| p.name == name)?;
        Some(self.properties.remove(index))
    }

    /// A number.
    pub fn float(&self, name: &str) -> Result<Option<f64>, LoadError> {
        self.typed(name, "a float", Value::as_float)
    }

    /// A number in a range that `is_valid` tells and `range` describes.
    pub fn float_in(
        &self,
        name: &str,
        default: f64,
        range: &str,
        is_valid: impl Fn(f64) -> bool,
    ) -> Result<f64, LoadError> {
        match (self.float(name)?, self.find(name)) {
            (Some(x), Some(property)) if !is_valid(x) => Err(property.out_of_range(x, range)),
            (x, _) => Ok(x.unwrap_or(default)),
        }
    }

    /// A whole number.
    pub fn integer(&self, name: &str) -> Result<Option<i64>, LoadError> {
        self.typed(name, "an integer", |value| match value {
            Value::Integer(i) => Some(*i),
            _ => None,
        })
    }

    /// `true` or `false`.
    pub fn boolean(&self, name: &str, default: bool) -> Result<bool, LoadError> {
        let value = self.typed(name, "a boolean", |value| match value {
            Value::Boolean(b) => Some(*b),
            _ => None,
        })?;
        Ok(value.unwrap_or(default))
    }

    /// Text.
    pub fn text(&self, name: &str) -> Result<Option<&str>, LoadError> {
        self.typed(name, "a string", |value| match value {
            Value::Text(text) => Some(text.as_str()),
            _ => None,
        })
    }

    /// Text that is one of `choices`, in capitals or not.
    pub fn choice<T: Copy>(
        &self,
        name: &str,
        default: T,
        choices: &[(&str, T)],
    ) -> Result<T, LoadError> {
        let (Some(text), Some(property)) = (self.text(name)?, self.find(name)) else {
            return Ok(default);
        };
        let found = choices
            .iter()
            .find(|(key, _)| key.eq_ignore_ascii_case(text));
        found.map(|(_, value)| *value).ok_or_else(|| {
            property.error(Cause::UnknownName {
                what: name.to_owned(),
                found: text.to_owned(),
                known: choices.iter().map(|&(key, _)| key.to_owned()).collect(),
            })
        })
    }

    /// A point or vector.
    pub fn vector(&self, name: &str) -> Result<Option<DVec3>, LoadError> {
        self.typed(name, "a point or vector", |value| match value {
            Value::Vector(v) => Some(*v),
            _ => None,
        })
    }

    /// A transform; the identity if there is none.
    pub fn transform(&self, name: &str) -> Result<DMat4, LoadError> {
        let value = self.typed(name, "a transform", |value| match value {
            Value::Transform(m) => Some(*m),
            _ => None,
        })?;
        Ok(value.unwrap_or(DMat4::IDENTITY))
    }

    /// Accepts parameters that cannot change the image.
    pub fn ignore(&self, names: &[&str]) {
        for name in names {
            self.find(name);
        }
    }

    /// Objects of the kind `tag` among its properties, whatever their name.
    pub fn children<'a>(
        &'a self,
        objects: &'a [Object],
        tag: Tag,
    ) -> impl Iterator<Item = (usize, &'a Property)> {
        self.properties
            .iter()
            .filter_map(move |property| match property.value {
                Value::Object(index) if objects[index].tag == tag => {
                    property.used.set(true);
                    Some((index, property))
                }
                _ => None,
            })
    }

    /// The only child of the kind `tag`, if there is one.
    pub fn child<'a>(
        &'a self,
        objects: &'a [Object],
        tag: Tag,
    ) -> Result<Option<usize>, LoadError> {
        let mut children = self.children(objects, tag);
        let first = children.next().map(|(index, _)| index);
        match children.next() {
            None => Ok(first),
            Some((_, second)) => Err(second.error(Cause::Conflict(format!(
                "{} may have one {} only, and this is its second",
                self.title(),
                tag.name()
            )))),
        }
    }

    /// Complains of a property that nobody asked for.
    pub fn finish(&self, objects: &[Object]) -> Result<(), LoadError> {
        let Some(unused) = self.properties.iter().find(|p| !p.used.get()) else {
            return Ok(());
        };
        let known = self.asked.borrow().iter().cloned().collect();
        let owner = self.title();
        Err(unused.error(match unused.value {
            Value::Object(index) if unused.name.is_empty() => Cause::UnexpectedChild {
                owner,
                child: format!("a nested {}", objects[index].title()),
                known,
            },
            _ => Cause::UnknownParameter {
                owner,
                found: unused.name.clone(),
                known,
            },
        }))
    }

    fn typed<'a, T>(
        &'a self,
        name: &str,
        expected: &str,
        convert: impl Fn(&'a Value) -> Option<T>,
    ) -> Result<Option<T>, LoadError> {
        let Some(property) = self.find(name) else {
            return Ok(None);
        };
        convert(&property.value)
            .map(Some)
            .ok_or_else(|| property.wrong_type(expected))
    }
}
