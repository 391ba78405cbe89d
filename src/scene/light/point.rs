//! Point lights.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::{Vec2, Vec3A};

use super::sample::{EmissionSample, LightEvaluation, LightSample, MIN_DISTANCE_SQUARED};
use super::specular::{self, ChainEnd};
use crate::math::Rgb;
use crate::sampling::warp::square_to_sphere;

/// A point that emits uniformly in all directions.
#[derive(Debug)]
pub struct PointEmitter {
    /// In scene units.
    pub position: Vec3A,
    /// Power per steradian, with square scene units as the unit of area.
    pub intensity: Rgb,
}

impl PointEmitter {
    /// Flux.
    pub fn power(&self) -> Rgb {
        self.intensity * (4.0 * PI)
    }

    /// As [`super::Emitters::sample_direct`]; `choice_pdf` is the probability of this emitter.
    #[inline]
    pub fn sample_direct(&self, point: Vec3A, choice_pdf: f32) -> Option<LightSample> {
        let to_light = self.position - point;
        let distance_squared = to_light.length_squared();
        (distance_squared > MIN_DISTANCE_SQUARED).then(|| LightSample {
            direction: to_light / distance_squared.sqrt(),
            target: self.position,
            emission: LightEvaluation {
                radiance: self.intensity,
                pdf_direct: choice_pdf,
                pdf_position: choice_pdf,
                pdf_direction: 0.25 * FRAC_1_PI,
            },
            jacobian_direction: 1.0 / distance_squared,
            jacobian_area: 1.0 / distance_squared,
            delta: true,
        })
    }

    /// As [`super::Emitters::sample_chain_end`].
    #[inline]
    pub fn chain_end(&self, [chains, subpaths]: [f32; 2]) -> ChainEnd {
        ChainEnd {
            end: specular::point(self.position),
            radiance: self.intensity,
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
        u_direction: Vec2,
        choice_pdf: f32,
    ) -> EmissionSample {
        let direction = square_to_sphere(u_direction);
        EmissionSample {
            emitter,
            origin: self.position,
            position: self.position,
            normal: direction,
            direction,
            weight: self.intensity * (4.0 * PI / choice_pdf),
            pdf_position: choice_pdf,
            pdf_direction: 0.25 * FRAC_1_PI,
            infinite: false,
            delta: true,
        }
    }
}
