//! Metropolis light transport in primary sample space, over a bidirectional path tracer.
//!
//! Every method here is a map from a point of the unit hypercube to splats on the film (a path sampler,
//! [`integrators`]), and a driver that decides how the point moves ([`render`](mod@render)): as independent
//! samples, or as the state of a Markov chain ([`markov`]).
//!
//! # Load, render, compare
//!
//! ```
//! use std::path::Path;
//!
//! use metrolight::metrics::image_errors;
//! use metrolight::mitsuba::{self, Overrides};
//! use metrolight::render::{Budget, Method, Settings, Unobserved, render};
//!
//! // Load a scene file, as a small image.
//! let overrides = Overrides { size: Some([24, 24]) };
//! let loaded = mitsuba::load_with(Path::new("scenes/cornell/scene.xml"), &[], overrides)?;
//! let scene = loaded.description.build()?;
//!
//! // Render it by bidirectional path tracing, with two seeds.
//! let image = |seed, samples| {
//!     let settings = Settings {
//!         budget: Budget::SamplesPerPixel(samples),
//!         seed,
//!         ..Settings::new(Method::Bdpt)
//!     };
//!     render(&scene, &settings, &Unobserved).map(|rendering| rendering.image)
//! };
//! let (image, reference) = (image(0, 16)?, image(1, 64)?);
//!
//! // Compare the images.
//! let error = image_errors(&image.pixels, &reference.pixels);
//! assert!(error.relative_mse < 0.1, "{error:?}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Modules
//!
//! In reading order; a module uses only modules further down, which a test checks:
//!
//! | module | content |
//! | --- | --- |
//! | [`convergence`], [`diagnosis`] | error against time; tests of chains |
//! | [`render`](mod@render) | drivers: independent samples, `pssmlt`, `mmlt`; budget, progress, error |
//! | [`analysis`] | light that is lost, rare or trapped |
//! | [`integrators`] | path samplers: a point of the hypercube to splats |
//! | [`technique`] | Veach's (s, t): hit, next event, camera, join |
//! | [`path`] | vertices, subpaths, MIS weights |
//! | [`markov`] | primary sample state, mutations, chains, Kelemen's weights, bootstrap |
//! | [`mitsuba`] | scene files to scenes |
//! | [`scene`] | camera, lights, BSDFs, textures, geometry |
//! | [`bvh`] | triangles and spheres to the nearest hit |
//! | [`sampling`] | the sampler trait, independent samples, seeds, distributions, warps |
//! | [`metrics`] | relMSE, FLIP, bias |
//! | [`film`] | filters, splats, image files |
//! | [`plot`], [`statistics`], [`math`] | charts; tests and moments; colours, frames, linear systems |
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod analysis;
pub mod bvh;
pub mod convergence;
pub mod diagnosis;
mod fault;
pub mod film;
pub mod integrators;
pub mod markov;
pub mod math;
pub mod metrics;
pub mod mitsuba;
pub mod path;
pub mod plot;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod statistics;
pub mod technique;
