//! The pilot: independent samples from which the clamp is chosen. They are not part of the image, so the
//! clamp is independent of the samples of the image.

use std::ops::Range;

use rayon::prelude::*;

use crate::film::Splat;
use crate::integrators::{BidirectionalPathTracer, PathSampler, Workspace};
use crate::markov::bootstrap::sample;
use crate::math::color;
use crate::scene::{RayCounts, Scene};
use crate::technique::Technique;

/// Samples of one task.
const TASK: u64 = 256;

/// Samples between two checks of the clock.
const BATCH: u64 = 1 << 12;

/// Maximum number of samples of a plan.
pub const MAX_SAMPLES: u64 = 1 << 15;

/// A path that carries light.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// The technique that sampled it.
    pub technique: Technique,
    /// Its weighted contribution.
    pub splat: Splat,
}

/// The paths of uniform samples of bidirectional path tracing.
#[derive(Debug, Default)]
pub struct Pilot {
    /// Samples taken.
    pub samples: u64,
    /// All paths that carry light, in the order of the samples.
    pub found: Vec<Found>,
    /// Rays traced.
    pub rays: RayCounts,
    /// Cost of all samples, in rays.
    pub cost: f64,
}

impl Pilot {
    /// Takes at most `max_samples` of `scene`. The pilot ends early when `is_over` returns true.
    pub fn run(scene: &Scene, seed: u64, max_samples: u64, is_over: impl Fn() -> bool) -> Self {
        let mut pilot = Self::default();
        while pilot.samples < max_samples && (pilot.samples == 0 || !is_over()) {
            let first = pilot.samples;
            let task = |i: u64| {
                let start = first + i * TASK;
                paths(scene, seed, start..start + TASK)
            };
            let tasks: Vec<_> = (0..BATCH / TASK).into_par_iter().map(task).collect();
            for (found, rays) in tasks {
                pilot.found.extend(found);
                pilot.rays += rays;
            }
            pilot.samples += BATCH;
        }
        pilot.cost = pilot.rays.cost(scene.casters.search_cost());
        pilot
    }
}

/// The paths of the uniform samples `samples`, and their rays.
fn paths(scene: &Scene, seed: u64, samples: Range<u64>) -> (Vec<Found>, RayCounts) {
    let mut workspace = Workspace::default();
    let mut found = Vec::new();
    for i in samples {
        let mut sampler = sample(seed, i);
        BidirectionalPathTracer.sample_paths(scene, &mut sampler, &mut workspace, |path| {
            let splat = path.splat();
            if color::is_light(splat.value) && splat.value.max_element() > 0.0 {
                let technique = path.technique;
                found.push(Found { technique, splat });
            }
        });
    }
    (found, workspace.rays)
}
