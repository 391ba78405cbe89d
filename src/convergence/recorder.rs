//! An observer that measures the image of a render at progresss fixed beforehand.

use std::sync::Mutex;

use crate::film::Image;
use crate::metrics::{ImageError, image_errors};
use crate::render::{Budget, Observer, Progress};

/// Measured progresss are a factor of sqrt(2) apart: two of them to an octave.
const PER_OCTAVE: f64 = 2.0;

/// Measured progresss, the end included.
const MOMENTS: usize = 17;

/// No image is measured before this second: a render needs some time to begin.
const FIRST_SECOND: f64 = 0.05;

/// Progresss at which to measure, in seconds or in samples, ascending; the last is the whole budget.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Schedule {
    /// Seconds of rendering.
    Seconds(Vec<f64>),
    /// Samples.
    Samples(Vec<f64>),
}

impl Schedule {
    /// For a render of `pixels` pixels.
    pub fn new(budget: Budget, pixels: u64) -> Self {
        match budget {
            Budget::Seconds(seconds) => Self::Seconds(progresss(seconds, FIRST_SECOND)),
            Budget::SamplesPerPixel(n) => {
                let pixels = pixels as f64;
                Self::Samples(progresss(n as f64 * pixels, pixels))
            }
            Budget::Unlimited => Self::Seconds(Vec::new()),
        }
    }

    /// Number of scheduled progresss that have come.
    fn reached(&self, progress: &Progress) -> usize {
        let (progresss, spent) = match self {
            Self::Seconds(progresss) => (progresss, progress.seconds),
            Self::Samples(progresss) => (progresss, progress.samples as f64),
        };
        progresss.partition_point(|&at| at <= spent)
    }

    /// Number of progresss.
    pub fn len(&self) -> usize {
        match self {
            Self::Seconds(progresss) | Self::Samples(progresss) => progresss.len(),
        }
    }
}

/// `last`, and what is before it by powers of the factor down to `first`, ascending.
fn progresss(last: f64, first: f64) -> Vec<f64> {
    let all = (0..MOMENTS).rev();
    let progresss = all.map(|i| last / (i as f64 / PER_OCTAVE).exp2());
    progresss.filter(|&at| at >= first || at == last).collect()
}

/// An image that was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// Which of the scheduled progresss it is.
    pub index: usize,
    /// When it was really measured.
    pub progress: Progress,
    /// What was measured.
    pub error: ImageError,
}

/// Measures a render against a reference and tells another observer how it goes.
pub(super) struct Recorder<'a> {
    pub inner: &'a dyn Observer,
    pub schedule: &'a Schedule,
    pub reference: &'a Image,
    /// Renders of the experiment done before this one, and all of them.
    pub renders: [usize; 2],
    /// Seconds since the experiment began.
    pub elapsed: &'a (dyn Fn() -> f64 + Sync),
    pub measured: Mutex<Vec<Measured>>,
}

impl Recorder<'_> {
    /// Number of scheduled progresss that need no measuring any more.
    fn done(&self) -> usize {
        let measured = self.measured.lock();
        measured.map_or(0, |m| m.last().map_or(0, |last| last.index + 1))
    }
}

impl Observer for Recorder<'_> {
    fn phase(&self, _name: &str) {}

    fn progress(&self, fraction: f64, _seconds_left: Option<f64>) {
        let [before, all] = self.renders.map(|n| n as f64);
        let done = (before + fraction) / all;
        let left = (self.elapsed)() * (1.0 / done - 1.0);
        let known = left.is_finite() && done > 0.01;
        self.inner.progress(done, known.then_some(left));
    }

    fn interrupted(&self) -> bool {
        self.inner.interrupted()
    }

    fn wants_snapshot(&self, progress: &Progress) -> bool {
        let reached = self.schedule.reached(progress);
        // The end is measured from the image that the render returns.
        reached > self.done() && reached < self.schedule.len()
    }

    fn on_snapshot(&self, progress: &Progress, image: &Image) {
        let measured = Measured {
            index: self.schedule.reached(progress) - 1,
            progress: *progress,
            error: image_errors(&image.pixels, &self.reference.pixels),
        };
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
    fn progresss_are_geometric_and_end_with_the_budget() {
        let Schedule::Seconds(progresss) = Schedule::new(Budget::Seconds(60.0), 100) else {
            panic!("a budget of seconds is scheduled in seconds");
        };
        assert_eq!(progresss.len(), MOMENTS);
        assert_eq!(progresss[MOMENTS - 1], 60.0);
        let ratios = progresss.windows(2).map(|pair| pair[1] / pair[0]);
        assert!(ratios.into_iter().all(|r| (r * r - 2.0).abs() < 1e-12));
        assert!(progresss[0] > 0.2 && progresss[0] < 0.3);
        // One sample per pixel is the first image.
        let samples = Schedule::new(Budget::SamplesPerPixel(4), 100);
        let expected = [100.0, 141.4, 200.0, 282.8, 400.0];
        let Schedule::Samples(progresss) = &samples else {
            panic!("a budget of samples is scheduled in samples");
        };
        let near = progresss.iter().zip(expected);
        assert!(progresss.len() == 5 && near.into_iter().all(|(a, e)| (a - e).abs() < 0.1));
        assert_eq!(samples.reached(&at(0.0, 99)), 0);
        assert_eq!(samples.reached(&at(0.0, 399)), 4);
        assert_eq!(samples.reached(&at(0.0, 400)), 5);
    }

    #[test]
    fn even_a_tiny_budget_has_its_end() {
        assert_eq!(Schedule::new(Budget::Seconds(0.01), 1).len(), 1);
    }
}
