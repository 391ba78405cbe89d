//! Hypothesis tests. Each returns a p-value: the probability, if the null hypothesis holds, of data
//! at least as far from it. A test at level alpha rejects when p < alpha and then raises a false
//! alarm with probability alpha.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

use super::Moments;
use super::pooling::pool_sparse;

/// Pearson's chi-square test. Null hypothesis: the counts `observed` come from a multinomial with
/// means `expected` (both of the same length and total). Cells that expect fewer than 5 are pooled,
/// the rule under which the chi-square approximation holds (Cochran 1954). A count in a cell that expects
/// none gives p = 0; with fewer than two pooled cells p = 1.
pub fn chi_square(observed: &[u64], expected: &[f64]) -> f64 {
    // Not statrs' `chisquare`: it pools no cells, and rejects totals that differ by rounding.
    assert_eq!(observed.len(), expected.len(), "one expected mean per cell");
    let impossible = |(&o, &e): (&u64, &f64)| o > 0 && e <= 0.0;
    if observed.iter().zip(expected).any(impossible) {
        return 0.0;
    }
    let (pool_of, pools) = pool_sparse(expected, 5.0);
    if pools < 2 {
        return 1.0;
    }
    let mut cells = vec![(0.0, 0.0); pools];
    for ((&pool, &o), &e) in pool_of.iter().zip(observed).zip(expected) {
        cells[pool] = (cells[pool].0 + o as f64, cells[pool].1 + e);
    }
    let statistic: f64 = cells.iter().map(|(o, e)| (o - e).powi(2) / e).sum();
    ChiSquared::new((pools - 1) as f64).map_or(1.0, |d| d.sf(statistic))
}

/// Welch's t-test, two-sided. Null hypothesis: both samples have the same mean; variances may
/// differ (Welch 1947, with Satterthwaite's degrees of freedom). Two samples without variance give
/// 1 if their means are equal, else 0.
pub fn welch(a: &Moments, b: &Moments) -> f64 {
    let difference = (a.mean - b.mean).abs();
    match Difference::of(a, b) {
        Some(d) => 2.0 * d.student().map_or(0.5, |s| s.sf(difference / d.error)),
        None if difference == 0.0 => 1.0,
        None => 0.0,
    }
}

/// Welch's test as a z-score, positive if `a` has the larger mean: standard normal under the null
/// hypothesis of [`welch`]. It is (a - b) / sqrt(var a + var b), corrected for variances estimated from few
/// values: the normal tail beyond it equals Student's tail beyond t. NaN for two samples without variance.
pub fn welch_score(a: &Moments, b: &Moments) -> f64 {
    let Some(difference) = Difference::of(a, b) else {
        return f64::NAN;
    };
    let t = (a.mean - b.mean) / difference.error;
    let tail = difference.student().map_or(0.5, |s| s.sf(t.abs()));
    // Tails that underflow all have the same score.
    let quantile = Normal::standard().inverse_cdf(tail.max(f64::MIN_POSITIVE));
    -quantile * t.signum()
}

/// The smallest difference of means that Welch's test of two such samples at `level` detects with
/// probability `power`: (t_{1 - level/2} + t_power) sqrt(var a + var b), the usual formula for z with
/// the quantiles of Student's distribution. For one of m tests under Holm's correction, `level` is
/// that of the first step, alpha / m. 0 for two samples without variance.
pub fn smallest_detectable(a: &Moments, b: &Moments, level: f64, power: f64) -> f64 {
    let quantiles = |d: &Difference| {
        let student = d.student()?;
        Some(student.inverse_cdf(power) - student.inverse_cdf(0.5 * level))
    };
    Difference::of(a, b).map_or(0.0, |d| d.error * quantiles(&d).unwrap_or(f64::INFINITY))
}

/// Precision of a difference of two means.
struct Difference {
    /// Its standard error.
    error: f64,
    /// Satterthwaite's degrees of freedom.
    freedom: f64,
}

impl Difference {
    /// `None` if neither sample has any variance.
    fn of(a: &Moments, b: &Moments) -> Option<Self> {
        let va = a.variance() / a.count as f64;
        let vb = b.variance() / b.count as f64;
        let parts = va * va / (a.count - 1) as f64 + vb * vb / (b.count - 1) as f64;
        (va + vb > 0.0).then(|| Self {
            error: (va + vb).sqrt(),
            freedom: (va + vb).powi(2) / parts,
        })
    }

    fn student(&self) -> Option<StudentsT> {
        StudentsT::new(0.0, 1.0, self.freedom).ok()
    }
}

/// Kolmogorov and Smirnov's distance: the largest difference between the share of `values` below x
/// and x itself, over x in [0, 1]. For p-values of true null hypotheses it is small; its distribution
/// depends on their correlation.
pub fn distance_from_uniform(values: &mut [f64]) -> f64 {
    // Not statrs' `ks_onesample`: it copies the values, and always computes a p-value too.
    values.sort_by(f64::total_cmp);
    let n = values.len() as f64;
    let gaps = values.iter().enumerate().map(|(i, &v)| {
        let [below, with] = [i as f64 / n, (i + 1) as f64 / n];
        (v - below).max(with - v)
    });
    gaps.fold(0.0, f64::max)
}

/// Two-sided p-value of a standard normal `z`.
pub fn normal_two_sided(z: f64) -> f64 {
    2.0 * Normal::standard().sf(z.abs())
}

