//! Monte Carlo: every point of the hypercube is an independent sample.

use std::time::Instant;

use super::clock::Clock;
use super::driver::{Driver, drive};
use super::error::ErrorEstimate;
use super::estimate::{ImageEstimate, TileSplats};
use super::passes::{BLOCK, PassLoop};
use super::{Observer, Rendering, Settings, pixel_count};
use crate::film::Image;
use crate::integrators::PathSampler;
use crate::scene::{RayCounts, Scene};

/// Renders the paths of `path_sampler` by independent samples.
pub(super) fn render<P: PathSampler>(
    scene: &Scene,
    path_sampler: P,
    settings: &Settings,
    observer: &dyn Observer,
) -> Rendering {
    observer.phase("rendering");
    let mut driver = Independent {
        scene,
        path_sampler,
        passes: PassLoop::new(scene, settings.seed),
        estimate: ImageEstimate::new(scene, settings),
    };
    let mut clock = Clock::new(
        Instant::now(),
        settings.budget,
        pixel_count(scene),
        observer,
    );
    drive(&mut driver, settings, &mut clock, pixel_count(scene))
}

/// The state of a render.
struct Independent<'a, P> {
    scene: &'a Scene,
    path_sampler: P,
    passes: PassLoop<TileSplats>,
    estimate: ImageEstimate,
}

impl<P: PathSampler> Driver for Independent<'_, P> {
    fn advance(&mut self, clock: &Clock) {
        // Sample the next tiles of the pass, in parallel.
        let (scene, path_sampler) = (self.scene, &self.path_sampler);
        let block = clock.prompt_block(self.samples(), BLOCK);
        let tiles = self
            .passes
            .advance(clock, block, |pixel, sampler, workspace, tile| {
                path_sampler.sample_splats(scene, sampler, workspace, &mut tile.last);
                tile.add_last(pixel);
            });

        if tiles.is_empty() {
            return;
        }

        // Add their splats to the film.
        let splats = tiles.iter().map(|(tile, splats)| (tile, *splats));
        self.estimate.add(splats);

        // Record the pass for the error.
        if self.passes.at_pass_end() {
            let samples = self.passes.samples();
            self.estimate
                .end_pass(|estimate, pixel| estimate.value(pixel, samples));
        }
    }

    fn samples(&self) -> u64 {
        self.passes.samples()
    }

    fn rays(&self) -> RayCounts {
        self.passes.rays()
    }

    fn has_image(&self) -> bool {
        self.passes.is_complete()
    }

    fn has_error(&self) -> bool {
        self.passes.at_pass_end()
    }

    fn image(&mut self) -> Image {
        let samples = self.passes.samples();
        self.estimate.image(|i| self.estimate.value(i, samples))
    }

    fn error(&self, image: &Image) -> Option<ErrorEstimate> {
        self.estimate.error(image)
    }

    fn finish(&mut self, settings: &Settings, clock: &Clock) -> Rendering {
        let (samples, rays, image) = (self.samples(), self.rays(), self.image());
        self.estimate
            .rendering(self.scene, settings, clock, image, samples, rays)
    }
}
