//! Reconstruction filters.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};
use std::ops::Range;

use statrs::function::erf::erf;

/// A separable reconstruction filter, parameterised as in Mitsuba 3; lengths in pixels. Its value at
/// a point is the product of [`Filter::evaluate`] of both offsets. Parameters must be positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// 1 within half a pixel of the centre.
    Box,
    /// Linear down to 0 at `radius`.
    Tent {
        /// Pixels.
        radius: f32,
    },
    /// A Gaussian, truncated at 4 standard deviations and shifted to 0 there. (Mitsuba 3 evaluates a
    /// polynomial that differs from it by less than 5e-4.)
    Gaussian {
        /// Standard deviation in pixels.
        stddev: f32,
    },
}

impl Filter {
    /// Half the width of the filter's support, in pixels.
    pub fn radius(&self) -> f64 {
        match *self {
            Self::Box => 0.5,
            Self::Tent { radius } => f64::from(radius),
            Self::Gaussian { stddev } => 4.0 * f64::from(stddev),
        }
    }

    /// The pixels along a side of `size` whose filters may reach `position`, in pixels.
    #[inline]
    pub fn reach(&self, position: f64, size: usize) -> Range<usize> {
        let radius = self.radius();
        // Conversion saturates: a negative bound becomes 0.
        let begin = (position - radius - 0.5).ceil() as usize;
        let end = (position + radius + 0.5).floor() as usize;
        begin.min(size)..end.min(size)
    }

    /// The one-dimensional filter at the offset `x` in pixels; not normalised.
    #[inline]
    pub fn evaluate(&self, x: f64) -> f64 {
        match *self {
            // Half open, so that a point on the edge of two pixels belongs to one of them.
            Self::Box => f64::from(u8::from((-0.5..0.5).contains(&x))),
            Self::Tent { radius } => (1.0 - x.abs() / f64::from(radius)).max(0.0),
            Self::Gaussian { stddev } => {
                let s = x / f64::from(stddev);
                ((-0.5 * s * s).exp() - GAUSSIAN_BIAS).max(0.0)
            }
        }
    }

    /// The integral of [`Filter::evaluate`] from `a` to `b`, in pixels.
    pub fn integral(&self, a: f64, b: f64) -> f64 {
        self.antiderivative(b) - self.antiderivative(a)
    }

    /// The antiderivative of the filter, 0 at 0: an odd function, constant beyond the radius.
    pub(super) fn antiderivative(&self, x: f64) -> f64 {
        let r = self.radius();
        let x = x.clamp(-r, r);
        match *self {
            Self::Box => x,
            Self::Tent { .. } => x - x * x.abs() / (2.0 * r),
            Self::Gaussian { stddev } => {
                let s = f64::from(stddev);
                s * FRAC_PI_2.sqrt() * erf(x / s * FRAC_1_SQRT_2) - GAUSSIAN_BIAS * x
            }
        }
    }

    /// For each of the `size` pixels along one side of a film, [`Filter::antiderivative`] at both ends
    /// of the part of the pixel's filter within the film. Their difference normalises the filter.
    pub(super) fn parts_within(&self, size: u32) -> Vec<[f64; 2]> {
        (0..size)
            .map(|j| {
                let center = f64::from(j) + 0.5;
                [-center, f64::from(size) - center].map(|end| self.antiderivative(end))
            })
            .collect()
    }
}

/// Value of the unit Gaussian at 4 standard deviations, exp(-8).
const GAUSSIAN_BIAS: f64 = 3.354_626_279_025_118_5e-4;

/// Number of cells in the table of a Gaussian's antiderivative.
const CELLS: usize = 1024;

/// Samples a [`Filter`] by inversion of its antiderivative: monotone in the random number.
#[derive(Clone, Debug)]
pub struct FilterSampler {
    filter: Filter,
    /// Antiderivative and value of a Gaussian at `CELLS + 1` offsets from 0 to its radius; empty for
    /// filters that are inverted in closed form.
    knots: Vec<(f64, f64)>,
}

impl FilterSampler {
    /// Prepares `filter` for sampling.
    pub fn new(filter: Filter) -> Self {
        let knot = |i: usize| {
            let x = filter.radius() * i as f64 / CELLS as f64;
            (filter.antiderivative(x), filter.evaluate(x))
        };
        let knots = match filter {
            Filter::Box | Filter::Tent { .. } => Vec::new(),
            Filter::Gaussian { .. } => (0..=CELLS).map(knot).collect(),
        };
        Self { filter, knots }
    }

    /// An offset in pixels, for `u` in [0, 1), with density `evaluate(x)` over the filter's whole
    /// integral.
    pub fn sample(&self, u: f64) -> f64 {
        let half = self.filter.antiderivative(self.filter.radius());
        self.invert((2.0 * u - 1.0) * half)
    }

