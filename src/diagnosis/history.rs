//! Chains that start in equilibrium, and what happens to them.

use std::time::Instant;

use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use super::DiagnoseError;
use super::observation::{Features, Observation, Subject, TILES};
use super::starts::{Start, Starts};
use crate::markov::bootstrap::sample_generator;
use crate::markov::{Chain, ChainCounters, Sample, Weighing};
use crate::render::Observer;
use crate::sampling::seeds;

/// Steps after which the chains are looked at.
pub const LOOKS: [u64; 4] = [1, 8, 64, 512];

/// One step of a chain.
#[derive(Clone, Copy, Debug)]
pub struct Transition {
    /// The state before.
    pub before: Features,
    /// The state after: the same if the proposal was rejected.
    pub after: Features,
    /// The proposal was a large step.
    pub large: bool,
}

/// What happened to one chain.
#[derive(Clone, Debug)]
pub struct History {
    /// The uniform sample that it started from: chains with one sample are one unit.
    pub sample: u64,
    /// The start.
    pub start: Features,
    /// The states after [`LOOKS`] steps.
    pub states: [Features; LOOKS.len()],
    /// The first and the last step.
    pub transitions: [Transition; 2],
    /// Estimates of integrals: the chain part, still to be multiplied by b/b_0, and the large-step
    /// part (see [`crate::markov::chain`]).
    pub integrals: [Integrals; 2],
    /// Counts of steps.
    pub counters: ChainCounters,
    /// Small steps proposed and accepted, by the tile of the state before.
    pub small_steps: Vec<[u32; 2]>,
}

/// Integrals over the hypercube, or estimates of them.
#[derive(Clone, Debug)]
pub struct Integrals {
    /// Of the light in each tile.
    pub light: Vec<f64>,
    /// Of its square.
    pub squares: Vec<f64>,
    /// Of I squared.
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

/// Chains that run between two looks at the observer.
const BATCH: usize = 256;

/// Runs a chain from every start for as many steps as the last look wants.
///
/// # Errors
/// If the observer stops it.
pub fn run<S: Subject>(
    subject: &S,
    starts: &Starts,
    seed: u64,
    weighing: Weighing,
    observer: &dyn Observer,
) -> Result<Vec<History>, DiagnoseError> {
    let all = starts.starts.len();
    let generators = seeds::chain_generators(seed, all);
    let begin = Instant::now();
    let mut histories = Vec::with_capacity(all);
    for (starts_of, generators) in starts.starts.chunks(BATCH).zip(generators.chunks(BATCH)) {
        if observer.interrupted() {
            return Err(DiagnoseError::Interrupted);
        }
        let done = histories.len() as f64 / all as f64;
        let left = begin.elapsed().as_secs_f64() * (1.0 / done - 1.0);
        observer.progress(done, (done > 0.0).then_some(left));
        let history = |(start, generator): (&Start, &Xoshiro256PlusPlus)| {
            let mut target = subject.target();
            let chain = Chain::start(
                &mut target,
                sample_generator(starts.seed, start.sample),
                generator.clone(),
                weighing.large_step_probability as f32,
                subject.small_step(),
            );
            Recorder::new(chain, start.sample, weighing).record(&mut target)
        };
        histories.par_extend(starts_of.par_iter().zip(generators).map(history));
    }
    Ok(histories)
}

/// A chain whose history is being written.
struct Recorder {
    chain: Chain<Observation>,
    weighing: Weighing,
    history: History,
}

impl Recorder {
    fn new(chain: Chain<Observation>, sample: u64, weighing: Weighing) -> Self {
        let start = Features::of(chain.current());
        let still = Transition {
            before: start,
            after: start,
            large: false,
        };
        let history = History {
            sample,
            start,
            states: [start; LOOKS.len()],
            transitions: [still; 2],
            integrals: [Integrals::zero(), Integrals::zero()],
            counters: ChainCounters::default(),
            small_steps: vec![[0; 2]; TILES * TILES],
        };
        Self {
            chain,
            weighing,
            history,
        }
    }

    fn record<T>(mut self, target: &mut T) -> History
    where
        T: crate::markov::Target<Contribution = Observation>,
    {
        let last = LOOKS[LOOKS.len() - 1];
        for step in 1..=last {
            let before = Features::of(self.chain.current());
            let [large, accepted] = self.step(target);
            let after = || Features::of(self.chain.current());
            let noted = [1, last].iter().position(|&s| s == step);
            if let Some(i) = noted {
                self.history.transitions[i] = Transition {
                    before,
                    after: after(),
                    large,
                };
            }
            if let Some(i) = LOOKS.iter().position(|&look| look == step) {
                self.history.states[i] = after();
            }
            if !large {
                let [proposals, acceptances] = &mut self.history.small_steps[before.tile];
                *proposals += 1;
                *acceptances += u32::from(accepted);
            }
        }
        let weights = self.chain.take_weights();
        let mut current = self.chain.current().clone();
        current.weights = weights;
        add(&mut self.history.integrals, &self.weighing, &current);
        let scale = 1.0 / last as f64;
        self.history
            .integrals
            .iter_mut()
            .for_each(|part| part.scale(scale));
        self.history.counters = self.chain.counters;
        self.history
    }

    /// One step. Returns whether it was large, and whether it was accepted.
    fn step<T>(&mut self, target: &mut T) -> [bool; 2]
    where
        T: crate::markov::Target<Contribution = Observation>,
    {
        let counts = |chain: &Chain<_>| [chain.counters.large[0], chain.counters.accepted()];
        let before = counts(&self.chain);
        let retired = self.chain.step(target);
        add(&mut self.history.integrals, &self.weighing, retired);
        let after = counts(&self.chain);
        [after[0] > before[0], after[1] > before[1]]
    }
}

/// Adds a sample with its weights to the estimates.
fn add(integrals: &mut [Integrals; 2], weighing: &Weighing, sample: &Sample<Observation>) {
    for (part, factor) in integrals.iter_mut().zip(weighing.factors(sample)) {
        part.add(sample, factor);
    }
}
