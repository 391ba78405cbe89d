//! Without a fault, p-values are uniform and the false-alarm rate is at most the level.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::{Analytic, budget, checks, run};
use crate::statistics::{clopper_pearson, distance_from_uniform};

/// Number of runs, over all targets together.
const RUNS: u64 = 1000;

/// Chains of a run: enough for the asymptotic approximations of the tests.
const CHAINS: usize = 400;

/// Tests whose p-values are uniform even for few chains and on targets where other tests have counts of
/// nearly 0.
const UNIFORM: [&str; 6] = [
    "b of",
    "rank of the start",
    "rank correlation of neighbours' log I",
    "rank correlation of neighbours' film x",
    "chi-square",
    "Stuart-Maxwell of tile x technique after 512",
];

/// Null hypothesis: chains are correct. Over 1000 runs, 200 of each target, the p-values of every test are
/// uniform, or larger if counts are small, and at most 5% of the runs have a corrected p-value below 5%
/// (1% below 1%). Kolmogorov's one-sided distance exceeds sqrt(ln(1/a) / 2n) with probability a: 10^-5
/// here, for each of 55 tests.
#[test]
fn p_values_are_uniform_and_false_alarms_rare() {
    let runs: Vec<_> = (0..RUNS)
        .into_par_iter()
        .map(|seed| {
            let target = Analytic::ALL[seed as usize % Analytic::ALL.len()];
            checks(target, &budget(seed, CHAINS, 14))
        })
        .collect();
    let mut p_values: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for check in runs.iter().flatten() {
        p_values.entry(&check.name).or_default().push(check.p_value);
    }
    assert!(p_values.len() >= 55);
    let critical = (1e5f64.ln() / (2.0 * RUNS as f64)).sqrt();
    for (name, values) in &mut p_values {
        assert_eq!(values.len(), RUNS as usize, "{name}");
        let excess = excess_of_small(values);
        assert!(
            excess < critical,
            "{name}: small p-values too often, by {excess}"
        );
        if UNIFORM.iter().any(|start| name.starts_with(start)) {
            let distance = distance_from_uniform(values);
            assert!(distance < critical, "{name}: {distance} from uniform");
        }
    }
    for level in [0.05, 0.01] {
        let alarm = |run: &&Vec<super::Check>| run.iter().any(|check| check.adjusted < level);
        let alarms = runs.iter().filter(alarm).count() as u64;
        let [low, _] = clopper_pearson(alarms, RUNS, 0.9999);
        assert!(
            low <= level,
            "{alarms} false alarms in {RUNS} runs at {level}"
        );
    }
}

/// The largest amount by which the share of values below p exceeds p.
fn excess_of_small(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len() as f64;
    let excesses = values
        .iter()
        .enumerate()
        .map(|(i, &p)| (i + 1) as f64 / n - p);
    excesses.fold(0.0, f64::max)
}

/// Every estimate of b is within 5 standard errors of the integral of the target.
#[test]
fn estimates_of_b_are_the_integral() {
    for target in Analytic::ALL {
        let found = run(target, &budget(3, CHAINS, 16));
        assert_eq!(found.normalisation.estimates.len(), 4);
        for estimate in &found.normalisation.estimates {
            let error = estimate.value - target.b();
            assert!(
                error.abs() < 5.0 * estimate.standard_error,
                "{target:?}, {}: {} +- {}, not {}",
                estimate.name,
                estimate.value,
                estimate.standard_error,
                target.b()
            );
        }
    }
}

/// If the bootstrap has found the maximum of the target, starts are found by rejection sampling: almost no
/// two chains have the same start, and their states are independent.
#[test]
fn starts_are_independent() {
    for target in Analytic::ALL {
        let found = run(target, &budget(1, CHAINS, 14));
        let (starts, clusters) = (found.starts.starts.len(), found.starts.clusters());
        assert!(
            starts >= CHAINS && clusters as f64 > 0.98 * starts as f64,
            "{target:?}: {clusters}"
        );
    }
}
