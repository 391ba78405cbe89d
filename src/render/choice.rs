//! The choice between bidirectional path tracing and multiplexed Metropolis for a scene, by a pilot.

use std::time::Instant;

use super::plan::{MmltSettings, Plan};
use super::{Integrator, Observer, Settings, in_pool};
use crate::analysis::{Loss, LostLight};
use crate::scene::{RayCounts, Scene};

/// Chains are chosen if the expected ratio of errors exceeds this. Otherwise independent samples are
/// preferred, because they are simpler.
const MIN_GAIN: f64 = 1.05;

/// The chosen integrator, and the reasons.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// [`Integrator::Bdpt`], or [`Integrator::Mmlt`] with the plan of the pilot.
    pub integrator: Integrator,
    /// Expected error of `bdpt` over that of `mmlt` at equal time.
    pub gain: f64,
    /// True if some light is found only by rare and bright paths.
    pub rare_light: bool,
    /// Samples of the pilot.
    pub samples: u64,
    /// Duration of the choice in seconds.
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
        if self.gain > MIN_GAIN {
            ChoiceReason::Gain(self.gain)
        } else if self.rare_light {
            ChoiceReason::RareLight
        } else {
            ChoiceReason::NoBrightPaths
        }
    }
}

/// Runs a pilot and chooses between bidirectional path tracing and multiplexed Metropolis with
/// `method_settings`, by the expected error of each at equal time. `lost` is the light that neither finds
/// well. The pilot takes a few per cent of a time budget, and the render reuses its plan.
///
/// # Errors
/// If the threads cannot be started.
pub fn choose(
    scene: &Scene,
    settings: &Settings,
    method_settings: &MmltSettings,
    lost: &[LostLight],
    observer: &dyn Observer,
) -> Result<Choice, rayon::ThreadPoolBuildError> {
    let start = Instant::now();
    observer.phase("choosing");
    in_pool(settings.threads, || {
        let is_over = || settings.pilot_is_over(start) || observer.interrupted();
        let plan = Plan::new(scene, settings.seed, method_settings, is_over);
        let gain = plan.clamp.gain.powi(2);
        let rare_light = lost.iter().any(|lost| lost.loss == Loss::Nearly);
        let samples = plan.samples;
        let integrator = if gain > MIN_GAIN || rare_light {
            // The render counts neither the time nor the rays of the choice.
            let plan = Plan {
                rays: RayCounts::default(),
                ..plan
            };
            Integrator::Mmlt(MmltSettings {
                plan: Some(plan),
                ..method_settings.clone()
            })
        } else {
            Integrator::Bdpt
        };
        Choice {
            integrator,
            gain,
            rare_light,
            samples,
            seconds: start.elapsed().as_secs_f64(),
        }
    })
}
