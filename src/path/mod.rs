//! Paths in Veach's terms (Veach 1997, chapters 8 and 10): vertices, subpaths from the lights and from
//! the lens, and the MIS weights that combine the techniques.
//!
//! A path of k edges is x_0 ... x_k with x_0 on a light and x_k on the lens. Technique (s, t) takes s
//! vertices y_0 ... y_{s-1} from a light subpath and t vertices z_0 ... z_{t-1} from a camera subpath,
//! s + t = k + 1. Here s >= 0 and t >= 1: light subpaths never hit the lens.
//!
//! ```
//! use glam::Vec2;
//! use metrolight::path::{Subpath, trace_camera_subpath};
//! use metrolight::sampling::IndependentSampler;
//! use metrolight::sampling::seeds::Purpose;
//! use metrolight::scene::RayCounts;
//!
//! # let size = metrolight::mitsuba::Overrides { size: Some([16, 12]) };
//! # let path = std::path::Path::new("scenes/cornell/scene.xml");
//! # let scene = metrolight::mitsuba::load_with(path, &[], size)?.description.build()?;
//! let mut sampler = IndependentSampler::new(0, Purpose::Pixels, 0);
//! let (mut rays, mut subpath) = (RayCounts::default(), Subpath::default());
//! trace_camera_subpath(&scene, Vec2::splat(0.5), 3, &mut sampler, &mut rays, &mut subpath);
//! let [z_1, ..] = &subpath.vertices[..] else { panic!("the middle of the image shows a surface") };
//! assert!(z_1.is_connectible(&scene));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod dimensions;
pub mod environment;
pub mod mis;
pub mod specular;
pub mod subpath;
pub mod vertex;

pub use environment::EnvironmentVertex;
pub use mis::PartialMis;
pub use subpath::{Subpath, trace_camera_subpath, trace_light_subpath};
pub use vertex::{DirectionSample, Scatter, Vertex};
