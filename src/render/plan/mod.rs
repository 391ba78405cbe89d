//! The plan of multiplexed Metropolis: how the light is divided between independent samples and chains. A
//! pilot makes it, within what the user has set.

pub mod clamp;
pub mod importance;
pub mod pilot;

use crate::markov::Perturbation;
use crate::scene::{RayCounts, Scene};

pub use clamp::Clamp;
pub use pilot::Pilot;

/// Settings of multiplexed Metropolis.
#[derive(Clone, Debug, PartialEq)]
pub struct MmltSettings {
    /// Perturbation of all coordinates but the technique by a small step.
    pub small_step: Perturbation,
    /// Direct light is not clamped.
    pub separate_direct: bool,
    /// Use an importance map; otherwise all regions of the image are weighted by their luminance.
    pub importance_map: bool,
    /// tau of [`clamp`]; `None` to choose the best by the pilot.
    pub threshold: Option<f32>,
    /// Number of samples of the pilot; `None` for as many as it may have in the time.
    pub pilot: Option<u64>,
    /// The plan of an earlier pilot for the same scene and settings; `None` to run a pilot.
    pub plan: Option<Plan>,
}

impl Default for MmltSettings {
    fn default() -> Self {
        Self {
            // Lengths of many scales, so that some steps suit features of any size.
            small_step: Perturbation::new(1.0 / f32::exp2(18.0), 1.0 / 64.0),
            separate_direct: true,
            importance_map: true,
            threshold: None,
            pilot: None,
            plan: None,
        }
    }
}

/// The result of the pilot.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// How light is divided between independent samples and chains.
    pub clamp: Clamp,
    /// Samples of the pilot.
    pub samples: u64,
    /// Its rays.
    pub rays: RayCounts,
}

impl Plan {
    /// Runs a pilot, which ends early when `is_over` returns true, unless the settings give its length.
    pub fn new(
        scene: &Scene,
        seed: u64,
        method_settings: &MmltSettings,
        is_over: impl Fn() -> bool,
    ) -> Self {
        let (max_samples, is_fixed) = match method_settings.pilot {
            Some(samples) => (samples, true),
            None => (pilot::MAX_SAMPLES, false),
        };
        let pilot = Pilot::run(scene, seed, max_samples, || !is_fixed && is_over());
        let size = [scene.film.width, scene.film.height];
        Self {
            clamp: Clamp::new(size, &pilot, method_settings),
            samples: pilot.samples,
            rays: pilot.rays,
        }
    }
}
