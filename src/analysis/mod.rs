//! Analysis of a scene before it is rendered: light that is lost, rare or trapped, views that are probably
//! mistakes, and surfaces that lie too close to each other.
//!
//! ```
//! use metrolight::analysis::{Loss, lost_light};
//! use metrolight::technique::TechniqueSet;
//!
//! let path = std::path::Path::new("scenes/lost-caustic/scene.xml");
//! let scene = metrolight::mitsuba::load(path, &[])?.description.build()?;
//! // A point light behind smooth glass, seen through smooth glass.
//! let lost = lost_light(&scene, TechniqueSet::Bidirectional);
//! assert!(lost.iter().any(|lost| lost.loss == Loss::Always));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod lost_light;
pub mod near_surfaces;
pub mod odd_view;
mod probe;
pub mod trapped_light;

pub use lost_light::{Loss, LostLight, lost_light, lost_light_observed};
pub use near_surfaces::{NearSurfaces, near_surfaces};
pub use odd_view::{OddView, odd_view};
pub use trapped_light::{TrappedLight, trapped_light};
