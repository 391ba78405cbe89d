//! Starts that are drawn exactly from the target distribution.
//!
//! A uniform sample u becomes the start of m(u) chains, where m is I(u)/c rounded up or down at random
//! so that its mean is I(u)/c. The starts are then a point process with an intensity proportional to I. If
//! c is a bound of I, this is rejection sampling, and all starts are independent. If no bound is known, c
//! is chosen from a bootstrap so that few samples exceed it. A sample that exceeds it starts several chains,
//! which are one cluster in the tests.

use std::time::Instant;

use rand::RngExt;
use rayon::prelude::*;

use super::observation::{ChainTarget, Features, Observation};
use crate::markov::{Bootstrap, Target, bootstrap};
use crate::render::Observer;
use crate::sampling::seeds::{self, Purpose};

/// Maximum share of the starts that coincide with another start, as estimated from the bootstrap.
const MAX_COINCIDENT: f64 = 0.005;

/// Uniform samples evaluated between two reports.
const BATCH: u64 = 1 << 14;

/// Uniform samples of one task.
const TASK: u64 = 256;

/// A start of a chain.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Index of the uniform sample. Chains with the same index are one cluster.
    pub sample: u64,
    /// The state there.
    pub features: Features,
}

/// Starts, and the samples among which they were found.
#[derive(Debug, Default)]
pub struct Starts {
    /// The seed of the uniform samples.
    pub seed: u64,
    /// In the order of their samples.
    pub starts: Vec<Start>,
    /// Uniform samples evaluated.
    pub samples: u64,
}

impl Starts {
    /// Draws `wanted` starts, or as many as are found among `max_samples` samples; fewer if the observer
    /// cancels.
    pub fn draw<S: ChainTarget>(
        chain_target: &S,
        seed: u64,
        c: f64,
        (wanted, max_samples): (usize, u64),
        observer: &dyn Observer,
    ) -> Self {
        let begin = Instant::now();
        let mut drawn = Self {
            seed,
            ..Self::default()
        };
        while drawn.starts.len() < wanted && drawn.samples < max_samples {
            if observer.interrupted() {
                break;
            }
            let found = drawn.starts.len() as f64 / wanted as f64;
            let done = found.max(drawn.samples as f64 / max_samples as f64);
            let left = begin.elapsed().as_secs_f64() * (1.0 / done - 1.0);
            observer.progress(done, (done > 0.0).then_some(left));
            let last = max_samples.min(drawn.samples + BATCH);
            let found: Vec<Vec<Start>> = (drawn.samples..last)
                .step_by(TASK as usize)
                .collect::<Vec<u64>>()
                .into_par_iter()
                .map(|first| {
                    let mut target = chain_target.target();
                    let mut out = Observation::default();
                    (first..last.min(first + TASK))
                        .flat_map(|i| starts_at(&mut target, &mut out, [seed, i], c))
                        .collect()
                })
                .collect();
            drawn.starts.extend(found.into_iter().flatten());
            drawn.samples = last;
        }
        drawn.starts.truncate(wanted);
        drawn
    }

    /// Number of different samples among the starts.
    pub fn clusters(&self) -> usize {
        let mut samples: Vec<u64> = self.starts.iter().map(|start| start.sample).collect();
        samples.dedup();
        samples.len()
    }
}

/// The starts at uniform sample `i` under `seed`: usually none.
fn starts_at<T: Target<Contribution = Observation>>(
    target: &mut T,
    out: &mut Observation,
    [seed, i]: [u64; 2],
    c: f64,
) -> impl Iterator<Item = Start> + use<T> {
    let density = target.evaluate(&mut bootstrap::sample(seed, i), out);
    let u: f64 = seeds::generator(seed, Purpose::Resampling, i).random();
    let mean = if density.is_finite() {
        density / c
    } else {
        0.0
    };
    let copies = mean.floor() + f64::from(u8::from(u < mean.fract()));
    let features = Features {
        log_density: density.ln(),
        ..out.features
    };
    std::iter::repeat_n(
        Start {
            sample: i,
            features,
        },
        copies as usize,
    )
}

/// The c that gives as many starts as possible while few of them coincide, from the densities of a
/// bootstrap. The share that coincide is the mean of (I - c)+ over the mean of I.
pub fn spacing(bootstrap: &Bootstrap) -> f64 {
    let mut densities = bootstrap.densities.clone();
    densities.sort_by(|a, b| b.total_cmp(a));
    let total: f64 = densities.iter().sum();
    let mut above = 0.0;
    for (i, &density) in densities.iter().enumerate() {
        // If c is this density, the sum of (I - c)+ is the sum of all greater densities minus c for each.
        if above - i as f64 * density > MAX_COINCIDENT * total {
            return densities[i.saturating_sub(1)];
        }
        above += density;
    }
    densities.first().copied().unwrap_or(0.0)
}
