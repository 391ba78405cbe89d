//! Budgets: how much is done, how long the rest will take, and when to stop.

use std::time::{Duration, Instant};

use super::{Budget, Moment, Observer};
use crate::film::Image;

/// Watches over one phase of a render whose work is counted in samples.
pub(super) struct Clock<'a> {
    start: Instant,
    /// Time since then that did not count.
    paused: Duration,
    /// Seconds since `start` at which the counted work began.
    began: f64,
    limit: Limit,
    /// The part of the work that the error of the image says is done.
    noted: f64,
    observer: &'a dyn Observer,
}

enum Limit {
    /// Total number of samples.
    Samples(u64),
    /// The second at which to stop.
    Seconds(f64),
    /// Nothing but what is noted.
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

    /// Takes note that this part of the work seems to be done, whatever the budget is; all is over
    /// when it is 1.
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

    /// How many samples the next block should have, after `done` samples: `block` of them, or fewer
    /// where these would take so long that the budget of time could not be kept. With a budget of
    /// samples the answer does not depend on time.
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

    /// Tells the observer that `done` samples are done; true if that is all there is time for, or if
    /// the observer wants it to be.
    pub fn is_over(&self, done: u64) -> bool {
        let spent = match self.limit {
            Limit::Samples(n) if done >= n => 1.0,
            Limit::Samples(n) => done as f64 / n as f64,
            // Late or not: a render without a sample would be a black image.
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

    /// Shows the observer the image that `develop` makes, if it wants to look after `samples` samples
    /// and `rays` rays. Neither making nor looking takes any time of the render.
    pub fn show(&mut self, samples: u64, rays: u64, develop: impl FnOnce() -> Image) {
        let moment = Moment {
            seconds: self.elapsed(),
            samples,
            rays,
        };
        if self.observer.wants_to_look(&moment) {
            let pause = Instant::now();
            self.observer.look(&moment, &develop());
            self.paused += pause.elapsed();
        }
    }

    /// Seconds since the start of the render.
    pub fn elapsed(&self) -> f64 {
        self.start
            .elapsed()
            .saturating_sub(self.paused)
            .as_secs_f64()
    }

    /// Second of the render at which the counted work began.
    pub fn began(&self) -> f64 {
        self.began
    }

    fn working_seconds(&self) -> f64 {
        self.elapsed() - self.began
    }
}
