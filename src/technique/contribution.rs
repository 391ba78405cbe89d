//! What a path brings to the film.

use glam::Vec2;

use super::Technique;
use crate::film::Splat;
use crate::math::Rgb;

/// The light of a path made by one technique.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// Path contribution over the density of this technique. Without the weight it is an unbiased
    /// estimate of the light of all paths of this length that the technique can make.
    pub value: Rgb,
    /// MIS weight among all techniques that can make the path, in [0, 1].
    pub weight: f32,
}

/// A path, and where it lands.
#[derive(Clone, Copy, Debug)]
pub struct PathContribution {
    /// The technique that made the path.
    pub technique: Technique,
    /// Film position in [0, 1)^2: where the camera subpath starts, or for t = 1 where the lens sees the
    /// light subpath.
    pub film: Vec2,
    /// See [`Connection::value`].
    pub value: Rgb,
    /// See [`Connection::weight`].
    pub weight: f32,
}

impl PathContribution {
    /// A path that `technique` made.
    #[inline]
    pub fn new(technique: Technique, film: Vec2, connection: Connection) -> Self {
        Self {
            technique,
            film,
            value: connection.value,
            weight: connection.weight,
        }
    }

    /// The weighted contribution at its place on the film.
    #[inline]
    pub fn splat(&self) -> Splat {
        Splat {
            position: self.film.into(),
            value: self.value * self.weight,
        }
    }
}
