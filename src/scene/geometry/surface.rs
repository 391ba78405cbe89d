//! The surface of a shape as emitters need it: its primitives in scene units.

use glam::{Mat3A, Vec2, Vec3A};

use super::shape::cross;
use crate::bvh::Corners;

/// The surface of a shape, in scene units.
pub(in crate::scene) enum ShapeSurface {
    /// Triangles with area, in the order of their primitives.
    Triangles(Vec<SurfaceTriangle>),
    /// A sphere of positive radius.
    Sphere {
        center: Vec3A,
        radius: f32,
        /// The front side is inside.
        inward: bool,
        /// From scene axes to its own, for texture coordinates.
        to_local: Mat3A,
    },
}

/// A triangle with area.
#[derive(Debug)]
pub(in crate::scene) struct SurfaceTriangle {
    pub(in crate::scene) corners: Corners,
    /// Unit, on the front side.
    pub(in crate::scene) normal: Vec3A,
    /// Texture coordinates of the corners.
    pub(in crate::scene) uvs: [Vec2; 3],
    /// Index of the primitive, as in `SurfacePoint`.
    pub(in crate::scene) primitive: u32,
}

impl SurfaceTriangle {
    /// In scene units squared.
    pub(in crate::scene) fn area(&self) -> f64 {
        0.5 * cross(&self.corners).length()
    }
}
