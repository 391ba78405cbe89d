//! Chains that start in equilibrium, and the recorded states and steps of each.

use std::time::Instant;

use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use super::DiagnoseError;
use super::observation::{ChainTarget, Features, Observation, TILES};
use super::starts::{Start, Starts};
use crate::markov::{Chain, ChainCounters, KelemenWeights, Sample, Step, bootstrap};
use crate::render::Observer;
use crate::sampling::seeds;

/// Steps after which the states of the chains are compared.
pub const CHECKPOINTS: [u64; 4] = [1, 8, 64, 512];

/// One step of a chain.
#[derive(Clone, Copy, Debug)]
pub struct Transition {
    /// The state before.
    pub before: Features,
    /// The state after: the same if the proposal was rejected.
    pub after: Features,
    /// The kind of mutation that was proposed, in the order of the chain's list.
    pub kind: usize,
}

/// The history of one chain.
#[derive(Clone, Debug)]
pub struct History {
    /// Index of the uniform sample at which it started. Chains with the same sample are one cluster.
    pub sample: u64,
    /// The start.
    pub start: Features,
    /// The states after [`CHECKPOINTS`] steps.
    pub states: [Features; CHECKPOINTS.len()],
    /// The first and the last step.
    pub transitions: [Transition; 2],
    /// Estimates of integrals: the chain part, still to be multiplied by b/b_0, and the large-step
    /// part (see [`crate::markov::chain`]).
    pub integrals: [Integrals; 2],
    /// Counters of the chain.
    pub counters: ChainCounters,
    /// Perturbations (all mutations but large steps) proposed and accepted, by the tile of the state before.
    pub perturbations: Vec<[u32; 2]>,
}

/// Integrals over the hypercube, or estimates of them.
#[derive(Clone, Debug)]
pub struct Integrals {
    /// Integral of the light in each tile.
    pub light: Vec<f64>,
    /// Integral of the square of the light in each tile.
    pub squares: Vec<f64>,
    /// Integral of I squared.
    pub square: f64,
}

impl Integrals {
    fn zero() -> Self {
        Self {
            light: vec![0.0; TILES * TILES],
            squares: vec![0.0; TILES * TILES],
            square: 0.0,
        }
    }

    fn add(&mut self, sample: &Sample<Observation>, factor: f64) {
        for &(tile, light) in &sample.contribution.light {
            self.light[tile] += light * factor;
            self.squares[tile] += light * light * factor;
        }
        if factor > 0.0 {
            self.square += sample.density * sample.density * factor;
        }
    }

    fn scale(&mut self, factor: f64) {
        self.light.iter_mut().for_each(|v| *v *= factor);
        self.squares.iter_mut().for_each(|v| *v *= factor);
        self.square *= factor;
    }
}

/// Number of chains between two reports to the observer.
const BATCH: usize = 256;

/// Runs a chain from every start up to the last checkpoint.
///
/// # Errors
/// If the observer cancels.
pub fn run<S: ChainTarget>(
    chain_target: &S,
    starts: &Starts,
    seed: u64,
    weights: KelemenWeights,
    observer: &dyn Observer,
) -> Result<Vec<History>, DiagnoseError> {
    let count = starts.starts.len();
    let generators = seeds::chain_generators(seed, count);
    let begin = Instant::now();
    let mut histories = Vec::with_capacity(count);
    for (batch, generators) in starts.starts.chunks(BATCH).zip(generators.chunks(BATCH)) {
        if observer.interrupted() {
            return Err(DiagnoseError::Interrupted);
        }
        let done = histories.len() as f64 / count as f64;
        let left = begin.elapsed().as_secs_f64() * (1.0 / done - 1.0);
        observer.progress(done, (done > 0.0).then_some(left));
        let history = |(start, generator): (&Start, &Xoshiro256PlusPlus)| {
            let mut target = chain_target.target();
            let chain = Chain::start(
                &mut target,
                bootstrap::sample(starts.seed, start.sample),
                generator.clone(),
                chain_target.mutations(),
            );
            Recorder::new(chain, start.sample, weights).record(&mut target)
        };
        histories.par_extend(batch.par_iter().zip(generators).map(history));
    }
    Ok(histories)
}

/// A chain whose history is being recorded.
struct Recorder {
    chain: Chain<Observation>,
    weights: KelemenWeights,
    history: History,
}

impl Recorder {
    fn new(chain: Chain<Observation>, sample: u64, weights: KelemenWeights) -> Self {
        let start = Features::of(chain.current());
        let initial = Transition {
            before: start,
            after: start,
            kind: 0,
        };
        let history = History {
            sample,
            start,
            states: [start; CHECKPOINTS.len()],
            transitions: [initial; 2],
            integrals: [Integrals::zero(), Integrals::zero()],
            counters: ChainCounters::default(),
            perturbations: vec![[0; 2]; TILES * TILES],
        };
        Self {
            chain,
            weights,
            history,
        }
    }

    fn record<T>(mut self, target: &mut T) -> History
    where
        T: crate::markov::Target<Contribution = Observation>,
    {
        let last = CHECKPOINTS[CHECKPOINTS.len() - 1];
        for step in 1..=last {
            let before = Features::of(self.chain.current());
            let Step {
                kind,
                accepted,
                sample,
            } = self.chain.step(target);
            add(&mut self.history.integrals, &self.weights, sample);
            let after = || Features::of(self.chain.current());
            let recorded = [1, last].iter().position(|&s| s == step);
            if let Some(i) = recorded {
                self.history.transitions[i] = Transition {
                    before,
                    after: after(),
                    kind,
                };
            }
            if let Some(i) = CHECKPOINTS
                .iter()
                .position(|&checkpoint| checkpoint == step)
            {
                self.history.states[i] = after();
            }
            if !self.chain.mutations().kind(kind).is_large_step() {
                let [proposals, acceptances] = &mut self.history.perturbations[before.tile];
                *proposals += 1;
                *acceptances += u32::from(accepted);
            }
        }
        let weights = self.chain.take_weights();
        let mut current = self.chain.current().clone();
        current.weights = weights;
        add(&mut self.history.integrals, &self.weights, &current);
        let scale = 1.0 / last as f64;
        self.history
            .integrals
            .iter_mut()
            .for_each(|part| part.scale(scale));
        self.history.counters = self.chain.counters;
        self.history
    }
}

/// Adds a sample with its weights to the estimates.
fn add(integrals: &mut [Integrals; 2], weights: &KelemenWeights, sample: &Sample<Observation>) {
    for (part, factor) in integrals.iter_mut().zip(weights.factors(sample)) {
        part.add(sample, factor);
    }
}
