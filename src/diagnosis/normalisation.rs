//! b, and what samples weigh: what chains make of the image must be what plain sampling makes of it.

use super::check::{Check, Family};
use super::history::History;
use super::observation::TILES;
use crate::markov::{Bootstrap, Weighing};
use crate::statistics::{Moments, holm, normal_two_sided, welch};

/// Estimates of b: the mean of I.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Normalisation {
    /// Where each is from, its value and its standard error.
    pub estimates: Vec<Estimate>,
}

/// A number and how well it is known.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Estimate {
    /// Where it is from.
    pub name: &'static str,
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// Compares b of the bootstrap, of the chains' large steps, of the chains' weights and of `plain`
/// sampling (estimates by tile), and the weights tile by tile.
pub fn normalisation(
    bootstrap: &Bootstrap,
    histories: &[History],
    plain: &[Vec<f64>],
    weighing: Weighing,
) -> (Normalisation, Vec<Check>) {
    let large = histories
        .iter()
        .fold(Moments::default(), |moments, history| {
            moments.merge(&history.counters.large_densities)
        });
    // Samples of one size: of a long-tailed I the smaller one would as a rule seem too dark.
    let count = (large.count as usize).min(bootstrap.densities.len());
    let boot = &bootstrap.moments;
    let beginning: Moments = bootstrap.densities[..count].iter().copied().collect();
    let plain_total: Moments = plain.iter().map(|tiles| tiles.iter().sum()).collect();
    let groups = plain.len().max(1);
    let boot_groups: Moments = (0..groups)
        .map(|i| bootstrap.part(i, groups).mean)
        .collect();
    let weights = Weights::new(histories, weighing, boot);
    let total = weights.of(&|parts| parts.iter().sum());

    let check = |name: &str, p_value| Check::new(Family::Normalisation, name, p_value);
    let mut checks = Vec::new();
    if large.count > 1 {
        checks.push(check(
            "b of bootstrap and large steps",
            welch(&beginning, &large),
        ));
    }
    if plain.len() > 1 {
        checks.push(check(
            "b of bootstrap and plain sampling",
            welch(&boot_groups, &plain_total),
        ));
        checks.push(check(
            "b of weights and plain sampling",
            total.differs_from(&plain_total),
        ));
        let tile = |i: usize| {
            let plain: Moments = plain.iter().map(|tiles| tiles[i]).collect();
            weights.of(&|parts| parts[i]).differs_from(&plain)
        };
        let tiles: Vec<f64> = (0..TILES * TILES).map(tile).collect();
        let least = holm(&tiles).into_iter().fold(1.0, f64::min);
        checks.push(check("weights and plain sampling, tile by tile", least));
    }
    let estimate = |name, moments: &Moments| Estimate {
        name,
        value: moments.mean,
        standard_error: moments.standard_error(),
    };
    let mut estimates = vec![
        estimate("bootstrap", boot),
        estimate("large steps", &large),
        estimate("plain sampling", &plain_total),
    ];
    estimates.push(Estimate {
        name: "weights",
        value: total.value,
        standard_error: total.standard_error,
    });
    (Normalisation { estimates }, checks)
}

/// Estimates by the weights of chains in equilibrium: b/b_0 times the chain part, plus the large-step
/// part.
struct Weights<'a> {
    units: Vec<&'a [History]>,
    chains: f64,
    b_0: f64,
    b: &'a Moments,
}

struct Weighted {
    value: f64,
    standard_error: f64,
}

impl<'a> Weights<'a> {
    fn new(histories: &'a [History], weighing: Weighing, b: &'a Moments) -> Self {
        Self {
            units: histories.chunk_by(|a, b| a.sample == b.sample).collect(),
            chains: histories.len() as f64,
            b_0: weighing.b,
            b,
        }
    }

    /// The estimate of what `value` takes from the tiles, and its standard error: that of the sum over
    /// independent units, and that of b.
    fn of(&self, value: &dyn Fn(&[f64]) -> f64) -> Weighted {
        let refinement = self.b.mean / self.b_0;
        let (mut sum, mut chain_sum) = (0.0, 0.0);
        let per_unit: Vec<(f64, f64)> = self
            .units
            .iter()
            .map(|unit| {
                let part = |i: usize| unit.iter().map(|h| value(&h.tiles[i])).sum::<f64>();
                let chain = part(0);
                chain_sum += chain;
                let total = refinement * chain + part(1);
                sum += total;
                (total, unit.len() as f64)
            })
            .collect();
        let mean = sum / self.chains;
        let squares: f64 = per_unit.iter().map(|(t, n)| (t - n * mean).powi(2)).sum();
        let units = self.units.len() as f64;
        let of_units = squares * units / (units - 1.0) / (self.chains * self.chains);
        let of_b = (chain_sum / self.chains / self.b_0 * self.b.standard_error()).powi(2);
        Weighted {
            value: mean,
            standard_error: (of_units + of_b).sqrt(),
        }
    }
}

impl Weighted {
    /// p-value of the hypothesis that `plain` has the same mean. 1 where neither varies.
    fn differs_from(&self, plain: &Moments) -> f64 {
        let error = self.standard_error.hypot(plain.standard_error());
        if error > 0.0 && error.is_finite() {
            normal_two_sided((self.value - plain.mean) / error)
        } else {
            1.0
        }
    }
}
