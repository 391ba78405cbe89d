//! Tests of whether two samples come from one distribution. Values within a sample must be independent;
//! those of a Markov chain must be thinned beyond its autocorrelation time. P-values as in
//! [`super::hypothesis`].

use rand::{Rng, RngExt};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::pooling::pool_sparse;

/// Probability that Kolmogorov's limit sup |B(t)| of a Brownian bridge exceeds `x`:
/// Q(x) = 2 sum_{k > 0} (-1)^{k-1} exp(-2 k^2 x^2) (Kolmogorov 1933). Below 1 by the theta series
/// 1 - sqrt(2 pi) / x sum exp(-(2k-1)^2 pi^2 / (8 x^2)), which converges where the first does not.
/// 1 for x <= 0. Error below 1e-12.
pub fn kolmogorov_survival(x: f64) -> f64 {
    // Not statrs: its Kolmogorov series is private, and does not converge for small x.
    use std::f64::consts::PI;
    if x <= 0.0 {
        return 1.0;
    }
    if x < 1.0 {
        let term = |k: f64| (-((2.0 * k - 1.0) * PI / x).powi(2) / 8.0).exp();
        return 1.0 - (2.0 * PI).sqrt() / x * (1..=6).map(|k| term(f64::from(k))).sum::<f64>();
    }
    let term = |k: f64| (-2.0 * (k * x).powi(2)).exp();
    2.0 * (term(1.0) - term(2.0) + term(3.0) - term(4.0))
}

/// Two-sample test of Kolmogorov and Smirnov. Null hypothesis: `a` and `b` come from one distribution.
/// The statistic is D = sup |F_a - F_b|, the p-value Q((s + 0.12 + 0.11 / s) D) with Q by
/// [`kolmogorov_survival`] and s = sqrt(n m / (n + m)), the correction for finite samples of Stephens
/// (1970, "Use of the Kolmogorov-Smirnov, Cramér-von Mises and related statistics without extensive
/// tables", section 2), here for the effective number of values.
///
/// Ties make it conservative: [`kolmogorov_smirnov_randomized`] is exact there. 1 if a sample is
/// empty. NaN counts as larger than every number.
pub fn kolmogorov_smirnov(a: &[f64], b: &[f64]) -> f64 {
    smirnov_p_value(a, b, || 0.0)
}

/// [`kolmogorov_smirnov`] with ties broken at random, for distributions with atoms: each value is
/// paired with a uniform number, and pairs are ordered by value first. Under the null hypothesis all
/// orders of the pairs are equally likely, as for values without ties. p depends on `rng`.
pub fn kolmogorov_smirnov_randomized(a: &[f64], b: &[f64], rng: &mut impl Rng) -> f64 {
    smirnov_p_value(a, b, || rng.random())
}

fn smirnov_p_value(a: &[f64], b: &[f64], mut tie_break: impl FnMut() -> f64) -> f64 {
    // Not statrs' `ks_twosample`: it has no correction for finite samples and breaks no ties.
    if a.is_empty() || b.is_empty() {
        return 1.0;
    }
    let (n, m) = (a.len() as f64, b.len() as f64);
    let steps_a = a.iter().map(|&x| (x, 1.0 / n));
    let steps_b = b.iter().map(|&x| (x, -1.0 / m));
    let mut steps: Vec<([f64; 2], f64)> = steps_a
        .chain(steps_b)
        .map(|(x, step)| ([x, tie_break()], step))
        .collect();
    steps.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let (mut difference, mut distance): (f64, f64) = (0.0, 0.0);
    for ties in steps.chunk_by(|a, b| a.0 == b.0) {
        difference += ties.iter().map(|t| t.1).sum::<f64>();
        distance = distance.max(difference.abs());
    }
    let root = (n * m / (n + m)).sqrt();
    kolmogorov_survival((root + 0.12 + 0.11 / root) * distance)
}

