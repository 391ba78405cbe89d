//! Techniques, which form a path from a light subpath and a camera subpath (Veach 1997, chapter 10). Each
//! gives the contribution of its path and the MIS weight. No shadow ray is traced if the unoccluded
//! contribution is zero.
//!
//! ```
//! use metrolight::technique::Technique;
//!
//! // Paths of two edges: a light that is hit, next event estimation, and a connection to the lens.
//! let names: Vec<String> = Technique::all(2).skip(1).map(|t| t.to_string()).collect();
//! assert_eq!(names, ["(0,3)", "(1,2)", "(2,1)"]);
//! ```

pub mod camera;
pub mod contribution;
pub mod hit;
pub mod join;
pub mod next_event;

use std::fmt;

pub use camera::connect_to_camera;
pub use contribution::{Connection, PathContribution};
pub use hit::{Hit, hit_environment, hit_light};
pub use join::connect_vertices;
pub use next_event::NextEvent;

/// Veach's technique (s, t): a path is formed from s light subpath vertices (the point on the light
/// included) and t camera subpath vertices (the point on the lens included).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Technique {
    /// s = 0: the camera subpath hits a light.
    Hit {
        /// Camera subpath vertices, the one on the light included.
        t: usize,
    },
    /// s = 1: a point on a light is sampled for the last vertex of the camera subpath (next event
    /// estimation).
    NextEvent {
        /// Camera subpath vertices.
        t: usize,
    },
    /// t = 1: the last vertex of the light subpath is connected to a point on the lens.
    Camera {
        /// Light subpath vertices.
        s: usize,
    },
    /// s >= 2 and t >= 2: the last vertices of both subpaths are connected.
    Join {
        /// Light subpath vertices.
        s: usize,
        /// Camera subpath vertices.
        t: usize,
    },
}

impl Technique {
    /// Veach's technique (s, t), with t >= 1 and s + t >= 2.
    pub fn new(s: usize, t: usize) -> Self {
        debug_assert!(t >= 1 && s + t >= 2, "no technique ({s},{t})");
        match (s, t) {
            (_, 1) => Self::Camera { s },
            (0, _) => Self::Hit { t },
            (1, _) => Self::NextEvent { t },
            _ => Self::Join { s, t },
        }
    }

    /// Vertices of the light subpath.
    #[inline]
    pub fn s(self) -> usize {
        match self {
            Self::Hit { .. } => 0,
            Self::NextEvent { .. } => 1,
            Self::Camera { s } | Self::Join { s, .. } => s,
        }
    }

    /// Vertices of the camera subpath.
    #[inline]
    pub fn t(self) -> usize {
        match self {
            Self::Camera { .. } => 1,
            Self::Hit { t } | Self::NextEvent { t } | Self::Join { t, .. } => t,
        }
    }

    /// Number of edges k of its paths.
    #[inline]
    pub fn edges(self) -> usize {
        self.s() + self.t() - 1
    }

    /// True if its paths contribute anywhere on the film and not at the film position of a camera subpath.
    #[inline]
    pub fn is_light_image(self) -> bool {
        matches!(self, Self::Camera { .. })
    }

    /// Number of techniques that bidirectional path tracing has for paths of `edges` >= 1 edges. Paths of
    /// one edge (directly visible lights) have only (0, 2).
    #[inline]
    pub fn count(edges: usize) -> usize {
        if edges == 1 { 1 } else { edges + 1 }
    }

    /// Technique `i` < [`Self::count`] for paths of `edges` edges, in the order of s.
    #[inline]
    pub fn nth(edges: usize, i: usize) -> Self {
        Self::new(i, edges + 1 - i)
    }

    /// Its index among the techniques of its path length: the inverse of [`Self::nth`].
    #[inline]
    pub fn index(self) -> usize {
        self.s()
    }

    /// All techniques of bidirectional path tracing for paths of up to `max_edges` edges, by length.
    pub fn all(max_edges: usize) -> impl Iterator<Item = Self> {
        (1..=max_edges).flat_map(|k| (0..Self::count(k)).map(move |i| Self::nth(k, i)))
    }

    /// Its index in [`Self::all`].
    #[inline]
    pub fn ordinal(self) -> usize {
        match self.edges() {
            1 => 0,
            // It follows one technique of one edge, and j + 1 techniques of j edges for 2 <= j < k.
            k => k * (k + 1) / 2 - 2 + self.index(),
        }
    }
}

/// The techniques that a path sampler combines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TechniqueSet {
    /// s <= 1: path tracing with next event estimation.
    Path,
    /// t = 1: light tracing.
    Light,
    /// All techniques with t >= 1: bidirectional path tracing.
    Bidirectional,
}

impl fmt::Display for Technique {
    /// As Veach writes it: (s,t).
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({},{})", self.s(), self.t())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn techniques_are_enumerated_by_length_and_s() {
        let all: Vec<Technique> = Technique::all(7).collect();
        assert_eq!(all.len(), 34);
        for (i, &technique) in all.iter().enumerate() {
            assert_eq!(technique.ordinal(), i, "{technique}");
            let (s, t) = (technique.s(), technique.t());
            assert_eq!(Technique::new(s, t), technique);
            let from_index = Technique::nth(technique.edges(), technique.index());
            assert_eq!(from_index, technique);
        }
        let names: Vec<String> = all[..4].iter().map(ToString::to_string).collect();
        assert_eq!(names, ["(0,2)", "(0,3)", "(1,2)", "(2,1)"]);
    }
}
