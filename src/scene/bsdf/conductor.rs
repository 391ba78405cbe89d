//! Smooth metals, seen from the front.

use glam::{Vec2, Vec3A};

use super::fresnel;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, DeltaLobe, TransportMode};
use crate::math::Rgb;
use crate::scene::texture::TextureAt;

/// `Material::Conductor` at a point.
pub(super) struct ConductorBsdf<'a> {
    pub eta: Rgb,
    pub k: Rgb,
    pub specular_reflectance: TextureAt<'a>,
}

impl Bsdf for ConductorBsdf<'_> {
    #[inline]
    fn evaluate(&self, _: Vec3A, _: Vec3A) -> BsdfEvaluation {
        BsdfEvaluation::ZERO
    }

    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, _: f32, _: Vec2) -> Option<BsdfSample> {
        self.sample_delta(from, mode, DeltaLobe::Reflection)
    }

    #[inline]
    fn sample_delta(&self, from: Vec3A, _: TransportMode, lobe: DeltaLobe) -> Option<BsdfSample> {
        (from.z > 0.0 && lobe == DeltaLobe::Reflection).then(|| {
            let fresnel = fresnel::conductor(from.z.min(1.0), self.eta, self.k);
            BsdfSample::delta_reflection(from, self.specular_reflectance.color() * fresnel, 1.0)
        })
    }
}
