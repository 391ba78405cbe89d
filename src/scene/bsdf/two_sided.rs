//! One model on the front of a surface and one on the back.

use glam::{Vec2, Vec3A};

use super::model::{Bsdf, BsdfEvaluation, BsdfSample, DeltaLobe, TransportMode};

/// `Material::TwoSided` at a point.
pub(super) struct TwoSidedBsdf<B> {
    pub front: B,
    /// Seen with the surface flipped.
    pub back: B,
}

impl<B: Bsdf> Bsdf for TwoSidedBsdf<B> {
    #[inline]
    fn evaluate(&self, to_light: Vec3A, to_camera: Vec3A) -> BsdfEvaluation {
        if to_camera.z > 0.0 {
            self.front.evaluate(to_light, to_camera)
        } else {
            self.back.evaluate(flipped(to_light), flipped(to_camera))
        }
    }

    #[inline]
    fn sample(&self, from: Vec3A, mode: TransportMode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if from.z > 0.0 {
            return self.front.sample(from, mode, u_lobe, u);
        }
        let sample = self.back.sample(flipped(from), mode, u_lobe, u)?;
        Some(flipped_sample(sample))
    }

    #[inline]
    fn sample_delta(
        &self,
        from: Vec3A,
        mode: TransportMode,
        lobe: DeltaLobe,
    ) -> Option<BsdfSample> {
        if from.z > 0.0 {
            return self.front.sample_delta(from, mode, lobe);
        }
        let sample = self.back.sample_delta(flipped(from), mode, lobe)?;
        Some(flipped_sample(sample))
    }
}

#[inline]
fn flipped_sample(sample: BsdfSample) -> BsdfSample {
    BsdfSample {
        direction: flipped(sample.direction),
        ..sample
    }
}

/// `v` seen with the surface flipped.
#[inline]
fn flipped(v: Vec3A) -> Vec3A {
    Vec3A::new(v.x, v.y, -v.z)
}
