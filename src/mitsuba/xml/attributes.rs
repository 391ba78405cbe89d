//! The attributes of one element, after substitution of `$variables`. Attributes that are not read
//! are errors.

use roxmltree::Node;

use super::document::File;
use super::substitution::Substitution;
use crate::mitsuba::error::{Cause, LoadError, Located};
use crate::mitsuba::source::Place;

struct Attribute {
    name: String,
    value: String,
    place: Place,
    used: bool,
}

/// The attributes of one element.
pub struct Attributes {
    element: String,
    place: Place,
    list: Vec<Attribute>,
    /// Names of attributes that have been asked for.
    known: Vec<String>,
}

impl Attributes {
    /// The attributes of `node` in `file`.
    pub fn new(node: Node, file: &File, variables: &mut Substitution) -> Result<Self, LoadError> {
        let read = |attribute: roxmltree::Attribute| {
            let place = Place::new(&file.source, attribute.range_value());
            let value = variables
                .apply(attribute.value())
                .map_err(|cause| place.error(cause))?;
            Ok(Attribute {
                name: attribute.name().to_owned(),
                value,
                place,
                used: false,
            })
        };
        Ok(Self {
            element: node.tag_name().name().to_owned(),
            place: file.start_tag(node),
            list: node.attributes().map(read).collect::<Result<_, _>>()?,
            known: Vec::new(),
        })
    }

    /// The text and the place of an attribute, if it is given.
    pub fn text_optional(&mut self, name: &str) -> Option<(String, Place)> {
        self.known.push(name.to_owned());
        let attribute = self.list.iter_mut().find(|a| a.name == name)?;
        attribute.used = true;
        Some((attribute.value.clone(), attribute.place.clone()))
    }

    /// The text of an attribute; empty if it is not given.
    pub fn text_or_empty(&mut self, name: &str) -> String {
        self.text_optional(name)
            .map_or(String::new(), |(text, _)| text)
    }

    /// The text and the place of a required attribute.
    pub fn text(&mut self, name: &str) -> Result<(String, Place), LoadError> {
        self.text_optional(name).ok_or_else(|| {
            self.error(Cause::MissingAttribute {
                element: self.element.clone(),
                attribute: name.to_owned(),
            })
        })
    }

    /// The value of an attribute, if it is given.
    pub fn parse_optional<T>(
        &mut self,
        name: &str,
        parse: fn(&str) -> Result<T, Cause>,
    ) -> Result<Option<T>, LoadError> {
        let Some((text, place)) = self.text_optional(name) else {
            return Ok(None);
        };
        parse(&text).map(Some).map_err(|cause| place.error(cause))
    }

    /// The value of a required attribute.
    pub fn parse<T>(
        &mut self,
        name: &str,
        parse: fn(&str) -> Result<T, Cause>,
    ) -> Result<T, LoadError> {
        let (text, place) = self.text(name)?;
        parse(&text).map_err(|cause| place.error(cause))
    }

    /// Reports the first attribute that has not been asked for.
    pub fn finish(self) -> Result<(), LoadError> {
        let Some(unused) = self.list.iter().find(|a| !a.used) else {
            return Ok(());
        };
        let cause = Cause::UnknownAttribute {
            element: self.element.clone(),
            found: unused.name.clone(),
            known: self.known.clone(),
        };
        Err(unused.place.error(cause))
    }
}

impl Located for Attributes {
    /// The start tag of the element.
    fn place(&self) -> &Place {
        &self.place
    }
}
