//! Confidence intervals of measured rates.

use statrs::distribution::{Beta, ContinuousCDF};

/// Clopper and Pearson's interval for a probability from `successes` of `trials` (1934, "The use of
/// confidence or fiducial limits illustrated in the case of the binomial"): it covers the true value with
/// probability `level` or more, for any true value. Its ends are the Beta quantiles
/// B((1 - level)/2; s, n - s + 1) and B((1 + level)/2; s + 1, n - s), or 0 without successes and 1 without
/// failures. Without trials, and for more successes than trials, [0, 1].
pub fn clopper_pearson(successes: u64, trials: u64, level: f64) -> [f64; 2] {
    let failures = trials.saturating_sub(successes);
    let quantile = |a: u64, b: u64, at: f64| {
        let beta = Beta::new(a as f64, b as f64).ok();
        beta.map(|beta| beta.inverse_cdf(at))
    };
    if successes > trials {
        return [0.0, 1.0];
    }
    // A Beta distribution has no zero parameter; the ends are 0 and 1 then.
    let low = quantile(successes, failures + 1, 0.5 * (1.0 - level));
    let high = quantile(successes + 1, failures, 0.5 * (1.0 + level));
    [low.unwrap_or(0.0), high.unwrap_or(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// scipy.stats.binomtest(k, n).proportion_ci(level, "exact")
    #[test]
    fn intervals_match_worked_examples() {
        for (k, n, level, expected) in [
            (0, 20, 0.95, [0.0, 0.168_433_470_983_085_48]),
            (
                7,
                50,
                0.99,
                [0.042_468_787_378_833_785, 0.309_106_965_964_818_9],
            ),
            (20, 20, 0.95, [0.831_566_529_016_914_5, 1.0]),
            (0, 0, 0.95, [0.0, 1.0]),
        ] {
            let found = clopper_pearson(k, n, level);
            let error = (found[0] - expected[0]).abs() + (found[1] - expected[1]).abs();
            assert!(error < 1e-7, "{found:?} {expected:?}");
        }
    }

    /// Summed over all outcomes, the interval at 0.95 covers the true value with at least that probability,
    /// for every true value tried. The test is not random.
    #[test]
    fn intervals_have_their_stated_coverage() {
        use statrs::distribution::{Binomial, Discrete};
        let intervals: Vec<[f64; 2]> = (0..=40).map(|k| clopper_pearson(k, 40, 0.95)).collect();
        for i in 1..100 {
            let truth = f64::from(i) / 100.0;
            let binomial = Binomial::new(truth, 40).unwrap();
            let held: f64 = (0..=40)
                .filter(|&k| (intervals[k][0]..=intervals[k][1]).contains(&truth))
                .map(|k| binomial.pmf(k as u64))
                .sum();
            assert!((0.95..1.0).contains(&held), "{truth}: {held}");
        }
    }
}
