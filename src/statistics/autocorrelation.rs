//! Autocovariances of a Markov chain, and its integrated autocorrelation time
//! tau = 1 + 2 sum_{k > 0} rho_k. The mean of n correlated values has variance sigma^2 tau / n, so
//! n / tau is the effective sample size. All times are in steps of the chain.

use super::Moments;

/// Autocovariances c_0, ..., c_L of a series, L = min(`max_lag`, n - 1):
/// c_k = 1/n sum_{i < n - k} (x_i - m)(x_{i+k} - m) with m the mean of the series, the estimate
/// whose matrix is positive definite (Priestley 1981, "Spectral analysis and time series", section
/// 5.3.3). In squared units of the series. Costs n times L. An empty series has none.
pub fn autocovariance(series: &[f64], max_lag: usize) -> Vec<f64> {
    let centered = centered(series);
    (0..series.len().min(max_lag.saturating_add(1)))
        .map(|lag| lagged_product(&centered, lag))
        .collect()
}

/// Autocorrelations rho_k = c_k / c_0 of a series for k up to `max_lag`, from [`autocovariance`].
/// NaN for a constant series.
pub fn autocorrelation(series: &[f64], max_lag: usize) -> Vec<f64> {
    let covariances = autocovariance(series, max_lag);
    covariances.iter().map(|c| c / covariances[0]).collect()
}

/// Integrated autocorrelation time tau = 1 + 2 sum_{k > 0} rho_k of one series, in steps. The sum is
/// cut by Geyer's initial monotone sequence (Geyer 1992, "Practical Markov chain Monte Carlo",
/// section 3.3): for a reversible chain the sums rho_{2k} + rho_{2k+1} are positive and decreasing, so
/// estimates are summed while they are positive, each limited to the smallest so far. As in Stan the
/// first even term after the cut is added once if it is positive, which reduces the bias for
/// alternating signs.
///
/// tau is at least 1 / log10(n), Stan's guard against an estimate near 0. NaN for fewer than four
/// values, for a constant series and for one that is not finite. Costs n times the lag of the cut,
/// which is a few tau: at most n^2 / 2 products, seconds for n = 1e5.
pub fn integrated_autocorrelation_time(series: &[f64]) -> f64 {
    let centered = centered(series);
    let variance = lagged_product(&centered, 0);
    if series.len() < 4 || !is_positive(variance) {
        return f64::NAN;
    }
    let correlation = |lag| lagged_product(&centered, lag) / variance;
    initial_sequence(correlation, series.len()).max(1.0 / (series.len() as f64).log10())
}

/// Integrated autocorrelation time of several chains of equal length n with one target, in steps.
/// Differences between chains count as correlation: rho_t = 1 - (W - mean_m s_m^2 rho_{t,m}) / var+, with W
/// the mean variance within chains and var+ = (n - 1)/n W + B/n that of all values (Vehtari et al.
/// 2021, "Rank-normalization, folding, and localization: an improved R-hat", eqs. 2 to 3 and section
/// 3.2). Cut as in [`integrated_autocorrelation_time`]; the effective sample size of all chains
/// together is the number of values divided by it.
///
/// NaN without chains, for chains of fewer than four values, of unequal length, all equal to one
/// constant, or not finite.
pub fn integrated_autocorrelation_time_of_chains(chains: &[Vec<f64>]) -> f64 {
    let Some(n) = common_length(chains).filter(|&n| n >= 4) else {
        return f64::NAN;
    };
    let length = n as f64;
    let centered: Vec<Vec<f64>> = chains.iter().map(|c| centered(c)).collect();
    let covariance = |lag| {
        let sum: f64 = centered.iter().map(|c| lagged_product(c, lag)).sum();
        sum / centered.len() as f64
    };
    let within = covariance(0) * length / (length - 1.0);
    let means: Moments = chains.iter().map(|c| mean(c)).collect();
    let total = within * (length - 1.0) / length + means.variance();
    if !is_positive(total) {
        return f64::NAN;
    }
    let values = length * chains.len() as f64;
    initial_sequence(|lag| 1.0 - (within - covariance(lag)) / total, n).max(1.0 / values.log10())
}

/// The common length of all chains; `None` if they differ, or without chains.
pub(super) fn common_length(chains: &[Vec<f64>]) -> Option<usize> {
    let n = chains.first()?.len();
    chains.iter().all(|c| c.len() == n).then_some(n)
}

