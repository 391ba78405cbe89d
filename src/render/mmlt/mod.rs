//! Multiplexed Metropolis light transport for the paths that are too bright for independent samples.
//!
//! Bidirectional path tracing with independent samples, whose contributions are clamped
//! ([`clamp`](super::plan::clamp)), plus multiplexed Markov chains for the residual (`redistribution`). The
//! sum of both is unbiased.

mod redistribution;
pub mod target;

use std::time::Instant;

pub use redistribution::mutations;

use self::redistribution::{Redistribution, Residual};
use super::clock::Clock;
use super::driver::{Driver, drive};
use super::error::ErrorEstimate;
use super::estimate::{ImageEstimate, TileSplats};
use super::passes::{BLOCK, PassLoop, TileBuffer};
use super::pixel_sampler::PixelSampler;
use super::plan::clamp::Clamp;
use super::plan::{MmltSettings, Plan};
use super::statistics::{MmltStatistics, MutationStatistics};
use super::{Budget, Integrator, Observer, Rendering, Settings, Unobserved, pixel_count};
use crate::film::{FilmSampler, Image};
use crate::integrators::{BidirectionalPathTracer, PathSampler, Workspace};
use crate::scene::{RayCounts, Scene};

/// Renders `scene`.
pub(super) fn render(
    scene: &Scene,
    settings: &Settings,
    method_settings: &MmltSettings,
    observer: &dyn Observer,
) -> Rendering {
    let start = Instant::now();

    // Choose the clamp by a pilot.
    let plan = method_settings.plan.clone().unwrap_or_else(|| {
        observer.phase("pilot");
        let is_over = || settings.pilot_is_over(start) || observer.interrupted();
        Plan::new(scene, settings.seed, method_settings, is_over)
    });

    // Take independent samples and redistribute their residuals, block by block.
    observer.phase("rendering");
    let mut driver = Mmlt::new(scene, settings, method_settings, plan);
    let mut clock = Clock::new(start, settings.budget, pixel_count(scene), observer);
    drive(&mut driver, settings, &mut clock, pixel_count(scene))
}

/// The image of the chains alone, after `passes` passes of a render of `scene` with `plan`.
pub fn residual_image(
    scene: &Scene,
    method_settings: &MmltSettings,
    plan: Plan,
    seed: u64,
    passes: u64,
) -> Image {
    let settings = Settings {
        budget: Budget::SamplesPerPixel(passes),
        seed,
        ..Settings::of(Integrator::Mmlt(method_settings.clone()))
    };
    let mut driver = Mmlt::new(scene, &settings, method_settings, plan);
    let pixels = pixel_count(scene);
    let mut clock = Clock::new(Instant::now(), settings.budget, pixels, &Unobserved);
    drive(&mut driver, &settings, &mut clock, pixels);
    driver.estimate.image(|pixel| driver.chains.value(pixel))
}

/// The state of a render: independent samples and chains.
struct Mmlt<'a> {
    scene: &'a Scene,
    plan: Plan,
    film: FilmSampler,
    passes: PassLoop<MmltTile>,
    estimate: ImageEstimate,
    chains: Redistribution<'a>,
}

/// The clamped splats of a tile's samples, and their residuals.
#[derive(Default)]
struct MmltTile {
    clamped: TileSplats,
    residuals: Vec<Residual>,
}

impl TileBuffer for MmltTile {
    fn clear(&mut self) {
        self.clamped.clear();
        self.residuals.clear();
    }
}

