//! Convergence of several chains to one distribution: R-hat and effective sample sizes after Vehtari,
//! Gelman, Simpson, Carpenter and Bürkner (2021, "Rank-normalization, folding, and localization: an
//! improved R-hat", Bayesian Analysis 16), which also hold for targets without mean or variance, and
//! nested R-hat for many short chains.
//!
//! Chains have equal lengths. Results are NaN, as in Stan's `posterior`, for chains of fewer than four
//! values or of unequal length, for values that are not finite, and for values that are all equal, because
//! a constant cannot be told from a stuck chain.

use statrs::distribution::{ContinuousCDF, Normal};

use super::Moments;
use super::autocorrelation::{common_length, integrated_autocorrelation_time_of_chains};

/// Rank-normalised split R-hat (Vehtari et al. 2021, section 4): the larger of the split R-hats of
/// the values' normal scores, which detects a difference of location, and of the scores of their
/// distances from the median, which detects one of scale. Near 1 if the chains agree; the paper recommends
/// less than 1.01 for four chains or more. Infinite if every half chain is constant but they differ. NaN
/// also for fewer than two chains, as in ArviZ.
pub fn r_hat(chains: &[Vec<f64>]) -> f64 {
    let Some(halves) = split(chains).filter(|_| chains.len() >= 2) else {
        return f64::NAN;
    };
    let median = quantile(&halves.concat(), 0.5);
    let folded = map(&halves, |x| (x - median).abs());
    // `max` ignores NaN if only one of the two is defined.
    plain_r_hat(&normal_scores(&halves)).max(plain_r_hat(&normal_scores(&folded)))
}

/// Bulk effective sample size: that of the normal scores of split chains (Vehtari et al. 2021,
/// section 4), by [`integrated_autocorrelation_time_of_chains`]: the number of independent values with the
/// same information on the location. It exceeds the number of values for negative autocorrelation. One
/// chain suffices.
pub fn bulk_ess(chains: &[Vec<f64>]) -> f64 {
    split(chains).map_or(f64::NAN, |halves| {
        effective_sample_size(&normal_scores(&halves))
    })
}

/// Tail effective sample size (Vehtari et al. 2021, section 4.3): the smaller of those of the
/// indicators x <= q for the quantiles q at 5% and at 95% (interpolated, type 7 of Hyndman and Fan
/// 1996). A constant indicator is left out; NaN if both are constant.
pub fn tail_ess(chains: &[Vec<f64>]) -> f64 {
    let Some(halves) = split(chains) else {
        return f64::NAN;
    };
    // The quantile includes the middle values that `split` leaves out, as in ArviZ.
    let all = chains.concat();
    let ess = |level| {
        let limit = quantile(&all, level);
        effective_sample_size(&map(&halves, |x| f64::from(x <= limit)))
    };
    ess(0.05).min(ess(0.95))
}

/// Nested R-hat (Margossian, Hoffman, Sountsov, Riou-Durand, Vehtari and Gelman 2024, "Nested R-hat:
/// assessing the convergence of Markov chain Monte Carlo when running many short chains", Bayesian
/// Analysis, section 3): sqrt(1 + B / W). `superchains` are groups of chains; the chains of a group
/// start at one point and are independent given it. B is the variance between the means of the
/// groups, W the mean over groups of the variance between its chains' means plus the mean variance
/// within its chains. At least 1. Of converged chains, with M chains in a group, it is about
/// sqrt(1 + 1/M): it tells whether the starts are forgotten even for chains of one value, whose variance
/// within is 0.
///
/// NaN for fewer than two groups, for groups or chains of unequal size, without chains or values, for
/// groups of one chain of one value, for values not finite or all equal; infinite if only the groups
/// differ.
pub fn nested_r_hat(superchains: &[Vec<Vec<f64>>]) -> f64 {
    let size = superchains.first().map_or(0, Vec::len);
    let chains = superchains.concat();
    let alike = superchains.iter().all(|group| group.len() == size);
    let length = common_length(&chains).unwrap_or(0);
    if superchains.len() < 2 || !alike || length == 0 || size * length < 2 {
        return f64::NAN;
    }
    let mut between = Moments::default();
    let mut within = Moments::default();
    for group in superchains {
        let of_chains: Vec<Moments> = group.iter().map(|c| moments(c)).collect();
        let means: Moments = of_chains.iter().map(|m| m.mean).collect();
        let inner: Moments = of_chains.iter().map(Moments::variance).collect();
        between.add(means.mean);
        within.add(means.variance() + inner.mean);
    }
    (1.0 + between.variance() / within.mean).sqrt()
}

/// Both halves of every chain, so that a drift within a chain becomes a difference between chains; the
/// middle value of an odd number is left out. `None` where results are NaN.
fn split(chains: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = common_length(chains).filter(|&n| n >= 4)?;
    let finite = chains.iter().flatten().all(|x| x.is_finite());
    let halves = |c: &Vec<f64>| [c[..n / 2].to_vec(), c[n - n / 2..].to_vec()];
    finite.then(|| chains.iter().flat_map(halves).collect())
}

