//! The rank test of a chain's correctness: is the rank of one value among others uniform?

use rand::{Rng, RngExt};

use super::chi_square;

/// Rank of `value` among `others`: the number of them below it, plus a uniform random number from 0 to t
/// for t ties. From 0 to the number of others. If all are exchangeable the rank is uniform, also for
/// distributions with atoms (Gandy and Scott 2020, "Unit testing for MCMC and other Monte Carlo methods",
/// arXiv 2001.06465, section 3). NaN in `others` counts as larger; NaN as `value` as smaller.
pub fn rank_among(value: f64, others: &[f64], rng: &mut impl Rng) -> usize {
    let below = others.iter().filter(|&&x| x < value).count();
    let ties = others.iter().filter(|&&x| x == value).count();
    below + rng.random_range(0..=ties)
}

/// Rank test. Null hypothesis: the independent `ranks` are uniform on 0 to `largest`. For a chain, a
/// rank is that of the start, drawn exactly from the target, among `largest` states of the chain run
/// from it forward and, by the reversed kernel, backward, with the start at a random position among them
/// (Gandy and Scott 2020, section 3, after Besag and Clifford 1989).
///
/// Chi-square over all ranks, or, if that expects fewer than 5 values per rank, over n/5 bins of
/// neighbouring ranks of nearly equal size. 1 for fewer than 10 ranks.
///
/// # Panics
/// If a rank is above `largest`.
pub fn rank_uniformity(ranks: &[usize], largest: usize) -> f64 {
    let possible = largest.saturating_add(1);
    let bins = possible.min(ranks.len() / 5).max(1);
    // u128, because the product of two large numbers may overflow.
    let bin_of = |rank: usize| (rank as u128 * bins as u128 / possible as u128) as usize;
    let mut observed = vec![0; bins];
    for &rank in ranks {
        assert!(rank <= largest, "rank {rank} above {largest}");
        observed[bin_of(rank)] += 1;
    }
    // The first rank in a bin is the smallest r with r bins >= bin possible.
    let start = |bin: usize| (bin as u128 * possible as u128).div_ceil(bins as u128);
    let share = |bin: usize| (start(bin + 1) - start(bin)) as f64 / possible as f64;
    let expected: Vec<f64> = (0..bins).map(|b| share(b) * ranks.len() as f64).collect();
    chi_square(&observed, &expected)
}

#[cfg(test)]
mod tests {
    use super::super::testing::assert_level_kept;
    use super::*;
    use rand::SeedableRng;
    use rand_distr::StandardNormal;
    use rand_xoshiro::Xoshiro256PlusPlus;

    #[test]
    fn ranks_and_p_values_by_hand() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(40);
        assert_eq!(rank_among(2.5, &[1.0, 2.0, 3.0], &mut rng), 2);
        assert_eq!(rank_among(0.0, &[], &mut rng), 0);
        let mut seen = [0; 4];
        for _ in 0..400 {
            seen[rank_among(1.0, &[1.0, 0.0, 1.0, 2.0], &mut rng)] += 1;
        }
        // Each of 1, 2, 3 has mean 133 and deviation 9.4; 60 is eight deviations below.
        assert!(
            seen[0] == 0 && seen[1..].iter().all(|&n| n > 60),
            "{seen:?}"
        );
        // Two ranks, 20 and 10: chi-square 100/30 with one degree, scipy.stats.chi2.sf(10/3, 1).
        let ranks: Vec<usize> = (0..30).map(|i| usize::from(i >= 20)).collect();
        assert!((rank_uniformity(&ranks, 1) - 0.067_889_154_861_829).abs() < 1e-9);
        assert_eq!(rank_uniformity(&[3; 9], 7), 1.0);
        assert_eq!(rank_uniformity(&[], 0), 1.0);
        // More ranks than values: expected counts are proportional to the size of the bins.
        let spread: Vec<usize> = (0..53).collect();
        assert!(rank_uniformity(&spread, 52) > 0.99);
    }

    /// Ranks of a value among others of its distribution, with atoms, 200 ranks in each of 1000 runs,
    /// with and without bins: no more false alarms than the level allows, and the mean p-value is 0.5
    /// within 4 deviations of 0.009. A value with twice the deviation of the others is detected in more
    /// than 95 of 100 runs at level 0.01.
    #[test]
    fn the_rank_test_keeps_its_level_and_has_power() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(41);
        for largest in [9, 60] {
            let (mut p_values, mut found) = (vec![], 0);
            for run in 0..1000 {
                let mut ranks = |scale: f64| -> Vec<usize> {
                    let mut rank = || {
                        let mut value = || (4.0 * rng.sample::<f64, _>(StandardNormal)).round();
                        let others: Vec<f64> = (0..largest).map(|_| value()).collect();
                        rank_among(scale * value(), &others, &mut rng)
                    };
                    (0..200).map(|_| rank()).collect()
                };
                p_values.push(rank_uniformity(&ranks(1.0), largest));
                if run < 100 {
                    found += u32::from(rank_uniformity(&ranks(2.0), largest) < 0.01);
                }
            }
            assert_level_kept(&p_values);
            let mean = p_values.iter().sum::<f64>() / 1000.0;
            assert!((mean - 0.5).abs() < 0.037, "{mean}");
            assert!(found > 95, "{found} of 100");
        }
    }
}
