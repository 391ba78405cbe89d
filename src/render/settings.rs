//! Settings of a render.

use std::time::Instant;

use serde::Serialize;

use super::plan::MmltSettings;
use crate::markov::Perturbation;
use crate::technique::TechniqueSet;

/// The integrators by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Unidirectional path tracing by independent samples.
    Path,
    /// Light tracing by independent samples.
    Light,
    /// Bidirectional path tracing by independent samples.
    Bdpt,
    /// Bidirectional path tracing by Metropolis in primary sample space.
    Pssmlt,
    /// Bidirectional path tracing by independent samples, clamped, and multiplexed Metropolis for the
    /// residual.
    Mmlt,
}

impl Method {
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

    /// The techniques that its path sampler combines.
    pub fn techniques(self) -> TechniqueSet {
        match self {
            Self::Path => TechniqueSet::Path,
            Self::Light => TechniqueSet::Light,
            Self::Bdpt | Self::Pssmlt | Self::Mmlt => TechniqueSet::Bidirectional,
        }
    }

    /// Samples (or mutations) per pixel by default.
    pub fn default_samples_per_pixel(self) -> u64 {
        match self {
            Self::Pssmlt => 128,
            Self::Path | Self::Light | Self::Bdpt | Self::Mmlt => 64,
        }
    }
}

/// A method with its own settings.
#[derive(Clone, Debug, PartialEq)]
pub enum Integrator {
    /// See [`Method::Path`].
    Path,
    /// See [`Method::Light`].
    Light,
    /// See [`Method::Bdpt`].
    Bdpt,
    /// See [`Method::Pssmlt`].
    Pssmlt(PssmltSettings),
    /// See [`Method::Mmlt`].
    Mmlt(MmltSettings),
}

impl Integrator {
    /// Its name.
    pub fn method(&self) -> Method {
        match self {
            Self::Path => Method::Path,
            Self::Light => Method::Light,
            Self::Bdpt => Method::Bdpt,
            Self::Pssmlt(_) => Method::Pssmlt,
            Self::Mmlt(_) => Method::Mmlt,
        }
    }
}

impl From<Method> for Integrator {
    /// With default settings.
    fn from(method: Method) -> Self {
        match method {
            Method::Path => Self::Path,
            Method::Light => Self::Light,
            Method::Bdpt => Self::Bdpt,
            Method::Pssmlt => Self::Pssmlt(PssmltSettings::default()),
            Method::Mmlt => Self::Mmlt(MmltSettings::default()),
        }
    }
}

/// Most Markov chains: each takes some kilobytes.
pub const MAX_CHAINS: u64 = 1 << 20;

/// Settings of primary sample space Metropolis.
#[derive(Clone, Debug, PartialEq)]
pub struct PssmltSettings {
    /// p_large: probability of a large step.
    pub large_step_probability: f32,
    /// Perturbation of the coordinates by a small step.
    pub small_step: Perturbation,
    /// Number of Markov chains.
    pub chains: u64,
    /// Number of bootstrap samples; `None` to continue until the standard error of b is small.
    pub bootstrap: Option<u64>,
}

impl Default for PssmltSettings {
    fn default() -> Self {
        Self {
            large_step_probability: 0.3,
            small_step: Perturbation::default(),
            chains: 1024,
            bootstrap: None,
        }
    }
}

/// When a render ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Samples per pixel; for `pssmlt` mutations per pixel.
    SamplesPerPixel(u64),
    /// Seconds of rendering, excluding loading and building.
    Seconds(f64),
    /// This number of samples or mutations in all. With the number that a render with [`Budget::Seconds`] has
    /// taken, and as many samples of the bootstrap or the pilot, the image is the same to the bit.
    Samples(u64),
    /// Until the target error is reached or the observer cancels.
    Unlimited,
}

/// What determines the image besides the scene, and how it is computed.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The method and its own settings.
    pub integrator: Integrator,
    /// When the render ends.
    pub budget: Budget,
    /// Estimate the standard error of every pixel.
    pub error: bool,
    /// End the render before the budget is spent when the estimated relMSE
    /// ([`relative_mse()`](crate::metrics::relative_mse())) is at most this. The error of `pssmlt` is estimated from the
    /// spread of chains, so with a single chain only the budget ends the render.
    pub target_error: Option<f64>,
    /// The same seed gives the same image.
    pub seed: u64,
    /// Number of threads; `None` for one per core.
    pub threads: Option<usize>,
}

impl Settings {
    /// The defaults for a method.
    pub fn new(method: Method) -> Self {
        Self::of(method.into())
    }

    /// The defaults for an integrator.
    pub fn of(integrator: Integrator) -> Self {
        let samples = integrator.method().default_samples_per_pixel();
        Self {
            integrator,
            budget: Budget::SamplesPerPixel(samples),
            error: false,
            target_error: None,
            seed: 0,
            threads: None,
        }
    }

    /// The name of the integrator.
    pub fn method(&self) -> Method {
        self.integrator.method()
    }

    /// True if standard errors are to be estimated, as a result or for a target.
    pub fn wants_error(&self) -> bool {
        self.error || self.target_error.is_some()
    }

    /// True if a pilot that began at `start` has used its share of a time budget.
    pub(super) fn pilot_is_over(&self, start: Instant) -> bool {
        const PILOT_SHARE: f64 = 0.03;
        match self.budget {
            Budget::Seconds(seconds) => start.elapsed().as_secs_f64() > PILOT_SHARE * seconds,
            Budget::SamplesPerPixel(_) | Budget::Samples(_) | Budget::Unlimited => false,
        }
    }
}
