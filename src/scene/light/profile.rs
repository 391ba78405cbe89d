//! How the intensity of a point light depends on the direction.

use std::f32::consts::{FRAC_1_PI, PI, TAU};

use glam::{Vec2, Vec3A};

use crate::math::Frame;
use crate::sampling::warp::square_to_sphere;

/// The intensity of a point light in a direction, as a factor on its own.
#[derive(Clone, Debug)]
pub enum Profile {
    /// The same in all directions.
    Uniform,
    /// 1 within a cone, and falling linearly with the angle to 0 at the edge of a wider one (Mitsuba's
    /// `spot`).
    Spot {
        /// Around the axis of both cones.
        frame: Frame,
        /// Angles between the axis and the edges of the cones, in radians: that within which the factor is 1,
        /// and that beyond which it is 0.
        beam: f32,
        /// The wider angle.
        cutoff: f32,
    },
    /// Such that the irradiance is pi within a rectangle across the axis at distance 1: 1 / cos^3 of the
    /// angle to the axis (Mitsuba's `projector`).
    Projector {
        /// Unit axes: to the right and up in the rectangle, and to its centre.
        right: Vec3A,
        /// Up.
        up: Vec3A,
        /// Forward.
        forward: Vec3A,
        /// Half the width and half the height of the rectangle at distance 1.
        half_extent: Vec2,
    },
}

impl Profile {
    /// The factor in the unit direction `direction`, away from the light.
    #[inline]
    pub fn factor(&self, direction: Vec3A) -> f32 {
        match self {
            Self::Uniform => 1.0,
            Self::Spot {
                frame,
                beam,
                cutoff,
            } => {
                let angle = frame.n.dot(direction).clamp(-1.0, 1.0).acos();
                if angle <= *beam {
                    1.0
                } else if angle < *cutoff {
                    (cutoff - angle) / (cutoff - beam)
                } else {
                    0.0
                }
            }
            Self::Projector { forward, .. } if self.is_in_frame(direction) => {
                forward.dot(direction).powi(-3)
            }
            Self::Projector { .. } => 0.0,
        }
    }

    /// A direction with the density [`Self::pdf`].
    #[inline]
    pub fn sample(&self, u: Vec2) -> Vec3A {
        match self {
            Self::Uniform => square_to_sphere(u),
            Self::Spot { frame, cutoff, .. } => {
                // Uniform in the wider cone (pbrt, 4th ed., section A.5.4).
                let cos = 1.0 - u.x * (1.0 - cutoff.cos());
                let sin = (1.0 - cos * cos).max(0.0).sqrt();
                let (sin_phi, cos_phi) = (TAU * u.y).sin_cos();
                frame.to_world(Vec3A::new(sin * cos_phi, sin * sin_phi, cos))
            }
            Self::Projector {
                right,
                up,
                forward,
                half_extent,
            } => {
                let p = (2.0 * u - Vec2::ONE) * *half_extent;
                (right * p.x + up * p.y + forward).normalize()
            }
        }
    }

    /// The density of [`Self::sample`] per steradian, where the factor is not 0.
    #[inline]
    pub fn pdf(&self, direction: Vec3A) -> f32 {
        match self {
            Self::Uniform => 0.25 * FRAC_1_PI,
            Self::Spot { cutoff, .. } => 1.0 / (TAU * (1.0 - cutoff.cos())),
            Self::Projector {
                forward,
                half_extent,
                ..
            } => {
                let area = 4.0 * half_extent.x * half_extent.y;
                forward.dot(direction).powi(-3) / area
            }
        }
    }

    /// The integral of the factor over all directions, in steradians.
    pub fn integral(&self) -> f32 {
        match self {
            Self::Uniform => 4.0 * PI,
            Self::Spot { beam, cutoff, .. } => {
                let [beam, cutoff] = [*beam, *cutoff].map(f64::from);
                let mean_cos = if cutoff > beam {
                    (cutoff.sin() - beam.sin()) / (cutoff - beam)
                } else {
                    beam.cos()
                };
                TAU * (1.0 - mean_cos) as f32
            }
            Self::Projector { half_extent, .. } => 4.0 * half_extent.x * half_extent.y,
        }
    }

    /// True if the rectangle of a projector contains a direction.
    #[inline]
    fn is_in_frame(&self, direction: Vec3A) -> bool {
        let Self::Projector {
            right,
            up,
            forward,
            half_extent,
        } = self
        else {
            return true;
        };
        let depth = forward.dot(direction);
        let p = Vec2::new(right.dot(direction), up.dot(direction)) / depth;
        depth > 0.0 && p.abs().cmple(*half_extent).all()
    }
}
