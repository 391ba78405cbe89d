//! Are chains in equilibrium, and how much are they worth?
//!
//! The tests know their subject only as a target on the hypercube with something to look at in each
//! state ([`Subject`]), so that the same code judges the chains of a scene and those of targets whose
//! distribution is known. Each test of a chain takes one state per chain, and chains start exactly in
//! the target distribution ([`starts`]): under the null hypothesis the states are then independent,
//! however slowly a chain moves.

pub mod check;
pub mod history;
pub mod invariance;
pub mod light;
pub mod normalisation;
pub mod observation;
pub mod quality;
pub mod reversibility;
pub mod start_up;
pub mod starts;

use serde::Serialize;

use crate::markov::{Bootstrap, BootstrapLimits, Weighing};
use crate::math::seeds::{self, Purpose};
use crate::render::Observer;

pub use check::{Check, Family};
pub use light::{COORDINATE_NAMES, SceneLight};
pub use normalisation::{Estimate, Normalisation};
pub use observation::{COORDINATES, Features, Observation, Subject, TECHNIQUES, TILES, tile_at};
pub use quality::{Mixing, Quality, TileMixing};
pub use start_up::StartUpBias;
pub use starts::Starts;

/// How thoroughly chains are diagnosed.
#[derive(Clone, Debug, Serialize)]
pub struct Effort {
    /// Seed of all random numbers.
    pub seed: u64,
    /// p_large of the chains.
    pub large_step_probability: f32,
    /// Chains that start in equilibrium, if so many independent starts can be found.
    pub chains: usize,
    /// Uniform samples to look for starts in; twice, for the chains and for states to compare with.
    pub samples: u64,
    /// Steps of each of the long chains.
    pub steps: u64,
    /// Names of the watched coordinates.
    pub coordinates: [&'static str; COORDINATES],
}

impl Default for Effort {
    fn default() -> Self {
        Self {
            seed: 0,
            large_step_probability: crate::render::Settings::default().large_step_probability,
            chains: 4096,
            samples: 1 << 22,
            steps: 4096,
            coordinates: COORDINATE_NAMES,
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
    pub units: usize,
    /// Uniform samples that were looked at to find them.
    pub samples: u64,
    /// Estimates of b.
    pub normalisation: Normalisation,
    /// Bias of chains that start from small bootstraps.
    pub start_up: Vec<StartUpBias>,
    /// What long chains are worth.
    pub quality: Quality,
}

/// Why chains cannot be diagnosed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DiagnoseError {
    /// Nothing to start a chain from.
    #[error("none of {0} samples found light: there is no chain to diagnose")]
    NoLight(u64),
    /// The observer stopped it.
    #[error("interrupted")]
    Interrupted,
}

/// Bounds on the bootstrap that b is first known from.
const BOOTSTRAP: BootstrapLimits = BootstrapLimits {
    at_least: 1 << 17,
    at_most: 1 << 20,
    relative_error: 0.005,
};

/// Parts of the random numbers; none is used twice.
mod part {
    pub const BOOTSTRAP: u64 = 0;
    pub const FRESH: u64 = 1;
    pub const STARTS: u64 = 2;
    pub const CHAINS: u64 = 3;
    pub const RANKS: u64 = 4;
    pub const PLAIN: u64 = 5;
    pub const START_UP: u64 = 6;
    pub const QUALITY: u64 = 7;
    pub const TESTS: u64 = 8;
}

/// Diagnoses the chains of `subject`.
///
/// # Errors
/// If there is no light to be found, or the observer stops it.
pub fn diagnose<S: Subject>(
    subject: &S,
    effort: &Effort,
    observer: &dyn Observer,
) -> Result<Diagnosis, DiagnoseError> {
    let seed = |part| seeds::part(effort.seed, part);
    let p_large = effort.large_step_probability;
    let phase = |name: &str| {
        observer.phase(name);
        if observer.interrupted() {
            Err(DiagnoseError::Interrupted)
        } else {
            Ok(())
        }
    };

    phase("bootstrap")?;
    let bootstrap = bootstrap(subject, seed(part::BOOTSTRAP), observer);
    if bootstrap.moments.mean <= 0.0 {
        return Err(DiagnoseError::NoLight(bootstrap.moments.count));
    }

    phase("starts")?;
    let c = starts::spacing(&bootstrap);
    let draw = |part| Starts::draw(subject, seed(part), c, effort.chains, effort.samples);
    let (fresh, starts) = (draw(part::FRESH), draw(part::STARTS));
    let fresh: Vec<Features> = fresh.starts.iter().map(|start| start.features).collect();

    phase("chains")?;
    let weighing = Weighing {
        b: bootstrap.moments.mean,
        large_step_probability: f64::from(p_large),
    };
    let histories = history::run(subject, &starts, seed(part::CHAINS), weighing);
    phase("ranks")?;
    let mut checks = reversibility::ranks(subject, &starts, seed(part::RANKS), p_large);
    phase("tests")?;
    let mut rng = seeds::generator(seed(part::TESTS), Purpose::Tests, 0);
    checks.extend(invariance::invariance(
        &fresh,
        &histories,
        effort.coordinates,
        &mut rng,
    ));
    checks.extend(reversibility::symmetry(&fresh, &histories));
    checks.extend(invariance::independence(&histories));

    phase("plain")?;
    let plain = subject.plain(seed(part::PLAIN));
    let (normalisation, more) =
        normalisation::normalisation(&bootstrap, &histories, &plain, weighing);
    checks.extend(more);
    check::correct(&mut checks);

    phase("start-up")?;
    let start_up = start_up::start_up_bias(subject, &fresh, seed(part::START_UP), p_large);
    phase("quality")?;
    let seed = seed(part::QUALITY);
    let quality = quality::quality(subject, &bootstrap, &histories, effort.steps, seed, p_large);
    Ok(Diagnosis {
        checks,
        chains: histories.len(),
        units: starts.units(),
        samples: starts.samples,
        normalisation,
        start_up,
        quality,
    })
}

fn bootstrap<S: Subject>(subject: &S, seed: u64, observer: &dyn Observer) -> Bootstrap {
    Bootstrap::run(
        seed,
        BOOTSTRAP,
        || subject.target(),
        |_| (),
        |done| {
            observer.progress(done as f64 / BOOTSTRAP.at_most as f64, None);
            observer.interrupted()
        },
    )
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