impl Driver for Mmlt<'_> {
    fn advance(&mut self, clock: &Clock) {
        // Take independent samples and add their clamped part to the film.
        let (scene, clamp, film) = (self.scene, &self.plan.clamp, &self.film);
        let block = clock.block(self.samples(), BLOCK);
        let tiles = self
            .passes
            .advance(clock, block, |pixel, sampler, workspace, tile| {
                sample(scene, clamp, film, sampler, workspace, tile);
                tile.clamped.add_last(pixel);
            });
        if tiles.is_empty() {
            return;
        }
        let clamped = tiles.iter().map(|(tile, buffer)| (tile, &buffer.clamped));
        self.estimate.add(clamped);

        // Redistribute the residuals by chains.
        let residuals = tiles.iter().flat_map(|(_, buffer)| buffer.residuals.iter());
        let residuals = residuals.copied().collect();
        let samples = tiles.iter().map(|(tile, _)| tile.samples()).sum();
        let non_finite = &mut self.estimate.non_finite;
        self.chains.run(clamp, residuals, samples, non_finite);

        // Record the pass for the error.
        if self.passes.at_pass_end() {
            self.chains.end_pass();
            let (chains, samples) = (&self.chains, self.passes.samples());
            self.estimate
                .end_pass(|estimate, pixel| value(estimate, chains, pixel, samples));
        }
    }

    fn samples(&self) -> u64 {
        self.passes.samples()
    }

    fn rays(&self) -> RayCounts {
        let all = [self.passes.rays(), self.chains.rays, self.plan.rays];
        all.into_iter().sum()
    }

    fn has_image(&self) -> bool {
        self.passes.is_complete()
    }

    fn has_error(&self) -> bool {
        self.passes.at_pass_end()
    }

    fn image(&mut self) -> Image {
        let samples = self.passes.samples();
        let value = |pixel| value(&self.estimate, &self.chains, pixel, samples);
        self.estimate.image(value)
    }

    fn error(&self, image: &Image) -> Option<ErrorEstimate> {
        self.estimate.error(image)
    }

    fn finish(&mut self, settings: &Settings, clock: &Clock) -> Rendering {
        let (samples, rays, image) = (self.samples(), self.rays(), self.image());
        let estimate = &self.estimate;
        let mut rendering = estimate.rendering(self.scene, settings, clock, image, samples, rays);
        let counters = &self.chains.counters;
        rendering.statistics.mmlt = Some(MmltStatistics {
            pilot_samples: self.plan.samples,
            threshold: self.plan.clamp.threshold,
            energy_per_mutation: self.plan.clamp.energy,
            chains: self.chains.chains,
            mutations: MutationStatistics::all(counters),
            longest_rejection_run: counters.longest_rejection_run,
        });
        rendering
    }
}

/// Takes an independent sample: stores its clamped splats in `tile.clamped.last`, and appends its residuals
/// to `tile.residuals`.
#[inline]
fn sample(
    scene: &Scene,
    clamp: &Clamp,
    film: &FilmSampler,
    sampler: &mut PixelSampler,
    workspace: &mut Workspace,
    tile: &mut MmltTile,
) {
    let MmltTile { clamped, residuals } = tile;
    clamped.last.clear();
    let start = *sampler;
    BidirectionalPathTracer.sample_paths(scene, sampler, workspace, |path| {
        let [splat, residual] = clamp.split(path.technique.edges(), path.splat());
        clamped.last.add(path.technique, splat);
        if let Some(density) = clamp.residual_density(residual) {
            residuals.push(Residual {
                sample: start,
                technique: path.technique,
                density: density / film.density(start.film()),
            });
        }
    });
}

/// The value of a pixel after `samples` independent samples of the film.
#[inline]
fn value(
    estimate: &ImageEstimate,
    chains: &Redistribution,
    pixel: usize,
    samples: u64,
) -> [f64; 3] {
    let (clamped, residual) = (estimate.value(pixel, samples), chains.value(pixel));
    std::array::from_fn(|c| clamped[c] + residual[c])
}

impl<'a> Mmlt<'a> {
    fn new(
        scene: &'a Scene,
        settings: &Settings,
        method_settings: &MmltSettings,
        plan: Plan,
    ) -> Self {
        let film = &scene.film;
        Self {
            film: FilmSampler::new(film.width, film.height, film.filter),
            passes: PassLoop::new(scene, settings.seed),
            estimate: ImageEstimate::new(scene, settings),
            chains: Redistribution::new(scene, settings.seed, method_settings.small_step),
            scene,
            plan,
        }
    }
}
