//! Convergence: the error of several renders of a scene against time.
//!
//! All variants are rendered once per repeat, in turn, so that a change of the machine's speed affects
//! all of them. The error is measured at geometrically spaced times of a single render, while its clock
//! is stopped.
//!
//! ```
//! use metrolight::convergence::{Experiment, Variant};
//! use metrolight::render::{Budget, Method, Settings, Unobserved, render};
//!
//! # let size = metrolight::mitsuba::Overrides { size: Some([16, 12]) };
//! # let path = std::path::Path::new("scenes/cornell/scene.xml");
//! # let mut scene = metrolight::mitsuba::load_with(path, &[], size)?.description.build()?;
//! let settings = |method, spp| Settings {
//!     budget: Budget::SamplesPerPixel(spp),
//!     ..Settings::new(method)
//! };
//! let reference = render(&scene, &settings(Method::Bdpt, 64), &Unobserved)?.image;
//! let variants = [Method::Path, Method::Bdpt].map(|method| Variant {
//!     settings: settings(method, 8),
//!     ..Variant::new(method)
//! });
//! let mut experiment = Experiment {
//!     scene: &mut scene,
//!     reference: &reference,
//!     variants: &variants,
//!     repeats: 2,
//! };
//! let outcome = experiment.run(&Unobserved)?;
//! assert!(outcome.measurements.iter().all(|m| m.error.relative_mse > 0.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod chart;
pub mod curve;
pub mod experiment;
pub mod recorder;

pub use chart::{comparison, convergence_chart};
pub use curve::{Cost, Curve, CurvePoint, Measure, Reached};
pub use experiment::{Experiment, Measurement, Outcome, Variant};
