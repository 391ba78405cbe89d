//! Drivers: they decide how the point of the hypercube moves, pair a path sampler with that, keep
//! to a budget, and add what comes out to a film.

mod choice;
pub mod clock;
mod division;
pub mod error;
mod importance;
pub mod metropolis;
pub mod monte_carlo;
mod multiplexed;
pub mod origin;
mod pilot;
mod redistribution;
pub mod replay;
pub mod seat;
pub mod settings;
pub mod statistics;
pub mod strategies;
mod sweep;
mod warnings;

use crate::film::Image;
use crate::scene::Scene;

pub use choice::{Choice, ChoiceReason, choose};
pub use division::DivisionSettings;
pub use error::ErrorEstimate;
pub use origin::{NonFinite, Origin};
pub use replay::{Replay, ReplayError};
pub use seat::LightTarget;
pub use settings::{Budget, Integrator, Settings};
pub use statistics::{MetropolisStatistics, MultiplexedStatistics, Statistics, StepStatistics};
pub use strategies::{Strategies, StrategiesError, TechniqueImages, strategies, techniques};
pub use warnings::Warning;

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Seconds of rendering so far, without those in which the observer looked at the image.
    pub seconds: f64,
    /// Path samples, or mutations.
    pub samples: u64,
    /// Closest-hit and shadow rays.
    pub rays: u64,
}

/// Who is told how a render goes, and may stop it.
pub trait Observer: Sync {
    /// A new phase of the work begins.
    fn phase(&self, name: &str);
    /// `fraction` of the phase is done; `seconds_left` is an estimate, once there is one.
    fn progress(&self, fraction: f64, seconds_left: Option<f64>);
    /// True if the render should finish what it is at and return what it has.
    fn interrupted(&self) -> bool;
    /// True if [`Self::look`] should be shown the image at this moment.
    fn wants_to_look(&self, _moment: &Moment) -> bool {
        false
    }
    /// Is shown the image so far, while the clock of the render stands still.
    fn look(&self, _moment: &Moment, _image: &Image) {}
}

/// An observer that neither listens nor stops.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn phase(&self, _name: &str) {}
    fn progress(&self, _fraction: f64, _seconds_left: Option<f64>) {}
    fn interrupted(&self) -> bool {
        false
    }
}

/// What a render gives.
#[derive(Debug)]
pub struct Rendering {
    /// Linear RGB radiance, W/(m^2 sr) in the units of the scene.
    pub image: Image,
    /// Its error, if it was asked for and could be estimated.
    pub error: Option<ErrorEstimate>,
    /// What it took.
    pub statistics: Statistics,
    /// The observer stopped it before its budget was spent.
    pub interrupted: bool,
    /// What limits the image.
    pub warnings: Vec<Warning>,
}

/// Renders `scene`. The image depends on the scene and the settings alone, to the bit, whatever the
/// number of threads, unless the budget is one of time or the observer interrupts.
///
/// # Errors
/// If the threads cannot be started.
pub fn render(
    scene: &Scene,
    settings: &Settings,
    observer: &dyn Observer,
) -> Result<Rendering, rayon::ThreadPoolBuildError> {
    let mut rendering = in_pool(settings.threads, || match settings.integrator {
        Integrator::Path | Integrator::Light | Integrator::Bdpt | Integrator::Mmlt => {
            monte_carlo::render(scene, settings, observer)
        }
        Integrator::Pssmlt => metropolis::render(scene, settings, observer),
    })?;
    let black = rendering
        .image
        .pixels
        .iter()
        .flatten()
        .all(|&value| value == 0.0);
    if black && !rendering.interrupted && rendering.warnings.is_empty() {
        rendering.warnings.push(Warning::Black);
    }
    Ok(rendering)
}

/// Runs `work` on so many threads, or on one per core.
fn in_pool<R: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> R + Send,
) -> Result<R, rayon::ThreadPoolBuildError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build()?;
    Ok(pool.install(work))
}
