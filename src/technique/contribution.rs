//! Contributions of paths to the film.

use glam::Vec2;

use super::Technique;
use crate::film::Splat;
use crate::math::Rgb;

/// The contribution of a path sampled by one technique.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// Path contribution over the density of this technique. Without the weight it is an unbiased
    /// estimate of the light of all paths of this length that the technique can sample.
    pub value: Rgb,
    /// MIS weight among all techniques that can sample the path, in [0, 1].
    pub weight: f32,
}

/// The contribution of a path and its film position.
#[derive(Clone, Copy, Debug)]
pub struct PathContribution {
    /// The technique that sampled the path.
    pub technique: Technique,
    /// Film position in [0, 1)^2: that of the camera subpath, or for t = 1 the projection of the last
    /// vertex of the light subpath.
    pub film: Vec2,
    /// See [`Connection::value`].
    pub value: Rgb,
    /// See [`Connection::weight`].
    pub weight: f32,
}

impl PathContribution {
    /// A path that `technique` sampled.
    #[inline]
    pub fn new(technique: Technique, film: Vec2, connection: Connection) -> Self {
        Self {
            technique,
            film,
            value: connection.value,
            weight: connection.weight,
        }
    }

    /// The weighted contribution at its film position.
    #[inline]
    pub fn splat(&self) -> Splat {
        Splat {
            position: self.film.into(),
            value: self.value * self.weight,
        }
    }
}
