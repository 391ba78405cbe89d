//! The vertex at infinity where a camera subpath leaves the scene.

use glam::Vec3A;

use super::mis::PartialMis;
use crate::math::Rgb;

/// The last vertex of a camera subpath that hits no surface.
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentVertex {
    /// Unit direction in which the subpath leaves the scene.
    pub direction: Vec3A,
    /// Importance over the density of the subpath.
    pub throughput: Rgb,
    /// Partial MIS sums; `forward` is per steradian.
    pub mis: PartialMis,
}
