//! The tests of chains, tested: on targets whose distribution is known, without a fault and with each
//! of many.

mod null;
mod power;
mod targets;

use super::equilibrium::{Equilibrium, equilibrium};
use super::{Check, Effort};
use crate::markov::BootstrapLimits;
use crate::render::Unobserved;
use targets::Analytic;

/// An effort for quick runs: `chains` chains, 2^`bootstrap` samples for b, and so few permutations that
/// corrected p-values of the maximum mean discrepancy stay above 1/40.
fn effort(seed: u64, chains: usize, bootstrap: u32) -> Effort {
    let samples = 1 << bootstrap;
    Effort {
        seed,
        large_step_probability: 0.3,
        chains,
        coordinates: ["x", "y", "z", "nothing"],
        bootstrap: BootstrapLimits {
            at_least: samples,
            at_most: samples,
            relative_error: 0.0,
        },
        permutations: 2000,
        ..Effort::default()
    }
}

fn run(target: Analytic, effort: &Effort) -> Equilibrium {
    equilibrium(&target, effort, &Unobserved).expect("a target with light")
}

fn checks(target: Analytic, effort: &Effort) -> Vec<Check> {
    run(target, effort).checks
}
