//! The power of the tests: with a planted fault, some test rejects in at least 99% of the runs.

use std::collections::BTreeMap;

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use super::mmlt::mmlt_checks;
use super::{Analytic, AnalyticChains, Check, budget, equilibrium};
use crate::diagnosis::{TILES, tile_at};
use crate::fault::{self, Fault};
use crate::integrators::{
    BidirectionalPathTracer, LightTracer, PathSampler, PathTracer, SplatList, Workspace,
};
use crate::markov::{Mutations, Perturbation, PrimarySample, bootstrap};
use crate::math::luminance;
use crate::render::Unobserved;
use crate::sampling::{Dimension, Sampler, Stream, seeds};
use crate::scene::Scene;
use crate::statistics::{Moments, clopper_pearson, holm, kolmogorov_smirnov, welch};
use crate::technique::TechniqueSet;

/// Level of a run, for all its tests together.
const ALPHA: f64 = 1e-3;

/// Runs of each fault in the quick test.
const QUICK_RUNS: u64 = 6;

/// Runs of each fault in the long test. If all 300 reject, the power is above 0.99 at 95% confidence.
const LONG_RUNS: u64 = 300;

/// The experiment that must detect a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Experiment {
    /// Diagnosis of chains: the probability of a large step, the target, the number of chains, and n for
    /// 2^n samples for b.
    Chains(f32, Analytic, usize, u32),
    /// Comparison of the distributions of a coordinate with and without lazy update.
    LazySteps,
    /// Welch's test between the images of two path samplers, tile by tile, and the number of samples of
    /// each.
    Images([TechniqueSet; 2], u64),
    /// Diagnosis of the chains of `mmlt` in a scene.
    Mmlt,
}

const CASES: [(Fault, Experiment, &str); 19] = [
    (
        Fault::Clamped,
        Experiment::Chains(0.3, Analytic::Ramp, 1000, 14),
        "clamp instead of wrap",
    ),
    (
        Fault::Asymmetric,
        Experiment::Chains(0.3, Analytic::Ridge, 2000, 14),
        "asymmetric step",
    ),
    (
        Fault::NotRestored,
        Experiment::Chains(0.3, Analytic::Ridge, 1000, 14),
        "no restore on reject",
    ),
    (
        Fault::LazyStepTooFew,
        Experiment::LazySteps,
        "one lazy step too few",
    ),
    (
        Fault::InvertedRatio,
        Experiment::Chains(0.3, Analytic::Ridge, 1000, 14),
        "inverted ratio",
    ),
    (
        Fault::UnclippedWeights,
        Experiment::Chains(0.3, Analytic::Ridge, 1000, 14),
        "acceptance not clipped in the weights",
    ),
    (
        Fault::ForcedAcceptance,
        Experiment::Chains(0.9, Analytic::Peaks, 1000, 14),
        "forced acceptance after 8 rejections",
    ),
    (
        Fault::OtherLargeStepProbability,
        Experiment::Chains(0.3, Analytic::Sine, 1000, 16),
        "p_large in the weights 20% off",
    ),
    (
        Fault::TechniqueCountLeftOut,
        Experiment::Mmlt,
        "technique count left out of the multiplexed density",
    ),
    (
        Fault::SharedNumbers,
        Experiment::Chains(0.3, Analytic::Ridge, 1000, 14),
        "chains sharing random numbers",
    ),
    (
        Fault::NormalisationOff,
        Experiment::Chains(0.3, Analytic::Sine, 1000, 18),
        "b off by 1%",
    ),
    (
        Fault::AdjointLeftOut,
        Experiment::Images([TechniqueSet::Path, TechniqueSet::Light], 1 << 19),
        "adjoint factor left out",
    ),
    (
        Fault::WeightOff,
        Experiment::Images([TechniqueSet::Path, TechniqueSet::Bidirectional], 1 << 20),
        "a MIS weight 20% off",
    ),
    (
        Fault::TechniquesSkewed,
        Experiment::Mmlt,
        "mmlt: techniques not chosen uniformly",
    ),
    (
        Fault::OtherThreshold,
        Experiment::Mmlt,
        "mmlt: chains clamp at twice the threshold",
    ),
    (
        Fault::ResidualUnclamped,
        Experiment::Mmlt,
        "mmlt: the residual is the whole path",
    ),
    (
        Fault::ResampledUniformly,
        Experiment::Mmlt,
        "mmlt: starts not in proportion to the residual",
    ),
    (
        Fault::LengthShares,
        Experiment::Mmlt,
        "mmlt: long paths get more than their share",
    ),
    (
        Fault::ChainWeightOff,
        Experiment::Mmlt,
        "mmlt: the weight of the chains twice too large",
    ),
];

