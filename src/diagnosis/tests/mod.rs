//! Tests of the diagnosis itself: on targets whose distribution is known and on a scene, without a fault
//! and with each of many planted faults.

mod mmlt;
mod null;
mod power;
mod targets;

use super::equilibrium::{Equilibrium, equilibrium};
use super::{Check, DiagnosisBudget};
use crate::markov::BootstrapLimits;
use crate::render::Unobserved;
use targets::{Analytic, AnalyticChains};

/// A budget for quick runs: `chains` chains and 2^`bootstrap` samples for b. With so few permutations,
/// corrected p-values of the maximum mean discrepancy stay above 1/40.
fn budget(seed: u64, chains: usize, bootstrap: u32) -> DiagnosisBudget {
    let samples = 1 << bootstrap;
    DiagnosisBudget {
        seed,
        chains,
        coordinates: ["x", "y", "z", "nothing"],
        bootstrap: BootstrapLimits {
            at_least: samples,
            at_most: samples,
            relative_error: 0.0,
        },
        permutations: 2000,
        ..DiagnosisBudget::default()
    }
}

/// Chains with the default probability of large steps.
fn chains_of(target: Analytic) -> AnalyticChains {
    AnalyticChains {
        target,
        large_step_probability: 0.3,
    }
}

fn run(target: Analytic, budget: &DiagnosisBudget) -> Equilibrium {
    equilibrium(&chains_of(target), budget, &Unobserved).expect("a target with light")
}

fn checks(target: Analytic, budget: &DiagnosisBudget) -> Vec<Check> {
    run(target, budget).checks
}
