//! The Monte Carlo driver: every point of the hypercube is fresh.
//!
//! The camera samples of a pixel are placed by its reconstruction filter and averaged; splats of
//! technique t = 1 land anywhere and are divided by the number of samples of the whole film (Veach
//! 1997, section 10.3.4).

use std::time::Instant;

use super::clock::Clock;
use super::division::Division;
use super::error::{ErrorEstimate, Passes, Target};
use super::pilot::Pilot;
use super::redistribution::{Excess, Redistribution};
use super::sweep::{AtPixel, Collector, Place, Sweep, pixels, size};
use super::warnings;
use super::{
    Integrator, MultiplexedStatistics, NonFinite, Observer, Origin, Rendering, Settings, Statistics,
};
use crate::film::{Film, Image, SplatLog};
use crate::integrators::{Sampler, Splats, Workspace};
use crate::math::color::to_pixel;
use crate::scene::{RayCounts, Scene};

/// Renders by Monte Carlo, with chains beside it if the integrator is multiplexed.
pub(super) fn render(scene: &Scene, settings: &Settings, observer: &dyn Observer) -> Rendering {
    let start = Instant::now();
    let mut canvas = Canvas::new(scene, settings);
    if settings.integrator == Integrator::Mmlt {
        observer.phase("pilot");
        canvas.divide(start, observer);
    }
    let mut sweep = Sweep::new(scene, settings.seed);
    observer.phase("rendering");
    let mut clock = Clock::new(start, settings.budget, pixels(scene), observer);
    sweep.sample(&mut canvas, &mut clock);
    canvas.finish(&sweep, &clock, observer)
}

/// A run of pixels, one sample each.
#[derive(Default)]
struct Run {
    splats: Splats,
    /// Light at the pixels of the run.
    pixels: Vec<[f64; 3]>,
    elsewhere: SplatLog,
    /// Pixels whose sample was not finite, and how many of its contributions.
    non_finite: Vec<(u64, u64)>,
    /// What is left to the chains.
    excess: Vec<Excess>,
}

/// The image in the making.
struct Canvas<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    sampler: Sampler,
    film: Film,
    /// There if the error is wanted.
    passes: Option<Passes>,
    target: Target,
    non_finite: NonFinite,
    /// There if the integrator is multiplexed.
    chains: Option<Redistribution<'a>>,
    /// What the pilot took.
    pilot_rays: RayCounts,
}

impl Collector for Canvas<'_> {
    type Run = Run;

    fn clear(run: &mut Run) {
        run.pixels.clear();
        run.elsewhere.clear();
        run.non_finite.clear();
        run.excess.clear();
    }

    #[inline]
    fn sample(&self, pixel: u64, point: &mut AtPixel, workspace: &mut Workspace, run: &mut Run) {
        let splats = &mut run.splats;
        match &self.chains {
            None => self.sampler.sample(self.scene, point, workspace, splats),
            Some(chains) => chains.sample(point, workspace, splats, &mut run.excess),
        }
        run.pixels.push(splats.camera.as_dvec3().to_array());
        splats
            .elsewhere
            .iter()
            .for_each(|splat| run.elsewhere.push(*splat));
        if splats.non_finite > 0 {
            run.non_finite.push((pixel, splats.non_finite));
        }
    }

    fn add(&mut self, runs: &[(Place, &Run)]) {
        for (place, run) in runs {
            if let Some(chains) = &mut self.chains {
                chains.collect(&run.excess, place.pixels.end - place.pixels.start);
            }
            for (pixel, sum) in place.pixels.clone().zip(&run.pixels) {
                self.film.add_samples(pixel as usize, *sum, 1);
            }
            let pass = place.pass;
            for &(pixel, count) in &run.non_finite {
                self.non_finite.add(count, Origin::Pixel { pass, pixel });
            }
        }
        let logs: Vec<&SplatLog> = runs.iter().map(|(_, run)| &run.elsewhere).collect();
        self.film.apply(&logs);
        if let Some(chains) = &mut self.chains {
            chains.run(&mut self.non_finite);
        }
    }

    fn end_block(&self, done: u64, rays: RayCounts, clock: &mut Clock) {
        // Before every pixel has a sample there is no image to speak of.
        if done >= pixels(self.scene) {
            clock.show(done, self.all_rays(rays).total(), || self.image(done));
        }
    }

    /// Takes note of the pass, if the error is wanted, and perhaps looks at the error.
    fn end_pass(&mut self, done: u64, clock: &mut Clock) {
        if let Some(chains) = &mut self.chains {
            chains.end_pass();
        }
        let Some(mut passes) = self.passes.take() else {
            return;
        };
        passes.add(|pixel| self.value(pixel, done));
        self.passes = Some(passes);
        if self.target.is_due(done) {
            let estimate = self.error(&self.image(done));
            clock.note(estimate.map_or(0.0, |estimate| self.target.look(done, &estimate)));
        }
    }
}