/// Normal scores of all values together: Phi^-1((r - 3/8) / (S + 1/4)) with r the rank from 1 to S,
/// the mean rank for ties (Vehtari et al. 2021, eq. 14; the offset is Blom's of 1958).
fn normal_scores(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let all: Vec<f64> = chains.iter().flatten().copied().collect();
    let normal = Normal::standard();
    let size = all.len() as f64;
    let mut scores = mean_ranks(&all)
        .into_iter()
        .map(|rank| normal.inverse_cdf((rank - 0.375) / (size + 0.25)));
    let chain_scores = |chain: &Vec<f64>| scores.by_ref().take(chain.len()).collect();
    chains.iter().map(chain_scores).collect()
}

/// Ranks from 1, with mean ranks for ties.
pub(super) fn mean_ranks(values: &[f64]) -> Vec<f64> {
    // Not statrs' `ranks`: it panics at NaN, and does not tie equal infinities.
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut ranks = vec![0.0; values.len()];
    let mut before = 0;
    for ties in order.chunk_by(|&i, &j| values[i] == values[j]) {
        let rank = before as f64 + 0.5 * (ties.len() + 1) as f64;
        ties.iter().for_each(|&i| ranks[i] = rank);
        before += ties.len();
    }
    ranks
}

/// sqrt((B/W + n - 1) / n) of chains of length n (Gelman and Rubin 1992): B / n is the variance
/// between their means, W the mean variance within.
fn plain_r_hat(chains: &[Vec<f64>]) -> f64 {
    let of_chains: Vec<Moments> = chains.iter().map(|c| moments(c)).collect();
    let means: Moments = of_chains.iter().map(|m| m.mean).collect();
    let within: Moments = of_chains.iter().map(Moments::variance).collect();
    let n = chains[0].len() as f64;
    (means.variance() / within.mean + (n - 1.0) / n).sqrt()
}

fn effective_sample_size(chains: &[Vec<f64>]) -> f64 {
    let values: usize = chains.iter().map(Vec::len).sum();
    values as f64 / integrated_autocorrelation_time_of_chains(chains)
}

/// Quantile of type 7: linear between the order statistics at level (n - 1).
fn quantile(values: &[f64], level: f64) -> f64 {
    // Not statrs' `quantile`, which is of type 8.
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let position = level * (sorted.len() - 1) as f64;
    let below = position as usize;
    let above = (below + 1).min(sorted.len() - 1);
    let share = position - below as f64;
    // Exact between equal values.
    sorted[below] + share * (sorted[above] - sorted[below])
}

fn map(chains: &[Vec<f64>], f: impl Fn(f64) -> f64) -> Vec<Vec<f64>> {
    let of_chain = |chain: &Vec<f64>| chain.iter().map(|&x| f(x)).collect();
    chains.iter().map(of_chain).collect()
}