/// The smallest corrected p-value of a run, and its test.
fn smallest_p_value(experiment: Experiment, seed: u64) -> (f64, String) {
    match experiment {
        Experiment::Chains(large_step_probability, target, chains, bootstrap) => {
            let chains_of = AnalyticChains {
                target,
                large_step_probability,
            };
            let budget = budget(seed, chains, bootstrap);
            let found = equilibrium(&chains_of, &budget, &Unobserved);
            smallest_of(found.expect("a target with light").checks)
        }
        Experiment::Mmlt => smallest_of(mmlt_checks(seed)),
        Experiment::LazySteps => (
            lazy_steps(seed),
            "Kolmogorov-Smirnov of lazy and eager steps".into(),
        ),
        Experiment::Images(samplers, samples) => (
            images(seed, samplers, samples),
            "Welch, tile by tile, of two images".into(),
        ),
    }
}

fn smallest_of(checks: Vec<Check>) -> (f64, String) {
    let smallest = checks
        .into_iter()
        .min_by(|a, b| a.p_value.total_cmp(&b.p_value))
        .expect("some test");
    (smallest.adjusted, smallest.name)
}

/// The centre of the hypercube: every coordinate is 1/2.
struct Centre;

impl Sampler for Centre {
    fn get<const N: usize>(&mut self, _first: Dimension) -> [f32; N] {
        [0.5; N]
    }
}

/// p-value of the null hypothesis that lazy update does not change the distribution of a coordinate. 4000
/// coordinates that were not read for one step and then read are compared with 4000 explicit sequences of
/// two steps.
fn lazy_steps(seed: u64) -> f64 {
    const UNREAD: usize = 1;
    const SMALL: usize = 1;
    let step = Perturbation::default();
    let dimension = Dimension::new(Stream::Light, 0);
    let moved = |lazy: bool| -> Vec<f64> {
        let part = seeds::part(seed, u64::from(lazy));
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(part);
        let mut run = || {
            if !lazy {
                return (0..=UNREAD).fold(0.5, |v, _| step.apply(v, &mut rng));
            }
            rng.jump();
            let mut state = PrimarySample::new(rng.clone(), Mutations::kelemen(0.0, step));
            let [_] = state.starting_at(Centre).get(dimension);
            for _ in 0..UNREAD {
                state.propose_kind(SMALL);
                state.accept();
            }
            state.propose_kind(SMALL);
            let [value] = state.get(dimension);
            value
        };
        (0..4000).map(|_| f64::from(run())).collect()
    };
    kolmogorov_smirnov(&moved(true), &moved(false))
}

/// Smallest corrected p-value of Welch's tests between the tiles of the images of two path samplers. The
/// images show a floor that is lit indirectly, through a square with tilted shading normals.
fn images(seed: u64, samplers: [TechniqueSet; 2], samples: u64) -> f64 {
    let scene = adjoint_scene();
    let [a, b] = [0, 1].map(|i| {
        let seed = seeds::part(seed, i as u64);
        match samplers[i] {
            TechniqueSet::Path => tiles(&scene, PathTracer, seed, samples),
            TechniqueSet::Light => tiles(&scene, LightTracer, seed, samples),
            TechniqueSet::Bidirectional => tiles(&scene, BidirectionalPathTracer, seed, samples),
        }
    });
    let p_values: Vec<f64> = a.iter().zip(&b).map(|(a, b)| welch(a, b)).collect();
    holm(&p_values).into_iter().fold(1.0, f64::min)
}

fn adjoint_scene() -> Scene {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/adjoint.xml");
    let loaded = crate::mitsuba::load(&path, &[]).expect("a scene of the tests");
    let mut description = loaded.description;
    // The last shapes are the water and a lamp outside of it, which a path tracer seldom hits. Means of
    // rare and bright contributions are far from normally distributed, so that Welch's test would raise
    // false alarms.
    let lamp = description.shapes.pop();
    assert!(lamp.is_some_and(|shape| shape.emission.is_some()));
    let water = description.shapes.pop();
    assert!(water.is_some_and(|shape| shape.emission.is_none()));
    description.build().expect("a scene of the tests")
}

