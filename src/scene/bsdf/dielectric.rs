//! Smooth interface between two transparent media (Veach 1997, "Robust Monte Carlo methods for light
//! transport simulation", section 5.2).

use glam::{Vec2, Vec3A};

use super::fresnel::{self, Interface};
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, DeltaLobe, TransportMode};
use crate::scene::texture::TextureAt;

/// `Material::Dielectric` at a point.
pub(super) struct DielectricBsdf<'a> {
    /// Inside over outside.
    pub eta: f32,
    pub specular_reflectance: TextureAt<'a>,
    pub specular_transmittance: TextureAt<'a>,
}

impl Bsdf for DielectricBsdf<'_> {
    #[inline]
    fn evaluate(&self, _: Vec3A, _: Vec3A) -> BsdfEvaluation {
        BsdfEvaluation::ZERO
    }

    /// Reflection or refraction, chosen in proportion to their power.
    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, _: Vec2) -> Option<BsdfSample> {
        let interface = self.interface(from)?;
        if u_lobe < interface.reflectance {
            Some(self.reflection(from, interface))
        } else {
            Some(self.transmission(from, mode, interface))
        }
    }

    #[inline]
    fn sample_delta(
        &self,
        from: Vec3A,
        mode: TransportMode,
        lobe: DeltaLobe,
    ) -> Option<BsdfSample> {
        let interface = self.interface(from)?;
        let sample = match lobe {
            DeltaLobe::Reflection => self.reflection(from, interface),
            DeltaLobe::Transmission if interface.cos_t > 0.0 => {
                self.transmission(from, mode, interface)
            }
            DeltaLobe::Transmission => return None,
        };
        (sample.pdf > 0.0).then_some(sample)
    }
}

impl DielectricBsdf<'_> {
    /// `None` at grazing incidence.
    #[inline]
    fn interface(&self, from: Vec3A) -> Option<Interface> {
        let cos = from.z.abs().min(1.0);
        (cos != 0.0).then(|| fresnel::dielectric(cos, eta_across(self.eta, from)))
    }

    #[inline]
    fn reflection(&self, from: Vec3A, interface: Interface) -> BsdfSample {
        let reflectance = interface.reflectance;
        let weight = reflectance * self.specular_reflectance.color();
        BsdfSample::delta_reflection(from, weight, reflectance)
    }

    #[inline]
    fn transmission(&self, from: Vec3A, mode: TransportMode, interface: Interface) -> BsdfSample {
        let Interface { reflectance, cos_t } = interface;
        let eta = eta_across(self.eta, from);
        let probability = 1.0 - reflectance;
        let inv_eta = eta.recip();
        let direction = Vec3A::new(
            -from.x * inv_eta,
            -from.y * inv_eta,
            -cos_t.copysign(from.z),
        );
        BsdfSample {
            direction: direction.normalize(),
            weight: self.specular_transmittance.color() * refraction_scale(mode, inv_eta),
            pdf: probability,
            // The transmittance is the same from both sides: P_reverse = P.
            reverse_pdf: probability * inv_eta * inv_eta * from.z.abs().min(1.0) / cos_t,
            delta: true,
            eta,
        }
    }
}

/// Index of refraction of the far side over that of the side of `v`; `eta` is that of the inside over
/// that of the outside.
#[inline]
pub(super) fn eta_across(eta: f32, v: Vec3A) -> f32 {
    if v.z > 0.0 { eta } else { eta.recip() }
}

/// Factor on the transported quantity at a refraction; `inv_eta` is the index of the given side over that
/// of the sampled side. The basic radiance L / eta^2 is conserved, and importance does not change (Veach
/// 1997, section 5.2.2).
#[inline]
fn refraction_scale(mode: TransportMode, inv_eta: f32) -> f32 {
    match mode {
        TransportMode::Radiance => inv_eta * inv_eta,
        TransportMode::Importance => 1.0,
    }
}
