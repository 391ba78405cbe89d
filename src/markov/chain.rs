//! A Markov chain and the weights of its samples.
//!
//! Kelemen et al. (2002, section 4) give a proposal v the weight (a + L) / (I(v)/b + p) and the
//! current state u the weight (1 - a) / (I(u)/b + p), where a is the acceptance probability, L is 1
//! for a large step and p the probability of one: a balance heuristic between the chain, whose
//! density is I/b, and the large steps, whose density is 1 and share p.
//!
//! The two parts of the numerator are kept separate here: a and 1 - a estimate integrals against the
//! density I/b, L estimates integrals against the density 1. So a sum of them may use a fixed b_0 in the
//! denominator, which is then a fixed positive function, and apply a better b, known later, as a factor of
//! the first part.

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{Mutations, PrimarySample, Target};
use crate::fault::{Fault, planted};
use crate::sampling::Sampler;
use crate::statistics::Moments;

/// Weights of a sample in the numerator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Weights {
    /// Expected visits of the chain: sums of a and of 1 - a.
    pub chain: f64,
    /// 1 if the sample was proposed by a large step.
    pub large: f64,
}

/// A point that the chain proposed. Its coordinates are not stored.
#[derive(Clone, Debug, Default)]
pub struct Sample<T> {
    /// I(u).
    pub density: f64,
    /// The contribution that the target returned.
    pub contribution: T,
    /// Weights accumulated so far.
    pub weights: Weights,
}

/// Numbers of proposals of one kind of mutation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MutationCounters {
    /// The kind.
    pub name: &'static str,
    /// Proposals.
    pub proposed: u64,
    /// Accepted proposals.
    pub accepted: u64,
}

/// Counters of a chain.
#[derive(Clone, Debug, Default)]
pub struct ChainCounters {
    /// By kind of mutation, in the order of the chain's list.
    pub mutations: Vec<MutationCounters>,
    /// Longest run of rejections.
    pub longest_rejection_run: u64,
    /// Proposals whose density was not finite.
    pub non_finite: u64,
    /// The steps, counted from 1, of the first such proposals.
    pub non_finite_steps: Vec<u64>,
    /// Densities of the proposals of large steps: independent uniform samples of I, whose mean is b.
    pub large_densities: Moments,
}

impl ChainCounters {
    /// Maximum length of `non_finite_steps`.
    const MAX_STEPS: usize = 16;

    fn new(mutations: &Mutations) -> Self {
        let counters = |name| MutationCounters {
            name,
            proposed: 0,
            accepted: 0,
        };
        Self {
            mutations: mutations.names().map(counters).collect(),
            ..Self::default()
        }
    }

    /// Steps made.
    pub fn steps(&self) -> u64 {
        self.mutations.iter().map(|kind| kind.proposed).sum()
    }

    /// Steps that were accepted.
    pub fn accepted(&self) -> u64 {
        self.mutations.iter().map(|kind| kind.accepted).sum()
    }

    /// Adds the counters of another chain with the same kinds of mutations, except its `non_finite_steps`,
    /// which refer to that chain.
    pub fn merge(&mut self, other: &Self) {
        if self.mutations.is_empty() {
            self.mutations.clone_from(&other.mutations);
        } else {
            for (kind, more) in self.mutations.iter_mut().zip(&other.mutations) {
                kind.proposed += more.proposed;
                kind.accepted += more.accepted;
            }
        }
        self.longest_rejection_run = self.longest_rejection_run.max(other.longest_rejection_run);
        self.non_finite += other.non_finite;
        self.large_densities = self.large_densities.merge(&other.large_densities);
    }
}

/// One step of a chain.
pub struct Step<'a, T> {
    /// Number of the kind of mutation that was proposed.
    pub kind: usize,
    /// True if the proposal became the state.
    pub accepted: bool,
    /// The sample whose accumulated weight is final: the old state if the proposal was accepted, else the
    /// proposal.
    pub sample: &'a Sample<T>,
}

/// A chain with its own stream of random numbers.
pub struct Chain<T> {
    /// Coordinates of the current state, and of the proposal while one is open.
    state: PrimarySample,
    /// Density, contribution and weights of the current state.
    current: Sample<T>,
    /// The same of the last proposal; after a step, of the sample whose weight is final.
    proposal: Sample<T>,
    /// Number of rejections since the last acceptance.
    rejection_run: u64,
    /// Counters so far.
    pub counters: ChainCounters,
}

impl<T: Default> Chain<T> {
    /// A chain that starts at the sample `start`. All other random numbers come from `rng`, so that two
    /// chains with the same start differ.
    pub fn start<G: Target<Contribution = T>>(
        target: &mut G,
        start: impl Sampler,
        rng: Xoshiro256PlusPlus,
        mutations: Mutations,
    ) -> Self {
        let counters = ChainCounters::new(&mutations);
        let mut state = PrimarySample::new(rng, mutations);
        let mut current = Sample::default();
        let mut start = state.starting_at(start);
        current.density = target.evaluate(&mut start, &mut current.contribution);
        Self {
            state,
            current,
            proposal: Sample::default(),
            rejection_run: 0,
            counters,
        }
    }

