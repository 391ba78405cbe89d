//! The transform of texture coordinates.

use glam::{Affine2, Mat2, Vec2};

use crate::mitsuba::error::LoadError;
use crate::mitsuba::xml::Object;

/// The affine map of the plane in `to_uv`: its upper left 2 x 2 entries and its translation.
pub fn to_uv(object: &Object) -> Result<Affine2, LoadError> {
    let Some((m, _)) = object.transform("to_uv")? else {
        return Ok(Affine2::IDENTITY);
    };
    let column = |i: usize| Vec2::new(m.col(i).x as f32, m.col(i).y as f32);
    let linear = Mat2::from_cols(column(0), column(1));
    Ok(Affine2::from_mat2_translation(linear, column(3)))
}
