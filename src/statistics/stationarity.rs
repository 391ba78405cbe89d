//! Tests of the stationarity of one series. Both need the variance of a mean of correlated values, S / n,
//! with S the spectral density at frequency zero.

use super::autocorrelation::{autocovariance, integrated_autocorrelation_time};
use super::{Moments, normal_two_sided};

/// Spectral density at frequency zero, S = sum over all lags of the autocovariance: n times the
/// variance of the mean of n values, n large. Estimated as c_0 tau with Geyer's initial monotone
/// sequence ([`integrated_autocorrelation_time`]), not by an autoregressive fit as in the R package
/// coda. In squared units of the series. NaN where tau is.
pub fn spectral_density_at_zero(series: &[f64]) -> f64 {
    let variance = autocovariance(series, 0).first().copied();
    variance.unwrap_or(f64::NAN) * integrated_autocorrelation_time(series)
}

/// Geweke's diagnostic (Geweke 1992, "Evaluating the accuracy of sampling-based approaches to the
/// calculation of posterior moments"): z = (m_a - m_b) / sqrt(S_a/n_a + S_b/n_b) for the mean of the
/// first 10% and of the last 50% of a series, S by [`spectral_density_at_zero`] of each part.
/// Null hypothesis: the series is stationary; z is then about standard normal if the shorter part spans a
/// hundred autocorrelation times or more. [`normal_two_sided`] gives the p-value.
///
/// It detects a drift that lasts longer than the first part. A transient within that part increases S_a and
/// is missed; [`heidelberger_welch`], whose S is from the second half, detects it.
///
/// NaN for fewer than 40 values, and if a part is constant or not finite.
pub fn geweke(series: &[f64]) -> f64 {
    let n = series.len();
    if n < 40 {
        return f64::NAN;
    }
    let [a, b] = [&series[..n / 10], &series[n - n / 2..]].map(|part| {
        let variance = spectral_density_at_zero(part) / part.len() as f64;
        (part.iter().copied().collect::<Moments>().mean, variance)
    });
    (a.0 - b.0) / (a.1 + b.1).sqrt()
}

/// P-value of [`geweke`]'s z; NaN where z is.
pub fn geweke_p_value(series: &[f64]) -> f64 {
    normal_two_sided(geweke(series))
}

/// Result of Heidelberger and Welch's test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeidelbergerWelch {
    /// Number of values to discard at the beginning for the rest to pass; `None` if the second half does
    /// not pass.
    pub discarded: Option<usize>,
    /// P-value of the rest, or of the second half if none passes.
    pub p_value: f64,
}

/// Heidelberger and Welch's stationarity test (1983, "Simulation run length control in the presence of
/// an initial transient", Operations Research 31, section 2; steps as in coda's `heidel.diag`): the
/// first 0, 10, 20, ... 50% of the series are discarded until [`stationarity_p_value`] of the rest is at
/// least `level`, with S always from the second half. As up to six tests are made until one passes, the
/// last p-value is not uniform, and stationary series fail with a probability below `level`.
///
/// Fails, with p NaN, for fewer than eight values, a constant second half and values not finite.
pub fn heidelberger_welch(series: &[f64], level: f64) -> HeidelbergerWelch {
    let n = series.len();
    let density = spectral_density_at_zero(&series[n / 2..]);
    let mut p_value = f64::NAN;
    for tenths in 0..=5 {
        let discarded = n * tenths / 10;
        p_value = stationarity_p_value(&series[discarded..], density);
        if p_value >= level {
            return HeidelbergerWelch {
                discarded: Some(discarded),
                p_value,
            };
        }
    }
    HeidelbergerWelch {
        discarded: None,
        p_value,
    }
}

/// P-value of one step of [`heidelberger_welch`]. Null hypothesis: the series is stationary with
/// spectral density `density` at zero. With n values, T_k the sum of the first k and m their mean,
/// B_k = (T_k - k m) / sqrt(n S) is about a Brownian bridge, and 1/n sum B_k^2 has the
/// distribution of [`cramer_von_mises_survival`]. NaN for a `density` that is not positive, for an
/// empty series and for values not finite.
pub fn stationarity_p_value(series: &[f64], density: f64) -> f64 {
    let n = series.len() as f64;
    let mean = series.iter().copied().collect::<Moments>().mean;
    let (mut sum, mut squares) = (0.0, 0.0);
    for x in series {
        sum += x - mean;
        squares += sum * sum;
    }
    let statistic = squares / (n * n * density);
    if density > 0.0 && statistic.is_finite() {
        cramer_von_mises_survival(statistic)
    } else {
        f64::NAN
    }
}

/// Probability that the integral of a squared Brownian bridge, the limit of Cramér's and von Mises's
/// statistic, exceeds `x`. One minus the series of Anderson and Darling (1952) in the form of Csörgő
/// and Faraway (1996, "The exact and asymptotic distributions of Cramér-von Mises statistics", J. R.
/// Statist. Soc. B 58, eq. 1.3): 1 / (pi^{3/2} sqrt(x)) sum_k Gamma(k + 1/2) / k! sqrt(4k + 1) e^{-q}
/// K_{1/4}(q) with q = (4k + 1)^2 / (16 x). Absolute error below 1e-12; 1 for x <= 0.
pub fn cramer_von_mises_survival(x: f64) -> f64 {
    use std::f64::consts::PI;
    if x <= 0.0 {
        return 1.0;
    }
    // Beyond 12 the probability is below 1e-25.
    if x > 12.0 {
        return 0.0;
    }
    // Gamma(k + 1/2) / k!
    let mut ratio = PI.sqrt();
    let mut sum = 0.0;
    for k in 0..40 {
        let y = f64::from(4 * k + 1);
        let term = ratio * y.sqrt() * damped_bessel(y * y / (16.0 * x));
        sum += term;
        if term <= 1e-17 * sum {
            break;
        }
        ratio *= (f64::from(k) + 0.5) / (f64::from(k) + 1.0);
    }
    (1.0 - sum / (PI.powf(1.5) * x.sqrt())).clamp(0.0, 1.0)
}

