//! Budgets: the fraction of the work that is done, the remaining time, and when to stop.

use std::time::{Duration, Instant};

use super::{Budget, Observer, Progress, Rendering};
use crate::film::Image;

/// Tracks the budget of a phase whose work is counted in samples.
pub(super) struct Clock<'a> {
    start: Instant,
    /// Time since `start` that was spent on snapshots and is not counted.
    paused: Duration,
    /// Seconds from `start` to the beginning of this phase.
    began: f64,
    limit: Limit,
    /// Fraction of the work that is done, as estimated from the error of the image.
    error_fraction: f64,
    observer: &'a dyn Observer,
}

enum Limit {
    /// Total number of samples, of which every pixel or chain has an equal share.
    Shared(u64),
    /// Total number of samples, in the order of a render that time ends.
    Samples(u64),
    /// Seconds since the start at which to stop.
    Seconds(f64),
    /// No limit but a target error.
    None,
}

impl<'a> Clock<'a> {
    /// A clock for `pixels` times the samples per pixel of `budget`, or for its seconds, counted from
    /// `start`.
    pub fn new(start: Instant, budget: Budget, pixels: u64, observer: &'a dyn Observer) -> Self {
        let limit = match budget {
            Budget::SamplesPerPixel(n) => Limit::Shared(n.saturating_mul(pixels)),
            Budget::Samples(n) => Limit::Samples(n),
            Budget::Seconds(seconds) => Limit::Seconds(seconds),
            Budget::Unlimited => Limit::None,
        };
        Self {
            start,
            paused: Duration::ZERO,
            began: start.elapsed().as_secs_f64(),
            limit,
            error_fraction: 0.0,
            observer,
        }
    }

    /// Sets the fraction of the work that is done as estimated from the error; 1 ends the phase, for any
    /// budget.
    pub fn set_error_fraction(&mut self, fraction: f64) {
        self.error_fraction = fraction;
    }

    /// Total number of samples, if the budget is a number of samples.
    pub fn total_samples(&self) -> Option<u64> {
        match self.limit {
            Limit::Shared(n) | Limit::Samples(n) => Some(n),
            Limit::Seconds(_) | Limit::None => None,
        }
    }

    /// Total number of samples, if every pixel or chain is to have an equal share of them.
    pub fn total_if_shared(&self) -> Option<u64> {
        match self.limit {
            Limit::Shared(n) => Some(n),
            Limit::Samples(_) | Limit::Seconds(_) | Limit::None => None,
        }
    }

    /// Number of samples of the next block, after `done` samples. It does not depend on time, so that the
    /// image does not: where time ends the render, blocks begin small and grow with the work done, so that
    /// the last one exceeds the budget by little.
    pub fn block(&self, done: u64, block: u64) -> u64 {
        match self.limit {
            Limit::Shared(_) | Limit::None => block,
            Limit::Samples(_) | Limit::Seconds(_) => (done / 64).clamp((block / 64).max(1), block),
        }
    }

    /// Number of samples of the next block, after `done` samples, if the image does not depend on it: `block`,
    /// or fewer if a time budget would be exceeded otherwise.
    pub fn prompt_block(&self, done: u64, block: u64) -> u64 {
        match self.limit {
            Limit::Seconds(seconds) if done > 0 => {
                let rate = done as f64 / self.working_seconds().max(1e-6);
                let left = (seconds - self.elapsed()).max(0.0);
                let fitting = rate * (0.02 * seconds).clamp(0.01, 0.25).min(left);
                (fitting as u64).clamp(1, block)
            }
            _ => self.block(done, block),
        }
    }

    /// True if the observer cancels.
    pub fn is_cancelled(&self) -> bool {
        self.observer.interrupted()
    }

    /// Reports `done` samples to the observer; true if the budget is spent or the observer cancels.
    pub fn is_over(&self, done: u64) -> bool {
        let spent = match self.limit {
            Limit::Shared(n) | Limit::Samples(n) if done >= n => 1.0,
            Limit::Shared(n) | Limit::Samples(n) => done as f64 / n as f64,
            // At least one block is sampled, even if it is late: without samples the image is black.
            Limit::Seconds(_) if done == 0 => 0.0,
            Limit::Seconds(seconds) => self.elapsed() / seconds,
            Limit::None => 0.0,
        };
        let fraction = spent.max(self.error_fraction).min(1.0);
        let left = match self.limit {
            Limit::Seconds(seconds) if self.error_fraction == 0.0 => seconds - self.elapsed(),
            _ => self.working_seconds() * (1.0 / fraction - 1.0),
        };
        let known = done > 0 && left.is_finite();
        self.observer
            .progress(fraction, known.then_some(left.max(0.0)));
        fraction >= 1.0 || self.observer.interrupted()
    }

    /// Passes a snapshot to the observer, if it wants one after `samples` samples and `rays` rays. `resolve`
    /// returns the image. The time of `resolve` and of the observer is not counted.
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

    /// Passes the result so far to the observer, if it wants it after `samples` samples and `rays` rays.
    /// `result` returns it. The time of both is not counted.
    pub fn save(&mut self, samples: u64, rays: u64, result: impl FnOnce(&Self) -> Rendering) {
        let progress = Progress {
            seconds: self.elapsed(),
            samples,
            rays,
        };
        if samples > 0 && self.observer.wants_rendering(&progress) {
            let pause = Instant::now();
            let result = Rendering {
                interrupted: true,
                ..result(self)
            };
            self.observer.on_rendering(&result);
            self.paused += pause.elapsed();
        }
    }

    /// True if the observer cancelled a render of `samples` samples before its budget was spent.
    pub fn was_cancelled(&self, samples: u64) -> bool {
        self.observer.interrupted() && self.total_samples().is_none_or(|n| samples < n)
    }

    /// Seconds since the start of the render.
    pub fn elapsed(&self) -> f64 {
        self.start
            .elapsed()
            .saturating_sub(self.paused)
            .as_secs_f64()
    }

    /// Seconds from the start of the render to the beginning of this phase.
    pub fn began(&self) -> f64 {
        self.began
    }

    /// Seconds of this phase.
    fn working_seconds(&self) -> f64 {
        self.elapsed() - self.began
    }
}
