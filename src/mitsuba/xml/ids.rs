//! Ids of objects, and references to them.

use std::collections::HashMap;

use super::object::Object;
use super::property::Value;
use crate::mitsuba::error::{Cause, Faults, LoadError, Located, Warning};
use crate::mitsuba::source::Place;

/// Maps ids and aliases to indices of objects.
#[derive(Default)]
pub struct Ids(HashMap<String, Named>);

/// What an id stands for.
struct Named {
    /// The index of the object that has it first.
    object: usize,
    /// Where it is given again, if it is.
    again: Option<Place>,
}

impl Ids {
    /// Assigns `id`, which is given at `place`, to the object at `index`. An id may be given twice, but then
    /// no object may refer to it.
    pub fn claim(&mut self, id: &str, index: usize, place: &Place) {
        let again = Some(place.clone());
        self.0
            .entry(id.to_owned())
            .and_modify(|first| first.again = again)
            .or_insert(Named {
                object: index,
                again: None,
            });
    }

    /// The index of the object with this id.
    pub fn object(&self, id: &str, objects: &[Object]) -> Result<usize, Cause> {
        match self.0.get(id) {
            Some(Named {
                object,
                again: None,
            }) => Ok(*object),
            Some(Named {
                object,
                again: Some(second),
            }) => Err(Cause::DuplicateId {
                id: id.to_owned(),
                first: objects[*object].place.clone(),
                second: second.clone(),
            }),
            None => {
                let mut known: Vec<String> = self.0.keys().cloned().collect();
                known.sort();
                let found = id.to_owned();
                Err(Cause::MissingReference { found, known })
            }
        }
    }

    /// Warnings of ids that are given twice.
    pub fn duplicates(&self) -> Vec<Warning> {
        let mut warnings: Vec<(&String, &Place)> = self
            .0
            .iter()
            .filter_map(|(id, named)| Some((id, named.again.as_ref()?)))
            .collect();
        warnings.sort_by_key(|(id, _)| *id);
        let warning = |(id, place): (&String, &Place)| {
            place.warning(format!(
                "the id `{id}` is given twice; nothing refers to it"
            ))
        };
        warnings.into_iter().map(warning).collect()
    }

    /// Replaces references by the indices of the objects they refer to.
    pub fn resolve_references(&self, objects: &mut [Object]) -> Result<(), LoadError> {
        let mut faults = Faults::default();
        for i in 0..objects.len() {
            for k in 0..objects[i].properties.len() {
                let property = &objects[i].properties[k];
                let Value::Reference(id) = &property.value else {
                    continue;
                };
                let found = self.object(id, objects);
                let found = found.map_err(|cause| property.error(cause));
                if let Some(index) = faults.check(found) {
                    objects[i].properties[k].value = Value::Object(index);
                }
            }
        }
        faults.or(())
    }
}
