//! Where a camera subpath leaves the scene.

use glam::Vec3A;

use super::mis::Carried;
use crate::math::Rgb;

/// A camera subpath that met no surface: its last vertex is at infinity.
#[derive(Clone, Copy, Debug)]
pub struct Escape {
    /// Unit, the way it went.
    pub direction: Vec3A,
    /// Importance over the density of having made the subpath.
    pub throughput: Rgb,
    /// `forward` is per steradian.
    pub carried: Carried,
}
