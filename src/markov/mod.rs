//! Metropolis-Hastings in the unit hypercube, for any target: nothing here depends on light transport.
//!
//! The state is a point u of [0,1)^inf, read lazily, and the target is a scalar I(u) >= 0 (Kelemen
//! et al. 2002, "A simple and robust mutation strategy for the Metropolis light transport
//! algorithm"; Hachisuka's smallpssmlt follows the same paper).

pub mod bootstrap;
pub mod chain;
pub mod kelemen;
pub mod mutation;
pub mod primary_sample;

pub use bootstrap::{Bootstrap, BootstrapLimits, systematic_resample};
pub use chain::{Chain, ChainCounters, MutationCounters, Sample, Weights};
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
