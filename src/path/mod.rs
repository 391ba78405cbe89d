//! Paths in Veach's terms (Veach 1997, chapters 8 and 10): subpaths from the light and from the
//! lens, the techniques (s, t) that join them, and the weights that combine the techniques.
//!
//! A path of k edges is x_0 ... x_k with x_0 on an emitter and x_k on the lens. Technique (s, t)
//! takes s vertices y_0 ... y_{s-1} from a light subpath and t vertices z_0 ... z_{t-1} from a camera
//! subpath, s + t = k + 1. Here s >= 0 and t >= 1: no technique lets light hit the lens.

pub mod dimensions;
pub mod endpoint;
pub mod mis;
pub mod subpath;
pub mod vertex;

pub use endpoint::Escape;
pub use mis::{Carried, Heuristic};
pub use subpath::{Subpath, walk_camera, walk_light};
pub use vertex::{Bounce, Vertex};
