//! Hypothesis tests. Each returns a p-value: the probability, if the null hypothesis holds, of data
//! at least as far from it. A test at level alpha rejects when p < alpha and then raises a false
//! alarm with probability alpha.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

use super::Moments;

/// Pearson's chi-square test. Null hypothesis: the counts `observed` come from a multinomial with
/// means `expected` (both of the same length and total). Cells that expect fewer than 5 are pooled,
/// the rule under which the chi-square approximation holds (Cochran 1954). A count where nothing at
/// all is expected gives p = 0; with fewer than two pooled cells there is nothing to test and p = 1.
pub fn chi_square(observed: &[u64], expected: &[f64]) -> f64 {
    assert_eq!(observed.len(), expected.len(), "one expected mean per cell");
    let mut cells: Vec<(f64, f64)> = observed
        .iter()
        .zip(expected)
        .map(|(&o, &e)| (o as f64, e))
        .collect();
    if cells.iter().any(|&(o, e)| o > 0.0 && e <= 0.0) {
        return 0.0;
    }
    cells.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut statistic = 0.0;
    let mut pooled_cells = 0u32;
    let mut pool = (0.0, 0.0);
    for (i, &(o, e)) in cells.iter().enumerate() {
        pool = (pool.0 + o, pool.1 + e);
        // The remainder must not be left with too small a pool: close one only if the rest suffices.
        let rest: f64 = cells[i + 1..].iter().map(|c| c.1).take(8).sum();
        if pool.1 >= 5.0 && (rest >= 5.0 || i + 1 == cells.len()) {
            statistic += (pool.0 - pool.1).powi(2) / pool.1;
            pooled_cells += 1;
            pool = (0.0, 0.0);
        }
    }
    if pooled_cells < 2 {
        return 1.0;
    }
    ChiSquared::new(f64::from(pooled_cells - 1)).map_or(1.0, |d| d.sf(statistic))
}

/// Welch's t-test, two-sided. Null hypothesis: both samples have the same mean; variances may
/// differ (Welch 1947, with Satterthwaite's degrees of freedom). Two samples without variance give
/// 1 if their means are equal, else 0.
pub fn welch(a: &Moments, b: &Moments) -> f64 {
    let va = a.variance() / a.count as f64;
    let vb = b.variance() / b.count as f64;
    let difference = (a.mean - b.mean).abs();
    if va + vb <= 0.0 {
        return if difference == 0.0 { 1.0 } else { 0.0 };
    }
    let freedom =
        (va + vb).powi(2) / (va * va / (a.count - 1) as f64 + vb * vb / (b.count - 1) as f64);
    let t = difference / (va + vb).sqrt();
    StudentsT::new(0.0, 1.0, freedom).map_or(1.0, |d| 2.0 * d.sf(t))
}

/// Two-sided p-value of a standard normal `z`.
pub fn normal_two_sided(z: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(1.0, |d| 2.0 * d.sf(z.abs()))
}

/// Holm's step-down correction (Holm 1979): adjusted p-values in the order given. Rejecting those
/// below alpha keeps the probability of any false alarm among them below alpha.
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

    /// Null hypothesis true: the share of p-values below 0.05 over 2000 runs has standard deviation
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
                    .map(|_| shift + scale * (0..12).map(|_| rng.random::<f64>()).sum::<f64>())
                    .collect()
            };
            let a = sample(10, 0.0, 1.0);
            t += usize::from(welch(&a, &sample(30, -12.0, 3.0)) < 0.05);
            t_power += usize::from(welch(&a, &sample(30, -7.0, 3.0)) < 0.05);
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
