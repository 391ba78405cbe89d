//! Budgets: how much is done, how long the rest takes, and when to stop.

use std::time::{Duration, Instant};

use super::{Budget, Observer, Progress};
use crate::film::Image;

/// Keeps the budget of a phase whose work is counted in samples.
pub(super) struct Clock<'a> {
    start: Instant,
    /// Time since then that does not count.
    paused: Duration,
    /// Seconds since `start` at which the counted work began.
    began: f64,
    limit: Limit,
    /// The part of the work that is done by the error of the image.
    noted: f64,
    observer: &'a dyn Observer,
}

enum Limit {
    /// Total number of samples.
    Samples(u64),
    /// The second at which to stop.
    Seconds(f64),
    /// Only what is noted.
    None,
}

impl<'a> Clock<'a> {
    /// For work of `pixels` times the samples per pixel of `budget`; seconds count from `start`.
    pub fn new(start: Instant, budget: Budget, pixels: u64, observer: &'a dyn Observer) -> Self {
        let limit = match budget {
            Budget::SamplesPerPixel(n) => Limit::Samples(n.saturating_mul(pixels)),
            Budget::Seconds(seconds) => Limit::Seconds(seconds),
            Budget::Unlimited => Limit::None,
        };
        Self {
            start,
            paused: Duration::ZERO,
            began: start.elapsed().as_secs_f64(),
            limit,
            noted: 0.0,
            observer,
        }
    }

    /// Records that this part of the work seems to be done, whatever the budget is; 1 ends the phase.
    pub fn note(&mut self, fraction: f64) {
        self.noted = fraction;
    }

    /// Number of samples of the whole work, unless time decides.
    pub fn total_samples(&self) -> Option<u64> {
        match self.limit {
            Limit::Samples(n) => Some(n),
            Limit::Seconds(_) | Limit::None => None,
        }
    }

    /// Number of samples of the next block, after `done` samples: `block`, or fewer where a budget of time
    /// could not be kept otherwise. With a budget of samples it does not depend on time.
    pub fn block(&self, done: u64, block: u64) -> u64 {
        match self.limit {
            Limit::Samples(_) | Limit::None => block,
            Limit::Seconds(seconds) => {
                if done == 0 {
                    return (block / 64).max(1);
                }
                let rate = done as f64 / self.working_seconds().max(1e-6);
                let left = (seconds - self.elapsed()).max(0.0);
                let fitting = rate * (0.02 * seconds).clamp(0.01, 0.25).min(left);
                (fitting as u64).clamp(1, block)
            }
        }
    }

    /// Reports `done` samples to the observer; true if the budget is spent or the observer cancels.
    pub fn is_over(&self, done: u64) -> bool {
        let spent = match self.limit {
            Limit::Samples(n) if done >= n => 1.0,
            Limit::Samples(n) => done as f64 / n as f64,
            // A render without any sample would be a black image, however late it is.
            Limit::Seconds(_) if done == 0 => 0.0,
            Limit::Seconds(seconds) => self.elapsed() / seconds,
            Limit::None => 0.0,
        };
        let fraction = spent.max(self.noted).min(1.0);
        let left = match self.limit {
            Limit::Seconds(seconds) if self.noted == 0.0 => seconds - self.elapsed(),
            _ => self.working_seconds() * (1.0 / fraction - 1.0),
        };
        let known = done > 0 && left.is_finite();
        self.observer
            .progress(fraction, known.then_some(left.max(0.0)));
        fraction >= 1.0 || self.observer.interrupted()
    }

    /// Gives the observer a snapshot, the image that `resolve` makes, if it wants one after `samples`
    /// samples and `rays` rays. The time for both does not count.
    pub fn show(&mut self, samples: u64, rays: u64, resolve: impl FnOnce() -> Image) {
        let progress = Progress {
            seconds: self.elapsed(),
            samples,
            rays,
        };
        if self.observer.wants_snapshot(&progress) {
            let pause = Instant::now();
            self.observer.on_snapshot(&progress, &resolve());
            self.paused += pause.elapsed();
        }
    }

    /// True if the observer cancelled a render of `samples` samples before its budget was spent.
    pub fn was_cut_short(&self, samples: u64) -> bool {
        self.observer.interrupted() && self.total_samples().is_none_or(|n| samples < n)
    }

    /// Seconds since the start of the render.
    pub fn elapsed(&self) -> f64 {
        self.start
            .elapsed()
            .saturating_sub(self.paused)
            .as_secs_f64()
    }

    /// Seconds since the start at which the counted work began.
    pub fn began(&self) -> f64 {
        self.began
    }

    fn working_seconds(&self) -> f64 {
        self.elapsed() - self.began
    }
}
