//! Fresh samples for every pixel, pass by pass: the loop of all Monte Carlo methods.

use std::ops::Range;

use glam::Vec2;
use rand::RngExt;
use rayon::prelude::*;

use super::clock::Clock;
use crate::film::FilmSampler;
use crate::integrators::Workspace;
use crate::path::dimensions;
use crate::sampling::seeds::{self, Purpose};
use crate::sampling::{Coordinates, FreshCoordinates, Stream};
use crate::scene::{RayCounts, Scene};

/// Pixels of one run: each has a stream of random numbers of its own in every pass.
const RUN: u64 = 256;

/// Runs that are sampled at once, if a pass has so many, so that no thread waits.
const FEWEST_RUNS: u64 = 8;

/// Samples between two looks at the clock.
const BLOCK: u64 = 1 << 16;

/// Places in a film that is sampled run by run, pass by pass.
#[derive(Clone, Copy)]
struct Raster {
    pixels: u64,
}

impl Raster {
    fn runs_per_pass(self) -> u64 {
        self.pixels.div_ceil(RUN)
    }

    /// Pixels of run `index`; runs are counted through all passes.
    fn pixels_of(self, index: u64) -> Range<u64> {
        let first = index % self.runs_per_pass() * RUN;
        first..self.pixels.min(first + RUN)
    }

    fn left_in_pass(self, next_run: u64) -> u64 {
        self.runs_per_pass() - next_run % self.runs_per_pass()
    }
}

/// Fresh coordinates, but for the film position, which a pixel's filter has chosen. A copy made before
/// the coordinates are read gives the same sample again.
#[derive(Clone, Debug)]
pub(super) struct AtPixel {
    film: Vec2,
    fresh: FreshCoordinates,
}

impl AtPixel {
    /// The numbers of run `index`.
    fn run(seed: u64, index: u64) -> Self {
        let rng = seeds::generator(seed, Purpose::Pixels, index);
        Self {
            film: Vec2::ZERO,
            fresh: FreshCoordinates::new(rng),
        }
    }

    /// Moves to a sample of `pixel`.
    #[inline]
    fn place(&mut self, film: &FilmSampler, pixel: u64) {
        let u = self.fresh.rng().random();
        self.film = Vec2::from(film.pixel_position(pixel as usize, u));
    }
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

/// Has `sample` take the sample of `pixel` that a render of `pixels` pixels takes in pass `pass`,
/// after those of the same run that come before it.
pub(super) fn pixel_sample(
    film: &FilmSampler,
    pixels: u64,
    seed: u64,
    pass: u64,
    pixel: u64,
    mut sample: impl FnMut(&mut AtPixel),
) {
    let raster = Raster { pixels };
    let index = pass * raster.runs_per_pass() + pixel / RUN;
    let mut point = AtPixel::run(seed, index);
    for pixel in raster.pixels_of(index).start..=pixel {
        point.place(film, pixel);
        sample(&mut point);
    }
}

/// What is made of the samples.
pub(super) trait Collector: Sync {
    /// What one run of pixels leaves; its memory is used again.
    type Run: Default + Send + Sync;

    /// Forgets what `run` holds.
    fn clear(run: &mut Self::Run);

    /// Takes the sample of `pixel` that `point` stands for.
    fn sample(
        &self,
        pixel: u64,
        point: &mut AtPixel,
        workspace: &mut Workspace,
        run: &mut Self::Run,
    );

    /// Adds what runs have left, in their order.
    fn add(&mut self, runs: &[(Place, &Self::Run)]);

    /// Every pixel has been sampled once more; there are `done` samples in all.
    fn end_pass(&mut self, _done: u64, _clock: &mut Clock) {}

    /// Some more pixels have been sampled; there are `done` samples in all, which took `rays`.
    fn end_block(&self, _done: u64, _rays: RayCounts, _clock: &mut Clock) {}
}

/// Which samples a run took: one of each of these pixels.
pub(super) struct Place {
    pub pass: u64,
    pub pixels: Range<u64>,
}

/// The loop over passes and runs.
pub(super) struct Sweep<'a, R> {
    scene: &'a Scene,
    seed: u64,
    raster: Raster,
    runs: Vec<(Workspace, R)>,
    next_run: u64,
    done: u64,
}

impl<'a, R: Default + Send + Sync> Sweep<'a, R> {
    pub fn new(scene: &'a Scene, seed: u64) -> Self {
        Self {
            scene,
            seed,
            raster: Raster {
                pixels: pixels(scene),
            },
            runs: Vec::new(),
            next_run: 0,
            done: 0,
        }
    }

    /// Samples until `clock` says that it is over. The samples depend on nothing but scene and seed.
    pub fn sample<C: Collector<Run = R>>(&mut self, collector: &mut C, clock: &mut Clock) {
        let [width, height] = [self.scene.film.width, self.scene.film.height];
        let film = FilmSampler::new(width, height, self.scene.film.filter);
        while !clock.is_over(self.done) {
            // Blocks are made of whole runs, and runs never cross into the next pass.
            let block = clock
                .block(self.done, BLOCK)
                .div_ceil(RUN)
                .max(FEWEST_RUNS)
                .min(self.raster.left_in_pass(self.next_run));
            self.block(collector, &film, block);
            if self.next_run.is_multiple_of(self.raster.runs_per_pass()) {
                collector.end_pass(self.done, clock);
            }
            collector.end_block(self.done, self.rays(), clock);
        }
    }

    /// Takes `block` runs, in parallel, and hands them on in order.
    fn block<C: Collector<Run = R>>(&mut self, collector: &mut C, film: &FilmSampler, block: u64) {
        let (raster, seed, next_run) = (self.raster, self.seed, self.next_run);
        let needed = self.runs.len().max(block as usize);
        self.runs.resize_with(needed, Default::default);
        let active = &mut self.runs[..block as usize];
        let shared: &C = collector;
        let numbered = active.par_iter_mut().enumerate();
        numbered.for_each(|(i, (workspace, run))| {
            let index = next_run + i as u64;
            C::clear(run);
            let mut point = AtPixel::run(seed, index);
            for pixel in raster.pixels_of(index) {
                point.place(film, pixel);
                shared.sample(pixel, &mut point, workspace, run);
            }
        });
        let place = |index: u64| Place {
            pass: index / raster.runs_per_pass(),
            pixels: raster.pixels_of(index),
        };
        let runs = active.iter().zip(next_run..);
        let placed: Vec<_> = runs.map(|((_, run), i)| (place(i), run)).collect();
        let taken = |(place, _): &(Place, &R)| place.pixels.end - place.pixels.start;
        self.done += placed.iter().map(taken).sum::<u64>();
        self.next_run += block;
        collector.add(&placed);
    }

    /// Samples taken.
    pub fn done(&self) -> u64 {
        self.done
    }

    /// Rays traced.
    pub fn rays(&self) -> RayCounts {
        self.runs.iter().map(|(workspace, _)| workspace.rays).sum()
    }
}

/// Number of pixels of the film.
pub(super) fn pixels(scene: &Scene) -> u64 {
    u64::from(scene.film.width) * u64::from(scene.film.height)
}

/// Pixels in a row and in a column of the film.
pub(super) fn size(scene: &Scene) -> [u32; 2] {
    [scene.film.width, scene.film.height]
}
