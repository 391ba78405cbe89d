//! The runs of an experiment, and what was measured in them.

use std::time::Instant;

use super::recorder::{Measured, Recorder, Schedule};
use crate::film::Image;
use crate::metrics::{ImageError, image_errors};
use crate::render::{Moment, Observer, Settings, Warning, render};
use crate::scene::Scene;

/// A way to render the scene.
#[derive(Clone, Debug)]
pub struct Variant {
    /// What it is called in tables and charts.
    pub label: String,
    /// Repeat i adds i to the seed.
    pub settings: Settings,
}

/// What is to be measured.
pub struct Experiment<'a> {
    /// What is rendered.
    pub scene: &'a Scene,
    /// The truth, as far as it is known; of the scene's size.
    pub reference: &'a Image,
    /// Ways to render it. The first is the baseline that others are compared with.
    pub variants: &'a [Variant],
    /// Renders of each.
    pub repeats: u64,
}

/// One image, measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Index of the variant.
    pub variant: usize,
    /// Which repeat, from 0.
    pub repeat: u64,
    /// Which of the scheduled moments, from 0: the same in all repeats of a variant.
    pub index: usize,
    /// How much had been done.
    pub moment: Moment,
    /// Against the reference.
    pub error: ImageError,
}

/// What came of an experiment.
#[derive(Debug, Default)]
pub struct Outcome {
    /// All measurements, render by render in the order of their making.
    pub measurements: Vec<Measurement>,
    /// Per variant, the last image of its first repeat; shorter if the observer stopped before.
    pub images: Vec<Image>,
    /// The observer stopped it: the render that it stopped counts for nothing.
    pub interrupted: bool,
    /// What limits the images, each with the index of the variant.
    pub warnings: Vec<(usize, Warning)>,
}

impl Experiment<'_> {
    /// Renders and measures.
    ///
    /// # Errors
    /// If the threads of a render cannot be started.
    pub fn run(&self, observer: &dyn Observer) -> Result<Outcome, rayon::ThreadPoolBuildError> {
        observer.phase("rendering");
        let start = Instant::now();
        let elapsed = || start.elapsed().as_secs_f64();
        let mut outcome = Outcome::default();
        let all = self.variants.len() * self.repeats as usize;
        for done in 0..all {
            let (variant, repeat) = (done % self.variants.len(), done / self.variants.len());
            self.render(
                &mut outcome,
                [variant, repeat],
                [done, all],
                &elapsed,
                observer,
            )?;
            if outcome.interrupted {
                break;
            }
        }
        Ok(outcome)
    }

    fn render(
        &self,
        outcome: &mut Outcome,
        [variant, repeat]: [usize; 2],
        renders: [usize; 2],
        elapsed: &(dyn Fn() -> f64 + Sync),
        observer: &dyn Observer,
    ) -> Result<(), rayon::ThreadPoolBuildError> {
        let settings = &self.variants[variant].settings;
        let pixels = self.reference.pixels.len() as u64;
        let schedule = Schedule::new(settings.budget, pixels);
        let recorder = Recorder {
            inner: observer,
            schedule: &schedule,
            reference: self.reference,
            renders,
            elapsed,
            measured: Vec::new().into(),
        };
        let settings = Settings {
            seed: settings.seed.wrapping_add(repeat as u64),
            ..settings.clone()
        };
        let rendering = render(self.scene, &settings, &recorder)?;
        if rendering.interrupted {
            outcome.interrupted = true;
            return Ok(());
        }
        let statistics = &rendering.statistics;
        let end = Measured {
            index: schedule.len().saturating_sub(1),
            moment: Moment {
                seconds: statistics.render_seconds,
                samples: statistics.samples,
                rays: statistics.closest_hit_rays + statistics.shadow_rays,
            },
            error: image_errors(&rendering.image.pixels, &self.reference.pixels),
        };
        let measured = recorder.measured.into_inner().unwrap_or_default();
        let measurement = |m: Measured| Measurement {
            variant,
            repeat: repeat as u64,
            index: m.index,
            moment: m.moment,
            error: m.error,
        };
        outcome
            .measurements
            .extend(measured.into_iter().chain([end]).map(measurement));
        let warnings = rendering.warnings.into_iter();
        outcome
            .warnings
            .extend(warnings.map(|warning| (variant, warning)));
        if repeat == 0 {
            outcome.images.push(rendering.image);
        }
        Ok(())
    }
}
