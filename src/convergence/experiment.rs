//! The renders of an experiment, and the errors measured in them.

use std::time::Instant;

use super::recorder::{Measured, Recorder, Schedule};
use crate::film::Image;
use crate::metrics::{ImageError, image_errors};
use crate::render::{Moment, Observer, Settings, Warning, render};
use crate::scene::Scene;

/// Settings that the scene is rendered with.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Name in tables and charts.
    pub label: String,
    /// Settings of the first repeat; repeat i adds i to the seed.
    pub settings: Settings,
}

/// An experiment to run.
pub struct Experiment<'a> {
    /// The scene to render.
    pub scene: &'a Scene,
    /// Image that errors are measured against, of the scene's size.
    pub reference: &'a Image,
    /// Settings to compare. The first variant is the baseline.
    pub variants: &'a [Variant],
    /// Number of renders of each variant.
    pub repeats: u64,
}

/// The error of an image at a time of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Index of the variant.
    pub variant: usize,
    /// Index of the repeat.
    pub repeat: u64,
    /// Index of the scheduled time, the same in all repeats of a variant.
    pub index: usize,
    /// Work done so far.
    pub moment: Moment,
    /// Error against the reference.
    pub error: ImageError,
}

/// Results of an experiment.
#[derive(Debug, Default)]
pub struct Outcome {
    /// All measurements, in the order in which they were made.
    pub measurements: Vec<Measurement>,
    /// Per variant, the final image of its first repeat; fewer if the observer interrupted.
    pub images: Vec<Image>,
    /// The observer interrupted. The interrupted render is discarded.
    pub interrupted: bool,
    /// Warnings of all renders, each with the index of its variant.
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
