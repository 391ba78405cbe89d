//! Diagnosis of Markov chains: tests of whether they are in equilibrium, and measures of how well they mix.
//!
//! The tests use only a target on the hypercube and some observed quantities of each state
//! ([`ChainTarget`]), so the same code tests the chains of a scene and those of targets whose distribution
//! is known. Each test uses one state per chain, and chains start exactly in the target distribution
//! ([`starts`]). Under the null hypothesis the states are then independent, however slowly the chains mix.
//!
//! ```
//! use metrolight::diagnosis::{DiagnosisBudget, PssmltChains, diagnose};
//! use metrolight::render::{PssmltSettings, Unobserved};
//!
//! # let size = metrolight::mitsuba::Overrides { size: Some([16, 12]) };
//! # let path = std::path::Path::new("scenes/cornell/scene.xml");
//! # let mut scene = metrolight::mitsuba::load_with(path, &[], size)?.description.build()?;
//! let chains = PssmltChains::new(&mut scene, PssmltSettings::default(), Some(2));
//! let budget = DiagnosisBudget { chains: 64, steps: 64, permutations: 100, ..Default::default() };
//! let diagnosis = diagnose(&chains, &budget, &Unobserved)?;
//! assert!(diagnosis.rejections(1e-6).is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod check;
mod equilibrium;
pub mod history;
pub mod invariance;
pub mod mmlt;
pub mod normalisation;
pub mod observation;
mod paths;
pub mod pssmlt;
pub mod quality;
pub mod reversibility;
pub mod start_up;
pub mod starts;
#[cfg(test)]
mod tests;

use serde::Serialize;

use crate::markov::BootstrapLimits;
use crate::render::Observer;
use crate::sampling::seeds;

use self::equilibrium::{Equilibrium, equilibrium};
pub use check::{Check, Family};
pub use mmlt::{MmltChains, MmltSamples};
pub use normalisation::{Estimate, Normalisation};
pub use observation::{
    COORDINATES, ChainTarget, Features, IndependentEstimate, Observation, Quantity, TECHNIQUES,
    TILES, tile_at,
};
pub use paths::COORDINATE_NAMES;
pub use pssmlt::PssmltChains;
pub use quality::{Mixing, Quality, TileMixing};
pub use start_up::StartUpBias;
pub use starts::Starts;

/// Numbers of chains and samples of a diagnosis.
#[derive(Clone, Debug, Serialize)]
pub struct DiagnosisBudget {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of chains that start in equilibrium; fewer if too few starts are found.
    pub chains: usize,
    /// Maximum number of uniform samples that are searched for starts of the chains, and again for
    /// reference states.
    pub samples: u64,
    /// Steps of each of the long chains.
    pub steps: u64,
    /// Names of the observed coordinates.
    pub coordinates: [&'static str; COORDINATES],
    /// Bounds on the bootstrap, which estimates b and gives the starts of the long chains.
    #[serde(skip)]
    pub bootstrap: BootstrapLimits,
    /// Maximum number of permutations for the maximum mean discrepancy. The smallest possible p-value is
    /// about one over this number.
    pub permutations: u32,
}

impl Default for DiagnosisBudget {
    fn default() -> Self {
        Self {
            seed: 0,
            chains: 4096,
            samples: 1 << 21,
            steps: 4096,
            coordinates: COORDINATE_NAMES,
            permutations: 100_000,
            bootstrap: BootstrapLimits {
                at_least: 1 << 17,
                at_most: 1 << 20,
                relative_error: 0.005,
            },
        }
    }
}

/// The result of a diagnosis.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// All tests, their p-values corrected together.
    pub checks: Vec<Check>,
    /// Chains that started in equilibrium.
    pub chains: usize,
    /// Number of independent starts of these chains.
    pub clusters: usize,
    /// Uniform samples among which the starts were found.
    pub samples: u64,
    /// Estimates of b.
    pub normalisation: Normalisation,
    /// Bias of chains that start from small bootstraps; empty if chains do not start from a bootstrap.
    pub start_up: Vec<StartUpBias>,
    /// How well long chains mix.
    pub quality: Quality,
}

/// Why chains cannot be diagnosed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DiagnoseError {
    /// No chain can start.
    #[error("none of {0} samples found light: there is no chain to diagnose")]
    NoLight(u64),
    /// No path has a residual.
    #[error("no path of {0} samples is bright enough for chains: there is no chain to diagnose")]
    NoResidual(u64),
    /// The observer cancelled the diagnosis.
    #[error("interrupted")]
    Interrupted,
}

/// Indices of the parts of the random numbers (`seeds::part`). Each part is used once.
mod part {
    pub const BOOTSTRAP: u64 = 0;
    pub const REFERENCE: u64 = 1;
    pub const STARTS: u64 = 2;
    pub const CHAINS: u64 = 3;
    pub const RANKS: u64 = 4;
    pub const INDEPENDENT: u64 = 5;
    pub const START_UP: u64 = 6;
    pub const QUALITY: u64 = 7;
    pub const TESTS: u64 = 8;
    pub const SPECIFIC: u64 = 9;
}

/// Diagnoses the chains of `chain_target`.
///
/// # Errors
/// If no light is found, or the observer cancels.
pub fn diagnose<S: ChainTarget>(
    chain_target: &S,
    budget: &DiagnosisBudget,
    observer: &dyn Observer,
) -> Result<Diagnosis, DiagnoseError> {
    let Equilibrium {
        checks,
        bootstrap,
        reference,
        starts,
        histories,
        normalisation,
    } = equilibrium(chain_target, budget, observer)?;
    begin(observer, "start-up bias")?;
    let seed = |part| seeds::part(budget.seed, part);
    let start_up = if chain_target.starts_from_bootstrap() {
        start_up::start_up_bias(chain_target, &reference, seed(part::START_UP))
    } else {
        Vec::new()
    };
    begin(observer, "long chains")?;
    let long = (budget.steps, seed(part::QUALITY));
    let quality = quality::quality(chain_target, &bootstrap, &histories, long);
    Ok(Diagnosis {
        checks,
        chains: histories.len(),
        clusters: starts.clusters(),
        samples: starts.samples,
        normalisation,
        start_up,
        quality,
    })
}

/// Reports a new phase to the observer. Fails if the observer cancels.
fn begin(observer: &dyn Observer, phase: &str) -> Result<(), DiagnoseError> {
    observer.phase(phase);
    if observer.interrupted() {
        Err(DiagnoseError::Interrupted)
    } else {
        Ok(())
    }
}

impl Diagnosis {
    /// Tests that reject at level `alpha`, in the order of their p-values.
    pub fn rejections(&self, alpha: f64) -> Vec<&Check> {
        let mut rejections: Vec<&Check> = self
            .checks
            .iter()
            .filter(|check| check.adjusted < alpha)
            .collect();
        rejections.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
        rejections
    }
}