    /// The current state, with the weight accumulated since it was accepted.
    pub fn current(&self) -> &Sample<T> {
        &self.current
    }

    /// Returns the accumulated weight of the current state and resets it to 0.
    pub fn take_weights(&mut self) -> Weights {
        std::mem::take(&mut self.current.weights)
    }

    /// Gives the current state the weight that [`Self::take_weights`] has returned.
    pub fn put_weights(&mut self, weights: Weights) {
        self.current.weights = weights;
    }

    /// The kinds of mutations.
    pub fn mutations(&self) -> &Mutations {
        self.state.mutations()
    }

    /// Makes one mutation.
    #[inline]
    pub fn step<G: Target<Contribution = T>>(&mut self, target: &mut G) -> Step<'_, T> {
        // Propose.
        let kind = self.state.propose();
        let density = target.evaluate(&mut self.state, &mut self.proposal.contribution);

        // Weight both by the acceptance probability.
        let mut acceptance = self.acceptance(density);
        if planted(Fault::ForcedAcceptance) && self.rejection_run >= 8 && density > 0.0 {
            acceptance = 1.0;
        }
        let large = self.state.mutations().kind(kind).is_large_step();
        self.proposal.density = density;
        self.proposal.weights = Weights {
            chain: acceptance,
            large: f64::from(u8::from(large)),
        };
        self.current.weights.chain += 1.0 - acceptance;

        // Accept or reject.
        let accepted = self.state.rng().random::<f64>() < acceptance;
        self.count(kind, accepted, density);
        if accepted {
            self.state.accept();
            std::mem::swap(&mut self.current, &mut self.proposal);
        } else {
            self.state.reject();
        }
        Step {
            kind,
            accepted,
            sample: &self.proposal,
        }
    }

    /// a = min(1, I(v) q(v -> u) / (I(u) q(u -> v))) (Hastings 1970). A proposal without a finite density
    /// is never accepted; any other is accepted if the density of the state is 0.
    #[inline]
    fn acceptance(&self, proposed: f64) -> f64 {
        if !proposed.is_finite() {
            0.0
        } else if self.current.density > 0.0 {
            let mut ratio = proposed / self.current.density;
            let log_density_ratio = self.state.log_density_ratio();
            if log_density_ratio != 0.0 && ratio > 0.0 {
                ratio *= log_density_ratio.exp();
            }
            if planted(Fault::InvertedRatio) {
                ratio = 1.0 / ratio;
            }
            if planted(Fault::UnclippedWeights) {
                return ratio;
            }
            ratio.min(1.0)
        } else {
            1.0
        }
    }

    #[inline]
    fn count(&mut self, kind: usize, accepted: bool, density: f64) {
        let counters = &mut self.counters;
        let mutation = &mut counters.mutations[kind];
        mutation.proposed += 1;
        mutation.accepted += u64::from(accepted);
        if !density.is_finite() {
            counters.non_finite += 1;
            if counters.non_finite_steps.len() < ChainCounters::MAX_STEPS {
                counters.non_finite_steps.push(counters.steps());
            }
        }
        if self.state.mutations().kind(kind).is_large_step() {
            counters
                .large_densities
                .add(if density.is_finite() { density } else { 0.0 });
        }
        self.rejection_run = if accepted { 0 } else { self.rejection_run + 1 };
        counters.longest_rejection_run = counters.longest_rejection_run.max(self.rejection_run);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::markov::bootstrap;
    use crate::markov::mutation::{LargeStep, Mutation};
    use crate::sampling::{Dimension, Sampler, Stream, seeds};

    /// A uniform coordinate.
    struct Uniform;

    impl Target for Uniform {
        type Contribution = f32;

        fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut f32) -> f64 {
            [*out] = sampler.get(Dimension::new(Stream::Camera, 0));
            1.0
        }
    }

    /// Null hypothesis: with an asymmetric kind the coordinate stays uniform, so that its mean square is
    /// 1/3. The standard error is about 0.002. If the ratio of the proposal densities is left out, the mean
    /// square is 0.45.
    #[test]
    fn the_ratio_of_proposal_densities_keeps_the_target() {
        let kinds = [(0.3, Mutation::LargeStep(LargeStep)), (0.7, Mutation::Ramp)];
        let rng = seeds::generator(1, seeds::Purpose::Chains, 0);
        let start = bootstrap::sample(1, 0);
        let mut chain = Chain::start(&mut Uniform, start, rng, Mutations::new(kinds));
        let (mut sum, steps) = (0.0, 200_000);
        for _ in 0..steps {
            chain.step(&mut Uniform);
            sum += f64::from(chain.current().contribution).powi(2);
        }
        let mean = sum / f64::from(steps);
        assert!((mean - 1.0 / 3.0).abs() < 0.01, "{mean}");
    }
}