/// e^{-q} K_{1/4}(q), from K_v(q) = integral over t > 0 of exp(-q cosh t) cosh(v t) (Abramowitz and
/// Stegun 1964, 9.6.24). The integrand is even and analytic and decays doubly exponentially, so the
/// trapezoidal rule with step 1/8 is exact up to rounding.
fn damped_bessel(q: f64) -> f64 {
    let step = 0.125;
    let mut sum = 0.5 * (-2.0 * q).exp();
    let first = sum;
    for i in 1..400 {
        let t = step * f64::from(i);
        let term = (-q * (1.0 + t.cosh())).exp() * (0.25 * t).cosh();
        sum += term;
        // For small q terms increase at first.
        if term <= 1e-18 * sum && term <= first {
            break;
        }
    }
    step * sum
}

#[cfg(test)]
mod tests {
    use super::super::testing::{
        Lehmer, assert_close, assert_level_kept, assert_uniform, autoregressive,
    };
    use super::*;
    use rand::SeedableRng;
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// 1 - scipy.stats._hypotests._cdf_cvm_inf(x), which stops at terms below 1e-7.
    #[test]
    fn cramers_distribution_matches_known_values() {
        for (x, expected) in [
            (0.02, 0.996_999_385_698_398_1),
            (0.05, 0.876_280_931_041_351),
            (0.1, 0.584_873_438_406_796_7),
            (0.2, 0.267_470_430_540_777_1),
            (0.461_36, 0.050_000_383_132_652_87),
            (0.743_46, 0.009_999_961_915_457_156),
            (1.2, 0.000_842_601_915_460_372_6),
            (2.0, 1.278_073_626_576_059_5e-5),
        ] {
            let found = cramer_von_mises_survival(x);
            assert!((found - expected).abs() < 2e-8, "{x}: {found} {expected}");
        }
        assert_eq!(cramer_von_mises_survival(0.0), 1.0);
        assert!(cramer_von_mises_survival(1e-4) > 1.0 - 1e-9);
        assert!(cramer_von_mises_survival(11.9) < 1e-12);
    }

    /// scipy.special.kve(0.25, q) * exp(-2 * q)
    #[test]
    fn bessels_function_matches_known_values() {
        for (q, expected) in [
            (0.005, 7.521_450_596_431_809),
            (0.1, 2.429_630_410_969_844),
            (1.0, 0.158_460_307_514_457_25),
            (30.0, 1.997_538_259_249_308_3e-27),
        ] {
            assert_close(damped_bessel(q), expected, 1e-12);
        }
    }

    #[test]
    fn degenerate_series_give_nan() {
        let failed = heidelberger_welch(&[], 0.05);
        assert!(failed.discarded.is_none() && failed.p_value.is_nan());
        for series in [vec![1.0; 3], vec![0.1; 200], vec![f64::NAN; 200]] {
            assert!(geweke_p_value(&series).is_nan());
            let failed = heidelberger_welch(&series, 0.05);
            assert!(failed.discarded.is_none() && failed.p_value.is_nan());
        }
        let series = Lehmer::new().chain(64, 0.5, 0.0);
        assert!(geweke(&series).is_finite());
    }

    /// 1000 stationary series of 4000 values with tau = 3. Geweke's p-values are uniform (false alarm
    /// rate 1e-3), as are those of the first step of Heidelberger and Welch; with all its steps no more
    /// series fail than the level allows. A shift of the first 15% by 0.7 deviations is detected by
    /// Geweke in more than 95% at level 0.01. A start at 8 deviations that decays at a rate of 1/100 is
    /// hardly ever detected by Geweke; Heidelberger and Welch detect it in more than 90% and accept the
    /// rest after discarding a part.
    #[test]
    fn tests_of_stationarity_keep_their_level_and_have_power() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(51);
        let (mut z, mut first, mut last) = (vec![], vec![], vec![]);
        let (mut geweke_found, mut hidden, mut discarded) = (0, 0, 0);
        for _ in 0..1000 {
            let mut series = autoregressive(&mut rng, 4000, 0.5);
            z.push(geweke_p_value(&series));
            let density = spectral_density_at_zero(&series[2000..]);
            first.push(stationarity_p_value(&series, density));
            let result = heidelberger_welch(&series, 0.05);
            last.push(if result.discarded.is_some() { 1.0 } else { 0.0 });
            let mut late = series.clone();
            late[..600].iter_mut().for_each(|x| *x += 0.7);
            geweke_found += u32::from(geweke_p_value(&late) < 0.01);
            for (i, x) in series.iter_mut().enumerate() {
                *x += 8.0 * (-(i as f64) / 100.0).exp();
            }
            hidden += u32::from(geweke_p_value(&series) < 0.01);
            let start = heidelberger_welch(&series, 0.05).discarded;
            discarded += u32::from(start.is_some_and(|start| start > 0));
        }
        assert_uniform(&mut z);
        assert_uniform(&mut first);
        let failed = last.iter().filter(|&&passed| passed == 0.0).count();
        assert!(failed < 50, "{failed} of 1000");
        assert_level_kept(&first);
        assert!(geweke_found > 950, "{geweke_found} of 1000");
        assert!(
            hidden < 50,
            "{hidden} of 1000: the note on transients in `geweke` is wrong"
        );
        assert!(discarded > 900, "{discarded} of 1000");
    }
}