/// Chi-square test of homogeneity. Null hypothesis: both rows of counts are multinomial with the same
/// cell probabilities; the rows' totals may differ (Pearson 1911). With N_r a row's total, N that of
/// both and T_j that of a cell, N_r T_j / N is expected. Cells where the smaller of the two is less
/// than 5 are pooled (Cochran 1954), by their totals, which are independent of a difference. 1 with fewer
/// than two pooled cells.
///
/// # Panics
/// If the rows differ in length.
pub fn chi_square_two_sample(a: &[u64], b: &[u64]) -> f64 {
    assert_eq!(a.len(), b.len(), "both rows have the same cells");
    let total = |row: &[u64]| row.iter().map(|&n| n as f64).sum::<f64>();
    let rows = [total(a), total(b)];
    let all = rows[0] + rows[1];
    let cells: Vec<f64> = a
        .iter()
        .zip(b)
        .map(|(&a, &b)| a as f64 + b as f64)
        .collect();
    let least = 5.0 * all / rows[0].min(rows[1]);
    if !least.is_finite() {
        return 1.0;
    }
    let (pool_of, pools) = pool_sparse(&cells, least);
    if pools < 2 {
        return 1.0;
    }
    let mut counts = vec![[0.0; 2]; pools];
    for (j, &pool) in pool_of.iter().enumerate() {
        counts[pool][0] += a[j] as f64;
        counts[pool][1] += b[j] as f64;
    }
    let term = |c: &[f64; 2]| -> f64 {
        let expected = rows.map(|row| row * (c[0] + c[1]) / all);
        (0..2)
            .map(|r| (c[r] - expected[r]).powi(2) / expected[r])
            .sum()
    };
    let statistic: f64 = counts.iter().map(term).sum();
    ChiSquared::new((pools - 1) as f64).map_or(1.0, |d| d.sf(statistic))
}

/// Number of permuted values as large as the observed one after which the test stops.
const MAX_AS_FAR: u32 = 20;

/// Permutation test by the maximum mean discrepancy. Null hypothesis: the points `a` and `b` come from
/// one distribution, of any dimension. The statistic is the unbiased MMD^2 (Gretton et al. 2012, "A
/// kernel two-sample test", JMLR 13, eq. 3) with the Gaussian kernel exp(-|x - y|^2 / (2 h^2)), h the
/// median distance between 200 points drawn from both samples (their section 8).
/// p = (1 + #{permuted >= observed}) / (1 + `permutations`), which keeps the level exactly, also with ties
/// and atoms (Phipson and Smyth 2010); p < alpha needs `permutations` > 1 / alpha - 1. As soon as 20
/// permuted values are as large as the observed one, after l permutations, p = 20 / l, which is valid too
/// (Besag and Clifford 1991, "Sequential Monte Carlo p-values") and saves most permutations under the null
/// hypothesis.
///
/// The kernel of all n points takes n^2 numbers of memory and n^2 d / 2 operations, each permutation
/// up to n^2 / 8: the caller bounds n. 1 for samples of fewer than two points and if all points are equal.
/// Coordinates should have equal scales, as the kernel depends on distances alone.
pub fn mmd_permutation<P: AsRef<[f64]>>(
    a: &[P],
    b: &[P],
    permutations: u32,
    rng: &mut impl Rng,
) -> f64 {
    if a.len() < 2 || b.len() < 2 {
        return 1.0;
    }
    let points: Vec<&[f64]> = a.iter().chain(b).map(AsRef::as_ref).collect();
    let Some(kernel) = Kernel::of(&points, rng) else {
        return 1.0;
    };
    let mut labels: Vec<usize> = (0..points.len()).collect();
    // The statistic is symmetric, and the smaller sample is cheaper to sum over.
    let smaller = a.len().min(b.len());
    if b.len() < a.len() {
        labels.rotate_left(a.len());
    }
    let observed = kernel.discrepancy(&labels[..smaller]);
    let mut as_far = 1u32;
    for made in 1..=permutations {
        // The head of a Fisher-Yates shuffle: a random subset.
        for i in 0..smaller {
            let j = rng.random_range(i..labels.len());
            labels.swap(i, j);
        }
        // Differences by rounding are ties, which count.
        as_far += u32::from(kernel.discrepancy(&labels[..smaller]) >= observed - 1e-12);
        if as_far > MAX_AS_FAR {
            return f64::from(MAX_AS_FAR) / f64::from(made);
        }
    }
    f64::from(as_far) / (f64::from(permutations) + 1.0)
}

/// The kernel between all points, zero on the diagonal.
struct Kernel {
    size: usize,
    values: Vec<f64>,
    /// Sum of each row, and of all of them.
    rows: Vec<f64>,
    total: f64,
}

impl Kernel {
    /// `None` if all points are the same.
    fn of(points: &[&[f64]], rng: &mut impl Rng) -> Option<Self> {
        let size = points.len();
        let scale = -0.5 / bandwidth(points, rng)?.powi(2);
        let mut values = vec![0.0; size * size];
        for i in 0..size {
            for j in 0..i {
                let value = (scale * squared_distance(points[i], points[j])).exp();
                values[i * size + j] = value;
                values[j * size + i] = value;
            }
        }
        let rows: Vec<f64> = values.chunks(size).map(|row| row.iter().sum()).collect();
        let total = rows.iter().sum();
        Some(Self {
            size,
            values,
            rows,
            total,
        })
    }

