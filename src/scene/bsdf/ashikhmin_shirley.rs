//! Rough metals whose microfacet normals follow a power of the cosine, seen from the front: Mitsuba 0.6's
//! `roughconductor` with the distribution `as` and one roughness (Ashikhmin and Shirley 2000, "An anisotropic
//! Phong BRDF model", with equal exponents).

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3A};

use super::microfacet::{MicrofacetDistribution, Microfacets};
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use super::{fresnel, rough_reflection};
use crate::math::Rgb;
use crate::scene::texture::TextureAt;

/// `Material::AshikhminShirley` at a point.
pub(super) struct AshikhminShirleyBsdf<'a> {
    /// Roughness, from 1e-4 to 1.
    pub alpha: f32,
    pub eta: Rgb,
    pub k: Rgb,
    pub specular_reflectance: TextureAt<'a>,
}

impl AshikhminShirleyBsdf<'_> {
    /// D(m) = (n + 2) / (2 pi) cos^n of the unit normal `m` (Walter et al. 2007, "Microfacet models for
    /// refraction through rough surfaces", equation 30), where the exponent n = 2 / alpha^2 - 2 gives the width
    /// of Beckmann's distribution of roughness alpha (section 5.2).
    #[inline]
    fn density(&self, m: Vec3A) -> f32 {
        let alpha2 = self.alpha * self.alpha;
        let sin2 = (m.x * m.x + m.y * m.y).min(1.0);
        // ln cos^n, from the sine, since the cosine is too coarse for large exponents
        let exponent = (alpha2.recip() - 1.0).max(0.0);
        let power = if exponent == 0.0 {
            1.0
        } else {
            (exponent * (-sin2).ln_1p()).exp()
        };
        FRAC_1_PI / alpha2 * power
    }

    /// The microfacets of which visible ones are sampled. Their density has no lighter tail than D.
    #[inline]
    fn sampled(&self) -> Microfacets {
        Microfacets::isotropic(MicrofacetDistribution::Ggx, self.alpha)
    }
}

impl Bsdf for AshikhminShirleyBsdf<'_> {
    /// f = F D G / (4 cos cos), with the masking of Beckmann's distribution of the same roughness (Walter et
    /// al. 2007, section 5.2), which is exact here. It is not that of D: at grazing angles a rough metal
    /// reflects more than it receives.
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        let Some(lobe) = rough_reflection::evaluate(self.sampled(), to_light, to_camera) else {
            return BsdfEvaluation::ZERO;
        };
        let masking = Microfacets::isotropic(MicrofacetDistribution::Beckmann, self.alpha);
        let gamma = |v: Vec3A| masking.masking_over_cosine(v);
        let d = self.density((to_light + to_camera).normalize());
        let fresnel = fresnel::conductor(lobe.cos, self.eta, self.k);
        let reflectance = self.specular_reflectance.color();
        BsdfEvaluation {
            f: reflectance * fresnel * (0.25 * d * gamma(to_light) * gamma(to_camera)),
            pdf_to_light: lobe.pdf_to_light,
            pdf_to_camera: lobe.pdf_to_camera,
        }
    }

    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, _: f32, u: Vec2) -> Option<BsdfSample> {
        let direction = rough_reflection::sample(self.sampled(), from, u)?;
        self.density_sample(from, direction, mode, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::integrate_hemisphere;
    use super::*;
    use crate::scene::Texture;

    /// D cos integrates to 1, since the projected area of the microfacets is that of the surface; and D is the
    /// power of the cosine as it is written.
    #[test]
    fn normals_follow_a_power_of_the_cosine() {
        let white = Texture::Constant(Rgb::ONE);
        for alpha in [0.1, 0.3, 0.8, 1.0] {
            let bsdf = AshikhminShirleyBsdf {
                alpha,
                eta: Rgb::ZERO,
                k: Rgb::ONE,
                specular_reflectance: TextureAt {
                    texture: &white,
                    uv: Vec2::ZERO,
                },
            };
            let all = integrate_hemisphere(&|m| f64::from(bsdf.density(m) * m.z));
            assert!((all - 1.0).abs() < 1e-4, "{alpha}: {all}");
            let exponent = 2.0 / (alpha * alpha) - 2.0;
            for cos in [0.99_f32, 0.8, 0.4] {
                let m = Vec3A::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                let expected = (exponent + 2.0) * 0.5 * FRAC_1_PI * cos.powf(exponent);
                let found = bsdf.density(m);
                let error = (found - expected).abs();
                assert!(
                    error <= 1e-4 * expected + 1e-9,
                    "{alpha} {cos}: {found} {expected}"
                );
            }
        }
    }
}
