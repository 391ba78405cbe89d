//! The surface of a shape as emitters need it: its primitives in scene units.

use glam::Vec3A;

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
    },
}

/// A triangle with area.
#[derive(Debug)]
pub(in crate::scene) struct SurfaceTriangle {
    pub(in crate::scene) corners: Corners,
    /// Unit, on the front side.
    pub(in crate::scene) normal: Vec3A,
    /// Index of the primitive, as in `SurfacePoint`.
    pub(in crate::scene) primitive: u32,
}

impl SurfaceTriangle {
    /// In scene units squared.
    pub(in crate::scene) fn area(&self) -> f64 {
        0.5 * cross(&self.corners).length()
    }
}
