//! Mixing, measured on long chains that start like those of a render.

use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::history::History;
use super::observation::{ChainTarget, Features, Quantity, TILES};
use crate::markov::{Bootstrap, Chain, ChainCounters};
use crate::render::{MutationStatistics, PssmltSettings};
use crate::sampling::seeds;
use crate::statistics::{
    autocorrelation, bulk_ess, geweke_p_value, heidelberger_welch,
    integrated_autocorrelation_time_of_chains, nested_r_hat, r_hat, tail_ess,
};

/// Number of different starts of the long chains.
const STARTS: usize = 16;

/// Number of chains from each start.
const PER_START: usize = 4;

/// Number of chains whose traces are stored for a chart.
const TRACES: usize = 4;

/// The stored autocorrelation ends at the length of a chain divided by this number.
const LENGTH_OVER_LAG: usize = 8;

/// Level of Geweke's and of Heidelberger and Welch's tests.
const ALPHA: f64 = 0.05;

/// How well long chains mix.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Quality {
    /// Number of long chains.
    pub chains: usize,
    /// Steps of each.
    pub steps: u64,
    /// Number of different starts of these chains.
    pub starts: usize,
    /// Duration of all steps of these chains, in seconds.
    pub seconds: f64,
    /// Mixing of log I, of the film position and of the path length.
    pub quantities: Vec<Mixing>,
    /// Mixing of the indicator function of each tile, in rows from the top.
    pub tiles: Vec<TileMixing>,
    /// Statistics of each kind of mutation, over all chains.
    pub mutations: Vec<MutationStatistics>,
    /// Longest run of rejections of any chain.
    pub longest_rejection_run: u64,
    /// Share of perturbations accepted, by the tile of the state before; NaN where none was proposed.
    #[serde(skip)]
    pub acceptance_of_tiles: Vec<f64>,
    /// Number of different bootstrap samples among the starts of a render, and number of these starts; `None`
    /// if chains do not start from a bootstrap.
    pub distinct_starts: Option<[usize; 2]>,
    /// log I of some chains, step by step.
    #[serde(skip)]
    pub traces: Vec<Vec<f64>>,
    /// Mean autocorrelation of log I, from lag 0 on.
    #[serde(skip)]
    pub autocorrelation: Vec<f64>,
}

/// Mixing of one quantity.
#[derive(Clone, Debug, Serialize)]
pub struct Mixing {
    /// Name of the quantity.
    pub name: &'static str,
    /// Rank-normalised split R-hat.
    pub r_hat: f64,
    /// Nested R-hat: chains with the same start are one group.
    pub nested_r_hat: f64,
    /// Effective sample size of all chains, for the centre of the distribution.
    pub bulk_ess: f64,
    /// Effective sample size of all chains, for the tails of the distribution.
    pub tail_ess: f64,
    /// Effective samples per second: bulk ESS over the time of the steps.
    pub ess_per_second: f64,
    /// Integrated autocorrelation time: number of steps equivalent to one independent sample.
    pub autocorrelation_time: f64,
    /// Share of chains whose beginning differs from their end (Geweke 1992) at 5%.
    pub geweke_rejects: f64,
    /// Share of chains that Heidelberger and Welch's test accepts as stationary at 5%, possibly after
    /// discarding an initial part.
    pub heidelberger_welch_passes: f64,
}

/// Mixing of the indicator function of a tile.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TileMixing {
    /// Share of the states in the tile.
    pub share: f64,
    /// Rank-normalised split R-hat; NaN if no state or every state is in the tile.
    pub r_hat: f64,
    /// Effective sample size of all chains.
    pub ess: f64,
}

