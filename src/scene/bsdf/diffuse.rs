//! Lambertian reflection from the front: f = reflectance / pi.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3A};

use super::Scattering;
use crate::math::Rgb;
use crate::sampling::warp::{cosine_hemisphere_pdf, square_to_cosine_hemisphere};

#[inline]
pub(super) fn scattering(reflectance: Rgb, to_light: Vec3A, to_camera: Vec3A) -> Scattering {
    if !(to_light.z > 0.0 && to_camera.z > 0.0) {
        return Scattering::ZERO;
    }
    Scattering {
        f: reflectance * FRAC_1_PI,
        pdf_to_light: cosine_hemisphere_pdf(to_light.z),
        pdf_to_camera: cosine_hemisphere_pdf(to_camera.z),
    }
}

/// The other direction; `None` from behind.
#[inline]
pub(super) fn sample(from: Vec3A, u: Vec2) -> Option<Vec3A> {
    (from.z > 0.0).then(|| square_to_cosine_hemisphere(u))
}
