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
    /// The origin of a ray that leaves this point along `direction`: [`offset`].
    #[inline]
    pub fn ray_origin(&self, direction: Vec3A) -> Vec3A {
        offset(self.position, self.geometric_normal, direction)
    }
}

/// Distance from a surface at which rays begin, in scene units: a bound of the distance at which rounding may
/// leave a point from its surface and a ray from its origin (pbrt, 4th ed., section 6.8).
///
/// With u = 2^-24, a point b_0 p_0 + b_1 p_1 + b_2 p_2 of a triangle in the ball of the scene's radius R is
/// off by at most 6 u R: three roundings of each term and its sum, two of b_0 = 1 - b_1 - b_2. The test
/// whether a ray hits that triangle again subtracts its origin from the corners, an error of u times their
/// distance, and then shears and weighs them; the signed distance of the origin is right to within 6 u R in
/// the tests of grazing rays. Spheres are intersected in f64, which leaves the rounding of the point.
pub const RAY_OFFSET: f32 = 12.0 * f32::EPSILON / 2.0 * super::SCENE_RADIUS;

/// `position` offset from its surface to the side into which `direction` points, so that a ray from there does
/// not hit the surface that it leaves. A surface further away than [`RAY_OFFSET`] is not passed over.
#[inline]
pub fn offset(position: Vec3A, geometric_normal: Vec3A, direction: Vec3A) -> Vec3A {
    let side = RAY_OFFSET.copysign(geometric_normal.dot(direction));
    position + geometric_normal * side
}
