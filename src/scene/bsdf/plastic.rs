//! A diffuse substrate under a smooth dielectric coat, seen from the front: Mitsuba 3's `plastic`.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3A};

use super::fresnel;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, DeltaLobe, TransportMode};
use super::substrate::Substrate;
use crate::sampling::warp::{cosine_hemisphere_pdf, square_to_cosine_hemisphere};
use crate::scene::texture::TextureAt;

/// Parameters of [`super::Material::Plastic`], with derived constants.
#[derive(Clone, Debug)]
pub struct Plastic {
    pub(super) substrate: Substrate,
    /// Fraction of diffuse light inside that the coat reflects back.
    internal_reflectance: f32,
}

impl Plastic {
    pub(super) fn new(substrate: Substrate) -> Self {
        Self {
            internal_reflectance: fresnel::internal_diffuse_reflectance(substrate.eta),
            substrate,
        }
    }
}

/// `Material::Plastic` at a point, with its two reflectances.
pub(super) struct PlasticBsdf<'a> {
    pub plastic: &'a Plastic,
    pub diffuse: TextureAt<'a>,
    pub specular: TextureAt<'a>,
}

impl Bsdf for PlasticBsdf<'_> {
    /// The diffuse lobe; the specular lobe is a delta function.
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        if !(to_light.z > 0.0 && to_camera.z > 0.0) {
            return BsdfEvaluation::ZERO;
        }
        let Plastic {
            substrate,
            internal_reflectance,
        } = self.plastic;
        let light = fresnel::dielectric(to_light.z.min(1.0), substrate.eta).reflectance;
        let camera = fresnel::dielectric(to_camera.z.min(1.0), substrate.eta).reflectance;
        let pdf = |reflectance: f32, direction: Vec3A| {
            (1.0 - substrate.specular_probability(reflectance)) * cosine_hemisphere_pdf(direction.z)
        };
        BsdfEvaluation {
            f: substrate.albedo(self.diffuse.color(), *internal_reflectance)
                * ((1.0 - light) * (1.0 - camera) * FRAC_1_PI),
            pdf_to_light: pdf(camera, to_light),
            pdf_to_camera: pdf(light, to_camera),
        }
    }

    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if from.z <= 0.0 {
            return None;
        }
        let (fresnel, probability) = self.coat(from);
        if u_lobe < probability {
            Some(self.reflection(from, fresnel, probability))
        } else {
            self.density_sample(from, square_to_cosine_hemisphere(u), mode, 1.0)
        }
    }

    #[inline]
    fn sample_delta(&self, from: Vec3A, _: TransportMode, lobe: DeltaLobe) -> Option<BsdfSample> {
        if from.z <= 0.0 || lobe == DeltaLobe::Transmission {
            return None;
        }
        let (fresnel, probability) = self.coat(from);
        (probability > 0.0).then(|| self.reflection(from, fresnel, probability))
    }
}

impl PlasticBsdf<'_> {
    /// Reflectance of the coat, and the probability of its lobe.
    #[inline]
    fn coat(&self, from: Vec3A) -> (f32, f32) {
        let substrate = &self.plastic.substrate;
        let fresnel = fresnel::dielectric(from.z.min(1.0), substrate.eta).reflectance;
        (fresnel, substrate.specular_probability(fresnel))
    }

    #[inline]
    fn reflection(&self, from: Vec3A, fresnel: f32, probability: f32) -> BsdfSample {
        let weight = self.specular.color() * fresnel;
        BsdfSample::delta_reflection(from, weight, probability)
    }
}
