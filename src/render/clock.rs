//! Budgets: how much is done, how long the rest will take, and when to stop.

use std::time::Instant;

use super::{Budget, Observer};

/// Watches over one phase of a render whose work is counted in samples.
pub(super) struct Clock<'a> {
    start: Instant,
    /// Seconds since `start` at which the counted work began.
    began: f64,
    /// Total number of samples, or the second at which to stop.
    limit: Limit,
    observer: &'a dyn Observer,
}

enum Limit {
    Samples(u64),
    Seconds(f64),
}

impl<'a> Clock<'a> {
    /// For work of `pixels` times the samples per pixel of `budget`; seconds count from `start`.
    pub fn new(start: Instant, budget: Budget, pixels: u64, observer: &'a dyn Observer) -> Self {
        let limit = match budget {
            Budget::SamplesPerPixel(n) => Limit::Samples(n.saturating_mul(pixels)),
            Budget::Seconds(seconds) => Limit::Seconds(seconds),
        };
        Self {
            start,
            began: start.elapsed().as_secs_f64(),
            limit,
            observer,
        }
    }

    /// Number of samples of the whole work, unless time decides.
    pub fn total_samples(&self) -> Option<u64> {
        match self.limit {
            Limit::Samples(n) => Some(n),
            Limit::Seconds(_) => None,
        }
    }

    /// How many samples the next block should have, after `done` samples: `block` of them, or fewer
    /// where these would take so long that the budget of time could not be kept. With a budget of
    /// samples the answer does not depend on time.
    pub fn block(&self, done: u64, block: u64) -> u64 {
        match self.limit {
            Limit::Samples(_) => block,
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
        let elapsed = self.elapsed();
        let (fraction, left) = match self.limit {
            Limit::Samples(n) => {
                let per_sample = self.working_seconds() / done.max(1) as f64;
                (
                    done as f64 / n.max(1) as f64,
                    (n - done) as f64 * per_sample,
                )
            }
            Limit::Seconds(seconds) => (elapsed / seconds, seconds - elapsed),
        };
        self.observer
            .progress(fraction.min(1.0), (done > 0).then_some(left.max(0.0)));
        let over = match self.limit {
            Limit::Samples(n) => done >= n,
            // Late or not: a render without a sample would be a black image.
            Limit::Seconds(_) => fraction >= 1.0 && done > 0,
        };
        over || self.observer.interrupted()
    }

    /// Seconds since the start of the render.
    pub fn elapsed(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Second of the render at which the counted work began.
    pub fn began(&self) -> f64 {
        self.began
    }

    fn working_seconds(&self) -> f64 {
        self.elapsed() - self.began
    }
}
