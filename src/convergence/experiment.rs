//! The renders of an experiment, and the errors measured in them.

use std::time::Instant;

use super::recorder::{ExperimentProgress, Recorder};
use crate::film::Image;
use crate::metrics::ImageError;
use crate::render::{Method, Observer, Progress, Settings, Warning, render};
use crate::scene::{ChainSearch, Scene};

/// Settings that the scene is rendered with.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Name in tables and charts.
    pub label: String,
    /// Settings of the first repeat; repeat i adds i to the seed.
    pub settings: Settings,
    /// Where technique 1* is used; `None` to leave it as it is in the scene.
    pub search: Option<ChainSearch>,
}

impl Variant {
    /// A method with default settings.
    pub fn new(method: Method) -> Self {
        Self {
            label: method.name().into(),
            settings: Settings::new(method),
            search: None,
        }
    }
}

/// An experiment to run.
pub struct Experiment<'a> {
    /// The scene to render.
    pub scene: &'a mut Scene,
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
    /// Index of the checkpoint, a scheduled time, the same in all repeats of a variant.
    pub index: usize,
    /// Work done so far.
    pub progress: Progress,
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
    pub fn run(&mut self, observer: &dyn Observer) -> Result<Outcome, rayon::ThreadPoolBuildError> {
        observer.phase("rendering");
        let mut outcome = Outcome::default();
        let variants = 0..self.variants.len();
        let mut progress = ExperimentProgress {
            start: Instant::now(),
            done: 0,
            count: self.repeats * variants.len() as u64,
        };
        for repeat in 0..self.repeats {
            for variant in variants.clone() {
                let recorder = Recorder::new(
                    observer,
                    progress,
                    self.variants[variant].settings.budget,
                    self.reference,
                );
                self.render(variant, repeat, recorder, &mut outcome)?;
                if outcome.interrupted {
                    return Ok(outcome);
                }
                progress.done += 1;
            }
        }
        Ok(outcome)
    }

    /// Renders a variant once, and adds its measurements to `outcome`.
    fn render(
        &mut self,
        variant: usize,
        repeat: u64,
        recorder: Recorder,
        outcome: &mut Outcome,
    ) -> Result<(), rayon::ThreadPoolBuildError> {
        let Variant {
            settings, search, ..
        } = &self.variants[variant];
        let usual = self.scene.casters.search();
        self.scene.casters.set_search(search.unwrap_or(usual));
        let settings = Settings {
            seed: settings.seed.wrapping_add(repeat),
            ..settings.clone()
        };
        let rendering = render(self.scene, &settings, &recorder)?;
        self.scene.casters.set_search(usual);
        if rendering.interrupted {
            outcome.interrupted = true;
            return Ok(());
        }
        let measured = recorder.finish(&rendering);
        let measurements = measured.into_iter().map(|m| Measurement {
            variant,
            repeat,
            index: m.index,
            progress: m.progress,
            error: m.error,
        });
        outcome.measurements.extend(measurements);
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
