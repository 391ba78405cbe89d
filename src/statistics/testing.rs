//! Random series for the tests of this module, and checks of their p-values.

use rand::RngExt;
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::distance_from_uniform;

/// Numbers that Python reproduces bit for bit: Park and Miller's generator ("Random number
/// generators: good ones are hard to find", 1988) with multiplier 48271, started at 1.
///
/// ```python
/// s = 1
/// def u():
///     global s; s = s * 48271 % 2147483647; return s / 2147483647
/// def chain(n, phi, shift):
///     x, out = 0.0, []
///     for _ in range(n): x = phi * x + u() - 0.5; out.append(shift + x)
///     return out
/// ```
pub struct Lehmer(u64);

impl Lehmer {
    pub fn new() -> Self {
        Self(1)
    }

    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0 * 48271 % 2_147_483_647;
        self.0 as f64 / 2_147_483_647.0
    }

    pub fn chain(&mut self, n: usize, phi: f64, shift: f64) -> Vec<f64> {
        let mut x = 0.0;
        let step = |_| {
            x = phi * x + self.uniform() - 0.5;
            shift + x
        };
        (0..n).map(step).collect()
    }
}

/// A stationary autoregressive series x' = phi x + sqrt(1 - phi^2) z of variance 1. Its integrated
/// autocorrelation time is (1 + phi) / (1 - phi).
pub fn autoregressive(rng: &mut Xoshiro256PlusPlus, n: usize, phi: f64) -> Vec<f64> {
    let mut x: f64 = rng.sample(StandardNormal);
    let step = |_| {
        x = phi * x + (1.0 - phi * phi).sqrt() * rng.sample::<f64, _>(StandardNormal);
        x
    };
    (0..n).map(step).collect()
}

/// P-values of true null hypotheses are uniform: Kolmogorov's distance of n of them exceeds
/// 1.95 / sqrt(n) with probability 1e-3.
pub fn assert_uniform(p_values: &mut [f64]) {
    let limit = 1.95 / (p_values.len() as f64).sqrt();
    let distance = distance_from_uniform(p_values);
    assert!(distance < limit, "distance {distance}, limit {limit}");
}

/// A conservative test does not exceed the false-alarm rates 0.05 and 0.01 by more than 4 standard
/// deviations: the false-alarm rate of this check is at most 3e-5 for each level.
pub fn assert_level_kept(p_values: &[f64]) {
    let n = p_values.len() as f64;
    for level in [0.05, 0.01] {
        let alarms = p_values.iter().filter(|&&p| p < level).count() as f64;
        let limit = level * n + 4.0 * (level * (1.0 - level) * n).sqrt();
        assert!(
            alarms <= limit,
            "{alarms} alarms at {level}, at most {limit}"
        );
    }
}

/// |a - b| is within `tolerance` of |b|.
pub fn assert_close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a} is not {b}");
}
