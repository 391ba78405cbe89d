//! Kelemen's weights of the samples of a chain.

use super::Sample;
use crate::fault::{Fault, planted};

/// The constants of the denominator I(u)/b_0 + p of Kelemen's weights (Kelemen et al. 2002, section 4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KelemenWeights {
    /// b_0: any positive constant, best near b.
    pub b: f64,
    /// p: probability of a large step.
    pub large_step_probability: f64,
}

impl KelemenWeights {
    /// The factors of a sample's contribution F(u) in the chain part and in the large-step part of an
    /// estimate (see [`super::chain`]), before division by the number of mutations. 0 if the density is 0
    /// or not finite.
    #[inline]
    pub fn factors<T>(&self, sample: &Sample<T>) -> [f64; 2] {
        if !sample.density.is_finite() || sample.density <= 0.0 {
            return [0.0; 2];
        }
        let mut p = self.large_step_probability;
        if planted(Fault::OtherLargeStepProbability) {
            p *= 0.8;
        }
        let per_weight = 1.0 / (sample.density / self.b + p);
        let weights = sample.weights;
        [weights.chain * per_weight, weights.large * per_weight]
    }
}
