//! The pilot: plain samples that decide how the light is divided. None of them counts in the image, so
//! that nothing the image is made of depends on what they decide.

use std::ops::Range;

use rayon::prelude::*;

use crate::film::Splat;
use crate::integrators::{Sampler, Technique, Workspace};
use crate::markov::bootstrap::sample_generator;
use crate::math::color;
use crate::sampling::FreshCoordinates;
use crate::scene::{RayCounts, Scene};
use crate::technique::Connection;

/// Samples evaluated one after the other.
const RUN: u64 = 256;

/// Samples between two looks at the clock.
const BATCH: u64 = 1 << 12;

/// Most samples.
const MOST: u64 = 1 << 15;

/// What one technique has found.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Number of edges of the path.
    pub edges: usize,
    /// Its weighted contribution.
    pub splat: Splat,
}

/// Uniform samples of bidirectional path tracing, taken apart.
#[derive(Debug, Default)]
pub struct Pilot {
    /// Samples taken.
    pub samples: u64,
    /// What they found, in their order.
    pub found: Vec<Found>,
    /// What they took.
    pub rays: RayCounts,
}

impl Pilot {
    /// Samples `scene`; fewer than usual if `is_over` says so.
    pub fn run(scene: &Scene, seed: u64, is_over: impl Fn() -> bool) -> Self {
        let mut pilot = Self::default();
        while pilot.samples < MOST && (pilot.samples == 0 || !is_over()) {
            let first = pilot.samples;
            let run = |run: u64| {
                let start = first + run * RUN;
                sample(scene, seed, start..start + RUN)
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

/// What some uniform samples find, and the rays they take.
fn sample(scene: &Scene, seed: u64, samples: Range<u64>) -> (Vec<Found>, RayCounts) {
    let mut workspace = Workspace::default();
    let mut found = Vec::new();
    let sampler = Sampler::Bidirectional;
    for sample in samples {
        let mut point = FreshCoordinates::new(sample_generator(seed, sample));
        let film = sampler.film_position(&mut point);
        let visit = |technique: Technique, connection: Connection| {
            let value = connection.contribution();
            let position = connection.position(film).to_array();
            if color::is_light(value) && value.max_element() > 0.0 {
                let edges = technique.edges();
                let splat = Splat { position, value };
                found.push(Found { edges, splat });
            }
        };
        sampler.connections(scene, film, &mut point, &mut workspace, visit);
    }
    (found, workspace.rays)
}
