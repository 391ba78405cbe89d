//! The large step (Kelemen et al. 2002, section 3): all coordinates are resampled, so that a chain reaches
//! every part of the hypercube.

use rand::{Rng, RngExt};

/// Proposes a uniform point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargeStep;

impl LargeStep {
    pub(super) const NAME: &str = "large step";

    #[inline]
    pub(super) fn propose(self, rng: &mut impl Rng) -> f32 {
        rng.random()
    }

    /// Both proposal densities are 1.
    #[inline]
    pub(super) fn log_density_ratio(self) -> f64 {
        0.0
    }
}
