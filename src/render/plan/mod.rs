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
    /// How a small step perturbs all coordinates but the technique.
    pub small_step: Perturbation,
    /// Direct light is not clamped.
    pub separate_direct: bool,
    /// Use an importance map; otherwise all regions of the image count by their luminance.
    pub importance_map: bool,
    /// tau of [`clamp`]; `None` for the best.
    pub threshold: Option<f32>,
    /// Made by an earlier pilot for the same scene and settings; `None` to run one.
    pub plan: Option<Plan>,
}

impl Default for MmltSettings {
    fn default() -> Self {
        Self {
            // Over many scales, so that some steps suit features of any size.
            small_step: Perturbation::new(1.0 / f32::exp2(18.0), 1.0 / 64.0),
            separate_direct: true,
            importance_map: true,
            threshold: None,
            plan: None,
        }
    }
}

/// What the pilot decides.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// How the light is divided.
    pub clamp: Clamp,
    /// Samples of the pilot.
    pub samples: u64,
    /// Its rays.
    pub rays: RayCounts,
}

impl Plan {
    /// Runs a pilot, until `is_over` at the latest.
    pub fn new(scene: &Scene, seed: u64, own: &MmltSettings, is_over: impl Fn() -> bool) -> Self {
        let pilot = Pilot::run(scene, seed, is_over);
        let size = [scene.film.width, scene.film.height];
        Self {
            clamp: Clamp::new(size, &pilot, own),
            samples: pilot.samples,
            rays: pilot.rays,
        }
    }
}
