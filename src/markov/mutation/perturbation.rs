//! Perturbations of a single coordinate.

use std::fmt;

use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use crate::fault::{Fault, planted};

/// A symmetric random step on the circle [0, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Perturbation {
    /// Log-uniform length between the bounds s_1 and s_2, with a random sign (Kelemen et al. 2002, section
    /// 3.1).
    LogUniform {
        /// s_1.
        shortest: f32,
        /// s_2.
        longest: f32,
        /// log2(s_1 / s_2).
        log2_ratio: f32,
    },
    /// Normally distributed.
    Gaussian {
        /// Standard deviation.
        deviation: f32,
    },
    /// A new uniform number with the given probability, otherwise no change. For a coordinate whose
    /// neighbouring values map to unrelated paths.
    Redraw {
        /// Probability of a new number.
        probability: f32,
    },
}

impl Default for Perturbation {
    /// The lengths of Kelemen et al. (2002), section 3.1.
    fn default() -> Self {
        Self::new(1.0 / 1024.0, 1.0 / 64.0)
    }
}

impl Perturbation {
    /// Log-uniform steps of lengths in [`shortest`, `longest`], with 0 < `shortest` <= `longest` <=
    /// 1/2.
    pub fn new(shortest: f32, longest: f32) -> Self {
        Self::LogUniform {
            shortest,
            longest,
            log2_ratio: (shortest / longest).log2(),
        }
    }

    /// `value` after one step, wrapped around the circle: clamping would not be symmetric.
    #[inline]
    pub fn apply(&self, value: f32, rng: &mut impl Rng) -> f32 {
        let moved = match *self {
            Self::LogUniform {
                longest,
                log2_ratio,
                ..
            } => {
                let bits = rng.next_u64();
                // The highest 24 bits give the length, the lowest bit gives the sign.
                let u = (bits >> 40) as f32 * (1.0 / (1u32 << 24) as f32);
                let length = longest * (log2_ratio * u).exp2();
                let up = bits & 1 == 0 || (planted(Fault::Asymmetric) && bits & 6 == 0);
                if up { value + length } else { value - length }
            }
            Self::Gaussian { deviation } => {
                let moved = value + deviation * rng.sample::<f32, _>(StandardNormal);
                moved - moved.floor()
            }
            Self::Redraw { probability } => {
                if rng.random::<f32>() < probability {
                    rng.random()
                } else {
                    value
                }
            }
        };
        if planted(Fault::Clamped) {
            return moved.clamp(0.0, 1.0 - f32::EPSILON / 2.0);
        }
        wrap(moved)
    }

    /// Number of steps after which a coordinate is uniform on the circle to 1e-12.
    pub fn steps_to_uniform(&self) -> u64 {
        // -ln(1e-12).
        const LOG_TOLERANCE: f64 = 27.6;
        // The slowest Fourier mode decays by exp(-2 pi^2 variance) per step, if the variance is small.
        let by_variance =
            |variance: f64| LOG_TOLERANCE / (2.0 * std::f64::consts::PI.powi(2) * variance);
        let steps = match *self {
            Self::LogUniform {
                shortest,
                longest,
                log2_ratio,
            } => {
                let [shortest, longest] = [shortest, longest].map(f64::from);
                let variance = if log2_ratio == 0.0 {
                    longest * longest
                } else {
                    let ln_ratio = -f64::from(log2_ratio) * std::f64::consts::LN_2;
                    (longest * longest - shortest * shortest) / (2.0 * ln_ratio)
                };
                // For steps of nearly one length, mode n decays by cos(2 pi n length), which may be 1.
                if longest > 0.125 {
                    f64::INFINITY
                } else {
                    by_variance(variance)
                }
            }
            Self::Gaussian { deviation } => by_variance(f64::from(deviation).powi(2)),
            Self::Redraw { probability } => LOG_TOLERANCE / f64::from(probability),
        };
        steps.ceil() as u64
    }
}

impl fmt::Display for Perturbation {
    /// `log:SHORTEST:LONGEST`, `gaussian:DEVIATION` or `redraw:PROBABILITY`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::LogUniform {
                shortest, longest, ..
            } => write!(f, "log:{shortest}:{longest}"),
            Self::Gaussian { deviation } => write!(f, "gaussian:{deviation}"),
            Self::Redraw { probability } => write!(f, "redraw:{probability}"),
        }
    }
}

/// `value`, which is in [-1, 2), on the circle [0, 1).
#[inline]
pub fn wrap(value: f32) -> f32 {
    let wrapped = if value >= 1.0 {
        value - 1.0
    } else if value < 0.0 {
        value + 1.0
    } else {
        value
    };
    // A tiny negative number plus 1 rounds to 1, which is 0 on the circle.
    if wrapped >= 1.0 { 0.0 } else { wrapped }
}
