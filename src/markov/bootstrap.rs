//! The bootstrap: starts of chains, and the first estimate of the normalisation b, the mean of I.

use rand::RngExt;
use rayon::prelude::*;

use super::Target;
use crate::fault::{Fault, planted};
use crate::sampling::IndependentSampler;
use crate::sampling::seeds::{self, Purpose};
use crate::statistics::Moments;

/// Samples evaluated between two checks of the error of b.
const BATCH: u64 = 1 << 14;

/// When the bootstrap ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BootstrapLimits {
    /// Minimum number of samples.
    pub at_least: u64,
    /// Maximum number of samples.
    pub at_most: u64,
    /// The bootstrap ends when the standard error of b is at most this fraction of b.
    pub relative_error: f64,
}

/// Independent uniform samples of the target.
#[derive(Debug)]
pub struct Bootstrap {
    seed: u64,
    /// I(u) of sample i; 0 where it was not finite.
    pub densities: Vec<f64>,
    /// Moments of I: the mean is b.
    pub moments: Moments,
    /// Indices of the samples whose density was not finite.
    pub non_finite: Vec<u64>,
}

impl Bootstrap {
    /// Samples the target until `limits` are reached or `interrupted`, which is given the number of samples
    /// so far, returns true. Each task creates a target by `worker` and passes it to `finish` at its end.
    /// The result depends only on the seed and the limits, not on the number of threads.
    pub fn run<G: Target>(
        seed: u64,
        limits: BootstrapLimits,
        worker: impl Fn() -> G + Sync,
        finish: impl Fn(G) + Sync,
        mut interrupted: impl FnMut(u64) -> bool,
    ) -> Self {
        let mut bootstrap = Self {
            seed,
            densities: Vec::new(),
            moments: Moments::default(),
            non_finite: Vec::new(),
        };
        while !bootstrap.is_enough(limits) && !interrupted(bootstrap.moments.count) {
            let first = bootstrap.moments.count;
            let last = limits.at_most.min(first + BATCH);
            bootstrap.extend(first..last, &worker, &finish);
        }
        bootstrap
    }

    fn is_enough(&self, limits: BootstrapLimits) -> bool {
        let count = self.moments.count;
        count >= limits.at_most
            || (count >= limits.at_least.max(2)
                && self.moments.mean > 0.0
                && self.moments.standard_error() <= limits.relative_error * self.moments.mean)
    }

    fn extend<G: Target>(
        &mut self,
        samples: std::ops::Range<u64>,
        worker: &(impl Fn() -> G + Sync),
        finish: &(impl Fn(G) + Sync),
    ) {
        /// Samples of one task.
        const TASK: u64 = 512;
        let tasks = (samples.end - samples.start).div_ceil(TASK);
        let densities: Vec<Vec<f64>> = (0..tasks)
            .into_par_iter()
            .map(|task| {
                let first = samples.start + task * TASK;
                let last = samples.end.min(first + TASK);
                let mut target = worker();
                let mut out = G::Contribution::default();
                let densities = (first..last)
                    .map(|i| target.evaluate(&mut sample(self.seed, i), &mut out))
                    .collect();
                finish(target);
                densities
            })
            .collect();
        for density in densities.into_iter().flatten() {
            let finite = density.is_finite();
            if !finite {
                self.non_finite.push(self.moments.count);
            }
            let mut density = if finite { density } else { 0.0 };
            if planted(Fault::NormalisationOff) {
                density *= 1.01;
            }
            self.moments.add(density);
            self.densities.push(density);
        }
    }

    /// Sample `i`.
    pub fn sample(&self, i: usize) -> IndependentSampler {
        sample(self.seed, i as u64)
    }

    /// Moments of I over the samples of part `i` of `parts` parts, whose sizes differ by at most 1.
    pub fn part(&self, i: usize, parts: usize) -> Moments {
        let bound = |i: usize| self.densities.len() * i / parts;
        let densities = &self.densities[bound(i)..bound(i + 1)];
        densities.iter().copied().collect()
    }

    /// Indices of the samples that `chains` chains start from, in proportion to their density. Empty if all
    /// densities are 0.
    pub fn starts(&self, chains: usize) -> Vec<usize> {
        let mut rng = seeds::generator(self.seed, Purpose::Resampling, 0);
        systematic_resample(&self.densities, chains, rng.random())
    }
}

/// Sample `i` of a bootstrap under `seed`.
pub fn sample(seed: u64, i: u64) -> IndependentSampler {
    IndependentSampler::new(seed, Purpose::Bootstrap, i)
}

/// Systematic resampling (Kitagawa 1996, "Monte Carlo filter and smoother"): `n` indices. The expected
/// number of times that index i occurs is n w_i / sum(w), and the actual number differs by less than 1.
/// `u` in [0, 1) is the only random number. Empty if all weights are 0.
pub fn systematic_resample(weights: &[f64], n: usize, u: f64) -> Vec<usize> {
    let total: f64 = weights.iter().sum();
    if total <= 0.0 {
        return Vec::new();
    }
    let mut indices = Vec::with_capacity(n);
    let mut sum = 0.0;
    let mut last_positive = 0;
    for (i, &weight) in weights.iter().enumerate() {
        sum += weight / total * n as f64;
        if weight > 0.0 {
            last_positive = i;
        }
        while indices.len() < n && indices.len() as f64 + u < sum {
            indices.push(i);
        }
    }
    // Rounding may omit the last index.
    indices.resize(n, last_positive);
    indices
}
