//! Which integrator suits a scene, when nobody has named one.

use std::fmt;
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

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.integrator.name();
        write!(f, "{name} is chosen: ")?;
        if self.gain > WORTH_IT {
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
