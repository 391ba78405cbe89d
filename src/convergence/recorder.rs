//! An observer that measures the error of an image at scheduled times of its render.

use std::sync::Mutex;
use std::time::Instant;

use crate::film::Image;
use crate::metrics::{ImageError, image_errors};
use crate::render::{Budget, Observer, Progress, Rendering};

/// Scheduled times per doubling of the time.
const PER_OCTAVE: f64 = 2.0;

/// Number of scheduled times, the end included.
const TIMES: usize = 17;

/// Earliest time of a measurement, in seconds: before it a render may have no image.
const MIN_SECONDS: f64 = 0.05;

/// Times of measurements, in seconds or in samples, ascending. The last one is the whole budget.
#[derive(Clone, Debug, PartialEq)]
enum Schedule {
    /// Times in seconds of rendering.
    Seconds(Vec<f64>),
    /// Times in numbers of samples.
    Samples(Vec<f64>),
}

impl Schedule {
    /// A schedule for a render of `pixels` pixels.
    pub fn new(budget: Budget, pixels: u64) -> Self {
        match budget {
            Budget::Seconds(seconds) => Self::Seconds(times(seconds, MIN_SECONDS)),
            Budget::SamplesPerPixel(n) => {
                let pixels = pixels as f64;
                Self::Samples(times(n as f64 * pixels, pixels))
            }
            Budget::Samples(_) | Budget::Unlimited => Self::Seconds(Vec::new()),
        }
    }

    /// Number of scheduled times that have been reached.
    fn reached(&self, progress: &Progress) -> usize {
        let (times, now) = match self {
            Self::Seconds(times) => (times, progress.seconds),
            Self::Samples(times) => (times, progress.samples as f64),
        };
        times.partition_point(|&time| time <= now)
    }

    /// Number of scheduled times.
    pub fn len(&self) -> usize {
        match self {
            Self::Seconds(times) | Self::Samples(times) => times.len(),
        }
    }
}

/// Geometrically spaced times from `first` or later to `last`, ascending.
fn times(last: f64, first: f64) -> Vec<f64> {
    let all = (0..TIMES).rev();
    let times = all.map(|i| last / (i as f64 / PER_OCTAVE).exp2());
    times
        .filter(|&time| time >= first || time == last)
        .collect()
}

/// A measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// Index of the scheduled time.
    pub index: usize,
    /// Work done at the measurement.
    pub progress: Progress,
    /// Error against the reference.
    pub error: ImageError,
}

/// Progress of a whole experiment.
#[derive(Clone, Copy)]
pub(super) struct ExperimentProgress {
    /// Start of the experiment.
    pub start: Instant,
    /// Number of complete renders.
    pub done: u64,
    /// Number of all renders.
    pub count: u64,
}

/// Measures a render against a reference, and forwards its progress to another observer.
pub(super) struct Recorder<'a> {
    inner: &'a dyn Observer,
    progress: ExperimentProgress,
    schedule: Schedule,
    reference: &'a Image,
    measured: Mutex<Vec<Measured>>,
}

impl<'a> Recorder<'a> {
    /// A recorder of a render with `budget`.
    pub fn new(
        inner: &'a dyn Observer,
        progress: ExperimentProgress,
        budget: Budget,
        reference: &'a Image,
    ) -> Self {
        Self {
            inner,
            progress,
            schedule: Schedule::new(budget, reference.pixels.len() as u64),
            reference,
            measured: Mutex::default(),
        }
    }

    /// Number of scheduled times that have been measured or skipped.
    fn done(&self) -> usize {
        let measured = self.measured.lock();
        measured.map_or(0, |m| m.last().map_or(0, |last| last.index + 1))
    }

    fn measure(&self, index: usize, progress: Progress, image: &Image) -> Measured {
        Measured {
            index,
            progress,
            error: image_errors(&image.pixels, &self.reference.pixels),
        }
    }

    /// All measurements of the render, the final image included.
    pub fn finish(self, rendering: &Rendering) -> Vec<Measured> {
        let statistics = &rendering.statistics;
        let progress = Progress {
            seconds: statistics.render_seconds,
            samples: statistics.samples,
            rays: statistics.closest_hit_rays + statistics.shadow_rays,
        };
        let last = self.schedule.len().saturating_sub(1);
        let end = self.measure(last, progress, &rendering.image);
        let mut measured = self.measured.into_inner().unwrap_or_default();
        measured.push(end);
        measured
    }
}

impl Observer for Recorder<'_> {
    fn phase(&self, _name: &str) {}

    fn progress(&self, fraction: f64, _seconds_left: Option<f64>) {
        let ExperimentProgress { start, done, count } = self.progress;
        let done = (done as f64 + fraction) / count as f64;
        let left = start.elapsed().as_secs_f64() * (1.0 / done - 1.0);
        let known = left.is_finite() && done > 0.01;
        self.inner.progress(done, known.then_some(left));
    }

    fn interrupted(&self) -> bool {
        self.inner.interrupted()
    }

    fn wants_snapshot(&self, progress: &Progress) -> bool {
        let reached = self.schedule.reached(progress);
        // The last time is measured from the image that the render returns.
        reached > self.done() && reached < self.schedule.len()
    }

    fn on_snapshot(&self, progress: &Progress, image: &Image) {
        let measured = self.measure(self.schedule.reached(progress) - 1, *progress, image);
        if let Ok(mut all) = self.measured.lock() {
            all.push(measured);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: f64, samples: u64) -> Progress {
        Progress {
            seconds,
            samples,
            rays: 0,
        }
    }

    #[test]
    fn times_are_geometric_and_end_with_the_budget() {
        let Schedule::Seconds(times) = Schedule::new(Budget::Seconds(60.0), 100) else {
            panic!("a budget of seconds is scheduled in seconds");
        };
        assert_eq!(times.len(), TIMES);
        assert_eq!(times[TIMES - 1], 60.0);
        let ratios = times.windows(2).map(|pair| pair[1] / pair[0]);
        assert!(ratios.into_iter().all(|r| (r * r - 2.0).abs() < 1e-12));
        assert!(times[0] > 0.2 && times[0] < 0.3);
        // The first image has one sample per pixel.
        let samples = Schedule::new(Budget::SamplesPerPixel(4), 100);
        let expected = [100.0, 141.4, 200.0, 282.8, 400.0];
        let Schedule::Samples(times) = &samples else {
            panic!("a budget of samples is scheduled in samples");
        };
        let near = times.iter().zip(expected);
        assert!(times.len() == 5 && near.into_iter().all(|(a, e)| (a - e).abs() < 0.1));
        assert_eq!(samples.reached(&at(0.0, 99)), 0);
        assert_eq!(samples.reached(&at(0.0, 399)), 4);
        assert_eq!(samples.reached(&at(0.0, 400)), 5);
    }

    #[test]
    fn a_tiny_budget_is_measured_at_its_end() {
        assert_eq!(Schedule::new(Budget::Seconds(0.01), 1).len(), 1);
    }
}