impl<'a> Canvas<'a> {
    fn new(scene: &'a Scene, settings: &'a Settings) -> Self {
        let [width, height] = [scene.film.width, scene.film.height];
        let pixels = pixels(scene);
        Self {
            scene,
            settings,
            sampler: settings.integrator.sampler(),
            film: Film::new(width, height, scene.film.filter),
            passes: settings.wants_error().then(|| Passes::new(pixels)),
            target: Target::new(settings, pixels),
            non_finite: NonFinite::default(),
            chains: None,
            pilot_rays: RayCounts::default(),
        }
    }

    /// Lets a pilot divide the light between plain samples and chains.
    fn divide(&mut self, start: Instant, observer: &dyn Observer) {
        let pilot = Pilot::run(self.scene, self.settings.seed, || {
            self.settings.pilot_is_over(start) || observer.interrupted()
        });
        let division = Division::new(size(self.scene), &pilot, self.settings.division);
        self.chains = Some(Redistribution::new(self.scene, division, self.settings));
        self.pilot_rays = pilot.rays;
    }

    /// All rays, given those of the plain samples.
    fn all_rays(&self, plain: RayCounts) -> RayCounts {
        let chains = self.chains.iter().map(Redistribution::rays);
        chains.chain([plain, self.pilot_rays]).sum()
    }

    /// The error of `image`, if it is wanted and known.
    fn error(&self, image: &Image) -> Option<ErrorEstimate> {
        self.passes.as_ref()?.estimate(image)
    }

    /// A pixel of the image after `done` samples.
    fn value(&self, pixel: usize, done: u64) -> [f64; 3] {
        let mut value = self.film.value(pixel, 1.0 / done.max(1) as f64);
        if let Some(chains) = &self.chains {
            let carried = chains.value(pixel);
            value = std::array::from_fn(|c| value[c] + carried[c]);
        }
        value
    }

    fn image(&self, done: u64) -> Image {
        let [width, height] = size(self.scene).map(|side| side as usize);
        let pixels = (0..width * height).map(|pixel| to_pixel(self.value(pixel, done)));
        Image {
            width,
            height,
            pixels: pixels.collect(),
        }
    }

    fn finish(self, sweep: &Sweep<Run>, clock: &Clock, observer: &dyn Observer) -> Rendering {
        let done = sweep.done();
        let image = self.image(done);
        let error = self.error(&image);
        let interrupted = observer.interrupted() && clock.total_samples().is_none_or(|n| done < n);
        // Light tracing splats everywhere: none of its pixels waits for a sample of its own.
        let unsampled = match self.sampler {
            Sampler::Light => None,
            Sampler::Path | Sampler::Bidirectional => warnings::unsampled(done, pixels(self.scene)),
        };
        let warnings = warnings::non_finite(&self.non_finite)
            .into_iter()
            .chain(unsampled)
            .chain(warnings::error(self.settings, error.as_ref()))
            .chain(warnings::single(error.as_ref()))
            .collect();
        let multiplexed = self.chains.as_ref().map(MultiplexedStatistics::new);
        let mut statistics = Statistics::new(
            self.scene,
            self.settings,
            [clock.elapsed(); 2],
            done,
            self.all_rays(sweep.rays()),
            self.non_finite,
        );
        statistics.multiplexed = multiplexed;
        Rendering {
            image,
            error,
            statistics,
            interrupted,
            warnings,
        }
    }
}
