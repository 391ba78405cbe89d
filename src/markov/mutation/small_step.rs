//! The small step (Kelemen et al. 2002, section 3.1): every coordinate is perturbed, so that a chain
//! explores the neighbourhood of its state.

use std::ops::Range;

use rand::Rng;

use super::Perturbation;
use crate::sampling::{Dimension, Stream};

/// Perturbs every coordinate, each by the perturbation of its class.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallStep {
    /// Dimensions with a perturbation of their own. The first entry that matches is used.
    classes: Vec<(Stream, Range<usize>, Perturbation)>,
    /// All other dimensions.
    rest: Perturbation,
}

impl From<Perturbation> for SmallStep {
    /// The same perturbation for all coordinates.
    fn from(rest: Perturbation) -> Self {
        Self {
            classes: Vec::new(),
            rest,
        }
    }
}

impl SmallStep {
    pub(super) const NAME: &str = "small step";

    /// Sets the perturbation of the dimensions `indices` of `stream`, unless an earlier call has set it.
    #[must_use]
    pub fn with(
        mut self,
        stream: Stream,
        indices: Range<usize>,
        perturbation: Perturbation,
    ) -> Self {
        self.classes.push((stream, indices, perturbation));
        self
    }

    /// The perturbation of a coordinate.
    #[inline]
    pub fn perturbation(&self, dimension: Dimension) -> Perturbation {
        self.classes
            .iter()
            .find(|(stream, indices, _)| {
                *stream == dimension.stream && indices.contains(&dimension.index)
            })
            .map_or(self.rest, |(.., perturbation)| *perturbation)
    }

    #[inline]
    pub(super) fn propose(&self, value: f32, dimension: Dimension, rng: &mut impl Rng) -> f32 {
        self.perturbation(dimension).apply(value, rng)
    }

    /// All perturbations are symmetric.
    #[inline]
    pub(super) fn log_density_ratio(&self, _u: f32, _v: f32, _dimension: Dimension) -> f64 {
        0.0
    }
}
