//! Rough interface between two transparent media (Walter et al. 2007, "Microfacet models for
//! refraction through rough surfaces").

use glam::{Vec2, Vec3A};

use super::dielectric::eta_across;
use super::fresnel::{self, Interface};
use super::microfacet::Microfacets;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use crate::scene::texture::TextureAt;

/// Relative indices of refraction closer to 1 than this count as 1: the deflection is below the
/// resolution of f32, and light passes straight through.
const INDEX_MATCHED: f32 = 1e-4;

/// True if an interface of relative index `eta` does not refract, however rough it is.
#[inline]
pub(super) fn is_index_matched(eta: f32) -> bool {
    (eta - 1.0).abs() < INDEX_MATCHED
}

/// `Material::RoughDielectric` at a point, unless it is index-matched.
pub(super) struct RoughDielectricBsdf<'a> {
    pub microfacets: Microfacets,
    /// Inside over outside.
    pub eta: f32,
    pub specular_reflectance: TextureAt<'a>,
    pub specular_transmittance: TextureAt<'a>,
}

impl Bsdf for RoughDielectricBsdf<'_> {
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        if to_light.z == 0.0 || to_camera.z == 0.0 {
            return BsdfEvaluation::ZERO;
        }
        let across = eta_across(self.eta, to_camera);
        let reflects = to_light.z * to_camera.z > 0.0;
        // Index of the light's side over that of the camera's side.
        let eta = if reflects { 1.0 } else { across };

        // Microfacet normal, on the front side (equations 13 and 16)
        let m = (to_camera + eta * to_light).normalize_or_zero();
        let m = if m.z < 0.0 { -m } else { m };
        let light_m = to_light.dot(m);
        let camera_m = to_camera.dot(m);
        if !(light_m * to_light.z > 0.0 && camera_m * to_camera.z > 0.0) {
            return BsdfEvaluation::ZERO;
        }

        let reflectance = fresnel::dielectric(camera_m.abs().min(1.0), across).reflectance;
        let light = self.microfacets.masking_over_cosine(to_light);
        let camera = self.microfacets.masking_over_cosine(to_camera);
        let d = self.microfacets.density(m);
        if reflects {
            // f_r = F D G / (4 cos cos) (equation 20)
            let lobe = 0.25 * reflectance * d;
            BsdfEvaluation {
                f: self.specular_reflectance.color() * (lobe * light * camera),
                pdf_to_light: lobe * camera,
                pdf_to_camera: lobe * light,
            }
        } else {
            // f_s = (1 - F) D G |l.m||c.m| / (cos cos (c.m + eta l.m)^2) (equation 21); the Jacobian of
            // refraction gives the densities (equation 17)
            let root = camera_m + eta * light_m;
            let lobe = (1.0 - reflectance) * d * (light_m * camera_m).abs() / (root * root);
            BsdfEvaluation {
                f: self.specular_transmittance.color() * (lobe * light * camera),
                pdf_to_light: lobe * camera * eta * eta,
                pdf_to_camera: lobe * light,
            }
        }
    }

    /// Samples a visible microfacet and reflects or refracts `from` in it; `None` where the direction
    /// is on the wrong side of the surface: light scattered more than once is lost, as in Mitsuba 3.
    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if from.z == 0.0 {
            return None;
        }
        // A direction from behind is mirrored in the origin, which leaves the microfacets the same.
        let side = 1.0_f32.copysign(from.z);
        let v = from * side;
        let m = self.microfacets.sample_visible(v, u);
        let cos = v.dot(m).clamp(0.0, 1.0);
        let across = eta_across(self.eta, from);
        let Interface { reflectance, cos_t } = fresnel::dielectric(cos, across);
        if u_lobe < reflectance {
            let direction = 2.0 * cos * m - v;
            if direction.z <= 0.0 {
                return None;
            }
            self.density_sample(from, side * direction.normalize(), mode, 1.0)
        } else {
            let inv_eta = across.recip();
            let direction = (cos * inv_eta - cos_t) * m - v * inv_eta;
            if direction.z >= 0.0 {
                return None;
            }
            self.density_sample(from, side * direction.normalize(), mode, across)
        }
    }
}
