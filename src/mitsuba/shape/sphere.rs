//! `sphere`.

use glam::DVec3;

use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::LoadError;
use crate::mitsuba::xml::Object;
use crate::scene::ShapeGeometry;

pub fn sphere(_: &mut Builder, object: &Object) -> Result<ShapeGeometry, LoadError> {
    Ok(ShapeGeometry::Sphere {
        center: object.vector("center")?.unwrap_or(DVec3::ZERO),
        radius: object.float_in("radius", 1.0, "above 0", |r| r > 0.0)?,
    })
}
