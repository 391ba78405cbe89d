//! Paths in Veach's terms (Veach 1997, chapters 8 and 10): vertices, subpaths from the lights and from
//! the lens, and the MIS weights that combine the techniques.
//!
//! A path of k edges is x_0 ... x_k with x_0 on a light and x_k on the lens. Technique (s, t) takes s
//! vertices y_0 ... y_{s-1} from a light subpath and t vertices z_0 ... z_{t-1} from a camera subpath,
//! s + t = k + 1. Here s >= 0 and t >= 1: light subpaths never hit the lens.

pub mod dimensions;
pub mod environment;
pub mod mis;
pub mod subpath;
pub mod vertex;

pub use environment::EnvironmentVertex;
pub use mis::PartialMis;
pub use subpath::{Subpath, trace_camera_subpath, trace_light_subpath};
pub use vertex::{Scatter, Vertex};
