//! `constant`: equal radiance from all directions.

use super::parameters::emission;
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::xml::Object;
use crate::scene::EmitterDescription;

pub fn constant(_: &Builder, object: &Object) -> Result<EmitterDescription, LoadError> {
    object.ignore(&["to_world"]);
    Ok(EmitterDescription::Constant {
        radiance: emission(object, "radiance")?,
    })
}