/// Runs long chains of `steps` steps that start like those of a render.
pub fn quality<S: ChainTarget>(
    chain_target: &S,
    bootstrap: &Bootstrap,
    histories: &[History],
    (steps, seed): (u64, u64),
) -> Quality {
    let begin = Instant::now();
    let starts = bootstrap.starts(STARTS);
    let generators = seeds::chain_generators(seed, starts.len() * PER_START);
    let runs: Vec<(Vec<Features>, ChainCounters)> = generators
        .into_par_iter()
        .enumerate()
        .map(|(i, generator)| {
            let mut target = chain_target.target();
            let start = bootstrap.sample(starts[i / PER_START]);
            let mut chain = Chain::start(&mut target, start, generator, chain_target.mutations());
            let states = (0..steps)
                .map(|_| {
                    chain.step(&mut target);
                    Features::of(chain.current())
                })
                .collect();
            (states, chain.counters)
        })
        .collect();
    let seconds = begin.elapsed().as_secs_f64();
    let mut counters = ChainCounters::default();
    runs.iter().for_each(|(_, chain)| counters.merge(chain));
    histories.iter().for_each(|h| counters.merge(&h.counters));

    let traces: Vec<&[Features]> = runs.iter().map(|(states, _)| &**states).collect();
    let log_densities = values(&traces, |f| Quantity::LogDensity.of(f));
    let mixing = |quantity: Quantity| {
        let chains = values(&traces, |f| quantity.of(f));
        Mixing::of(quantity.name(), &chains, seconds)
    };
    let lag = (steps as usize / LENGTH_OVER_LAG).max(1);
    Quality {
        chains: runs.len(),
        steps,
        starts: starts.len(),
        seconds,
        quantities: Quantity::ALL.into_iter().map(mixing).collect(),
        tiles: (0..TILES * TILES)
            .into_par_iter()
            .map(|tile| TileMixing::of(tile, &traces))
            .collect(),
        mutations: counters.mutations.iter().map(Into::into).collect(),
        longest_rejection_run: counters.longest_rejection_run,
        acceptance_of_tiles: acceptance_of_tiles(histories),
        distinct_starts: chain_target
            .starts_from_bootstrap()
            .then(|| distinct(bootstrap)),
        autocorrelation: mean_autocorrelation(&log_densities, lag),
        traces: log_densities
            .into_iter()
            .step_by(PER_START)
            .take(TRACES)
            .collect(),
    }
}

/// A scalar function of the states, chain by chain.
fn values(traces: &[&[Features]], value: impl Fn(&Features) -> f64) -> Vec<Vec<f64>> {
    traces
        .iter()
        .map(|states| states.iter().map(&value).collect())
        .collect()
}

/// Mean autocorrelation at lags from 0 to `lags`, over the chains for which it is finite.
fn mean_autocorrelation(chains: &[Vec<f64>], lags: usize) -> Vec<f64> {
    let all: Vec<Vec<f64>> = chains
        .iter()
        .map(|chain| autocorrelation(chain, lags))
        .collect();
    let mean = |lag: usize| {
        let known = all
            .iter()
            .filter_map(|a| a.get(lag))
            .filter(|v| v.is_finite());
        let moments: crate::statistics::Moments = known.copied().collect();
        moments.mean
    };
    (0..=lags).map(mean).collect()
}

/// Share of perturbations accepted, by tile.
fn acceptance_of_tiles(histories: &[History]) -> Vec<f64> {
    let rate = |tile: usize| {
        let counts = histories
            .iter()
            .map(|h| h.perturbations[tile].map(f64::from));
        let [proposed, accepted] = counts.fold([0.0; 2], |[p, a], [q, b]| [p + q, a + b]);
        accepted / proposed
    };
    (0..TILES * TILES).map(rate).collect()
}

/// Number of different starts of a render with the default number of chains, and number of its starts.
fn distinct(bootstrap: &Bootstrap) -> [usize; 2] {
    let mut starts = bootstrap.starts(PssmltSettings::default().chains as usize);
    let all = starts.len();
    starts.sort_unstable();
    starts.dedup();
    [starts.len(), all]
}

impl Mixing {
    fn of(name: &'static str, chains: &[Vec<f64>], seconds: f64) -> Self {
        let ess = bulk_ess(chains);
        let nested: Vec<Vec<Vec<f64>>> = chains.chunks(PER_START).map(<[_]>::to_vec).collect();
        let share = |holds: &dyn Fn(&[f64]) -> bool| {
            chains.iter().filter(|chain| holds(chain)).count() as f64 / chains.len() as f64
        };
        Self {
            name,
            r_hat: r_hat(chains),
            nested_r_hat: nested_r_hat(&nested),
            bulk_ess: ess,
            tail_ess: tail_ess(chains),
            ess_per_second: ess / seconds,
            autocorrelation_time: integrated_autocorrelation_time_of_chains(chains),
            geweke_rejects: share(&|chain| geweke_p_value(chain) < ALPHA),
            heidelberger_welch_passes: share(&|chain| {
                heidelberger_welch(chain, ALPHA).discarded.is_some()
            }),
        }
    }
}

impl TileMixing {
    fn of(tile: usize, traces: &[&[Features]]) -> Self {
        let inside = values(traces, |f| f64::from(u8::from(f.tile == tile)));
        let steps: usize = inside.iter().map(Vec::len).sum();
        Self {
            share: inside.iter().flatten().sum::<f64>() / steps as f64,
            r_hat: r_hat(&inside),
            ess: bulk_ess(&inside),
        }
    }
}
