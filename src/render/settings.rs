//! What the user asks for.

use std::time::Instant;

use serde::Serialize;

use super::DivisionSettings;
use crate::integrators::Sampler;
use crate::markov::SmallStep;

/// Pairs of a path sampler and a driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Integrator {
    /// Unidirectional path tracing by Monte Carlo.
    Path,
    /// Light tracing by Monte Carlo.
    Light,
    /// Bidirectional path tracing by Monte Carlo.
    Bdpt,
    /// Bidirectional path tracing by Metropolis in primary sample space.
    Pssmlt,
    /// Multiplexed Metropolis beside plain bidirectional path tracing.
    Mmlt,
}

impl Integrator {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Path,
        Self::Light,
        Self::Bdpt,
        Self::Pssmlt,
        Self::Mmlt,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Light => "light",
            Self::Bdpt => "bdpt",
            Self::Pssmlt => "pssmlt",
            Self::Mmlt => "mmlt",
        }
    }

    /// Its path sampler.
    pub fn sampler(self) -> Sampler {
        match self {
            Self::Path => Sampler::Path,
            Self::Light => Sampler::Light,
            Self::Bdpt | Self::Pssmlt | Self::Mmlt => Sampler::Bidirectional,
        }
    }

    /// True if it moves by a Markov chain.
    pub fn is_metropolis(self) -> bool {
        matches!(self, Self::Pssmlt)
    }

    /// How its chains move when the user names no step.
    pub fn default_small_step(self) -> SmallStep {
        match self {
            // Over many scales, so that there are some steps for features of any size.
            Self::Mmlt => SmallStep::new(1.0 / f32::exp2(18.0), 1.0 / 64.0),
            Self::Path | Self::Light | Self::Bdpt | Self::Pssmlt => SmallStep::default(),
        }
    }

    /// Samples (or mutations) per pixel when the user names no budget.
    pub fn default_samples_per_pixel(self) -> u64 {
        if self.is_metropolis() { 128 } else { 64 }
    }
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Samples per pixel; for Metropolis integrators mutations per pixel.
    SamplesPerPixel(u64),
    /// Seconds of rendering, with neither loading nor building counted.
    Seconds(f64),
    /// Until the target error is reached or the observer interrupts.
    Unlimited,
}

/// Everything that decides the image, besides the scene.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Which method.
    pub integrator: Integrator,
    /// How long.
    pub budget: Budget,
    /// Estimate the standard error of every pixel.
    pub error: bool,
    /// Stop, before the budget is spent, as soon as the estimated relMSE
    /// ([`crate::metrics::relative_mse`]) is this or less. The error of a Metropolis image takes two
    /// chains to be known: with one, only the budget ends the render.
    pub target_error: Option<f64>,
    /// The same seed gives the same image.
    pub seed: u64,
    /// Number of threads; `None` for one per core.
    pub threads: Option<usize>,
    /// p_large: probability of a large step.
    pub large_step_probability: f32,
    /// How coordinates move in a small step; of the multiplexed integrator all but the technique.
    pub small_step: SmallStep,
    /// Number of Markov chains.
    pub chains: u64,
    /// Number of bootstrap samples; `None` to go on until b is known well enough.
    pub bootstrap: Option<u64>,
    /// How the multiplexed integrator divides light between plain samples and chains.
    pub division: DivisionSettings,
}

impl Settings {
    /// The defaults for an integrator.
    pub fn new(integrator: Integrator) -> Self {
        Self {
            integrator,
            budget: Budget::SamplesPerPixel(integrator.default_samples_per_pixel()),
            error: false,
            target_error: None,
            seed: 0,
            threads: None,
            large_step_probability: 0.3,
            small_step: integrator.default_small_step(),
            chains: 1024,
            bootstrap: None,
            division: DivisionSettings::default(),
        }
    }
}

impl Settings {
    /// True if a pilot that began at `start` has taken its part of a budget of time.
    pub(super) fn pilot_is_over(&self, start: Instant) -> bool {
        const PART: f64 = 0.03;
        match self.budget {
            Budget::Seconds(seconds) => start.elapsed().as_secs_f64() > PART * seconds,
            Budget::SamplesPerPixel(_) | Budget::Unlimited => false,
        }
    }

    /// True if standard errors are to be estimated, for their own sake or for a target.
    pub fn wants_error(&self) -> bool {
        self.error || self.target_error.is_some()
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::new(Integrator::Pssmlt)
    }
}
