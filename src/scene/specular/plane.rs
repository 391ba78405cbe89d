//! Planes: distances, reflections, images under isometries.

use glam::{DAffine3, DMat3, DVec3};

use super::chain::Endpoint;

/// The points x with normal . x = offset.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// Unit, on the front side.
    pub normal: DVec3,
    pub offset: f64,
}

impl Plane {
    /// Signed distance of a point, positive in front.
    pub fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    /// The reflection in the plane.
    pub fn mirror(&self) -> DAffine3 {
        let n = self.normal;
        let outer = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        DAffine3 {
            matrix3: DMat3::IDENTITY - outer * 2.0,
            translation: 2.0 * self.offset * n,
        }
    }

    /// The image of the plane under an isometry.
    pub fn transformed(&self, isometry: &DAffine3) -> Self {
        let normal = isometry.matrix3 * self.normal;
        Self {
            normal,
            offset: self.offset + normal.dot(isometry.translation),
        }
    }

    /// Positive if the end is in front.
    pub fn side_of(&self, end: &Endpoint) -> f64 {
        match end {
            Endpoint::Point { position, .. } => self.distance(*position),
            Endpoint::Direction(direction) => self.normal.dot(*direction),
        }
    }
}
