//! The Monte Carlo driver: every point of the hypercube is fresh.
//!
//! The camera samples of a pixel are placed by its reconstruction filter and averaged; splats of
//! technique t = 1 land anywhere and are divided by the number of samples of the whole film (Veach
//! 1997, section 10.3.4).

use std::time::Instant;

use glam::Vec2;
use rand::RngExt;
use rayon::prelude::*;

use super::clock::Clock;
use super::{Observer, Rendering, Settings, Statistics};
use crate::film::{Film, FilmSampler, SplatLog};
use crate::integrators::{Sampler, Splats, Workspace};

use crate::math::seeds::{self, Purpose};
use crate::math::{Coordinates, FreshCoordinates, Stream};
use crate::path::dimensions;
use crate::scene::Scene;

/// Pixels of one run: each has a stream of random numbers of its own in every pass.
const RUN: u64 = 256;

/// Runs that are sampled at once, if a pass has so many, so that no thread waits.
const FEWEST_RUNS: u64 = 8;

/// Samples between two looks at the clock.
const BLOCK: u64 = 1 << 16;

/// A run of pixels, one sample each.
#[derive(Default)]
struct Run {
    workspace: Workspace,
    splats: Splats,
    /// Light at the pixels of the run.
    pixels: Vec<[f64; 3]>,
    elsewhere: SplatLog,
    non_finite: u64,
}

/// Fresh coordinates, but for the film position, which a pixel's filter has chosen.
struct AtPixel {
    film: Vec2,
    fresh: FreshCoordinates,
}

impl Coordinates for AtPixel {
    #[inline]
    fn read<const N: usize>(&mut self, stream: Stream, first: usize) -> [f32; N] {
        let mut values = self.fresh.read::<N>(stream, first);
        if stream == Stream::Camera && first == dimensions::FILM {
            values[..2].copy_from_slice(&self.film.to_array());
        }
        values
    }
}

impl Run {
    /// Samples the pixels of run `index` once; runs are counted through all passes.
    fn sample(
        &mut self,
        scene: &Scene,
        sampler: Sampler,
        film: &FilmSampler,
        seed: u64,
        index: u64,
    ) {
        self.pixels.clear();
        self.elsewhere.clear();
        let pixels = u64::from(scene.film.width) * u64::from(scene.film.height);
        let first = index % pixels.div_ceil(RUN) * RUN;
        let rng = seeds::generator(seed, Purpose::Pixels, index);
        let mut point = AtPixel {
            film: Vec2::ZERO,
            fresh: FreshCoordinates::new(rng),
        };
        for pixel in first..pixels.min(first + RUN) {
            let u = point.fresh.rng().random();
            point.film = Vec2::from(film.pixel_position(pixel as usize, u));
            sampler.sample(scene, &mut point, &mut self.workspace, &mut self.splats);
            self.pixels.push(self.splats.camera.as_dvec3().to_array());
            self.splats
                .elsewhere
                .iter()
                .for_each(|splat| self.elsewhere.push(*splat));
            self.non_finite += self.splats.non_finite;
        }
    }
}

/// Renders by Monte Carlo.
pub(super) fn render(scene: &Scene, settings: &Settings, observer: &dyn Observer) -> Rendering {
    let start = Instant::now();
    let [width, height] = [scene.film.width, scene.film.height];
    let pixels = u64::from(width) * u64::from(height);
    let runs_per_pass = pixels.div_ceil(RUN);
    let sampler = settings.integrator.sampler();
    let film_sampler = FilmSampler::new(width, height, scene.film.filter);
    let mut film = Film::new(width, height, scene.film.filter);
    let mut runs: Vec<Run> = Vec::new();

    observer.phase("rendering");
    let clock = Clock::new(start, settings.budget, pixels, observer);
    let (mut next_run, mut done) = (0, 0);
    while !clock.is_over(done) {
        // Blocks are made of whole runs, and runs never cross into the next pass.
        let block = clock
            .block(done, BLOCK)
            .div_ceil(RUN)
            .max(FEWEST_RUNS)
            .min(left_in_pass(next_run, runs_per_pass));
        runs.resize_with(runs.len().max(block as usize), Run::default);
        let active = &mut runs[..block as usize];
        active.par_iter_mut().enumerate().for_each(|(i, run)| {
            run.sample(
                scene,
                sampler,
                &film_sampler,
                settings.seed,
                next_run + i as u64,
            );
        });
        for (run, index) in active.iter().zip(next_run..) {
            let first = (index % runs_per_pass * RUN) as usize;
            for (pixel, sum) in (first..).zip(&run.pixels) {
                film.add_samples(pixel, *sum, 1);
            }
            done += run.pixels.len() as u64;
        }
        film.apply(&active.iter().map(|run| &run.elsewhere).collect::<Vec<_>>());
        next_run += block;
    }

    let rays = runs.iter().map(|run| run.workspace.rays).sum();
    let non_finite = runs.iter().map(|run| run.non_finite).sum();
    let interrupted = observer.interrupted() && clock.total_samples().is_none_or(|n| done < n);
    let image = film.develop(1.0 / done.max(1) as f64);
    let seconds = [clock.elapsed(); 2];
    let statistics = Statistics::new(scene, settings, seconds, done, rays, non_finite);
    let mut warnings: Vec<String> = super::non_finite_warning(non_finite).into_iter().collect();
    if done < pixels && sampler != Sampler::Light {
        warnings.push(format!(
            "only {done} of {pixels} pixels have been sampled: the rest is dark. Render for longer"
        ));
    }
    Rendering {
        image,
        statistics,
        interrupted,
        warnings,
    }
}

fn left_in_pass(next_run: u64, runs_per_pass: u64) -> u64 {
    runs_per_pass - next_run % runs_per_pass
}
