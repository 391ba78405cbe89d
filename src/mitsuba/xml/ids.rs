//! Ids of objects, and references to them.

use std::collections::HashMap;

use super::object::Object;
use super::property::Value;
use crate::mitsuba::error::{Cause, LoadError, Located};
use crate::mitsuba::source::Place;

/// Maps ids and aliases to indices of objects.
#[derive(Default)]
pub struct Ids(HashMap<String, usize>);

impl Ids {
    /// Assigns `id`, which is given at `place`, to the object at `index` of `objects`.
    pub fn claim(
        &mut self,
        id: &str,
        index: usize,
        objects: &[Object],
        place: &Place,
    ) -> Result<(), LoadError> {
        match self.0.insert(id.to_owned(), index) {
            None => Ok(()),
            Some(first) => {
                let id = id.to_owned();
                let first = objects[first].place.clone();
                Err(place.error(Cause::DuplicateId { id, first }))
            }
        }
    }

    /// The index of the object with this id.
    pub fn object(&self, id: &str) -> Result<usize, Cause> {
        self.0.get(id).copied().ok_or_else(|| {
            let mut known: Vec<String> = self.0.keys().cloned().collect();
            known.sort();
            let found = id.to_owned();
            Cause::MissingReference { found, known }
        })
    }

    /// Replaces references by the indices of the objects they refer to.
    pub fn resolve_references(&self, objects: &mut [Object]) -> Result<(), LoadError> {
        for property in objects.iter_mut().flat_map(|o| &mut o.properties) {
            if let Value::Reference(id) = &property.value {
                let index = self.object(id).map_err(|cause| property.error(cause))?;
                property.value = Value::Object(index);
            }
        }
        Ok(())
    }
}
