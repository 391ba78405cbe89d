//! Point lights.

use glam::{Vec2, Vec3A};

use super::profile::Profile;
use super::sample::{EmissionSample, LightEvaluation, LightSample, MIN_DISTANCE_SQUARED};
use super::specular::{self, ChainEnd};
use crate::math::Rgb;

/// A point that emits.
#[derive(Debug)]
pub struct PointEmitter {
    /// In scene units.
    pub position: Vec3A,
    /// Power per steradian, with square scene units as the unit of area.
    pub intensity: Rgb,
    /// Its dependence on the direction.
    pub profile: Profile,
}

impl PointEmitter {
    /// Flux.
    pub fn power(&self) -> Rgb {
        self.intensity * self.profile.integral()
    }

    /// As [`super::Emitters::sample_direct`]; `choice_pdf` is the probability of this emitter.
    #[inline]
    pub fn sample_direct(&self, point: Vec3A, choice_pdf: f32) -> Option<LightSample> {
        let to_light = self.position - point;
        let distance_squared = to_light.length_squared();
        if distance_squared <= MIN_DISTANCE_SQUARED {
            return None;
        }
        let direction = to_light / distance_squared.sqrt();
        let factor = self.profile.factor(-direction);
        (factor > 0.0).then(|| LightSample {
            direction,
            target: self.position,
            emission: LightEvaluation {
                radiance: self.intensity * factor,
                pdf_direct: choice_pdf,
                pdf_position: choice_pdf,
                pdf_direction: self.profile.pdf(-direction),
            },
            jacobian_direction: 1.0 / distance_squared,
            jacobian_area: 1.0 / distance_squared,
            delta: true,
        })
    }

    /// True if chains end here: the light does not depend on the direction in which a chain leaves.
    pub fn ends_chains(&self) -> bool {
        matches!(self.profile, Profile::Uniform)
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
        let direction = self.profile.sample(u_direction);
        let pdf_direction = self.profile.pdf(direction);
        let factor = self.profile.factor(direction);
        EmissionSample {
            emitter,
            origin: self.position,
            position: self.position,
            normal: direction,
            direction,
            weight: self.intensity * (factor / (pdf_direction * choice_pdf)),
            pdf_position: choice_pdf,
            pdf_direction,
            infinite: false,
            delta: true,
        }
    }
}
