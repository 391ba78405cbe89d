//! Objects of a scene file (shapes, materials, ...) and their parameters. A plugin reads the
//! parameters it knows; parameters that are not read are errors.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeSet, HashSet};
use std::ops::RangeInclusive;

use glam::{DMat4, DVec3};

use super::property::{Property, Value};
use crate::mitsuba::error::{Cause, Faults, LoadError, Located};
use crate::mitsuba::source::Place;

/// The kind of an object, given by its element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tag {
    /// The whole scene.
    Scene,
    /// A material.
    Bsdf,
    /// A light source.
    Emitter,
    /// The image and its reconstruction filter.
    Film,
    /// A light transport algorithm.
    Integrator,
    /// A source of sample values.
    Sampler,
    /// A camera.
    Sensor,
    /// A surface.
    Shape,
    /// A reflectance that varies over a surface.
    Texture,
    /// A reconstruction filter.
    Rfilter,
    /// A participating medium.
    Medium,
    /// The phase function of a medium.
    Phase,
    /// A function of the position in a medium.
    Volume,
}

impl Tag {
    /// All tags, with the names of their elements.
    pub const ALL: [(&'static str, Tag); 13] = [
        ("bsdf", Tag::Bsdf),
        ("emitter", Tag::Emitter),
        ("film", Tag::Film),
        ("integrator", Tag::Integrator),
        ("medium", Tag::Medium),
        ("phase", Tag::Phase),
        ("rfilter", Tag::Rfilter),
        ("sampler", Tag::Sampler),
        ("scene", Tag::Scene),
        ("sensor", Tag::Sensor),
        ("shape", Tag::Shape),
        ("texture", Tag::Texture),
        ("volume", Tag::Volume),
    ];

    /// The tag of the element `name`, if that is an object.
    pub fn named(name: &str) -> Option<Self> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, tag)| *tag)
    }

    /// The name of the element.
    pub fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(_, tag)| *tag == self)
            .map_or("", |(name, _)| name)
    }
}

/// A parameter of some type, with its place; `None` if it is not given.
type Given<'a, T> = Result<Option<(T, &'a Property)>, LoadError>;

/// An object of a scene file.
#[derive(Debug)]
pub struct Object {
    /// Its kind.
    pub tag: Tag,
    /// Its type: `sphere`, `diffuse`, ...
    pub plugin: String,
    /// Its id, if it has one.
    pub id: Option<String>,
    /// Its start tag.
    pub place: Place,
    /// Its parameters and nested objects, in the order of the file.
    pub properties: Vec<Property>,
    /// The names of the parameters.
    names: HashSet<String>,
    /// Names of parameters that have been asked for.
    asked: RefCell<BTreeSet<String>>,
}

impl Located for Object {
    fn place(&self) -> &Place {
        &self.place
    }
}

impl Object {
    /// An object without parameters.
    pub fn new(tag: Tag, plugin: String, id: Option<String>, place: Place) -> Self {
        Self {
            tag,
            plugin,
            id,
            place,
            properties: Vec::new(),
            names: HashSet::new(),
            asked: RefCell::default(),
        }
    }

    /// Adds a parameter or a nested object, whose name may be empty.
    pub fn add(&mut self, name: String, value: Value, place: Place) -> Result<(), LoadError> {
        if !name.is_empty() && !self.names.insert(name.clone()) {
            let first = self.properties.iter().find(|p| p.name == name);
            let first = first.map_or(&self.place, |first| &first.place).clone();
            return Err(place.error(Cause::DuplicateParameter { name, first }));
        }
        self.properties.push(Property {
            name,
            value,
            place,
            used: Cell::new(false),
        });
        Ok(())
    }

    /// Removes a parameter and returns it.
    pub fn remove(&mut self, name: &str) -> Option<Property> {
        let index = self.properties.iter().position(|p| p.name == name)?;
        self.names.remove(name);
        Some(self.properties.remove(index))
    }