    /// The offset at which the antiderivative is `y`.
    #[inline]
    pub(super) fn invert(&self, y: f64) -> f64 {
        match self.filter {
            Filter::Box => y,
            Filter::Tent { radius } => {
                // The root of x - x^2/(2r) = |y|, in the form without cancellation for small y.
                let root = (1.0 - 2.0 * y.abs() / f64::from(radius)).max(0.0).sqrt();
                2.0 * y / (1.0 + root)
            }
            Filter::Gaussian { .. } => self.invert_table(y.abs()).copysign(y),
        }
    }

    /// As [`Self::invert`] for `y` >= 0. The filter is linear within a cell (pbrt, 4th ed., section A.4.1
    /// "Sampling the linear function") and has the exact integral of the cell.
    fn invert_table(&self, y: f64) -> f64 {
        let after = self.knots.partition_point(|&(integral, _)| integral <= y);
        let cell = after.clamp(1, CELLS) - 1;
        let ((p0, h0), (p1, h1)) = (self.knots[cell], self.knots[cell + 1]);
        let v = ((y - p0) / (p1 - p0)).clamp(0.0, 1.0);
        let t = v * (h0 + h1) / (h0 + (h0 * h0 + v * (h1 * h1 - h0 * h0)).max(0.0).sqrt());
        self.filter.radius() * (cell as f64 + t.min(1.0)) / CELLS as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FILTERS: [Filter; 5] = [
        Filter::Box,
        Filter::Tent { radius: 1.0 },
        Filter::Tent { radius: 0.3 },
        Filter::Gaussian { stddev: 0.5 },
        Filter::Gaussian { stddev: 1.7 },
    ];

    /// mi.load_dict({'type': T, ...}).eval(x, True) of Mitsuba 3.9.1, whose Gaussian is a fit.
    #[test]
    fn values_are_mitsubas() {
        let gaussian = Filter::Gaussian { stddev: 0.5 };
        let wide = Filter::Gaussian { stddev: 0.8 };
        let tent = Filter::Tent { radius: 1.5 };
        for (filter, x, expected, tolerance) in [
            (Filter::Box, -0.5, 1.0, 0.0),
            (Filter::Box, 0.5, 0.0, 0.0),
            (tent, -1.0, 0.333_333_3, 1e-6),
            (tent, 0.25, 0.833_333_3, 1e-6),
            (tent, 1.5, 0.0, 0.0),
            (gaussian, 0.0, 0.999_247_1, 5e-4),
            (gaussian, -0.5, 0.606_423, 5e-4),
            (gaussian, 1.0, 0.134_960_5, 5e-4),
            (gaussian, 1.9, 0.000_387_9, 5e-5),
            (gaussian, 2.5, 0.0, 0.0),
            (wide, 2.0, 0.043_612_4, 5e-4),
            (wide, 3.1, 0.000_222_3, 5e-5),
        ] {
            let value = filter.evaluate(x);
            assert!(
                (value - expected).abs() <= tolerance,
                "{filter:?} at {x}: {value}"
            );
        }
        assert_eq!(gaussian.radius(), 2.0);
        assert_eq!(GAUSSIAN_BIAS, (-8.0_f64).exp());
    }

    #[test]
    fn integrals_are_sums_of_values() {
        for filter in FILTERS {
            let r = filter.radius();
            for (a, b) in [
                (-r, r),
                (-0.5, 3.0 * r),
                (-2.0 * r, 0.1 * r),
                (0.2 * r, 0.7 * r),
            ] {
                let n = 200_000;
                let width = (b - a) / f64::from(n);
                let midpoint = |i: i32| filter.evaluate(a + (f64::from(i) + 0.5) * width);
                let sum = (0..n).map(midpoint).sum::<f64>() * width;
                let integral = filter.integral(a, b);
                assert!(
                    (integral - sum).abs() < 1e-5,
                    "{filter:?} {a}..{b}: {integral} {sum}"
                );
            }
        }
    }

    proptest! {
        /// The cumulative distribution at a sample is the random number, to the table's precision.
        #[test]
        fn sampling_inverts_the_cumulative_distribution(u in 0.0..1.0f64, which in 0..FILTERS.len()) {
            let filter = FILTERS[which];
            let r = filter.radius();
            let x = FilterSampler::new(filter).sample(u);
            prop_assert!(x.abs() <= r);
            let cdf = filter.integral(-r, x) / filter.integral(-r, r);
            prop_assert!((cdf - u).abs() < 1e-8, "{filter:?}: {cdf} at {u}");
        }

        #[test]
        fn sampling_is_monotone(a in 0.0..1.0f64, b in 0.0..1.0f64, which in 0..FILTERS.len()) {
            let sampler = FilterSampler::new(FILTERS[which]);
            prop_assert!(sampler.sample(a.min(b)) <= sampler.sample(a.max(b)));
        }
    }
}