fn moments(chain: &[f64]) -> Moments {
    chain.iter().copied().collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Lehmer, assert_close, autoregressive};
    use super::*;
    use rand::SeedableRng;
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// ArviZ 0.23.4, `chain` as in `testing.rs`, `s = 1` before each line:
    ///
    /// ```python
    /// a = np.array([chain(101, 0.7, 0.1 * k) for k in range(4)])
    /// b = np.array([chain(60, -0.6, 0) for k in range(3)])
    /// c = np.array([np.round(3 * np.array(chain(101, 0.7, 0.1 * k))) for k in range(4)])
    /// d = np.array([np.array(chain(200, 0.3, 0)) * (1 + k) for k in range(4)])
    /// for x in (a, b, c, d): print(az.rhat(x), az.ess(x), az.ess(x, method="tail"))
    /// ```
    #[test]
    fn r_hat_and_ess_match_worked_examples() {
        let chains = |count: u32, n, phi, change: &dyn Fn(u32, f64) -> f64| -> Vec<Vec<f64>> {
            let mut numbers = Lehmer::new();
            let mut chain = |k| -> Vec<f64> {
                let series = numbers.chain(n, phi, 0.0);
                series.iter().map(|&x| change(k, x)).collect()
            };
            (0..count).map(&mut chain).collect()
        };
        let shifted = |k: u32, x: f64| x + 0.1 * f64::from(k);
        let examples = [
            (
                chains(4, 101, 0.7, &shifted),
                [
                    1.036_966_957_062_869_7,
                    67.034_878_592_166,
                    143.370_282_524_820_28,
                ],
            ),
            (
                chains(3, 60, -0.6, &|_, x| x),
                [
                    1.019_865_037_403_394_2,
                    405.949_050_895_185_1,
                    175.851_063_829_787_17,
                ],
            ),
            (
                chains(4, 101, 0.7, &|k, x| (3.0 * shifted(k, x)).round_ties_even()),
                [
                    1.035_775_040_592_605_6,
                    68.135_046_633_719_3,
                    128.197_897_209_439_65,
                ],
            ),
            (
                chains(4, 200, 0.3, &|k, x| x * f64::from(k + 1)),
                [
                    1.188_350_135_657_448_4,
                    446.149_919_695_604_75,
                    115.183_080_537_598_12,
                ],
            ),
        ];
        for (chains, expected) in &examples {
            let found = [r_hat(chains), bulk_ess(chains), tail_ess(chains)];
            for (found, expected) in found.into_iter().zip(expected) {
                assert_close(found, *expected, 1e-6);
            }
        }
        // s = 1; c = np.array([chain(200, 0.9, 0)]); az.ess(c), az.ess(c, method="tail")
        let one = [Lehmer::new().chain(200, 0.9, 0.0)];
        assert_close(bulk_ess(&one), 11.181_485_694_582_488, 1e-6);
        assert_close(tail_ess(&one), 34.773_410_402_442_95, 1e-6);
    }

    /// ```python
    /// c = np.array([chain(20, 0.7, 0.3 * (k // 3)) for k in range(6)]).reshape(2, 3, 20)
    /// m = c.mean(2); B = m.mean(1).var(ddof=1)
    /// W = (m.var(1, ddof=1) + c.var(2, ddof=1).mean(1)).mean(); np.sqrt(1 + B / W)
    /// ```
    #[test]
    fn nested_r_hat_matches_a_worked_example() {
        let mut numbers = Lehmer::new();
        let groups: Vec<Vec<Vec<f64>>> = [0.0, 0.3]
            .map(|shift| (0..3).map(|_| numbers.chain(20, 0.7, shift)).collect())
            .into();
        assert_close(nested_r_hat(&groups), 1.003_141_819_784_559, 1e-12);
    }

    /// For 200 independent sets of four chains of 1000 values, R-hat never exceeds 1.01 (its excess is of
    /// order 1e-3), and the mean bulk size is right to 10%, with a standard error of 1%. A shift of one
    /// chain by 0.6 deviations, and a scale of 2, are always detected.
    #[test]
    fn r_hat_detects_chains_that_differ() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(8);
        let mut ess = Moments::default();
        for _ in 0..200 {
            let mut chains: Vec<Vec<f64>> = (0..4)
                .map(|_| autoregressive(&mut rng, 1000, 0.3))
                .collect();
            assert!(r_hat(&chains) < 1.01, "{}", r_hat(&chains));
            ess.add(bulk_ess(&chains));
            let first = chains[0].clone();
            chains[0].iter_mut().for_each(|x| *x += 0.6);
            let shifted = r_hat(&chains);
            assert!(shifted > 1.01, "{shifted}");
            chains[0] = first.iter().map(|x| x * 2.0).collect();
            let scaled = r_hat(&chains);
            assert!(scaled > 1.01, "{scaled}");
        }
        assert_close(ess.mean, 4000.0 * 0.7 / 1.3, 0.1);
    }

    /// Many chains of one value each: nested R-hat of groups of 64 that have forgotten their starts is near
    /// sqrt(1 + 1/64) = 1.008; that of groups shifted by their starts is not.
    #[test]
    fn nested_r_hat_detects_starts_that_are_not_forgotten() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(9);
        let mut groups: Vec<Vec<Vec<f64>>> = (0..32)
            .map(|_| (0..64).map(|_| autoregressive(&mut rng, 1, 0.0)).collect())
            .collect();
        let mixed = nested_r_hat(&groups);
        assert!((mixed - 1.0078).abs() < 0.008, "{mixed}");
        for (k, group) in groups.iter_mut().enumerate() {
            group.iter_mut().for_each(|c| c[0] += (k % 2) as f64);
        }
        assert!(nested_r_hat(&groups) > 1.1);
    }

    #[test]
    fn degenerate_chains_give_nan() {
        let constant = vec![vec![0.1; 8]; 3];
        let short = vec![vec![1.0, 2.0, 3.0]; 2];
        let unequal = vec![vec![1.0, 2.0, 3.0, 4.0], vec![1.0; 5]];
        let infinite = vec![vec![1.0, 2.0, f64::INFINITY, 4.0]; 2];
        for chains in [vec![], constant, short, unequal, infinite] {
            assert!(r_hat(&chains).is_nan());
            assert!(bulk_ess(&chains).is_nan() && tail_ess(&chains).is_nan());
        }
        assert!(nested_r_hat(&[]).is_nan());
        assert!(nested_r_hat(&[vec![vec![0.1; 3]; 2], vec![vec![0.1; 3]; 2]]).is_nan());
        assert!(nested_r_hat(&[vec![vec![1.0]], vec![vec![2.0]]]).is_nan());
        // Stuck in different states.
        assert_eq!(r_hat(&[vec![1.0; 8], vec![2.0; 8]]), f64::INFINITY);
        // Two values, evenly mixed: distances from the median are constant, the values are not.
        let coin = [vec![0.0, 1.0, 0.0, 1.0], vec![1.0, 0.0, 1.0, 0.0]];
        assert!(r_hat(&coin).is_finite());
    }
}
