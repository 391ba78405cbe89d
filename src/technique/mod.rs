//! Techniques, which form a path from a light subpath and a camera subpath (Veach 1997, chapter 10). Each
//! gives the contribution of its path and the MIS weight. No shadow ray is traced if the unoccluded
//! contribution is zero.
//!
//! ```
//! use metrolight::technique::Techniques;
//!
//! // Paths of two edges: a light that is hit, next event estimation, and a connection to the lens.
//! let techniques = Techniques::without_chains();
//! let names: Vec<String> = techniques.all(2).skip(1).map(|t| t.to_string()).collect();
//! assert_eq!(names, ["(0,3)", "(1,2)", "(2,1)"]);
//! ```

pub mod camera;
pub mod contribution;
pub mod hit;
pub mod join;
pub mod next_event;
pub mod specular;
pub mod techniques;

use std::fmt;

pub use camera::connect_to_camera;
pub use contribution::{Connection, PathContribution};
pub use hit::{Hit, hit_environment, hit_light};
pub use join::connect_vertices;
pub use next_event::NextEvent;
pub use specular::{SpecularNextEvent, has_specular, specular_next_event, specular_term};
pub use techniques::Techniques;

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
    /// 1*: a point on a light is sampled and connected to the last vertex of the camera subpath through delta
    /// vertices (specular next event estimation).
    Specular {
        /// Camera subpath vertices.
        t: usize,
        /// Delta vertices.
        n: usize,
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

    /// Vertices of the light subpath. For 1* the point on the light and the delta vertices.
    #[inline]
    pub fn s(self) -> usize {
        match self {
            Self::Hit { .. } => 0,
            Self::NextEvent { .. } => 1,
            Self::Camera { s } | Self::Join { s, .. } => s,
            Self::Specular { n, .. } => n + 1,
        }
    }

    /// Vertices of the camera subpath.
    #[inline]
    pub fn t(self) -> usize {
        match self {
            Self::Camera { .. } => 1,
            Self::Hit { t }
            | Self::NextEvent { t }
            | Self::Join { t, .. }
            | Self::Specular { t, .. } => t,
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
    /// As Veach writes it: (s,t). For 1* an asterisk for every delta vertex, as in (1**,3).
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Specular { t, n } => write!(f, "(1{},{t})", "*".repeat(*n)),
            _ => write!(f, "({},{})", self.s(), self.t()),
        }
    }
}
