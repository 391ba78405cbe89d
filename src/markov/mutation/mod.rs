//! Mutations: the kinds of proposals of a chain, each in its own file.
//!
//! A kind proposes a value for each dimension and gives the log ratio of its proposal densities. A chain
//! chooses among a weighted list of kinds and counts the proposals and acceptances of each. A new kind
//! needs a file here and a variant of [`Mutation`], whose methods ask it.

pub mod large_step;
pub mod perturbation;
pub mod small_step;

use rand::Rng;
#[cfg(test)]
use rand::RngExt;

pub use large_step::LargeStep;
pub use perturbation::Perturbation;
pub use small_step::SmallStep;

use crate::sampling::Dimension;

/// The kinds of proposals.
#[derive(Clone, Debug, PartialEq)]
pub enum Mutation {
    /// Resamples all coordinates.
    LargeStep(LargeStep),
    /// Perturbs every coordinate.
    SmallStep(SmallStep),
    /// An asymmetric kind for tests: resamples all coordinates with density 2v.
    #[cfg(test)]
    Ramp,
}

impl Mutation {
    /// Its name in statistics.
    pub fn name(&self) -> &'static str {
        match self {
            Self::LargeStep(_) => LargeStep::NAME,
            Self::SmallStep(_) => SmallStep::NAME,
            #[cfg(test)]
            Self::Ramp => "ramp",
        }
    }

    /// The proposed value of a coordinate whose current value is `value`.
    #[inline]
    pub fn propose(&self, value: f32, dimension: Dimension, rng: &mut impl Rng) -> f32 {
        match self {
            Self::LargeStep(kind) => kind.propose(rng),
            Self::SmallStep(kind) => kind.propose(value, dimension, rng),
            #[cfg(test)]
            Self::Ramp => rng.random::<f32>().sqrt(),
        }
    }

    /// log q(v -> u) - log q(u -> v) of a coordinate that moves from `u` to `v`: 0 for a symmetric kind.
    /// A kind may be asymmetric only in dimensions that every path reads, because unread coordinates do
    /// not contribute to the ratio.
    #[inline]
    pub fn log_density_ratio(&self, u: f32, v: f32, dimension: Dimension) -> f64 {
        match self {
            Self::LargeStep(kind) => kind.log_density_ratio(),
            Self::SmallStep(kind) => kind.log_density_ratio(u, v, dimension),
            #[cfg(test)]
            Self::Ramp => f64::from(u).ln() - f64::from(v).ln(),
        }
    }

    /// True if proposals are uniform and do not depend on the state: Kelemen's large step.
    #[inline]
    pub fn is_large_step(&self) -> bool {
        matches!(self, Self::LargeStep(_))
    }

    /// Number of accepted proposals of this kind after which a coordinate is uniform on the circle to
    /// 1e-12.
    pub fn steps_to_uniform(&self, dimension: Dimension) -> u64 {
        match self {
            Self::LargeStep(_) => 1,
            Self::SmallStep(kind) => kind.perturbation(dimension).steps_to_uniform(),
            // The test reads its coordinate in every step.
            #[cfg(test)]
            Self::Ramp => u64::MAX,
        }
    }
}

/// The kinds of a chain, with the probabilities of choosing them.
#[derive(Clone, Debug, PartialEq)]
pub struct Mutations {
    /// Probability and kind; the probabilities sum to 1.
    kinds: Vec<(f32, Mutation)>,
}

impl Mutations {
    /// Kinds in proportion to their weights, which are not negative and not all 0.
    pub fn new(weighted: impl IntoIterator<Item = (f32, Mutation)>) -> Self {
        let mut kinds: Vec<(f32, Mutation)> = weighted.into_iter().collect();
        let total: f32 = kinds.iter().map(|(weight, _)| weight).sum();
        kinds.iter_mut().for_each(|(weight, _)| *weight /= total);
        Self { kinds }
    }

    /// Large steps with probability `p_large`, else small steps (Kelemen et al. 2002, section 3).
    pub fn kelemen(p_large: f32, small_step: impl Into<SmallStep>) -> Self {
        Self {
            kinds: vec![
                (p_large, Mutation::LargeStep(LargeStep)),
                (1.0 - p_large, Mutation::SmallStep(small_step.into())),
            ],
        }
    }

    /// Index of the kind that `u` in [0, 1) chooses.
    #[inline]
    pub fn choose(&self, u: f32) -> usize {
        let mut below = 0.0;
        let last = self.kinds.len() - 1;
        for (i, (probability, _)) in self.kinds[..last].iter().enumerate() {
            below += probability;
            if u < below {
                return i;
            }
        }
        last
    }

    /// The kind with index `i`.
    #[inline]
    pub fn kind(&self, i: usize) -> &Mutation {
        &self.kinds[i].1
    }

    /// Their names, in order.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.kinds.iter().map(|(_, kind)| kind.name())
    }

    /// p_large: probability of a large step.
    pub fn large_step_probability(&self) -> f64 {
        let large = self.kinds.iter().filter(|(_, kind)| kind.is_large_step());
        large.map(|(probability, _)| f64::from(*probability)).sum()
    }
}
