//! A weighted sum of two models: Mitsuba 3's `blendbsdf`.

use glam::{Vec2, Vec3A};

use super::mask::ALMOST_ONE;
use super::model::{Bsdf, BsdfEvaluation, BsdfSample, TransportMode};
use crate::fault::{Fault, planted};

/// `Material::Blend` at a point.
pub(super) struct BlendBsdf<B> {
    /// Weight of the second model, from 0 to 1; that of the first is the rest.
    pub weight: f32,
    pub first: B,
    pub second: B,
}

impl<B: Bsdf> Bsdf for BlendBsdf<B> {
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        let first = self.first.evaluate(to_light, to_camera);
        let second = self.second.evaluate(to_light, to_camera);
        first.scaled(1.0 - self.weight) + second.scaled(self.weight)
    }

    /// Chooses a model by its weight. The density of a direction is that of both; delta lobes of the two are
    /// distinct even if their directions are the same.
    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let (model, probability, u_lobe) = if u_lobe < self.weight {
            (&self.second, self.weight, u_lobe / self.weight)
        } else {
            let rest = 1.0 - self.weight;
            (&self.first, rest, (u_lobe - self.weight) / rest)
        };
        let sample = model.sample(from, mode, u_lobe.min(ALMOST_ONE), u)?;
        if sample.delta || planted(Fault::BlendOfOneModel) {
            return Some(sample.chosen_with(probability));
        }
        self.density_sample(from, sample.direction, mode, sample.eta)
    }
}
