//! Reflection by a rough surface whose microfacets are mirrors (Walter et al. 2007, "Microfacet models
//! for refraction through rough surfaces").

use glam::{Vec2, Vec3A};

use super::microfacet::Microfacets;

/// Reflection by microfacets that reflect all light.
#[derive(Clone, Copy)]
pub(super) struct RoughReflection {
    /// Cosine of the angle between either direction and the microfacet normal, for Fresnel's equations.
    pub cos: f32,
    /// D G / (4 cos cos), 1/sr.
    pub f: f32,
    /// Density of [`sample`] for the direction to the light, 1/sr.
    pub pdf_to_light: f32,
    /// As `pdf_to_light`, for the direction to the camera.
    pub pdf_to_camera: f32,
}

/// Evaluates the reflection; `None` unless both directions are in front. The densities are
/// D_v(m) / (4 |v.m|) (equation 14).
#[inline]
pub(super) fn evaluate(
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

/// Samples a visible microfacet and reflects `from` in it; `None` from behind, and where the reflected
/// direction points into the surface: light reflected more than once is lost, as in Mitsuba 3.
#[inline]
pub(super) fn sample(microfacets: Microfacets, from: Vec3A, u: Vec2) -> Option<Vec3A> {
    if from.z <= 0.0 {
        return None;
    }
    let m = microfacets.sample_visible(from, u);
    let direction = (2.0 * from.dot(m) * m - from).normalize();
    (direction.z > 0.0).then_some(direction)
}
