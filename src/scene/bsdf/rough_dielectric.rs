//! Rough interface between two transparent media (Walter et al. 2007, "Microfacet models for
//! refraction through rough surfaces").

use glam::{Vec2, Vec3A};

use super::dielectric::eta_across;
use super::fresnel::{self, Interface};
use super::microfacet::Microfacets;
use super::{Draw, Scattering};
use crate::math::Rgb;

/// Relative indices closer to 1 than this refract by less than an f32 can tell from the two
/// directions: light then passes straight on.
const INDEX_MATCHED: f32 = 1e-4;

/// True if an interface of relative index `eta` is no interface at all, however rough.
#[inline]
pub(super) fn is_index_matched(eta: f32) -> bool {
    (eta - 1.0).abs() < INDEX_MATCHED
}

/// `Material::RoughDielectric` at a point.
#[derive(Clone, Copy)]
pub(super) struct RoughInterface {
    pub microfacets: Microfacets,
    /// Inside over outside.
    pub eta: f32,
    pub specular_reflectance: Rgb,
    pub specular_transmittance: Rgb,
}

impl RoughInterface {
    /// Reflection and refraction by microfacets.
    #[inline]
    pub fn scattering(&self, to_light: Vec3A, to_camera: Vec3A) -> Scattering {
        if to_light.z == 0.0 || to_camera.z == 0.0 {
            return Scattering::ZERO;
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
            return Scattering::ZERO;
        }

        let reflectance = fresnel::dielectric(camera_m.abs().min(1.0), across).reflectance;
        let light = self.microfacets.masking_over_cosine(to_light);
        let camera = self.microfacets.masking_over_cosine(to_camera);
        let d = self.microfacets.density(m);
        if reflects {
            // f_r = F D G / (4 cos cos) (equation 20)
            let lobe = 0.25 * reflectance * d;
            Scattering {
                f: self.specular_reflectance * (lobe * light * camera),
                pdf_to_light: lobe * camera,
                pdf_to_camera: lobe * light,
            }
        } else {
            // f_s = (1 - F) D G |l.m||c.m| / (cos cos (c.m + eta l.m)^2) (equation 21); the densities
            // by the Jacobian of refraction (equation 17)
            let root = camera_m + eta * light_m;
            let lobe = (1.0 - reflectance) * d * (light_m * camera_m).abs() / (root * root);
            Scattering {
                f: self.specular_transmittance * (lobe * light * camera),
                pdf_to_light: lobe * camera * eta * eta,
                pdf_to_camera: lobe * light,
            }
        }
    }
}

/// Reflects or refracts `from` in a visible microfacet; `None` where the light would leave to the
/// wrong side, to meet the surface again: that light is lost, as in Mitsuba 3.
#[inline]
pub(super) fn sample(
    microfacets: Microfacets,
    eta: f32,
    from: Vec3A,
    lobe: f32,
    u: Vec2,
) -> Option<Draw> {
    if from.z == 0.0 {
        return None;
    }
    // Mirrored in the origin if need be, so that `from` is in front: the facets stay the same.
    let side = 1.0_f32.copysign(from.z);
    let v = from * side;
    let m = microfacets.sample_visible(v, u);
    let cos = v.dot(m).clamp(0.0, 1.0);
    let eta = eta_across(eta, from);
    let Interface { reflectance, cos_t } = fresnel::dielectric(cos, eta);
    if lobe < reflectance {
        let direction = 2.0 * cos * m - v;
        (direction.z > 0.0).then(|| Draw::reflection(side * direction.normalize()))
    } else {
        let inv_eta = eta.recip();
        let direction = (cos * inv_eta - cos_t) * m - v * inv_eta;
        (direction.z < 0.0).then(|| Draw::Density {
            direction: side * direction.normalize(),
            eta,
        })
    }
}
