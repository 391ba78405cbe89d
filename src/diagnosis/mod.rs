//! Are chains in equilibrium, and how well do they mix?
//!
//! The tests see a target on the hypercube and some observed quantities of each state ([`ChainTarget`]), so that the same code judges the chains of a scene and those of targets whose
//! distribution is known. Each test of a chain takes one state per chain, and chains start exactly in
//! the target distribution ([`starts`]): under the null hypothesis the states are then independent,
//! however slowly a chain moves.
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
    /// Chains that start in equilibrium, if so many independent starts can be found.
    pub chains: usize,
    /// Uniform samples to look for starts in; twice, for the chains and for states to compare with.
    pub samples: u64,
    /// Steps of each of the long chains.
    pub steps: u64,
    /// Names of the observed coordinates.
    pub coordinates: [&'static str; COORDINATES],
    /// Bounds on the bootstrap that b is known from and long chains start from.
    #[serde(skip)]
    pub bootstrap: BootstrapLimits,
    /// Most permutations of the maximum mean discrepancy: p-values down to one over their number can
    /// be told.
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

/// What was found.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// All tests, their p-values corrected together.
    pub checks: Vec<Check>,
    /// Chains that started in equilibrium.
    pub chains: usize,
    /// Independent starts among them.
    pub clusters: usize,
    /// Uniform samples among which they were found.
    pub samples: u64,
    /// Estimates of b.
    pub normalisation: Normalisation,
    /// Bias of chains that start from small bootstraps.
    pub start_up: Vec<StartUpBias>,
    /// How well long chains mix.
    pub quality: Quality,
}

/// Why chains cannot be diagnosed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DiagnoseError {
    /// Nothing to start a chain from.
    #[error("none of {0} samples found light: there is no chain to diagnose")]
    NoLight(u64),
    /// Independent samples carry all light.
    #[error("no path of {0} samples is bright enough for chains: there is no chain to diagnose")]
    NoResidual(u64),
    /// The observer cancelled it.
    #[error("interrupted")]
    Interrupted,
}

/// Parts of the random numbers; none is used twice.
mod part {
    pub const BOOTSTRAP: u64 = 0;
    pub const FRESH: u64 = 1;
    pub const STARTS: u64 = 2;
    pub const CHAINS: u64 = 3;
    pub const RANKS: u64 = 4;
    pub const INDEPENDENT: u64 = 5;
    pub const START_UP: u64 = 6;
    pub const QUALITY: u64 = 7;
    pub const TESTS: u64 = 8;
    pub const OWN: u64 = 9;
}

/// Diagnoses the chains of `chain_target`.
///
/// # Errors
/// If there is no light to be found, or the observer stops it.
pub fn diagnose<S: ChainTarget>(
    chain_target: &S,
    budget: &DiagnosisBudget,
    observer: &dyn Observer,
) -> Result<Diagnosis, DiagnoseError> {
    let Equilibrium {
        checks,
        bootstrap,
        fresh,
        starts,
        histories,
        normalisation,
    } = equilibrium(chain_target, budget, observer)?;
    begin(observer, "start-up bias")?;
    let seed = |part| seeds::part(budget.seed, part);
    let start_up = start_up::start_up_bias(chain_target, &fresh, seed(part::START_UP));
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

/// Tells of a phase, unless the observer wants an end.
fn begin(observer: &dyn Observer, phase: &str) -> Result<(), DiagnoseError> {
    observer.phase(phase);
    if observer.interrupted() {
        Err(DiagnoseError::Interrupted)
    } else {
        Ok(())
    }
}

impl Diagnosis {
    /// Tests that reject at level `alpha`, the surest first.
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
