//! Rays.

use glam::Vec3A;

use super::primitive::RADIUS;

/// A half-line or segment.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Start.
    pub origin: Vec3A,
    /// Unit length.
    pub direction: Vec3A,
    /// Hits at this distance or farther do not count.
    pub t_max: f32,
}

impl Ray {
    /// The ray with its origin advanced to the neighbourhood of the primitives, so that rounding
    /// errors scale with [`RADIUS`] and not with the distance of the origin; `None` if the ray
    /// misses the ball in which they lie.
    #[inline]
    pub(super) fn advanced_to_primitives(&self) -> Option<Self> {
        const NEAR: f32 = 1.2 * RADIUS;
        if self.origin.length_squared() <= NEAR * NEAR {
            return Some(*self);
        }
        let along = self.origin.dot(self.direction);
        let closest = self.origin - self.direction * along;
        let skipped = -along - NEAR;
        if closest.length_squared() > NEAR * NEAR || along >= 0.0 {
            return None;
        }
        if skipped <= 0.0 {
            return Some(*self);
        }
        (self.t_max > skipped).then(|| Self {
            origin: closest - self.direction * NEAR,
            direction: self.direction,
            t_max: self.t_max - skipped,
        })
    }
}
