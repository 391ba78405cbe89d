//! Which integrator suits a scene, when nobody has named one.

use std::time::Instant;

use super::division::Division;
use super::pilot::Pilot;
use super::sweep::size;
use super::{Integrator, Observer, Settings, in_pool};
use crate::analysis::{Loss, LostLight};
use crate::scene::Scene;

/// Metropolis is chosen if it promises to be better by so much: plain sampling is simpler.
const WORTH_IT: f64 = 1.05;

/// An integrator, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// [`Integrator::Bdpt`] or [`Integrator::Mmlt`].
    pub integrator: Integrator,
    /// By how much less error chains are expected to leave at equal time than plain bidirectional path
    /// tracing would.
    pub gain: f64,
    /// There is light that only rare and bright paths find.
    pub rare_light: bool,
    /// Samples that tell so.
    pub samples: u64,
    /// Seconds that it took.
    pub seconds: f64,
}

/// Why an integrator was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChoiceReason {
    /// Chains are expected to leave 1/`gain` of the error of bidirectional path tracing at equal time.
    Gain(f64),
    /// Only rare and bright paths find some of the light.
    RareLight,
    /// No path is bright enough for chains to reduce the error.
    NoBrightPaths,
}

impl Choice {
    /// The first reason that applies.
    pub fn reason(&self) -> ChoiceReason {
        if self.gain > WORTH_IT {
            ChoiceReason::Gain(self.gain)
        } else if self.rare_light {
            ChoiceReason::RareLight
        } else {
            ChoiceReason::NoBrightPaths
        }
    }
}

/// Lets a pilot choose between bidirectional path tracing and multiplexed Metropolis, by the error that
/// each is expected to leave at equal time; `lost` is the light that neither finds well. Of a budget of
/// time it takes a few hundredths.
///
/// # Errors
/// If the threads cannot be started.
pub fn choose(
    scene: &Scene,
    settings: &Settings,
    lost: &[LostLight],
    observer: &dyn Observer,
) -> Result<Choice, rayon::ThreadPoolBuildError> {
    let start = Instant::now();
    observer.phase("choosing");
    in_pool(settings.threads, || {
        let is_over = || settings.pilot_is_over(start) || observer.interrupted();
        let pilot = Pilot::run(scene, settings.seed, is_over);
        let gain = Division::new(size(scene), &pilot, settings.division)
            .gain
            .powi(2);
        let rare_light = lost.iter().any(|lost| lost.loss == Loss::Nearly);
        Choice {
            integrator: if gain > WORTH_IT || rare_light {
                Integrator::Mmlt
            } else {
                Integrator::Bdpt
            },
            gain,
            rare_light,
            samples: pilot.samples,
            seconds: start.elapsed().as_secs_f64(),
        }
    })
}
