//! Rough metals, seen from the front (Walter et al. 2007, "Microfacet models for refraction through rough
//! surfaces").

use glam::{Vec2, Vec3A};

use super::microfacet::Microfacets;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use super::{fresnel, rough_reflection};
use crate::math::Rgb;
use crate::scene::texture::TextureAt;

/// `Material::RoughConductor` at a point.
pub(super) struct RoughConductorBsdf<'a> {
    pub microfacets: Microfacets,
    pub eta: Rgb,
    pub k: Rgb,
    pub specular_reflectance: TextureAt<'a>,
}

impl Bsdf for RoughConductorBsdf<'_> {
    /// f = F D G / (4 cos cos) (equation 20).
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        let reflectance = self.specular_reflectance.color();
        let Some(lobe) = rough_reflection::evaluate(self.microfacets, to_light, to_camera) else {
            return BsdfEvaluation::ZERO;
        };
        let fresnel = fresnel::conductor(lobe.cos, self.eta, self.k);
        BsdfEvaluation {
            f: reflectance * fresnel * lobe.f,
            pdf_to_light: lobe.pdf_to_light,
            pdf_to_camera: lobe.pdf_to_camera,
        }
    }

    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, _: f32, u: Vec2) -> Option<BsdfSample> {
        let direction = rough_reflection::sample(self.microfacets, from, u)?;
        self.density_sample(from, direction, mode, 1.0)
    }
}
