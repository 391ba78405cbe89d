//! Metropolis light transport in primary sample space, over a bidirectional path tracer.
//!
//! Every method here is a map from a point of the unit hypercube to splats on the film (a path
//! sampler, [`integrators`]) and a driver that decides how the point moves ([`render`]): at random,
//! or as the state of a Markov chain ([`markov`]). Modules use only what stands below them:
//!
//! `commands` > [`convergence`], [`diagnosis`] > [`render`] > [`analysis`], [`integrators`], [`markov`] >
//! [`technique`] > [`path`] > [`mitsuba`] > [`scene`] > [`bvh`], [`sampling`], [`metrics`] > [`film`] >
//! [`plot`], [`statistics`], [`math`].
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
