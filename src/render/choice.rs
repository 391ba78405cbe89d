//! The choice of an integrator for a scene, by a pilot.

use std::fmt;
use std::time::Instant;

use super::mmlt::{MmltSettings, Plan};
use super::{Integrator, Observer, Settings, in_pool};
use crate::analysis::{Loss, LostLight};
use crate::scene::Scene;

/// Chains are chosen if the expected ratio of errors exceeds this: independent samples are simpler.
const MIN_GAIN: f64 = 1.05;

/// An integrator, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// [`Integrator::Bdpt`], or [`Integrator::Mmlt`] with the plan of the pilot.
    pub integrator: Integrator,
    /// Expected error of `bdpt` over that of `mmlt` at equal time.
    pub gain: f64,
    /// Some light is found only by rare and bright paths.
    pub rare_light: bool,
    /// Samples of the pilot.
    pub samples: u64,
    /// Seconds that it took.
    pub seconds: f64,
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.integrator.method().name();
        write!(f, "{name} is chosen: ")?;
        if self.gain > MIN_GAIN {
            let gain = self.gain;
            write!(
                f,
                "chains should leave 1/{gain:.3} of bdpt's error in the same time"
            )?;
        } else if self.rare_light {
            write!(
                f,
                "there is light that only rare and bright paths find, which bdpt shows as dots"
            )?;
        } else {
            write!(f, "no path is bright enough for chains to pay")?;
        }
        let (samples, seconds) = (self.samples, self.seconds);
        write!(
            f,
            " (a pilot of {samples} samples, {seconds:.1} s; --integrator overrules it)"
        )
    }
}

/// Lets a pilot choose between bidirectional path tracing and multiplexed Metropolis with settings `own`,
/// by the error that each is expected to leave at equal time; `lost` is the light that neither finds well.
/// It takes a few per cent of a budget of time. The render goes on with the plan of the pilot.
///
/// # Errors
/// If the threads cannot be started.
pub fn choose(
    scene: &Scene,
    settings: &Settings,
    own: &MmltSettings,
    lost: &[LostLight],
    observer: &dyn Observer,
) -> Result<Choice, rayon::ThreadPoolBuildError> {
    let start = Instant::now();
    observer.phase("choosing");
    in_pool(settings.threads, || {
        let is_over = || settings.pilot_is_over(start) || observer.interrupted();
        let plan = Plan::new(scene, settings.seed, own, is_over);
        let gain = plan.clamp.gain.powi(2);
        let rare_light = lost.iter().any(|lost| lost.loss == Loss::Nearly);
        let samples = plan.samples;
        let integrator = if gain > MIN_GAIN || rare_light {
            Integrator::Mmlt(MmltSettings {
                plan: Some(plan),
                ..own.clone()
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
