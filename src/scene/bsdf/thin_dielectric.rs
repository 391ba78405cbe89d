//! A thin pane of a transparent medium, whose two parallel surfaces are one: Mitsuba 3's `thindielectric`.

use glam::{Vec2, Vec3A};

use super::fresnel;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use crate::scene::texture::TextureAt;

/// `Material::ThinDielectric` at a point.
pub(super) struct ThinDielectricBsdf<'a> {
    /// Index of refraction of the pane over that of its surroundings.
    pub eta: f32,
    pub specular_reflectance: TextureAt<'a>,
    pub specular_transmittance: TextureAt<'a>,
}

impl Bsdf for ThinDielectricBsdf<'_> {
    #[inline]
    fn evaluate(&self, _: Vec3A, _: Vec3A) -> BsdfEvaluation {
        BsdfEvaluation::ZERO
    }

    /// Reflection or transmission, chosen in proportion to their power. With the reflectance r of one surface,
    /// all reflections inside add up to R = r + (1 - r)^2 r + (1 - r)^2 r^3 + ... = 2 r / (1 + r), and T = 1 - R
    /// (Stokes 1862, "On the intensity of the light reflected from or transmitted through a pile of plates").
    #[inline]
    fn sample(&self, from: Vec3A, _: TransportMode, u_lobe: f32, _: Vec2) -> Option<BsdfSample> {
        let cos = from.z.abs().min(1.0);
        if cos == 0.0 {
            return None;
        }
        let r = fresnel::dielectric(cos, self.eta).reflectance;
        let reflectance = 2.0 * r / (1.0 + r);
        Some(if u_lobe < reflectance {
            let weight = reflectance * self.specular_reflectance.color();
            BsdfSample::delta_reflection(from, weight, reflectance)
        } else {
            let transmittance = 1.0 - reflectance;
            let weight = transmittance * self.specular_transmittance.color();
            BsdfSample::straight(from, weight, transmittance)
        })
    }
}
