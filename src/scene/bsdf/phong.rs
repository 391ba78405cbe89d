//! Modified Phong reflection, seen from the front (Lafortune and Willems 1994, "Using the modified Phong
//! reflectance model for physically based rendering"): Mitsuba 0.6's `phong`.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3A};

use super::mask::ALMOST_ONE;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use crate::fault::{Fault, planted};
use crate::math::{Frame, luminance};
use crate::sampling::warp::{cosine_hemisphere_pdf, square_to_cosine_hemisphere};
use crate::scene::texture::TextureAt;

/// `Material::Phong` at a point.
pub(super) struct PhongBsdf<'a> {
    pub exponent: f32,
    pub diffuse: TextureAt<'a>,
    pub specular: TextureAt<'a>,
}

impl PhongBsdf<'_> {
    /// Probability of the specular lobe.
    #[inline]
    fn specular_probability(&self) -> f32 {
        let specular = luminance(self.specular.color());
        let sum = specular + luminance(self.diffuse.color());
        if sum > 0.0 { specular / sum } else { 0.0 }
    }
}

impl Bsdf for PhongBsdf<'_> {
    /// f = k_d / pi + k_s (n + 2) / (2 pi) cos^n, with the angle between one direction and the mirror image of the
    /// other (equations 1 and 3).
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        if !(to_light.z > 0.0 && to_camera.z > 0.0) {
            return BsdfEvaluation::ZERO;
        }
        let n = self.exponent;
        let cos = mirrored(to_light).dot(to_camera).clamp(0.0, 1.0);
        let power = 0.5 * FRAC_1_PI * cos.powf(n);
        let p = self.specular_probability();
        let pdf = |direction: Vec3A| {
            p * (n + 1.0) * power + (1.0 - p) * cosine_hemisphere_pdf(direction.z)
        };
        let normalisation = if planted(Fault::PhongNormalisedAsDensity) {
            n + 1.0
        } else {
            n + 2.0
        };
        BsdfEvaluation {
            f: self.diffuse.color() * FRAC_1_PI + self.specular.color() * (normalisation * power),
            pdf_to_light: pdf(to_light),
            pdf_to_camera: pdf(to_camera),
        }
    }

    /// Directions of the specular lobe have the density (n + 1) / (2 pi) cos^n; those below the surface end the
    /// path.
    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if from.z <= 0.0 {
            return None;
        }
        let direction = if u_lobe < self.specular_probability() {
            let cos = (1.0 - u.x.min(ALMOST_ONE)).powf((self.exponent + 1.0).recip());
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            let (sin_phi, cos_phi) = (std::f32::consts::TAU * u.y).sin_cos();
            let local = Vec3A::new(sin * cos_phi, sin * sin_phi, cos);
            Frame::from_normal(mirrored(from))
                .to_world(local)
                .normalize()
        } else {
            square_to_cosine_hemisphere(u)
        };
        self.density_sample(from, direction, mode, 1.0)
    }
}

/// The mirror image of `v` in the normal.
#[inline]
fn mirrored(v: Vec3A) -> Vec3A {
    Vec3A::new(-v.x, -v.y, v.z)
}
