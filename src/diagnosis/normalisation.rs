//! Normalisation: tests of b, and of the weights of samples. Chains and independent samples must estimate
//! the same image.
//!
//! If light is rare and bright, uniform samples underestimate the variance of their mean, because most of
//! them have not found it. Chains have found it. So the variance of uniform samples is estimated with the
//! weights of the chains, like any other integral, and a mean of too few contributing samples is not tested.

use super::check::{Check, Family};
use super::history::{History, Integrals};
use super::observation::{IndependentEstimate, TILES};
use crate::markov::{Bootstrap, KelemenWeights};
use crate::statistics::{Moments, holm, normal_two_sided};

/// Minimum effective number of clusters of chains, or of contributing samples, for a test. The z-score is
/// then approximately normal.
pub(super) const MIN_EFFECTIVE: f64 = 200.0;

/// Estimates of b: the mean of I.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Normalisation {
    /// All of them.
    pub estimates: Vec<Estimate>,
}

/// An estimate and its standard error.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Estimate {
    /// The samples that it is from.
    pub name: &'static str,
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// True if there are enough samples, or clusters of chains, for a test.
    #[serde(skip)]
    is_testable: bool,
}

impl Estimate {
    /// The mean of `count` uniform samples whose square has the integral `square`, or at most that: a
    /// sample of all techniques has a smaller square than one of a multiplexed target.
    fn uniform(name: &'static str, value: f64, count: u64, square: f64) -> Self {
        let count = count as f64;
        Self {
            name,
            value,
            standard_error: ((square - value * value).max(0.0) / count).sqrt(),
            // The effective number of contributing samples is n mean^2 / mean square: the number of
            // non-zero samples if these are equal.
            is_testable: count * value * value > MIN_EFFECTIVE * square,
        }
    }

    /// p-value of the null hypothesis that both have the same mean; `None` if it cannot be tested.
    fn differs_from(&self, other: &Self) -> Option<f64> {
        let error = self.standard_error.hypot(other.standard_error);
        let testable = self.is_testable && other.is_testable && error > 0.0 && error.is_finite();
        testable.then(|| normal_two_sided((self.value - other.value) / error))
    }
}

/// Compares b of the bootstrap, of the chains' large steps, of the chains' weights and of `independent`
/// samples, and the weights tile by tile.
pub fn normalisation(
    bootstrap: &Bootstrap,
    histories: &[History],
    independent: &IndependentEstimate,
    weights: KelemenWeights,
) -> (Normalisation, Vec<Check>) {
    let large = histories
        .iter()
        .fold(Moments::default(), |moments, history| {
            moments.merge(&history.counters.large_densities)
        });
    let p_large = weights.large_step_probability;
    let mut weights = WeightedHistories::new(histories, weights, &bootstrap.moments);
    let square = weights.of(&|part| part.square).value;
    let uniform = |name, mean, count| Estimate::uniform(name, mean, count, square);
    let from_bootstrap = uniform("bootstrap", bootstrap.moments.mean, bootstrap.moments.count);
    let large = uniform("large steps", large.mean, large.count);
    weights.b_error = from_bootstrap.standard_error;
    let independent_total = uniform(
        "independent samples",
        independent.tiles.iter().sum(),
        independent.samples,
    );
    let weights_total = weights.of(&|part| part.light.iter().sum());
    let tile = |i: usize| {
        let squares = weights.of(&|part| part.squares[i]).value;
        let independent = Estimate::uniform(
            "independent samples",
            independent.tiles[i],
            independent.samples,
            squares,
        );
        weights.of(&|part| part.light[i]).differs_from(&independent)
    };
    let tiles: Vec<f64> = (0..TILES * TILES).filter_map(tile).collect();
    let least = (!tiles.is_empty()).then(|| holm(&tiles).into_iter().fold(1.0, f64::min));
    let tests = [
        (
            "b of bootstrap and large steps",
            from_bootstrap.differs_from(&large),
        ),
        (
            "b of bootstrap and independent samples",
            from_bootstrap.differs_from(&independent_total),
        ),
        // Without large steps the weights of every chain sum to b of the bootstrap: the same test again.
        (
            "b of weights and independent samples",
            (p_large > 0.0)
                .then(|| weights_total.differs_from(&independent_total))
                .flatten(),
        ),
        ("weights and independent samples, tile by tile", least),
    ];
    let check = |(name, p_value): (&str, Option<f64>)| {
        Some(Check::new(Family::Normalisation, name, p_value?))
    };
    let mut estimates = vec![from_bootstrap, large, independent_total, weights_total];
    // Chains without large steps have no estimate from large steps.
    estimates.retain(|estimate| estimate.standard_error.is_finite());
    if p_large == 0.0 {
        estimates.pop();
    }
    (
        Normalisation { estimates },
        tests.into_iter().filter_map(check).collect(),
    )
}

/// Estimates by the weights of chains in equilibrium: b/b_0 times the chain part, plus the large-step
/// part.
struct WeightedHistories<'a> {
    clusters: Vec<&'a [History]>,
    chains: f64,
    b_0: f64,
    b: f64,
    /// Standard error of b.
    b_error: f64,
}

impl<'a> WeightedHistories<'a> {
    fn new(histories: &'a [History], weights: KelemenWeights, b: &Moments) -> Self {
        Self {
            clusters: histories.chunk_by(|a, b| a.sample == b.sample).collect(),
            chains: histories.len() as f64,
            b_0: weights.b,
            b: b.mean,
            b_error: b.standard_error(),
        }
    }

    /// The estimate of the integral that `value` selects. Its variance is the sum of the variance over
    /// independent clusters and the variance due to b.
    fn of(&self, value: &dyn Fn(&Integrals) -> f64) -> Estimate {
        let refinement = self.b / self.b_0;
        let (mut sum, mut chain_sum) = (0.0, 0.0);
        let mut per_cluster = Vec::with_capacity(self.clusters.len());
        for cluster in &self.clusters {
            let part = |i: usize| cluster.iter().map(|h| value(&h.integrals[i])).sum::<f64>();
            let chain = part(0);
            let total = refinement * chain + part(1);
            chain_sum += chain;
            sum += total;
            per_cluster.push((total, cluster.len() as f64));
        }
        let mean = sum / self.chains;
        let squares: f64 = per_cluster
            .iter()
            .map(|(t, n)| (t - n * mean).powi(2))
            .sum();
        let sum_of_squares: f64 = per_cluster.iter().map(|(t, _)| t * t).sum();
        let clusters = self.clusters.len() as f64;
        let of_clusters = squares * clusters / (clusters - 1.0) / (self.chains * self.chains);
        let of_b = (chain_sum / self.chains / self.b_0 * self.b_error).powi(2);
        Estimate {
            name: "weights",
            value: mean,
            standard_error: (of_clusters + of_b).sqrt(),
            is_testable: sum * sum > MIN_EFFECTIVE * sum_of_squares,
        }
    }
}
