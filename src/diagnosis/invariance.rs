//! Invariance: chains that start in the target distribution have it after any number of steps.

use rand_xoshiro::Xoshiro256PlusPlus;

use super::DiagnosisBudget;
use super::check::{Check, Family};
use super::history::{CHECKPOINTS, History};
use super::observation::{Features, Quantity};
use crate::statistics::{
    chi_square_two_sample, kolmogorov_smirnov, kolmogorov_smirnov_randomized, mmd_permutation,
    spearman, stuart_maxwell,
};

/// Points of each sample that the maximum mean discrepancy compares.
const MMD_POINTS: usize = 256;

/// Compares `reference` states, drawn exactly from the target, with the states of `histories` at each
/// checkpoint, one per chain. Also compares the states at each checkpoint with the starts of the same
/// chains.
pub fn invariance(
    reference: &[Features],
    histories: &[History],
    budget: &DiagnosisBudget,
    rng: &mut Xoshiro256PlusPlus,
) -> Vec<Check> {
    let (coordinates, permutations) = (budget.coordinates, budget.permutations);
    let mut checks = Vec::new();
    for (checkpoint, steps) in CHECKPOINTS.into_iter().enumerate() {
        let states: Vec<Features> = histories.iter().map(|h| h.states[checkpoint]).collect();
        let mut check = |test: &str, p_value| {
            let name = format!("{test} after {}", count_steps(steps));
            checks.push(Check::new(Family::Invariance, name, p_value));
        };
        check(
            "chi-square of tile x technique",
            chi_square_two_sample(&cells(reference), &cells(&states)),
        );
        check(
            "Stuart-Maxwell of tile x technique",
            stuart_maxwell(&changes(histories, checkpoint)).p_value,
        );
        let compare = |value: &dyn Fn(&Features) -> f64| {
            [reference, &states].map(|sample| sample.iter().map(value).collect::<Vec<f64>>())
        };
        let [a, b] = compare(&|f| f.log_density);
        check("Kolmogorov-Smirnov of log I", kolmogorov_smirnov(&a, &b));
        let [a, b] = compare(&|f| f.length);
        let p = kolmogorov_smirnov_randomized(&a, &b, rng);
        check("Kolmogorov-Smirnov of path length", p);
        for (i, name) in coordinates.iter().enumerate() {
            let [a, b] = compare(&|f| f.coordinates[i]);
            let p = kolmogorov_smirnov_randomized(&a, &b, rng);
            check(&format!("Kolmogorov-Smirnov of {name}"), p);
        }
        let [a, b] = points(reference, &states);
        let p = mmd_permutation(&a, &b, permutations, rng);
        check("maximum mean discrepancy", p);
    }
    checks
}

/// Null hypothesis: neighbouring chains are independent. Chains with the same start are excluded.
pub fn independence(histories: &[History]) -> Vec<Check> {
    let last = CHECKPOINTS.len() - 1;
    let neighbours: Vec<[&Features; 2]> = histories
        .chunks_exact(2)
        .filter(|pair| pair[0].sample != pair[1].sample)
        .map(|pair| [&pair[0].states[last], &pair[1].states[last]])
        .collect();
    let check = |quantity: Quantity| {
        let [a, b] = [0, 1].map(|i| {
            let values = neighbours.iter().map(|pair| quantity.of(pair[i]));
            values.collect::<Vec<f64>>()
        });
        let name = format!("rank correlation of neighbours' {}", quantity.name());
        Check::new(Family::Independence, name, spearman(&a, &b))
    };
    Quantity::ALL.map(check).into()
}

/// `1 step`, `8 steps`.
pub(super) fn count_steps(steps: u64) -> String {
    format!("{steps} step{}", if steps == 1 { "" } else { "s" })
}

fn cells(states: &[Features]) -> Vec<u64> {
    let mut counts = vec![0; Features::CELLS];
    states.iter().for_each(|state| counts[state.cell()] += 1);
    counts
}

/// Per cluster, the cells that its chains have left (-1) and entered (1).
fn changes(histories: &[History], checkpoint: usize) -> Vec<Vec<(usize, f64)>> {
    let clusters = histories.chunk_by(|a, b| a.sample == b.sample);
    let change = |h: &History| [(h.start.cell(), -1.0), (h.states[checkpoint].cell(), 1.0)];
    clusters
        .map(|cluster| cluster.iter().flat_map(change).collect())
        .collect()
}

/// Film position, log I and length, scaled to a spread of about 1. Log I and length are divided by their
/// standard deviations over the reference states.
fn points(reference: &[Features], states: &[Features]) -> [Vec<[f64; 4]>; 2] {
    let scale = |value: &dyn Fn(&Features) -> f64| {
        let moments: crate::statistics::Moments = reference.iter().map(value).collect();
        moments.variance().sqrt().max(1e-9)
    };
    let [density, length] = [scale(&|f| f.log_density), scale(&|f| f.length)];
    [reference, states].map(|sample| {
        let stride = sample.len().div_ceil(MMD_POINTS).max(1);
        let point = |f: &Features| {
            let [x, y] = [f.coordinates[0], f.coordinates[1]].map(|u| 4.0 * u);
            [x, y, f.log_density / density, f.length / length]
        };
        sample.iter().step_by(stride).map(point).collect()
    })
}
