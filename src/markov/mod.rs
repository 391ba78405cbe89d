//! Metropolis-Hastings in the unit hypercube, for any target: nothing here knows what light is.
//!
//! The state is a point u of [0,1)^inf, read lazily, and the target is a scalar I(u) >= 0 (Kelemen
//! et al. 2002, "A simple and robust mutation strategy for the Metropolis light transport
//! algorithm"; Hachisuka and Jensen's smallpssmlt follows the same paper).

pub mod bootstrap;
pub mod chain;
pub mod mutation;
pub mod point;
pub mod weighing;

pub use bootstrap::{Bootstrap, BootstrapLimits, systematic_resample};
pub use chain::{Chain, ChainCounters, Recording, Sample, Weights};
pub use mutation::{SmallStep, Steps};
pub use point::LazyPoint;
pub use weighing::Weighing;

use crate::sampling::Coordinates;

/// A target on the hypercube.
pub trait Target {
    /// What the point gives besides its density, kept with the state of a chain.
    type Contribution: Default;

    /// Evaluates the target at `point` and writes what it gives into `out`, which holds an old
    /// contribution to be overwritten. Returns I(u) >= 0, or NaN if it has no finite value there.
    fn evaluate<C: Coordinates>(&mut self, point: &mut C, out: &mut Self::Contribution) -> f64;
}
