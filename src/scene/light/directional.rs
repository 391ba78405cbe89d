//! Directional lights.

use glam::{Vec2, Vec3A};

use super::infinite::{DISK_AREA, emission_from_infinity, light_from_infinity};
use super::sample::{EmissionSample, LightEvaluation, LightSample};
use super::specular::{ChainEnd, at_infinity};
use crate::math::Rgb;

/// Parallel light.
#[derive(Debug)]
pub struct DirectionalEmitter {
    /// Unit direction in which the light travels.
    pub direction: Vec3A,
    /// W/m^2 on a plane perpendicular to the light.
    pub irradiance: Rgb,
}

impl DirectionalEmitter {
    /// Flux into the scene.
    pub fn power(&self) -> Rgb {
        self.irradiance * DISK_AREA
    }

    /// As [`super::Emitters::sample_direct`]; `choice_pdf` is the probability of this emitter.
    #[inline]
    pub fn sample_direct(&self, point: Vec3A, choice_pdf: f32) -> LightSample {
        let emission = LightEvaluation {
            radiance: self.irradiance,
            pdf_direct: choice_pdf,
            pdf_position: choice_pdf,
            pdf_direction: 1.0 / DISK_AREA,
        };
        LightSample {
            delta: true,
            ..light_from_infinity(point, -self.direction, emission)
        }
    }

    /// As [`super::Emitters::sample_chain_end`].
    #[inline]
    pub fn chain_end(&self, [chains, subpaths]: [f32; 2]) -> ChainEnd {
        ChainEnd {
            end: at_infinity(-self.direction),
            radiance: self.irradiance,
            pdf: f64::from(chains),
            pdf_position: f64::from(subpaths),
            delta: true,
        }
    }

    /// As [`super::Emitters::sample_emission`].
    #[inline]
    pub fn sample_emission(
        &self,
        emitter: u32,
        u_position: Vec2,
        choice_pdf: f32,
    ) -> EmissionSample {
        let weight = self.power() / choice_pdf;
        EmissionSample {
            delta: true,
            ..emission_from_infinity(emitter, self.direction, u_position, choice_pdf, weight)
        }
    }
}
