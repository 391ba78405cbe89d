//! What emitters at infinity have in common. Their light enters the scene through disks that are
//! perpendicular to it and cover the scene's bounding sphere; y_0 is a direction, and its native measure
//! is solid angle.

use std::f32::consts::PI;

use glam::{Vec2, Vec3A};

use super::sample::{EmissionSample, LightEvaluation, LightSample};
use crate::math::{Frame, Rgb};
use crate::sampling::warp::square_to_disk;
use crate::scene::SCENE_RADIUS;

/// Radius of the disks: that of the scene, with a margin for rounding.
const DISK_RADIUS: f32 = 1.0001 * SCENE_RADIUS;

/// Area of the disks.
pub const DISK_AREA: f32 = PI * DISK_RADIUS * DISK_RADIUS;

/// Light that arrives at `point` from the unit `direction`.
#[inline]
pub fn light_from_infinity(
    point: Vec3A,
    direction: Vec3A,
    emission: LightEvaluation,
) -> LightSample {
    // Outside the scene wherever `point` is.
    let distance = point.length() + 2.0 * SCENE_RADIUS;
    LightSample {
        direction,
        target: point + direction * distance,
        emission,
        jacobian_direction: 1.0,
        jacobian_area: 1.0,
        delta: false,
    }
}

/// Light along `direction` from the point of the disk that `u_position` maps to.
#[inline]
pub fn emission_from_infinity(
    emitter: u32,
    direction: Vec3A,
    u_position: Vec2,
    pdf_position: f32,
    weight: Rgb,
) -> EmissionSample {
    let disk = square_to_disk(u_position) * DISK_RADIUS;
    let frame = Frame::from_normal(direction);
    let origin = frame.s * disk.x + frame.t * disk.y - direction * DISK_RADIUS;
    EmissionSample {
        emitter,
        origin,
        position: origin,
        normal: direction,
        direction,
        weight,
        pdf_position,
        pdf_direction: 1.0 / DISK_AREA,
        infinite: true,
        delta: false,
    }
}
