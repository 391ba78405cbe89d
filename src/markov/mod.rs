//! Metropolis-Hastings in the unit hypercube, for any target: nothing here depends on light transport.
//!
//! The state is a point u of [0,1)^inf, read lazily, and the target is a scalar I(u) >= 0 (Kelemen
//! et al. 2002, "A simple and robust mutation strategy for the Metropolis light transport
//! algorithm"; Hachisuka's smallpssmlt follows the same paper).
//!
//! ```
//! use metrolight::markov::{Chain, Mutations, Perturbation, Target, bootstrap};
//! use metrolight::sampling::{Dimension, Sampler, Stream, seeds};
//!
//! /// I(u) = 2 u in one dimension; a state is u.
//! struct Ramp;
//!
//! impl Target for Ramp {
//!     type Contribution = f32;
//!
//!     fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut f32) -> f64 {
//!         [*out] = sampler.get(Dimension::new(Stream::Camera, 0));
//!         2.0 * f64::from(*out)
//!     }
//! }
//!
//! let rng = seeds::chain_generator(0, 0);
//! let mutations = Mutations::kelemen(0.3, Perturbation::default());
//! let mut chain = Chain::start(&mut Ramp, bootstrap::sample(0, 0), rng, mutations);
//! let mut mean = 0.0;
//! for _ in 0..100_000 {
//!     chain.step(&mut Ramp);
//!     mean += f64::from(chain.current().contribution) / 100_000.0;
//! }
//! // E[u] under the density 2 u.
//! assert!((mean - 2.0 / 3.0).abs() < 0.02, "{mean}");
//! ```

pub mod bootstrap;
pub mod chain;
pub mod kelemen;
pub mod mutation;
pub mod primary_sample;

pub use bootstrap::{Bootstrap, BootstrapLimits, systematic_resample};
pub use chain::{Chain, ChainCounters, MutationCounters, Sample, Step, Weights};
pub use kelemen::KelemenWeights;
pub use mutation::{Mutation, Mutations, Perturbation, SmallStep};
pub use primary_sample::PrimarySample;

use crate::sampling::Sampler;

/// A target density on the hypercube, up to a constant factor.
pub trait Target {
    /// The result of an evaluation besides the density, stored with the state of a chain.
    type Contribution: Default;

    /// Evaluates the target at the point `sampler` and replaces `out` by its contribution. Returns
    /// I(u) >= 0, or NaN if I is not finite there.
    fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut Self::Contribution) -> f64;
}
