//! A surface that covers a fraction of its area and lets light pass elsewhere: Mitsuba 3's `mask`.

use glam::{Vec2, Vec3A};

use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use crate::fault::{Fault, planted};
use crate::math::Rgb;

/// Largest number below 1 of the resolution of random numbers, 2^-24.
pub(super) const ALMOST_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// `Material::Mask` at a point.
pub(super) struct MaskBsdf<B> {
    /// Fraction of the area that is covered, from 0 to 1.
    pub opacity: f32,
    /// Scatters light where the area is covered.
    pub covered: B,
}

impl<B: Bsdf> Bsdf for MaskBsdf<B> {
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        if self.opacity == 0.0 {
            return BsdfEvaluation::ZERO;
        }
        self.covered
            .evaluate(to_light, to_camera)
            .scaled(self.opacity)
    }

    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if u_lobe < self.opacity {
            let u_lobe = (u_lobe / self.opacity).min(ALMOST_ONE);
            let sample = self.covered.sample(from, mode, u_lobe, u)?;
            if planted(Fault::OpacityLeftOut) {
                return Some(sample);
            }
            Some(sample.chosen_with(self.opacity))
        } else {
            let open = 1.0 - self.opacity;
            Some(BsdfSample::straight(from, Rgb::splat(open), open))
        }
    }
}
