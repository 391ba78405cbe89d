//! Small steps.

use rand::Rng;

use crate::fault::{Fault, planted};

/// A symmetric step on the circle [0, 1): its length is log-uniform between two bounds and its sign
/// fair (Kelemen et al. 2002, section 3.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallStep {
    /// s_2.
    longest: f32,
    /// log2(s_1 / s_2).
    log2_ratio: f32,
}

impl Default for SmallStep {
    /// The lengths of Kelemen et al. (2002), section 3.1.
    fn default() -> Self {
        Self::new(1.0 / 1024.0, 1.0 / 64.0)
    }
}

impl SmallStep {
    /// Steps of lengths in [`shortest`, `longest`], with 0 < `shortest` <= `longest` <= 1/2.
    pub fn new(shortest: f32, longest: f32) -> Self {
        Self {
            longest,
            log2_ratio: (shortest / longest).log2(),
        }
    }

    /// `value` after one step: wrapped around the circle, never clamped, which would not be
    /// symmetric.
    #[inline]
    pub fn apply(&self, value: f32, rng: &mut impl Rng) -> f32 {
        let bits = rng.next_u64();
        // 24 bits for the length, and one far from them for the sign.
        let u = (bits >> 40) as f32 * (1.0 / (1u32 << 24) as f32);
        let length = self.longest * (self.log2_ratio * u).exp2();
        let up = bits & 1 == 0 || (planted(Fault::Asymmetric) && bits & 6 == 0);
        let moved = if up { value + length } else { value - length };
        if planted(Fault::Clamped) {
            return moved.clamp(0.0, 1.0 - f32::EPSILON / 2.0);
        }
        wrap(moved)
    }
}

/// `value`, at most one turn out of [0, 1), brought back.
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
