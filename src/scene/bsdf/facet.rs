//! Reflection and refraction by single microfacets of a dielectric (Walter et al. 2007, "Microfacet models for
//! refraction through rough surfaces"), for models that weigh them by a reflectance of their own.

use glam::{Vec2, Vec3A};

use super::dielectric::eta_across;
use super::fresnel::{self, Interface};
use super::microfacet::Microfacets;
use crate::fault::{Fault, planted};

/// The microfacet that scatters one direction into another.
pub(super) struct Facet {
    /// D gamma gamma times the Jacobian of the half vector, 1/sr.
    pub lobe: f32,
    /// Density per steradian of sampling the light's direction by the microfacet.
    pub pdf_to_light: f32,
    /// As `pdf_to_light`, for the camera's direction.
    pub pdf_to_camera: f32,
    /// Fresnel reflectance of a dielectric.
    pub reflectance: f32,
    /// Absolute cosine between the camera's direction and the normal of the microfacet.
    pub cos: f32,
    /// Whether both directions are on the same side.
    pub reflects: bool,
}

impl Facet {
    /// The microfacet that scatters `to_light` into `to_camera`, neither of which is parallel to the surface; `None` if
    /// none does. `eta` is the index of refraction inside over outside.
    #[inline]
    pub fn between(
        microfacets: &Microfacets,
        eta: f32,
        to_light: Vec3A,
        to_camera: Vec3A,
    ) -> Option<Self> {
        let across = eta_across(eta, to_camera);
        let reflects = to_light.z * to_camera.z > 0.0;
        // Index of the light's side over that of the camera's side.
        let eta = if reflects { 1.0 } else { across };
        let m = (to_camera + eta * to_light).normalize_or_zero();
        let m = if m.z < 0.0 { -m } else { m };
        let (light_m, camera_m) = (to_light.dot(m), to_camera.dot(m));
        if !(light_m * to_light.z > 0.0 && camera_m * to_camera.z > 0.0) {
            return None;
        }
        let cos = camera_m.abs().min(1.0);
        let light = microfacets.masking_over_cosine(to_light);
        let camera = microfacets.masking_over_cosine(to_camera);
        let d = microfacets.density(m);
        let (density, squared_index) = if reflects {
            (0.25 * d, 1.0)
        } else {
            let root = camera_m + eta * light_m;
            let squared_index = if planted(Fault::FacetJacobianOff) {
                1.0
            } else {
                eta * eta
            };
            (
                d * (light_m * camera_m).abs() / (root * root),
                squared_index,
            )
        };
        Some(Self {
            lobe: density * light * camera,
            pdf_to_light: density * camera * squared_index,
            pdf_to_camera: density * light,
            reflectance: fresnel::dielectric(cos, across).reflectance,
            cos,
            reflects,
        })
    }
}

/// A microfacet that is visible from a direction.
pub(super) struct VisibleFacet {
    /// 1 or -1: the side of the direction.
    side: f32,
    /// The direction, mirrored in the origin if it is behind.
    v: Vec3A,
    /// The normal.
    m: Vec3A,
    cos: f32,
    /// Index of the other side over that of the direction's side.
    across: f32,
    interface: Interface,
}

impl VisibleFacet {
    /// A sample from the microfacets visible from `from`; `eta` is the index of refraction inside over outside.
    #[inline]
    pub fn sample(microfacets: &Microfacets, eta: f32, from: Vec3A, u: Vec2) -> Self {
        let side = 1.0_f32.copysign(from.z);
        let v = from * side;
        let m = microfacets.sample_visible(v, u);
        let cos = v.dot(m).clamp(0.0, 1.0);
        let across = eta_across(eta, from);
        Self {
            side,
            v,
            m,
            cos,
            across,
            interface: fresnel::dielectric(cos, across),
        }
    }

    /// Fresnel reflectance of a dielectric.
    #[inline]
    pub fn reflectance(&self) -> f32 {
        self.interface.reflectance
    }

    /// Index of refraction of the other side over that of the direction's side.
    #[inline]
    pub fn eta(&self) -> f32 {
        self.across
    }

    /// The reflected direction; `None` where it points to the other side: light scattered more than once is lost.
    #[inline]
    pub fn reflected(&self) -> Option<Vec3A> {
        let direction = 2.0 * self.cos * self.m - self.v;
        (direction.z > 0.0).then(|| self.side * direction.normalize())
    }

    /// The refracted direction; `None` where it points to the same side.
    #[inline]
    pub fn refracted(&self) -> Option<Vec3A> {
        let inv_eta = self.across.recip();
        let direction = (self.cos * inv_eta - self.interface.cos_t) * self.m - self.v * inv_eta;
        (direction.z <= 0.0).then(|| self.side * direction.normalize())
    }
}
