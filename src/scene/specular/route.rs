//! The route of a chain that a subpath has sampled: the finder is asked whether it returns this chain, which
//! takes less than a search for all chains.

use arrayvec::ArrayVec;
use glam::Vec3A;

use super::chain::{Candidate, Lobes, MAX_LENGTH};

/// Distance of unit vectors below which the direction of a chain and that of a subpath are the same: the
/// rounding of f32, magnified by the chain.
const SAME_DIRECTION: f32 = 2e-3;

/// A chain of delta vertices on one shape, in the order from D.
#[derive(Clone, Debug)]
pub struct Route {
    /// Index of the shape.
    pub shape: u32,
    /// The lobes of its vertices.
    pub lobes: Lobes,
    /// Indices of the primitives that its vertices lie on.
    pub primitives: ArrayVec<u32, MAX_LENGTH>,
    /// Unit direction in which it leaves D.
    pub direction: Vec3A,
}

impl Route {
    /// The candidate that goes along the route.
    #[inline]
    pub(super) fn nearest<'a>(&self, candidates: &'a [Candidate]) -> Option<&'a Candidate> {
        let distance =
            |candidate: &Candidate| (candidate.direction.as_vec3a() - self.direction).length();
        candidates
            .iter()
            .filter(|candidate| candidate.shape == self.shape && candidate.lobes == self.lobes)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .filter(|candidate| distance(candidate) < SAME_DIRECTION)
    }
}
