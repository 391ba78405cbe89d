//! Metals, seen from the front: smooth, and rough after Walter et al. 2007, "Microfacet models for
//! refraction through rough surfaces".

use glam::{Vec2, Vec3A};

use super::microfacet::Microfacets;
use super::{BsdfSample, Scattering, fresnel};
use crate::math::Rgb;

/// Mirror reflection in a smooth metal; `None` from behind.
#[inline]
pub(super) fn sample(
    eta: Rgb,
    k: Rgb,
    specular_reflectance: Rgb,
    from: Vec3A,
) -> Option<BsdfSample> {
    (from.z > 0.0).then(|| {
        let reflectance = specular_reflectance * fresnel::conductor(from.z.min(1.0), eta, k);
        BsdfSample::delta_reflection(from, reflectance, 1.0)
    })
}

/// Rough metal: f = F D G / (4 cos cos) (Walter et al. 2007, equation 20).
#[inline]
pub(super) fn scattering(
    microfacets: Microfacets,
    eta: Rgb,
    k: Rgb,
    specular_reflectance: Rgb,
    to_light: Vec3A,
    to_camera: Vec3A,
) -> Scattering {
    let Some(lobe) = rough_reflection(microfacets, to_light, to_camera) else {
        return Scattering::ZERO;
    };
    Scattering {
        f: specular_reflectance * fresnel::conductor(lobe.cos, eta, k) * lobe.f,
        pdf_to_light: lobe.pdf_to_light,
        pdf_to_camera: lobe.pdf_to_camera,
    }
}

/// Reflection by microfacets that are perfect mirrors.
#[derive(Clone, Copy)]
pub(super) struct RoughReflection {
    /// Cosine of both directions with the microfacet: the argument of the Fresnel reflectance.
    pub cos: f32,
    /// D G / (4 cos cos), 1/sr.
    pub f: f32,
    /// Density of [`sample_rough_reflection`] for the direction to the light, 1/sr.
    pub pdf_to_light: f32,
    /// As `pdf_to_light`, for the direction to the camera.
    pub pdf_to_camera: f32,
}

/// `None` unless both directions are in front. The densities are D_v(m) / (4 |v.m|) (Walter et al.
/// 2007, equation 14).
#[inline]
pub(super) fn rough_reflection(
    microfacets: Microfacets,
    to_light: Vec3A,
    to_camera: Vec3A,
) -> Option<RoughReflection> {
    if !(to_light.z > 0.0 && to_camera.z > 0.0) {
        return None;
    }
    let m = (to_light + to_camera).normalize();
    let quarter_d = 0.25 * microfacets.density(m);
    let light = microfacets.masking_over_cosine(to_light);
    let camera = microfacets.masking_over_cosine(to_camera);
    Some(RoughReflection {
        cos: to_camera.dot(m).clamp(0.0, 1.0),
        f: quarter_d * light * camera,
        pdf_to_light: quarter_d * camera,
        pdf_to_camera: quarter_d * light,
    })
}

/// Reflects `from` in a visible microfacet; `None` from behind and where the light would leave
/// downwards, to be reflected again between facets: that light is lost, as in Mitsuba 3.
#[inline]
pub(super) fn sample_rough_reflection(
    microfacets: Microfacets,
    from: Vec3A,
    u: Vec2,
) -> Option<Vec3A> {
    if from.z <= 0.0 {
        return None;
    }
    let m = microfacets.sample_visible(from, u);
    let direction = (2.0 * from.dot(m) * m - from).normalize();
    (direction.z > 0.0).then_some(direction)
}
