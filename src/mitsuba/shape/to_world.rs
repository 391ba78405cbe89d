//! The transform of a shape.

use glam::{DMat3, DMat4, DVec4};

use crate::mitsuba::error::{Cause, LoadError, Located};
use crate::mitsuba::xml::Object;

/// Minimum absolute determinant of an invertible transform, relative to the product of the lengths of
/// its columns.
const MIN_DETERMINANT: f64 = 1e-12;

/// The invertible affine map `to_world`.
pub fn to_world(object: &Object) -> Result<DMat4, LoadError> {
    let Some((matrix, property)) = object.transform("to_world")? else {
        return Ok(DMat4::IDENTITY);
    };
    if matrix.row(3) != DVec4::W {
        let feature = "perspective in the transform of a shape: its last row must be 0 0 0 1";
        return Err(property.not_modelled(feature));
    }
    let linear = DMat3::from_mat4(matrix);
    let lengths = linear.x_axis.length() * linear.y_axis.length() * linear.z_axis.length();
    let determinant = linear.determinant().abs();
    // Not written with `<=`, so that NaN counts as singular.
    if lengths.is_finite() && determinant > MIN_DETERMINANT * lengths {
        Ok(matrix)
    } else {
        Err(property.error(Cause::SingularTransform(object.title())))
    }
}