    /// Unbiased MMD^2 between the points `subset` and the others. With S the sum within the subset, R its
    /// row sums and T the total, the sum between both is R - S and that within the others T - 2R + S.
    fn discrepancy(&self, subset: &[usize]) -> f64 {
        let mut within = 0.0;
        let mut rows = 0.0;
        for (k, &i) in subset.iter().enumerate() {
            let row = &self.values[i * self.size..(i + 1) * self.size];
            within += 2.0 * subset[..k].iter().map(|&j| row[j]).sum::<f64>();
            rows += self.rows[i];
        }
        let n = subset.len() as f64;
        let m = (self.size - subset.len()) as f64;
        let others = self.total - 2.0 * rows + within;
        within / (n * (n - 1.0)) + others / (m * (m - 1.0)) - 2.0 * (rows - within) / (n * m)
    }
}

/// Median distance between points drawn from both samples together; their mean distance if most are equal.
/// `None` if all are.
fn bandwidth(points: &[&[f64]], rng: &mut impl Rng) -> Option<f64> {
    let mut drawn = points.to_vec();
    for i in 0..drawn.len().min(200) {
        let j = rng.random_range(i..drawn.len());
        drawn.swap(i, j);
    }
    drawn.truncate(200);
    let mut distances: Vec<f64> = (0..drawn.len())
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .map(|(i, j)| squared_distance(drawn[i], drawn[j]).sqrt())
        .collect();
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    let middle = distances.len() / 2;
    let (_, &mut median, _) = distances.select_nth_unstable_by(middle, f64::total_cmp);
    let width = if median > 0.0 { median } else { mean };
    (width > 0.0).then_some(width)
}

