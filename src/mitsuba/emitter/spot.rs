//! `spot`: a point that emits into a cone.

use glam::DVec3;

use super::parameters::{emission, no_texture, rigid_to_world};
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::xml::Object;
use crate::scene::EmitterDescription;

pub fn spot(_: &Builder, object: &Object) -> Result<EmitterDescription, LoadError> {
    no_texture(object, "texture")?;
    let to_world = rigid_to_world(object)?;
    let is_angle = |degrees: f64| degrees > 0.0 && degrees < 180.0;
    let range = "above 0 and below 180 degrees";
    let cutoff_angle = object.float_in("cutoff_angle", 20.0, range, is_angle)?;
    let range = "at least 0 and at most `cutoff_angle`";
    let is_within = |degrees: f64| (0.0..=cutoff_angle).contains(&degrees);
    Ok(EmitterDescription::Spot {
        position: to_world.transform_point3(DVec3::ZERO),
        direction: to_world.transform_vector3(DVec3::Z),
        intensity: emission(object, "intensity")?,
        beam_width: object.float_in("beam_width", 0.75 * cutoff_angle, range, is_within)?,
        cutoff_angle,
    })
}
