//! One Markov chain, and the weights of what it visits.
//!
//! Kelemen et al. (2002, section 4) give a proposal v the weight (a + L) / (I(v)/b + p) and the
//! current state u the weight (1 - a) / (I(u)/b + p), where a is the acceptance probability, L is 1
//! for a large step and p the probability of one: a balance heuristic between the chain, whose
//! density is I/b, and the large steps, whose density is 1 and share p.
//!
//! The two parts of the numerator are kept apart here: a and 1 - a estimate integrals against I/b,
//! L those against 1. So whoever sums them can use one b in the denominator, which then is just a
//! fixed positive function, and a better b, known later, as the factor of the first part.

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{LazyPoint, Steps, Target};
use crate::fault::{Fault, planted};
use crate::sampling::{Coordinates, FreshCoordinates, Stream};
use crate::statistics::Moments;

/// How often a sample counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Weights {
    /// Expected visits of the chain: sums of a and of 1 - a.
    pub chain: f64,
    /// 1 if the sample was proposed by a large step.
    pub large: f64,
}

/// A point that the chain proposed, without its coordinates.
#[derive(Clone, Debug, Default)]
pub struct Sample<T> {
    /// I(u).
    pub density: f64,
    /// What the target gave.
    pub contribution: T,
    /// How often it counts so far.
    pub weights: Weights,
}

/// What happened to a chain.
#[derive(Clone, Debug, Default)]
pub struct ChainCounters {
    /// Large steps proposed and accepted.
    pub large: [u64; 2],
    /// Small steps proposed and accepted.
    pub small: [u64; 2],
    /// Longest run of rejections.
    pub longest_rejection_run: u64,
    /// Proposals whose density was not finite.
    pub non_finite: u64,
    /// The steps, counted from 1, that proposed the first of them.
    pub non_finite_steps: Vec<u64>,
    /// Densities met by large steps: independent uniform samples of I, whose mean is b.
    pub large_densities: Moments,
}

impl ChainCounters {
    /// Most steps in `non_finite_steps`.
    const MOST_STEPS: usize = 16;

    /// Steps made.
    pub fn steps(&self) -> u64 {
        self.large[0] + self.small[0]
    }

    /// Steps that were accepted.
    pub fn accepted(&self) -> u64 {
        self.large[1] + self.small[1]
    }

    /// Adds what happened to another chain, but for its `non_finite_steps`, which mean nothing
    /// outside of that chain.
    pub fn merge(&mut self, other: &Self) {
        for i in 0..2 {
            self.large[i] += other.large[i];
            self.small[i] += other.small[i];
        }
        self.longest_rejection_run = self.longest_rejection_run.max(other.longest_rejection_run);
        self.non_finite += other.non_finite;
        self.large_densities = self.large_densities.merge(&other.large_densities);
    }
}

/// A chain with its own stream of random numbers.
pub struct Chain<T> {
    point: LazyPoint,
    large_step_probability: f32,
    current: Sample<T>,
    proposal: Sample<T>,
    rejection_run: u64,
    /// What happened so far.
    pub counters: ChainCounters,
}

/// Coordinates of a point found elsewhere, set into a lazy point as they are read.
pub struct Recording<'a, C> {
    source: C,
    point: &'a mut LazyPoint,
}

impl<'a, C: Coordinates> Recording<'a, C> {
    /// Coordinates of `source`, set into `point`.
    pub fn new(source: C, point: &'a mut LazyPoint) -> Self {
        Self { source, point }
    }
}

impl<C: Coordinates> Coordinates for Recording<'_, C> {
    fn read<const N: usize>(&mut self, stream: Stream, first: usize) -> [f32; N] {
        let values = self.source.read::<N>(stream, first);
        self.point.set(stream, first, &values);
        values
    }
}

