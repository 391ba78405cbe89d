//! Lambertian reflection from the front: f = reflectance / pi.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3A};

use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use crate::sampling::warp::{cosine_hemisphere_pdf, square_to_cosine_hemisphere};
use crate::scene::texture::TextureAt;

/// `Material::Diffuse` at a point.
pub(super) struct DiffuseBsdf<'a> {
    pub reflectance: TextureAt<'a>,
}

impl Bsdf for DiffuseBsdf<'_> {
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        if !(to_light.z > 0.0 && to_camera.z > 0.0) {
            return BsdfEvaluation::ZERO;
        }
        BsdfEvaluation {
            f: self.reflectance.color() * FRAC_1_PI,
            pdf_to_light: cosine_hemisphere_pdf(to_light.z),
            pdf_to_camera: cosine_hemisphere_pdf(to_camera.z),
        }
    }

    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, _: f32, u: Vec2) -> Option<BsdfSample> {
        if from.z <= 0.0 {
            return None;
        }
        self.density_sample(from, square_to_cosine_hemisphere(u), mode, 1.0)
    }
}