/// Moments of the light of each tile, over batches of uniform samples of the hypercube.
fn tiles(scene: &Scene, path_sampler: impl PathSampler, seed: u64, samples: u64) -> Vec<Moments> {
    const BATCHES: u64 = 64;
    let per_batch = samples / BATCHES;
    let mut moments = vec![Moments::default(); TILES * TILES];
    let (mut workspace, mut splats) = (Workspace::default(), SplatList::default());
    for batch in 0..BATCHES {
        let mut light = vec![0.0; TILES * TILES];
        for i in batch * per_batch..(batch + 1) * per_batch {
            let mut sampler = bootstrap::sample(seed, i);
            path_sampler.sample_splats(scene, &mut sampler, &mut workspace, &mut splats);
            for splat in splats.iter() {
                let tile = tile_at(splat.position.map(f64::from), [1.0; 2]);
                light[tile] += f64::from(luminance(splat.value));
            }
        }
        moments
            .iter_mut()
            .zip(light)
            .for_each(|(m, light)| m.add(light));
    }
    moments
}

/// Number of rejections in `runs` runs, in total and by the test with the smallest p-value.
fn rejections(
    fault: Option<Fault>,
    experiment: Experiment,
    runs: u64,
) -> (u64, BTreeMap<String, u64>) {
    let seeds: Vec<u64> = (0..runs).collect();
    let halves: Vec<Vec<(f64, String)>> = seeds
        .par_chunks(seeds.len().div_ceil(2))
        .map(|seeds| {
            fault::with(fault, || {
                seeds
                    .iter()
                    .map(|&seed| smallest_p_value(experiment, seed))
                    .collect()
            })
        })
        .collect();
    let mut tests = BTreeMap::new();
    for (p, name) in halves.into_iter().flatten() {
        if p < ALPHA {
            *tests.entry(name).or_insert(0) += 1;
        }
    }
    (tests.values().sum(), tests)
}

/// Makes `runs` runs with each fault and prints the table of docs/diagnostics.md. Returns, by the name of the
/// fault, the number of runs that reject and the lower end of the one-sided 95% interval of the power.
fn table(runs: u64) -> Vec<(&'static str, u64, f64)> {
    println!("| fault | found in | power, at 95% confidence | by, as a rule |");
    println!("| --- | --- | --- | --- |");
    let row = |(fault, experiment, name)| {
        let (found, tests) = rejections(Some(fault), experiment, runs);
        // The lower end of a two-sided interval of 90% is one-sided at 95%.
        let [power, _] = clopper_pearson(found, runs, 0.9);
        let most_frequent = tests.iter().max_by_key(|(_, count)| **count);
        let by = most_frequent.map_or("", |(test, _)| test);
        println!("| {name} | {found} of {runs} runs | above {power:.3} | {by} |");
        (name, found, power)
    };
    CASES.into_iter().map(row).collect()
}

#[test]
fn every_planted_fault_is_detected() {
    let mut missed = table(QUICK_RUNS);
    missed.retain(|&(_, found, _)| found < QUICK_RUNS);
    assert!(missed.is_empty(), "not found in every run: {missed:?}");
}

/// Null hypothesis: without a fault a run rejects with probability 0.001. One of 60 different runs rejects
/// with probability 0.06; the test fails if two or more reject, with probability 0.002.
#[test]
fn no_fault_is_detected_without_one() {
    let mut experiments: Vec<Experiment> = Vec::new();
    for (_, experiment, _) in CASES {
        if !experiments.contains(&experiment) {
            experiments.push(experiment);
        }
    }
    assert_eq!(experiments.len(), 10);
    let runs = experiments.into_iter();
    let found: Vec<u64> = runs.map(|e| rejections(None, e, QUICK_RUNS).0).collect();
    assert!(found.iter().sum::<u64>() <= 1, "{found:?}");
}

#[test]
#[ignore = "takes many minutes"]
fn every_planted_fault_is_detected_in_99_of_100_runs() {
    let mut weak = table(LONG_RUNS);
    weak.retain(|&(_, _, power)| power <= 0.99);
    assert!(weak.is_empty(), "power below 0.99: {weak:?}");
}
