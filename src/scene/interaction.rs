//! Points where rays hit surfaces.

use glam::{Vec2, Vec3A};

use crate::math::Frame;

/// A point on a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// In scene units; on the surface up to the precision of f32.
    pub position: Vec3A,
    /// Unit normal of the geometry, on the front side.
    pub geometric_normal: Vec3A,
    /// Frame around the unit shading normal.
    pub shading: Frame,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Index of the shape.
    pub shape: u32,
    /// Index of the primitive (triangle or sphere), in the order of the acceleration structure.
    pub primitive: u32,
}

impl SurfacePoint {
    /// The origin of a ray that leaves this point along `direction`, offset so that the ray does not hit
    /// the surface that it leaves (Wachter and Binder 2019, "A fast and robust method for avoiding
    /// self-intersection", adapted to the size of the scene).
    #[inline]
    pub fn ray_origin(&self, direction: Vec3A) -> Vec3A {
        offset(self.position, self.geometric_normal, direction)
    }
}

/// Relative offset of the origin of a ray: 256 ulps of a coordinate, as in Wachter and Binder's figure
/// 6-6.
const RELATIVE_OFFSET: f32 = 256.0 * f32::EPSILON / 2.0;

/// Smaller coordinates are offset as if they were of this size, since the error of a point on a large
/// triangle depends on the corners of the triangle. 1/32 of the scene, as in their listing.
const MIN_OFFSET_MAGNITUDE: f32 = super::SCENE_RADIUS / 32.0;

/// `position` offset from its surface to the side into which `direction` points.
#[inline]
pub fn offset(position: Vec3A, geometric_normal: Vec3A, direction: Vec3A) -> Vec3A {
    let magnitude = position.abs().max(Vec3A::splat(MIN_OFFSET_MAGNITUDE));
    let side = 1.0_f32.copysign(geometric_normal.dot(direction));
    position + geometric_normal * magnitude * (side * RELATIVE_OFFSET)
}
