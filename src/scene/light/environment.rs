//! Environment lights: radiance from all directions.

use std::f32::consts::PI;

use glam::{Mat3A, Vec2, Vec3A};

use super::environment_map::EnvironmentMap;
use super::infinite::{DISK_AREA, emission_from_infinity, light_from_infinity};
use super::sample::{EmissionSample, LightEvaluation, LightSample};
use super::specular::{ChainEnd, at_infinity};
use crate::math::Rgb;
use crate::sampling::warp::square_to_sphere;

/// Radiance from all directions.
#[derive(Debug)]
pub enum Environment {
    /// The same from every direction.
    Constant(Rgb),
    /// By direction.
    Map {
        /// In its own coordinates.
        map: EnvironmentMap,
        /// Orthogonal, from the coordinates of the map to those of the scene.
        to_scene: Mat3A,
    },
}

impl Environment {
    /// Flux into the scene.
    pub fn power(&self) -> Rgb {
        let integral = match self {
            Self::Constant(radiance) => *radiance * (4.0 * PI),
            Self::Map { map, .. } => map.integral(),
        };
        integral * DISK_AREA
    }

    /// Radiance from the unit `direction`, and the density per steradian of sampling it.
    #[inline]
    fn radiance(&self, direction: Vec3A) -> (Rgb, f32) {
        match self {
            Self::Constant(radiance) => (*radiance, 0.25 / PI),
            Self::Map { map, to_scene } => map.evaluate(to_scene.transpose() * direction),
        }
    }

    /// Samples a direction from which radiance arrives.
    #[inline]
    fn sample(&self, u: Vec2) -> Vec3A {
        match self {
            Self::Constant(_) => square_to_sphere(u),
            Self::Map { map, to_scene } => *to_scene * map.sample(u),
        }
    }

    /// As [`super::Emitters::evaluate_environment`]; `choice_pdf` is the probability of this emitter.
    #[inline]
    pub fn evaluate(&self, direction: Vec3A, choice_pdf: f32) -> LightEvaluation {
        let (radiance, pdf) = self.radiance(direction);
        LightEvaluation {
            radiance,
            pdf_direct: choice_pdf * pdf,
            pdf_position: choice_pdf * pdf,
            pdf_direction: 1.0 / DISK_AREA,
        }
    }

    /// As [`super::Emitters::sample_direct`].
    #[inline]
    pub fn sample_direct(
        &self,
        point: Vec3A,
        u_position: Vec2,
        choice_pdf: f32,
    ) -> Option<LightSample> {
        let direction = self.sample(u_position);
        let emission = self.evaluate(direction, choice_pdf);
        (emission.pdf_direct > 0.0).then(|| light_from_infinity(point, direction, emission))
    }

    /// As [`super::Emitters::sample_chain_end`].
    #[inline]
    pub fn sample_chain_end(&self, u: Vec2, pdfs: [f32; 2]) -> ChainEnd {
        self.chain_end(self.sample(u), pdfs)
    }

    /// As [`super::Emitters::chain_end_at`].
    #[inline]
    pub fn chain_end(&self, direction: Vec3A, [chains, subpaths]: [f32; 2]) -> ChainEnd {
        let (radiance, pdf) = self.radiance(direction);
        ChainEnd {
            end: at_infinity(direction),
            radiance,
            pdf: f64::from(chains * pdf),
            pdf_position: f64::from(subpaths * pdf),
            delta: false,
        }
    }

    /// As [`super::Emitters::sample_emission`].
    #[inline]
    pub fn sample_emission(
        &self,
        emitter: u32,
        u_position: Vec2,
        u_direction: Vec2,
        choice_pdf: f32,
    ) -> Option<EmissionSample> {
        let toward = self.sample(u_direction);
        let (radiance, pdf) = self.radiance(toward);
        let pdf_position = choice_pdf * pdf;
        (pdf_position > 0.0).then(|| {
            let weight = radiance * (DISK_AREA / pdf_position);
            emission_from_infinity(emitter, -toward, u_position, pdf_position, weight)
        })
    }
}