fn squared_distance(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| (x - y).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Lehmer, assert_close, assert_level_kept, assert_uniform};
    use super::*;
    use rand::SeedableRng;
    use rand_distr::StandardNormal;
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// scipy.special.kolmogorov(x)
    #[test]
    fn kolmogorovs_distribution_matches_known_values() {
        for (x, expected) in [
            (0.2, 0.999_999_999_999_495),
            (0.5, 0.963_945_243_664_875_1),
            (0.8, 0.544_142_411_574_198_1),
            (1.0, 0.269_999_671_677_354_56),
            (1.358, 0.050_026_797_334_446_98),
            (2.0, 0.000_670_925_255_779_695_3),
            (3.0, 3.045_995_948_942_526e-8),
        ] {
            assert_close(kolmogorov_survival(x), expected, 1e-11);
        }
        assert_eq!(kolmogorov_survival(0.0), 1.0);
    }

    /// s = 1; a, b = chain(40, 0, 0), chain(60, 0, 0.15), `chain` as in `testing.rs`:
    /// ks_2samp(a, b, method="exact") -> D = 0.13333, p = 0.75465; Stephens' form of it is
    /// scipy.special.kolmogorov((24**.5 + .12 + .11 / 24**.5) * D) = 0.75689.
    #[test]
    fn kolmogorov_smirnov_matches_a_worked_example() {
        let mut numbers = Lehmer::new();
        let [a, b] = [(40, 0.0), (60, 0.15)].map(|(n, shift)| numbers.chain(n, 0.0, shift));
        let p = kolmogorov_smirnov(&a, &b);
        assert_close(p, 0.756_888_763_757_838, 1e-10);
        assert_close(p, 0.754_650_746_769_628_3, 0.01);
        assert_eq!(kolmogorov_smirnov(&a, &[]), 1.0);
        assert_eq!(kolmogorov_smirnov(&[1.0; 9], &[1.0; 5]), 1.0);
    }

    /// scipy.stats.chi2_contingency([[10, 20, 30, 40], [15, 35, 20, 60]]).pvalue
    #[test]
    fn homogeneity_matches_a_worked_example() {
        let p = chi_square_two_sample(&[10, 20, 30, 40], &[15, 35, 20, 60]);
        assert_close(p, 0.062_867_489_513_439_15, 1e-9);
        assert_eq!(chi_square_two_sample(&[0, 0], &[5, 9]), 1.0);
        assert_eq!(chi_square_two_sample(&[], &[]), 1.0);
        // Sparse cells are pooled with each other.
        let p = chi_square_two_sample(&[0, 5, 0, 5, 90], &[2, 0, 2, 0, 90]);
        assert_eq!(p, chi_square_two_sample(&[10, 90], &[4, 90]));
    }

    /// Samples of one distribution, 1000 runs: uniform p-values (false alarm rate 1e-3) without ties or
    /// with ties broken; for a distribution on five values no more alarms than the level allows. A shift
    /// by one deviation, 50 values against 70, is detected in more than 95% at level 0.01.
    #[test]
    fn kolmogorov_smirnov_keeps_its_level_and_has_power() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(21);
        let (mut plain, mut tied, mut broken, mut found) = (vec![], vec![], vec![], 0);
        for _ in 0..1000 {
            let [a, b] = [250, 350].map(|n| -> Vec<f64> { (0..n).map(|_| rng.random()).collect() });
            plain.push(kolmogorov_smirnov(&a, &b));
            let [a, b] = [a, b].map(|x| x.iter().map(|x| (5.0 * x).floor()).collect::<Vec<_>>());
            tied.push(kolmogorov_smirnov(&a, &b));
            broken.push(kolmogorov_smirnov_randomized(&a, &b, &mut rng));
            let [a, b] = [(50, 0.0), (70, 1.0)].map(|(n, shift)| -> Vec<f64> {
                (0..n)
                    .map(|_| rng.sample::<f64, _>(StandardNormal) + shift)
                    .collect()
            });
            found += u32::from(kolmogorov_smirnov(&a, &b) < 0.01);
        }
        assert_uniform(&mut plain);
        assert_uniform(&mut broken);
        assert_level_kept(&tied);
        assert!(found > 950, "{found} of 1000");
    }

    /// Rows of 300 and 500 over 24 cells, most of them sparse, 1000 runs: uniform p-values (false
    /// alarm rate 1e-3); another exponent is detected in more than 95% at level 0.01.
    #[test]
    fn homogeneity_keeps_its_level_and_has_power() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(22);
        let mut row = |n: u32, power: f64| {
            let mut counts = [0; 24];
            for _ in 0..n {
                counts[(rng.random::<f64>().powf(power) * 24.0) as usize] += 1;
            }
            counts
        };
        let (mut p_values, mut found) = (vec![], 0);
        for _ in 0..1000 {
            p_values.push(chi_square_two_sample(&row(300, 3.0), &row(500, 3.0)));
            found += u32::from(chi_square_two_sample(&row(300, 3.0), &row(500, 1.6)) < 0.01);
        }
        assert_uniform(&mut p_values);
        assert!(found > 950, "{found} of 1000");
    }

    /// Points of the plane, 25 against 35 with 199 permutations, 1000 runs: p-values are uniform up to
    /// their step of 1/200 (false alarm rate 1e-3), and on a lattice of four points there are no more
    /// alarms than the level allows. A correlation of 0.9, which does not change the marginals, is
    /// detected in more than 60% of 100 runs with 60 points each at level 0.05.
    #[test]
    fn mmd_keeps_its_level_and_has_power() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(23);
        let mut points = |n: usize, correlation: f64| -> Vec<[f64; 2]> {
            let mut point = || {
                let [x, y] = [(); 2].map(|()| rng.sample::<f64, _>(StandardNormal));
                [
                    x,
                    correlation * x + (1.0 - correlation * correlation).sqrt() * y,
                ]
            };
            (0..n).map(|_| point()).collect()
        };
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(24);
        let (mut p_values, mut tied, mut found) = (vec![], vec![], 0);
        for run in 0..1000 {
            let (a, b) = (points(25, 0.0), points(35, 0.0));
            p_values.push(mmd_permutation(&a, &b, 199, &mut rng));
            let [a, b] = [b, a].map(|s| s.iter().map(|p| p.map(f64::signum)).collect::<Vec<_>>());
            tied.push(mmd_permutation(&a, &b, 199, &mut rng));
            if run < 100 {
                let (a, b) = (points(60, 0.0), points(60, 0.9));
                found += u32::from(mmd_permutation(&a, &b, 199, &mut rng) < 0.05);
            }
        }
        assert_uniform(&mut p_values);
        assert_level_kept(&tied);
        assert!(found > 60, "{found} of 100");
        assert_eq!(mmd_permutation(&[[1.0]; 5], &[[1.0]; 4], 99, &mut rng), 1.0);
        // Equal samples have the smallest discrepancy; all permutations tie or exceed it.
        let pair = [[0.0], [1.0]];
        assert_eq!(mmd_permutation(&pair, &pair, 99, &mut rng), 1.0);
    }
}