    /// The object in messages: "shape `sphere`" or "the scene".
    pub fn title(&self) -> String {
        match self.tag {
            Tag::Scene => "the scene".to_owned(),
            tag => format!("{} `{}`", tag.name(), self.plugin),
        }
    }

    /// A required parameter is missing.
    pub fn missing(&self, parameter: &str) -> LoadError {
        self.error(Cause::MissingParameter {
            owner: self.title(),
            parameter: parameter.to_owned(),
        })
    }

    /// The entry of `plugins` for the type of this object; an error if there is none.
    pub fn find_plugin<T: Copy>(&self, plugins: &[(&str, T)]) -> Result<T, LoadError> {
        let found = plugins.iter().find(|(name, _)| *name == self.plugin);
        found.map(|&(_, plugin)| plugin).ok_or_else(|| {
            self.error(Cause::UnknownPlugin {
                kind: self.tag.name().to_owned(),
                found: self.plugin.clone(),
                known: plugins.iter().map(|&(name, _)| name.to_owned()).collect(),
            })
        })
    }

    /// The parameter `name`, if it is given.
    pub fn find(&self, name: &str) -> Option<&Property> {
        self.asked.borrow_mut().insert(name.to_owned());
        let property = self.properties.iter().find(|p| p.name == name)?;
        property.used.set(true);
        Some(property)
    }

    /// A number that satisfies `is_valid`; `range` describes which do.
    pub fn float_in(
        &self,
        name: &str,
        default: f64,
        range: &str,
        is_valid: impl Fn(f64) -> bool,
    ) -> Result<f64, LoadError> {
        match self.typed(name, "a float", Value::as_float)? {
            Some((x, property)) if !is_valid(x) => Err(property.out_of_range(x, range)),
            given => Ok(given.map_or(default, |(x, _)| x)),
        }
    }

