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
use super::error::{ErrorEstimate, Passes, Target};
use super::warnings;
use super::{NonFinite, Observer, Origin, Rendering, Settings, Statistics};
use crate::film::{Film, FilmSampler, Image, SplatLog};
use crate::integrators::{Sampler, Splats, Workspace};
use crate::math::seeds::{self, Purpose};
use crate::math::{Coordinates, FreshCoordinates, Stream};
use crate::path::dimensions;
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
    fn of(scene: &Scene) -> Self {
        let [width, height] = [scene.film.width, scene.film.height];
        Self {
            pixels: u64::from(width) * u64::from(height),
        }
    }

    fn runs_per_pass(self) -> u64 {
        self.pixels.div_ceil(RUN)
    }

    /// Pixels of run `index`; runs are counted through all passes.
    fn pixels_of(self, index: u64) -> std::ops::Range<u64> {
        let first = index % self.runs_per_pass() * RUN;
        first..self.pixels.min(first + RUN)
    }

    fn left_in_pass(self, next_run: u64) -> u64 {
        self.runs_per_pass() - next_run % self.runs_per_pass()
    }
}

/// Fresh coordinates, but for the film position, which a pixel's filter has chosen.
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

/// A run of pixels, one sample each.
#[derive(Default)]
struct Run {
    workspace: Workspace,
    splats: Splats,
    /// Light at the pixels of the run.
    pixels: Vec<[f64; 3]>,
    elsewhere: SplatLog,
    /// Pixels whose sample was not finite, and how many of its contributions.
    non_finite: Vec<(u64, u64)>,
}

impl Run {
    /// Samples the pixels of run `index` once.
    fn sample(&mut self, scene: &Scene, settings: &Settings, film: &FilmSampler, index: u64) {
        self.pixels.clear();
        self.elsewhere.clear();
        self.non_finite.clear();
        let sampler = settings.integrator.sampler();
        let mut point = AtPixel::run(settings.seed, index);
        for pixel in Raster::of(scene).pixels_of(index) {
            point.place(film, pixel);
            sampler.sample(scene, &mut point, &mut self.workspace, &mut self.splats);
            self.pixels.push(self.splats.camera.as_dvec3().to_array());
            self.splats
                .elsewhere
                .iter()
                .for_each(|splat| self.elsewhere.push(*splat));
            if self.splats.non_finite > 0 {
                self.non_finite.push((pixel, self.splats.non_finite));
            }
        }
    }
}

/// Renders by Monte Carlo.
pub(super) fn render(scene: &Scene, settings: &Settings, observer: &dyn Observer) -> Rendering {
    let mut driver = Driver::new(scene, settings);
    observer.phase("rendering");
    let pixels = Raster::of(scene).pixels;
    let mut clock = Clock::new(Instant::now(), settings.budget, pixels, observer);
    driver.sample(&mut clock);
    driver.finish(&clock, observer)
}

struct Driver<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    film: Film,
    runs: Vec<Run>,
    /// There if the error is wanted.
    passes: Option<Passes>,
    non_finite: NonFinite,
    next_run: u64,
    done: u64,
}

impl<'a> Driver<'a> {
    fn new(scene: &'a Scene, settings: &'a Settings) -> Self {
        let [width, height] = [scene.film.width, scene.film.height];
        let pixels = Raster::of(scene).pixels;
        Self {
            scene,
            settings,
            film: Film::new(width, height, scene.film.filter),
            runs: Vec::new(),
            passes: settings.wants_error().then(|| Passes::new(pixels)),
            non_finite: NonFinite::default(),
            next_run: 0,
            done: 0,
        }
    }

    /// Samples until the budget is spent or the error is small enough.
    fn sample(&mut self, clock: &mut Clock) {
        let raster = Raster::of(self.scene);
        let [width, height] = [self.scene.film.width, self.scene.film.height];
        let film_sampler = FilmSampler::new(width, height, self.scene.film.filter);
        let mut target = Target::new(self.settings, raster.pixels);
        while !clock.is_over(self.done) {
            // Blocks are made of whole runs, and runs never cross into the next pass.
            let block = clock
                .block(self.done, BLOCK)
                .div_ceil(RUN)
                .max(FEWEST_RUNS)
                .min(raster.left_in_pass(self.next_run));
            self.block(&film_sampler, block);
            if self.next_run.is_multiple_of(raster.runs_per_pass()) {
                self.end_pass(&mut target, clock);
            }
            // Before every pixel has a sample there is no image to speak of.
            if self.done >= raster.pixels {
                clock.show(self.done, self.rays().total(), || self.image());
            }
        }
    }

    /// Takes note of the pass, if the error is wanted, and perhaps looks at the error.
    fn end_pass(&mut self, target: &mut Target, clock: &mut Clock) {
        let Some(passes) = &mut self.passes else {
            return;
        };
        passes.add(&self.film);
        if target.is_due(self.done) {
            let estimate = self.error(&self.image());
            clock.note(estimate.map_or(0.0, |estimate| target.look(self.done, &estimate)));
        }
    }

    /// The error of `image`, if it is wanted and known.
    fn error(&self, image: &Image) -> Option<ErrorEstimate> {
        self.passes.as_ref()?.estimate(image)
    }

    /// Takes `block` runs, in parallel, and adds them to the film in order.
    fn block(&mut self, film_sampler: &FilmSampler, block: u64) {
        let raster = Raster::of(self.scene);
        let (scene, settings, next_run) = (self.scene, self.settings, self.next_run);
        let needed = self.runs.len().max(block as usize);
        self.runs.resize_with(needed, Run::default);
        let active = &mut self.runs[..block as usize];
        active.par_iter_mut().enumerate().for_each(|(i, run)| {
            run.sample(scene, settings, film_sampler, next_run + i as u64);
        });
        for (run, index) in active.iter().zip(next_run..) {
            for (pixel, sum) in raster.pixels_of(index).zip(&run.pixels) {
                self.film.add_samples(pixel as usize, *sum, 1);
            }
            let pass = index / raster.runs_per_pass();
            for &(pixel, count) in &run.non_finite {
                self.non_finite.add(count, Origin::Pixel { pass, pixel });
            }
            self.done += run.pixels.len() as u64;
        }
        let logs: Vec<&SplatLog> = active.iter().map(|run| &run.elsewhere).collect();
        self.film.apply(&logs);
        self.next_run += block;
    }

    fn rays(&self) -> RayCounts {
        self.runs.iter().map(|run| run.workspace.rays).sum()
    }

    fn image(&self) -> Image {
        self.film.develop(1.0 / self.done.max(1) as f64)
    }

    fn finish(self, clock: &Clock, observer: &dyn Observer) -> Rendering {
        let image = self.image();
        let error = self.error(&image);
        let interrupted =
            observer.interrupted() && clock.total_samples().is_none_or(|n| self.done < n);
        // Light tracing splats everywhere: none of its pixels waits for a sample of its own.
        let unsampled = match self.settings.integrator.sampler() {
            Sampler::Light => None,
            Sampler::Path | Sampler::Bidirectional => {
                warnings::unsampled(self.done, Raster::of(self.scene).pixels)
            }
        };
        let warnings = warnings::non_finite(&self.non_finite)
            .into_iter()
            .chain(unsampled)
            .chain(warnings::error(self.settings, error.as_ref()))
            .chain(warnings::single(error.as_ref()))
            .collect();
        let statistics = Statistics::new(
            self.scene,
            self.settings,
            [clock.elapsed(); 2],
            self.done,
            self.rays(),
            self.non_finite,
        );
        Rendering {
            image,
            error,
            statistics,
            interrupted,
            warnings,
        }
    }
}