/// tau by the initial monotone sequence. `correlation` gives rho at a lag, and is evaluated only for the
/// lags needed.
fn initial_sequence(mut correlation: impl FnMut(usize) -> f64, n: usize) -> f64 {
    let mut pair = [1.0, correlation(1)];
    // Sum of the pairs so far, and the last of them, which limits the next.
    let (mut sum, mut last) = (0.0, f64::INFINITY);
    let mut lag = 0;
    // If no pair is negative, the last one is left out too, as in Stan and ArviZ.
    while pair[0] + pair[1] > 0.0 && lag + 4 < n {
        last = (pair[0] + pair[1]).min(last);
        sum += last;
        lag += 2;
        pair = [correlation(lag), correlation(lag + 1)];
    }
    2.0 * sum - 1.0 + pair[0].max(0.0)
}

fn is_positive(variance: f64) -> bool {
    variance.is_finite() && variance > 0.0
}

/// Welford's mean, which is exact for equal values.
fn mean(series: &[f64]) -> f64 {
    series.iter().copied().collect::<Moments>().mean
}

fn centered(series: &[f64]) -> Vec<f64> {
    let mean = mean(series);
    series.iter().map(|x| x - mean).collect()
}

/// 1/n sum x_i x_{i+lag}, in eight partial sums, so that additions do not wait for each other.
fn lagged_product(x: &[f64], lag: usize) -> f64 {
    let (a, b) = (&x[..x.len() - lag], &x[lag..]);
    let (blocks_a, blocks_b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest = blocks_a.remainder().iter().zip(blocks_b.remainder());
    let mut sum: f64 = rest.map(|(a, b)| a * b).sum();
    let mut lanes = [0.0; 8];
    for (a, b) in blocks_a.zip(blocks_b) {
        for i in 0..8 {
            lanes[i] += a[i] * b[i];
        }
    }
    sum += lanes.iter().sum::<f64>();
    sum / x.len() as f64
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Lehmer, assert_close, autoregressive};
    use super::*;
    use rand::SeedableRng;
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// c = chain(500, 0.6, 0); d = c - c.mean(); rho_k = (d[:-k] * d[k:]).sum() / (d * d).sum(), with
    /// `chain` as in `testing.rs`.
    #[test]
    fn autocorrelations_match_a_worked_example() {
        let series = Lehmer::new().chain(500, 0.6, 0.0);
        let rho = autocorrelation(&series, 5);
        for (lag, expected) in [
            (0, 1.0),
            (1, 0.615_953_218_700_345_3),
            (2, 0.381_333_972_529_161_5),
            (5, 0.114_037_882_135_912_23),
        ] {
            assert_close(rho[lag], expected, 1e-12);
        }
        assert_eq!(autocovariance(&[1.0, 3.0], 9), [1.0, -0.5]);
        assert!(autocovariance(&[], 3).is_empty());
    }

    /// Autoregressive series have tau = (1 + phi) / (1 - phi). The mean estimate of 32 series of 20000
    /// values is within 10%; its standard error is at most 3%, its bias by truncation less.
    #[test]
    fn autocorrelation_times_are_those_of_autoregressive_series() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
        for phi in [-0.5, 0.0, 0.5, 0.9, 0.97] {
            let chains: Vec<Vec<f64>> = (0..32)
                .map(|_| autoregressive(&mut rng, 20_000, phi))
                .collect();
            let truth = (1.0 + phi) / (1.0 - phi);
            let single: Moments = chains
                .iter()
                .map(|c| integrated_autocorrelation_time(c))
                .collect();
            assert_close(single.mean, truth, 0.1);
            let together = integrated_autocorrelation_time_of_chains(&chains);
            assert_close(together, truth, 0.1);
        }
    }

    /// Chains with different means: at shifts of 3 deviations 90% of the variance is between chains, and
    /// the effective sample size of each chain of 500 is about one.
    #[test]
    fn chains_with_different_means_have_a_long_autocorrelation_time() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
        let chains: Vec<Vec<f64>> = (0..4)
            .map(|k| {
                let series = autoregressive(&mut rng, 500, 0.0);
                series.iter().map(|x| x + 3.0 * f64::from(k)).collect()
            })
            .collect();
        let together = integrated_autocorrelation_time_of_chains(&chains);
        assert!(together > 300.0, "{together}");
        assert!(integrated_autocorrelation_time(&chains[0]) < 2.0);
    }

    #[test]
    fn degenerate_series_give_nan() {
        for series in [
            vec![],
            vec![1.0, 2.0, 1.0],
            vec![0.1; 50],
            vec![f64::NAN; 9],
        ] {
            assert!(integrated_autocorrelation_time(&series).is_nan());
            assert!(integrated_autocorrelation_time_of_chains(&[series.clone(), series]).is_nan());
        }
        assert!(integrated_autocorrelation_time_of_chains(&[]).is_nan());
        let unequal = [vec![1.0, 2.0, 0.0, 4.0], vec![1.0; 5]];
        assert!(integrated_autocorrelation_time_of_chains(&unequal).is_nan());
    }
}