/// Holm's step-down correction (Holm 1979): adjusted p-values in the given order. Rejecting those below
/// alpha keeps the probability of any false alarm below alpha.
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&i, &j| p_values[i].total_cmp(&p_values[j]));
    let mut adjusted = vec![1.0; p_values.len()];
    let mut running: f64 = 0.0;
    for (rank, &i) in order.iter().enumerate() {
        running = running
            .max(p_values[i] * (p_values.len() - rank) as f64)
            .min(1.0);
        adjusted[i] = running;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_xoshiro::Xoshiro256PlusPlus;

    #[test]
    fn holm_matches_a_worked_example() {
        // Sorted: 0.005*4, 0.01*3, 0.03*2, 0.04*1 made monotone.
        let adjusted = holm(&[0.01, 0.04, 0.03, 0.005]);
        for (a, e) in adjusted.iter().zip([0.03, 0.06, 0.06, 0.02]) {
            assert!((a - e).abs() < 1e-12, "{adjusted:?}");
        }
    }

    #[test]
    fn welch_matches_a_worked_example() {
        // scipy.stats.ttest_ind(a, b, equal_var=False) -> p = 0.010751561149784488
        let a: Moments = [3.0, 4.0, 1.0, 2.1].into_iter().collect();
        let b: Moments = [490.2, 340.0, 433.9].into_iter().collect();
        let p = welch(&a, &b);
        assert!((p - 0.010_751_561).abs() < 1e-6, "{p}");
    }

    /// The distance of independent values has Kolmogorov's distribution, whose quantile at 0.95 is
    /// 1.358 / sqrt(n): of 1000 distances 50 +- 7 exceed it.
    #[test]
    fn distances_from_uniform_are_kolmogorovs() {
        assert!((distance_from_uniform(&mut [0.9, 0.2, 0.3]) - 0.3667).abs() < 1e-4);
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(11);
        let critical = 1.358 / 200f64.sqrt();
        let mut beyond = |power: f64| {
            let mut values = [0.0; 200];
            let mut is_beyond = || {
                values.fill_with(|| rng.random::<f64>().powf(power));
                distance_from_uniform(&mut values) > critical
            };
            (0..1000).filter(|_| is_beyond()).count()
        };
        let alarms = beyond(1.0);
        assert!((20..=80).contains(&alarms), "{alarms} of 1000");
        assert!(beyond(1.4) > 900);
    }

    /// A difference of the size detectable with power 0.9 is detected in 90% of 4000 runs, with a standard
    /// deviation of 0.5%; scores have the p-values of the test.
    #[test]
    fn the_smallest_detectable_difference_has_the_stated_power() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
        let (level, power) = (1e-3, 0.9);
        let truth = [(16, 1.0), (32, 9.0)].map(|(n, v)| Moments::from_summary(n, 0.0, v));
        let size = smallest_detectable(&truth[0], &truth[1], level, power);
        let runs = 4000;
        let mut found = 0;
        for _ in 0..runs {
            let [a, b] = [(0, size), (1, 0.0)].map(|(i, shift): (usize, f64)| -> Moments {
                let deviation = truth[i].variance().sqrt();
                (0..truth[i].count)
                    .map(|_| shift + deviation * rng.sample::<f64, _>(StandardNormal))
                    .collect()
            });
            let (p, score) = (welch(&a, &b), welch_score(&a, &b));
            assert!(
                (normal_two_sided(score) / p - 1.0).abs() < 1e-6,
                "{score} {p}"
            );
            assert_eq!(score > 0.0, a.mean > b.mean);
            found += usize::from(p < level);
        }
        let rate = found as f64 / f64::from(runs);
        assert!((rate - power).abs() < 0.02, "power {rate}");
    }

    /// Under the null hypothesis the share of p-values below 0.05 over 2000 runs has standard deviation
    /// 0.005; outside 0.05 +- 0.02 (4 sigma) the test does not keep its level. The seed is fixed.
    #[test]
    fn tests_keep_their_level_and_have_power() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
        let runs = 2000;
        let (mut chi, mut t, mut chi_power, mut t_power) = (0, 0, 0, 0);
        for _ in 0..runs {
            let mut counts = [[0u64; 20]; 2];
            for _ in 0..400 {
                counts[0][rng.random_range(0..20)] += 1;
                let u: f64 = rng.random();
                counts[1][(u.powf(1.5) * 20.0) as usize] += 1;
            }
            chi += usize::from(chi_square(&counts[0], &[20.0; 20]) < 0.05);
            chi_power += usize::from(chi_square(&counts[1], &[20.0; 20]) < 0.05);
            let mut sample = |n: usize, shift: f64, scale: f64| -> Moments {
                (0..n)
                    .map(|_| shift + scale * rng.sample::<f64, _>(StandardNormal))
                    .collect()
            };
            let a = sample(10, 0.0, 1.0);
            t += usize::from(welch(&a, &sample(30, 0.0, 3.0)) < 0.05);
            t_power += usize::from(welch(&a, &sample(30, 5.0, 3.0)) < 0.05);
        }
        for (name, alarms) in [("chi-square", chi), ("welch", t)] {
            let rate = alarms as f64 / f64::from(runs);
            assert!(
                (rate - 0.05).abs() < 0.02,
                "{name}: false alarm rate {rate}"
            );
        }
        for (name, rejections) in [("chi-square", chi_power), ("welch", t_power)] {
            assert!(rejections > 1900, "{name}: {rejections} of 2000");
        }
    }
}
