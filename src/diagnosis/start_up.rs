//! Start-up bias: chains that start from a small bootstrap are not exactly in equilibrium.
//!
//! The expectation over a start that is resampled from n uniform samples is that of a ratio of two means,
//! whose bias falls as 1/n (Owen 2013, "Monte Carlo theory, methods and examples", section 9.2). The bias
//! is measured here in log I of chains, each of which starts from its own bootstrap, at the start and after
//! some steps.

use rayon::prelude::*;
use serde::Serialize;

use super::observation::{ChainTarget, Features, Observation};
use crate::markov::{Chain, Target, bootstrap, systematic_resample};
use crate::sampling::seeds::{self, Purpose};
use crate::statistics::Moments;

/// Sizes of bootstraps. Each bootstrap starts one chain.
const SIZES: [u64; 4] = [16, 64, 256, 1024];

/// Number of bootstraps of each size.
const REPEATS: u64 = 512;

/// Numbers of steps after which the bias is measured.
const STEPS: [u64; 3] = [0, 8, 64];

/// The bias of log I, in standard deviations of log I in equilibrium.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StartUpBias {
    /// Bootstrap samples for each chain.
    pub samples_per_chain: u64,
    /// Number of bootstraps that found light, and so of chains.
    pub chains: u64,
    /// Number of steps, bias, and its standard error.
    pub after: Vec<(u64, f64, f64)>,
}

/// Measures the bias against `reference` states, drawn exactly from the target.
pub fn start_up_bias<S: ChainTarget>(
    chain_target: &S,
    reference: &[Features],
    seed: u64,
) -> Vec<StartUpBias> {
    let equilibrium: Moments = reference.iter().map(|f| f.log_density).collect();
    let deviation = equilibrium.variance().sqrt();
    let bias = |(part, &size): (u64, &u64)| {
        let seed = seeds::part(seed, part);
        let chains: Vec<[f64; STEPS.len()]> = (0..REPEATS)
            .into_par_iter()
            .filter_map(|chain| log_densities(chain_target, seed, [chain, size]))
            .collect();
        let after = STEPS.into_iter().enumerate().map(|(i, steps)| {
            let values: Moments = chains.iter().map(|chain| chain[i]).collect();
            let error = values.standard_error().hypot(equilibrium.standard_error());
            (
                steps,
                (values.mean - equilibrium.mean) / deviation,
                error / deviation,
            )
        });
        StartUpBias {
            samples_per_chain: size,
            chains: chains.len() as u64,
            after: after.collect(),
        }
    };
    (0..).zip(&SIZES).map(bias).collect()
}

/// log I of one chain after each of [`STEPS`]; `None` if its bootstrap found no light.
fn log_densities<S: ChainTarget>(
    chain_target: &S,
    seed: u64,
    [chain, size]: [u64; 2],
) -> Option<[f64; STEPS.len()]> {
    let mut target = chain_target.target();
    let mut out = Observation::default();
    let samples = chain * size..(chain + 1) * size;
    let densities: Vec<f64> = samples
        .map(|i| {
            let density = target.evaluate(&mut bootstrap::sample(seed, i), &mut out);
            if density.is_finite() { density } else { 0.0 }
        })
        .collect();
    let mut rng = seeds::generator(seed, Purpose::Tests, chain);
    let u = rand::RngExt::random(&mut rng);
    let start = *systematic_resample(&densities, 1, u).first()?;
    let start = bootstrap::sample(seed, chain * size + start as u64);
    let mut chain = Chain::start(&mut target, start, rng, chain_target.mutations());
    let mut made = 0;
    Some(STEPS.map(|steps| {
        for _ in made..steps {
            chain.step(&mut target);
        }
        made = steps;
        chain.current().density.ln()
    }))
}
