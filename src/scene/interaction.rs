//! Points where rays hit surfaces.

use glam::{Vec2, Vec3A};

use crate::math::Frame;

/// A point on a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// In scene units; on the surface to the precision of f32.
    pub position: Vec3A,
    /// Unit normal of the true surface, on its front side.
    pub geometric_normal: Vec3A,
    /// Around the unit shading normal.
    pub shading: Frame,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Index of the shape.
    pub shape: u32,
    /// Index of the primitive, a triangle or a sphere, in the order of the acceleration structure.
    pub primitive: u32,
}

impl SurfacePoint {
    /// A start for a ray that leaves this point along `direction` and must not meet the surface that
    /// it leaves (Wachter and Binder 2019, "A fast and robust method for avoiding
    /// self-intersection", adapted to the size of the scene).
    #[inline]
    pub fn ray_origin(&self, direction: Vec3A) -> Vec3A {
        offset(self.position, self.geometric_normal, direction)
    }
}

/// Relative offset of a ray's start: 256 ulps of a coordinate, as in Wachter and Binder's figure 6-6.
const RELATIVE_OFFSET: f32 = 256.0 * f32::EPSILON / 2.0;

/// Coordinates smaller than this are offset as if they were as large: the error of a point on a big
/// triangle follows the triangle's corners, not the point. 1/32 of the scene, as in their listing.
const OFFSET_ORIGIN: f32 = super::SCENE_RADIUS / 32.0;

/// `position` moved off its surface to the side into which `direction` points.
#[inline]
pub fn offset(position: Vec3A, geometric_normal: Vec3A, direction: Vec3A) -> Vec3A {
    let magnitude = position.abs().max(Vec3A::splat(OFFSET_ORIGIN));
    let side = 1.0_f32.copysign(geometric_normal.dot(direction));
    position + geometric_normal * magnitude * (side * RELATIVE_OFFSET)
}
