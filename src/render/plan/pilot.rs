//! The pilot: independent samples from which the clamp is chosen. The image contains none of them, so that
//! no sample of the image depends on the choice.

use std::ops::Range;

use rayon::prelude::*;

use crate::film::Splat;
use crate::integrators::{BidirectionalPathTracer, PathSampler, Workspace};
use crate::markov::bootstrap::sample;
use crate::math::color;
use crate::scene::{RayCounts, Scene};

/// Samples evaluated by one task.
const RUN: u64 = 256;

/// Samples between two checks of the clock.
const BATCH: u64 = 1 << 12;

/// Most samples.
const MAX_SAMPLES: u64 = 1 << 15;

/// A path that was found.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Number of edges.
    pub edges: usize,
    /// Its weighted contribution.
    pub splat: Splat,
}

/// The paths of uniform samples of bidirectional path tracing.
#[derive(Debug, Default)]
pub struct Pilot {
    /// Samples taken.
    pub samples: u64,
    /// All paths with light, in the order of the samples.
    pub found: Vec<Found>,
    /// Rays traced.
    pub rays: RayCounts,
}

impl Pilot {
    /// Samples `scene`, until `is_over` at the latest.
    pub fn run(scene: &Scene, seed: u64, is_over: impl Fn() -> bool) -> Self {
        let mut pilot = Self::default();
        while pilot.samples < MAX_SAMPLES && (pilot.samples == 0 || !is_over()) {
            let first = pilot.samples;
            let run = |run: u64| {
                let start = first + run * RUN;
                paths(scene, seed, start..start + RUN)
            };
            let runs: Vec<_> = (0..BATCH / RUN).into_par_iter().map(run).collect();
            for (found, rays) in runs {
                pilot.found.extend(found);
                pilot.rays += rays;
            }
            pilot.samples += BATCH;
        }
        pilot
    }
}

/// The paths of some uniform samples, and their rays.
fn paths(scene: &Scene, seed: u64, samples: Range<u64>) -> (Vec<Found>, RayCounts) {
    let mut workspace = Workspace::default();
    let mut found = Vec::new();
    for i in samples {
        let mut sampler = sample(seed, i);
        BidirectionalPathTracer.sample_paths(scene, &mut sampler, &mut workspace, |path| {
            let splat = path.splat();
            if color::is_light(splat.value) && splat.value.max_element() > 0.0 {
                let edges = path.technique.edges();
                found.push(Found { edges, splat });
            }
        });
    }
    (found, workspace.rays)
}
