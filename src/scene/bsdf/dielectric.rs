//! Smooth interface between two transparent media (Veach 1997, "Robust Monte Carlo methods for light
//! transport simulation", section 5.2).

use glam::Vec3A;

use super::fresnel::{self, Interface};
use super::{BsdfSample, TransportMode};
use crate::math::Rgb;

/// Index of refraction of the far side over that of the side of `v`, from `eta`, that of the inside
/// over that of the outside.
#[inline]
pub(super) fn eta_across(eta: f32, v: Vec3A) -> f32 {
    if v.z > 0.0 { eta } else { eta.recip() }
}

/// Reflection or refraction, chosen in proportion to their power.
#[inline]
pub(super) fn sample(
    eta: f32,
    specular_reflectance: Rgb,
    specular_transmittance: Rgb,
    from: Vec3A,
    mode: TransportMode,
    lobe: f32,
) -> Option<BsdfSample> {
    let cos = from.z.abs().min(1.0);
    if cos == 0.0 {
        return None;
    }
    let eta = eta_across(eta, from);
    let Interface { reflectance, cos_t } = fresnel::dielectric(cos, eta);
    if lobe < reflectance {
        let weight = reflectance * specular_reflectance;
        return Some(BsdfSample::delta_reflection(from, weight, reflectance));
    }
    let probability = 1.0 - reflectance;
    let inv_eta = eta.recip();
    let direction = Vec3A::new(
        -from.x * inv_eta,
        -from.y * inv_eta,
        -cos_t.copysign(from.z),
    );
    Some(BsdfSample {
        direction: direction.normalize(),
        weight: specular_transmittance * refraction_scale(mode, inv_eta),
        pdf: probability,
        // Both sides transmit the same share: P_reverse = P.
        reverse_pdf: probability * inv_eta * inv_eta * cos / cos_t,
        delta: true,
        eta,
    })
}

/// Factor on what is carried through a refraction, `inv_eta` being the index of the given side over
/// that of the sampled side: radiance follows from the basic radiance L / eta^2, which is conserved,
/// and importance does not change (Veach 1997, section 5.2.2).
#[inline]
fn refraction_scale(mode: TransportMode, inv_eta: f32) -> f32 {
    match mode {
        TransportMode::Radiance => inv_eta * inv_eta,
        TransportMode::Importance => 1.0,
    }
}