    /// An integer.
    pub fn integer(&self, name: &str) -> Given<'_, i64> {
        self.typed(name, "an integer", |value| match value {
            Value::Integer(i) => Some(*i),
            _ => None,
        })
    }

    /// An integer in `range`, which `description` describes.
    pub fn integer_in<T: TryFrom<i64>>(
        &self,
        name: &str,
        range: RangeInclusive<i64>,
        description: &str,
    ) -> Result<Option<T>, LoadError> {
        let Some((value, property)) = self.integer(name)? else {
            return Ok(None);
        };
        let valid = range.contains(&value).then(|| T::try_from(value).ok());
        match valid.flatten() {
            Some(value) => Ok(Some(value)),
            None => Err(property.out_of_range(value, description)),
        }
    }

    /// `true` or `false`.
    pub fn boolean(&self, name: &str, default: bool) -> Result<bool, LoadError> {
        let given = self.given_boolean(name)?;
        Ok(given.map_or(default, |(value, _)| value))
    }

    /// A boolean for which only `false` is modelled; otherwise `reason` is part of the error.
    pub fn must_be_false(&self, name: &str, reason: &str) -> Result<(), LoadError> {
        match self.given_boolean(name)? {
            Some((true, property)) => Err(property.not_modelled(format!("`{name}`: {reason}"))),
            _ => Ok(()),
        }
    }

    /// Text.
    pub fn text(&self, name: &str) -> Given<'_, &str> {
        self.typed(name, "a string", |value| match value {
            Value::Text(text) => Some(text.as_str()),
            _ => None,
        })
    }

    /// Text that is one of `choices`, in any case.
    pub fn choice<T: Copy>(
        &self,
        name: &str,
        default: T,
        choices: &[(&str, T)],
    ) -> Result<T, LoadError> {
        let Some((text, property)) = self.text(name)? else {
            return Ok(default);
        };
        let found = choices
            .iter()
            .find(|(key, _)| key.eq_ignore_ascii_case(text));
        found
            .map(|(_, value)| *value)
            .ok_or_else(|| property.unknown_name(name, text, choices.iter().map(|(key, _)| *key)))
    }

    /// A point or vector.
    pub fn vector(&self, name: &str) -> Result<Option<DVec3>, LoadError> {
        let given = self.typed(name, "a point or vector", |value| match value {
            Value::Vector(v) => Some(*v),
            _ => None,
        })?;
        Ok(given.map(|(v, _)| v))
    }

    /// A transform.
    pub fn transform(&self, name: &str) -> Given<'_, DMat4> {
        self.typed(name, "a transform", |value| match value {
            Value::Transform(m) => Some(*m),
            _ => None,
        })
    }

    /// Accepts parameters that cannot change the image.
    pub fn ignore(&self, names: &[&str]) {
        for name in names {
            self.find(name);
        }
    }

    /// The nested objects of the kind `tag`, whatever their names, with their indices in `objects`.
    pub fn nested<'a>(
        &'a self,
        objects: &'a [Object],
        tag: Tag,
    ) -> impl Iterator<Item = (usize, &'a Property)> {
        self.properties
            .iter()
            .filter_map(move |property| match property.value {
                Value::Object(index) if objects[index].tag == tag => Some((index, property)),
                _ => None,
            })
    }

    /// As [`nested`](Self::nested), and marks the objects as used.
    pub fn children<'a>(
        &'a self,
        objects: &'a [Object],
        tag: Tag,
    ) -> impl Iterator<Item = (usize, &'a Property)> {
        self.nested(objects, tag)
            .inspect(|(_, property)| property.used.set(true))
    }

    /// The only nested object of the kind `tag`, if there is one.
    pub fn child(&self, objects: &[Object], tag: Tag) -> Result<Option<usize>, LoadError> {
        let mut children = self.children(objects, tag);
        let first = children.next().map(|(index, _)| index);
        match children.next() {
            None => Ok(first),
            Some((_, second)) => Err(second.conflict(format!(
                "{} may have only one {}, and this is its second",
                self.title(),
                tag.name()
            ))),
        }
    }

    /// Reports all parameters and nested objects that have not been read.
    pub fn finish(&self, objects: &[Object]) -> Result<(), LoadError> {
        let mut faults = Faults::default();
        for unused in self.unused() {
            faults.add(self.unknown(unused, objects));
        }
        faults.or(())
    }

    /// The parameters and nested objects that have not been read.
    pub fn unused(&self) -> impl Iterator<Item = &Property> {
        self.properties.iter().filter(|p| !p.used.get())
    }

    /// The object has no such parameter or nested object.
    fn unknown(&self, unused: &Property, objects: &[Object]) -> LoadError {
        let known = self.asked.borrow().iter().cloned().collect();
        let owner = self.title();
        let nested = match unused.value {
            Value::Object(index) => Some(&objects[index]),
            _ => None,
        };
        unused.error(match nested {
            Some(medium) if medium.tag == Tag::Medium => {
                Cause::NotSupported(format!("participating media such as {}", medium.title()))
            }
            Some(child) if unused.name.is_empty() => Cause::UnexpectedChild {
                owner,
                child: format!("a nested {}", child.title()),
                known,
            },
            _ => Cause::UnknownParameter {
                owner,
                found: unused.name.clone(),
                known,
            },
        })
    }

    fn given_boolean(&self, name: &str) -> Given<'_, bool> {
        self.typed(name, "a boolean", |value| match value {
            Value::Boolean(b) => Some(*b),
            _ => None,
        })
    }

    fn typed<'a, T>(
        &'a self,
        name: &str,
        expected: &str,
        convert: impl Fn(&'a Value) -> Option<T>,
    ) -> Given<'a, T> {
        let Some(property) = self.find(name) else {
            return Ok(None);
        };
        match convert(&property.value) {
            Some(value) => Ok(Some((value, property))),
            None => Err(property.wrong_type(expected)),
        }
    }
}
