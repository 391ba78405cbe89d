//! Metropolis-Hastings in the unit hypercube, for any target: nothing here depends on light.
//!
//! The state is a point u of [0,1)^inf, read lazily, and the target is a scalar I(u) >= 0 (Kelemen
//! et al. 2002, "A simple and robust mutation strategy for the Metropolis light transport
//! algorithm"; Hachisuka and Jensen's smallpssmlt follows the same paper).

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

/// A target on the hypercube.
pub trait Target {
    /// What a point gives besides its density, kept with the state of a chain.
    type Contribution: Default;

    /// Evaluates the target at the point that `sampler` stands for and writes its contribution into `out`,
    /// which holds an old one to be overwritten. Returns I(u) >= 0, or NaN if it has no finite value there.
    fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut Self::Contribution) -> f64;
}
