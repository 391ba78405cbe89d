//! The attributes of one element, with `$variables` replaced, and a check that all have a meaning.

use roxmltree::Node;

use super::error::{Cause, LoadError};
use super::source::{Place, SourceFile};
use super::substitution::Substitution;
use std::sync::Arc;

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
    /// Names that were asked for.
    known: Vec<String>,
}

impl Attributes {
    /// The attributes of `node` in `file`.
    pub fn new(
        node: Node,
        file: &Arc<SourceFile>,
        variables: &mut Substitution,
    ) -> Result<Self, LoadError> {
        let read = |attribute: roxmltree::Attribute| {
            let place = Place::new(file, attribute.range_value());
            let value = variables
                .apply(attribute.value())
                .map_err(|cause| LoadError::at(&place, cause))?;
            Ok(Attribute {
                name: attribute.name().to_owned(),
                value,
                place,
                used: false,
            })
        };
        Ok(Self {
            element: node.tag_name().name().to_owned(),
            place: start_tag(node, file),
            list: node.attributes().map(read).collect::<Result<_, _>>()?,
            known: Vec::new(),
        })
    }

    /// Where the element begins.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// A fault of the element as a whole.
    pub fn error(&self, cause: Cause) -> LoadError {
        LoadError::at(&self.place, cause)
    }

    /// The text of an attribute and its place, if there is one.
    pub fn text_optional(&mut self, name: &str) -> Option<(String, Place)> {
        self.known.push(name.to_owned());
        let attribute = self.list.iter_mut().find(|a| a.name == name)?;
        attribute.used = true;
        Some((attribute.value.clone(), attribute.place.clone()))
    }

    /// The text of an attribute that must be there.
    pub fn text(&mut self, name: &str) -> Result<(String, Place), LoadError> {
        self.text_optional(name).ok_or_else(|| {
            self.error(Cause::MissingAttribute {
                element: self.element.clone(),
                attribute: name.to_owned(),
            })
        })
    }

    /// A value, if there is one.
    pub fn parse_optional<T>(
        &mut self,
        name: &str,
        parse: fn(&str) -> Result<T, Cause>,
    ) -> Result<Option<T>, LoadError> {
        let Some((text, place)) = self.text_optional(name) else {
            return Ok(None);
        };
        parse(&text)
            .map(Some)
            .map_err(|cause| LoadError::at(&place, cause))
    }

    /// A value that must be there.
    pub fn parse<T>(
        &mut self,
        name: &str,
        parse: fn(&str) -> Result<T, Cause>,
    ) -> Result<T, LoadError> {
        let (text, place) = self.text(name)?;
        parse(&text).map_err(|cause| LoadError::at(&place, cause))
    }

    /// Complains of an attribute that nobody asked for.
    pub fn finish(self) -> Result<(), LoadError> {
        let Some(unused) = self.list.iter().find(|a| !a.used) else {
            return Ok(());
        };
        let cause = Cause::UnknownAttribute {
            element: self.element.clone(),
            found: unused.name.clone(),
            known: self.known.clone(),
        };
        Err(LoadError::at(&unused.place, cause))
    }
}

/// The start tag of an element, without its contents.
pub fn start_tag(node: Node, file: &Arc<SourceFile>) -> Place {
    let whole = node.range();
    let attributes_end = node.attributes().map(|a| a.range().end).max();
    let name_end = whole.start + 1 + node.tag_name().name().len();
    let end = attributes_end.unwrap_or(name_end).min(whole.end);
    Place::new(file, whole.start..end)
}