impl<T: Default> Chain<T> {
    /// A chain that starts at the point which `start` generates: that of a bootstrap sample. All
    /// further numbers come from `rng`, so two chains with one start go separate ways.
    pub fn start<G: Target<Contribution = T>>(
        target: &mut G,
        start: Xoshiro256PlusPlus,
        rng: Xoshiro256PlusPlus,
        large_step_probability: f32,
        steps: impl Into<Steps>,
    ) -> Self {
        let mut point = LazyPoint::new(rng, steps);
        let mut current = Sample::default();
        let mut recording = Recording::new(FreshCoordinates::new(start), &mut point);
        current.density = target.evaluate(&mut recording, &mut current.contribution);
        Self::at(point, current, large_step_probability)
    }

    /// A chain that starts at `point`, whose coordinates have been set as far as the target reads them.
    pub fn start_at<G: Target<Contribution = T>>(
        target: &mut G,
        mut point: LazyPoint,
        large_step_probability: f32,
    ) -> Self {
        let mut current = Sample::default();
        current.density = target.evaluate(&mut point, &mut current.contribution);
        Self::at(point, current, large_step_probability)
    }

    fn at(point: LazyPoint, current: Sample<T>, large_step_probability: f32) -> Self {
        Self {
            point,
            large_step_probability,
            current,
            proposal: Sample::default(),
            rejection_run: 0,
            counters: ChainCounters::default(),
        }
    }

    /// The state, with the weight it has gathered since it became the state.
    pub fn current(&self) -> &Sample<T> {
        &self.current
    }

    /// Takes the weight that the state has gathered, at the end of a run: what is gathered after
    /// that starts from 0.
    pub fn take_weights(&mut self) -> Weights {
        std::mem::take(&mut self.current.weights)
    }

    /// One mutation. Returns the sample that will gather no more weight: the old state if the
    /// proposal was accepted, else the proposal.
    #[inline]
    pub fn step<G: Target<Contribution = T>>(&mut self, target: &mut G) -> &Sample<T> {
        let large = self.point.rng().random::<f32>() < self.large_step_probability;
        self.point.propose(large);
        let density = target.evaluate(&mut self.point, &mut self.proposal.contribution);
        let mut acceptance = self.acceptance(density);
        if planted(Fault::ForcedAcceptance) && self.rejection_run >= 8 && density > 0.0 {
            acceptance = 1.0;
        }
        self.proposal.density = density;
        self.proposal.weights = Weights {
            chain: acceptance,
            large: f64::from(u8::from(large)),
        };
        self.current.weights.chain += 1.0 - acceptance;
        let accepted = self.point.rng().random::<f64>() < acceptance;
        self.count(large, accepted, density);
        if accepted {
            self.point.accept();
            std::mem::swap(&mut self.current, &mut self.proposal);
        } else {
            self.point.reject();
        }
        &self.proposal
    }

    /// a = min(1, I(v) / I(u)); a proposal without a finite density is never accepted, and any
    /// other is, if the chain stands where there is no light.
    fn acceptance(&self, proposed: f64) -> f64 {
        if !proposed.is_finite() {
            0.0
        } else if self.current.density > 0.0 {
            let mut ratio = proposed / self.current.density;
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

    fn count(&mut self, large: bool, accepted: bool, density: f64) {
        let counters = &mut self.counters;
        let kind = if large {
            &mut counters.large
        } else {
            &mut counters.small
        };
        kind[0] += 1;
        kind[1] += u64::from(accepted);
        if !density.is_finite() {
            counters.non_finite += 1;
            if counters.non_finite_steps.len() < ChainCounters::MOST_STEPS {
                counters.non_finite_steps.push(counters.steps());
            }
        }
        if large {
            counters
                .large_densities
                .add(if density.is_finite() { density } else { 0.0 });
        }
        self.rejection_run = if accepted { 0 } else { self.rejection_run + 1 };
        counters.longest_rejection_run = counters.longest_rejection_run.max(self.rejection_run);
    }
}
