//! Tests of whether a step of a chain preserves its distribution (marginal homogeneity), and whether it
//! goes from i to j as often as from j to i (symmetry, that is, detailed balance). Both compare matched
//! pairs: the states before and after a step, each given by its cell.

use std::collections::BTreeMap;

use statrs::distribution::{Beta, ChiSquared, ContinuousCDF};

use super::pooling::pool_sparse;
use crate::math::inverse_form;

/// Result of a test of symmetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetryTest {
    /// Its statistic: about chi-square with `freedom` degrees under the null hypothesis.
    pub statistic: f64,
    /// Degrees of freedom after pooling; 0 if there were too few pairs.
    pub freedom: usize,
    /// Probability of a larger statistic under the null hypothesis; 1 without degrees of freedom.
    pub p_value: f64,
}

impl SymmetryTest {
    const NOTHING: Self = Self {
        statistic: 0.0,
        freedom: 0,
        p_value: 1.0,
    };
}

/// Bowker's test of symmetry (Bowker 1948, "A test for symmetry in contingency tables", JASA 43).
/// `table[i][j]` counts the pairs that went from i to j. Null hypothesis: the pairs are independent
/// and i to j is as probable as j to i. The statistic is sum_{i<j} (n_ij - n_ji)^2 / (n_ij + n_ji).
///
/// Pairs of cells with n_ij + n_ji < 10, which expect fewer than 5 each way, are pooled: the counts
/// above the diagonal are added up, and those below; given their sum they are binomial with probability
/// 1/2 too. Pools depend on that sum alone, so the level is kept; but opposite asymmetries in one pool
/// cancel. Counts on the diagonal carry no information.
///
/// # Panics
/// If the table is not square.
pub fn bowker(table: &[Vec<u64>]) -> SymmetryTest {
    let k = table.len();
    assert!(table.iter().all(|row| row.len() == k), "a square table");
    let pairs = (0..k).flat_map(|i| (i + 1..k).map(move |j| (i, j)));
    let both: Vec<[f64; 2]> = pairs
        .map(|(i, j)| [table[i][j] as f64, table[j][i] as f64])
        .filter(|[above, below]| above + below > 0.0)
        .collect();
    let totals: Vec<f64> = both.iter().map(|[above, below]| above + below).collect();
    let (pool_of, freedom) = pool_sparse(&totals, 10.0);
    if freedom == 0 {
        return SymmetryTest::NOTHING;
    }
    let mut pools = vec![[0.0; 2]; freedom];
    for (pool, [above, below]) in pool_of.into_iter().zip(both) {
        pools[pool] = [pools[pool][0] + above, pools[pool][1] + below];
    }
    let term = |&[above, below]: &[f64; 2]| (above - below).powi(2) / (above + below);
    let statistic = pools.iter().map(term).sum();
    SymmetryTest {
        statistic,
        freedom,
        p_value: ChiSquared::new(freedom as f64).map_or(1.0, |d| d.sf(statistic)),
    }
}

/// Test of marginal homogeneity of Stuart (1955, "A test for homogeneity of the marginal distributions
/// in a two-way classification", Biometrika 42) and Maxwell (1970), for pairs in clusters. A unit is a
/// cluster independent of the others: a pair, or all pairs of one chain. It is given by its sparse
/// differences d, (cell, count after - count before); a cell listed twice counts twice. Null hypothesis: d
/// has mean 0 in every cell.
///
/// The statistic is s' A^-1 s with s = sum d and A = sum d d' over units. With one pair in each unit this
/// is exactly Stuart's and Maxwell's, where s_i = n_.i - n_i. and A_ii = n_i. + n_.i - 2 n_ii, A_ij =
/// -(n_ij + n_ji); A estimates the covariance for any dependence within units (as in Liang and Zeger
/// 1986). Linearly dependent cells, as of counts with a constant sum, are left out: `freedom` is the rank
/// r. For normal d, statistic / n is Beta distributed with r/2 and (n - r)/2, n the number of units with
/// a change; this is equivalent to Hotelling's T^2 (Anderson 2003, section 5.2) and tends to chi-square
/// with r degrees. It gives the p-value, because units are usually few.
///
/// Cells are merged until max(10, 5 m) units change each, with m the mean number of cells that a unit
/// changes, so that r is at most n/5. The rule depends on whether there is a change, not on its sign, and
/// is thus invariant under exchange of before and after, so that the level is kept.
pub fn stuart_maxwell<U: AsRef<[(usize, f64)]>>(units: &[U]) -> SymmetryTest {
    let changes: Vec<BTreeMap<usize, f64>> = units
        .iter()
        .map(|unit| sums(unit.as_ref().iter().copied()))
        .filter(|unit| !unit.is_empty())
        .collect();
    let mut changed = BTreeMap::<usize, f64>::new();
    for &cell in changes.iter().flat_map(BTreeMap::keys) {
        *changed.entry(cell).or_default() += 1.0;
    }
    let sizes: Vec<f64> = changed.values().copied().collect();
    let each = sizes.iter().sum::<f64>() / changes.len() as f64;
    let (pool_of, k) = pool_sparse(&sizes, f64::max(10.0, 5.0 * each));
    if k == 0 {
        return SymmetryTest::NOTHING;
    }
    let pool_of: BTreeMap<usize, usize> = changed.into_keys().zip(pool_of).collect();
    // Sums over units of d and d d'.
    let (mut s, mut a) = (vec![0.0; k], vec![0.0; k * k]);
    let mut n = 0.0;
    for unit in &changes {
        let merged = sums(unit.iter().map(|(cell, &d)| (pool_of[cell], d)));
        n += f64::from(u8::from(!merged.is_empty()));
        for (&i, &x) in &merged {
            s[i] += x;
            for (&j, &y) in &merged {
                a[i * k + j] += x * y;
            }
        }
    }
    wald(s, a, n)
}

/// The test of mean zero from sums of d and d d' over `n` units.
fn wald(mut s: Vec<f64>, mut a: Vec<f64>, n: f64) -> SymmetryTest {
    // Scale to unit diagonal, so that the rank does not depend on the number of changes of a cell.
    let k = s.len();
    let scale: Vec<f64> = (0..k).map(|i| a[i * k + i].sqrt().recip()).collect();
    for i in 0..k {
        let of = |j: usize| if scale[j].is_finite() { scale[j] } else { 0.0 };
        s[i] *= of(i);
        for j in 0..k {
            a[i * k + j] *= of(i) * of(j);
        }
    }
    let (statistic, freedom) = inverse_form(a, &s);
    let r = freedom as f64;
    // Merging cells may leave few units with a change. If these all change alike, their covariance about
    // their mean is 0 and the statistic has no distribution.
    if n < f64::max(10.0, 5.0 * r) {
        return SymmetryTest::NOTHING;
    }
    let Ok(beta) = Beta::new(0.5 * r, 0.5 * (n - r)) else {
        return SymmetryTest::NOTHING;
    };
    SymmetryTest {
        statistic,
        freedom,
        p_value: beta.sf((statistic / n).min(1.0)),
    }
}

/// Sums of differences by cell, without zeros.
fn sums(changes: impl Iterator<Item = (usize, f64)>) -> BTreeMap<usize, f64> {
    let mut sums = BTreeMap::new();
    for (cell, change) in changes {
        *sums.entry(cell).or_insert(0.0) += change;
    }
    sums.retain(|_, change| *change != 0.0);
    sums
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, assert_level_kept, assert_uniform};
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    const TABLE: [[u64; 4]; 4] = [
        [20, 10, 5, 4],
        [3, 30, 15, 6],
        [8, 7, 40, 12],
        [9, 5, 4, 50],
    ];

    /// statsmodels 0.15: SquareTable(TABLE, shift_zeros=False).symmetry() -> 13.384615, 6 degrees,
    /// p = 0.0373183; .homogeneity() -> 0.5532190, 3 degrees, p = 0.907053 by chi-square, which
    /// differs from Beta by terms of order 1/n.
    #[test]
    fn both_tests_match_a_worked_example() {
        let found = bowker(&TABLE.map(Vec::from));
        assert_eq!(found.freedom, 6);
        assert_close(found.statistic, 13.384_615_384_615_385, 1e-12);
        assert_close(found.p_value, 0.037_318_935_313_034_915, 1e-9);
        let mut units = Vec::new();
        for (i, row) in TABLE.iter().enumerate() {
            for (j, &n) in row.iter().enumerate() {
                units.extend(vec![[(j, 1.0), (i, -1.0)]; n as usize]);
            }
        }
        let found = stuart_maxwell(&units);
        assert_eq!(found.freedom, 3);
        assert_close(found.statistic, 0.553_218_963_290_904_6, 1e-10);
        assert_close(found.p_value, 0.907_053_177_574_878_5, 0.01);
    }

    #[test]
    fn too_few_pairs_give_one() {
        assert_eq!(bowker(&[]), SymmetryTest::NOTHING);
        assert_eq!(bowker(&[vec![9, 4], vec![5, 9]]), SymmetryTest::NOTHING);
        assert_eq!(stuart_maxwell::<[_; 0]>(&[]), SymmetryTest::NOTHING);
        assert_eq!(
            stuart_maxwell(&[[(0, 1.0), (0, -1.0)]; 99]),
            SymmetryTest::NOTHING
        );
        assert_eq!(
            stuart_maxwell(&[[(0, 1.0), (1, -1.0)]; 9]),
            SymmetryTest::NOTHING
        );
        // Three units are left, which all change alike: the probability of that is 1/4, not 0.
        assert_eq!(wald(vec![3.0], vec![3.0], 3.0), SymmetryTest::NOTHING);
        // Sparse pairs are pooled: 6 to 6 in one, 20 to 10 in the other.
        let pooled = bowker(&[vec![0, 4, 20], vec![2, 0, 2], vec![10, 4, 0]]);
        assert_eq!(pooled.freedom, 2);
        assert_close(pooled.statistic, 100.0 / 30.0, 1e-12);
    }

    /// 1000 tables of 400 pairs over 12 cells whose probabilities decrease fast, so that most pairs of
    /// cells are pooled. A product of equal margins is symmetric: uniform p-values (false alarm rate
    /// 1e-3). If one step in two goes up by one cell, modulo 12, both margins of a uniform start are
    /// equal but the flow is asymmetric: detected in more than 95% at level 0.01.
    #[test]
    fn bowkers_test_keeps_its_level_and_has_power() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(31);
        let (mut p_values, mut found) = (vec![], 0);
        for _ in 0..1000 {
            let mut even = vec![vec![0; 12]; 12];
            let mut circular = even.clone();
            for _ in 0..400 {
                let [i, j] = [(); 2].map(|()| (rng.random::<f64>().powi(2) * 12.0) as usize);
                even[i][j] += 1;
                let i = rng.random_range(0..12);
                let up: bool = rng.random();
                circular[i][if up {
                    (i + 1) % 12
                } else {
                    rng.random_range(0..12)
                }] += 1;
            }
            p_values.push(bowker(&even).p_value);
            found += u32::from(bowker(&circular).p_value < 0.01);
        }
        assert_uniform(&mut p_values);
        assert!(found > 950, "{found} of 1000");
    }

    /// 1000 runs of 150 chains, each with 20 pairs that are correlated by a common start: uniform
    /// p-values (false alarm rate 1e-3) for dense units; for single pairs, which are discrete, no more
    /// alarms than the level allows. A step that drifts up in one of four pairs is detected in more than
    /// 95% at level 0.01. Treating the pairs as independent would raise a false alarm at 0.05 in more
    /// than 90 of 100 runs.
    #[test]
    fn stuart_and_maxwells_test_keeps_its_level_and_has_power() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(32);
        let (mut clustered, mut single, mut found, mut naive) = (vec![], vec![], 0, 0);
        for run in 0..1000 {
            let [mut fair, mut drifting, mut apart] = [vec![], vec![], vec![]];
            for _ in 0..150 {
                let [from, to] = [(); 2].map(|()| cell(&mut rng));
                let (mut unit, mut drift) = (vec![], vec![]);
                for _ in 0..20 {
                    let moved = rng.random::<f64>() < 0.5;
                    let after = if moved { to } else { cell(&mut rng) };
                    let before = if moved { from } else { cell(&mut rng) };
                    unit.extend([(before, -1.0), (after, 1.0)]);
                    // Four in five stay where they are.
                    let stays = rng.random::<f64>() < 0.8;
                    let after = if stays { before } else { cell(&mut rng) };
                    let up = usize::from(rng.random::<f64>() < 0.25);
                    drift.extend([(before, -1.0), ((after + up).min(19), 1.0)]);
                }
                apart.extend(unit.chunks(2).map(<[_]>::to_vec));
                fair.push(unit);
                drifting.push(drift);
            }
            clustered.push(stuart_maxwell(&fair).p_value);
            found += u32::from(stuart_maxwell(&drifting).p_value < 0.01);
            if run < 100 {
                naive += u32::from(stuart_maxwell(&apart).p_value < 0.05);
            }
            let pairs: Vec<_> = (0..150)
                .map(|_| [(cell(&mut rng), 1.0), (cell(&mut rng), -1.0)])
                .collect();
            single.push(stuart_maxwell(&pairs).p_value);
        }
        assert_uniform(&mut clustered);
        assert_level_kept(&single);
        assert!(found > 950, "{found} of 1000");
        assert!(naive > 90, "{naive} of 100");
    }

    /// One of 20 cells, the last ones rare.
    fn cell(rng: &mut Xoshiro256PlusPlus) -> usize {
        (rng.random::<f64>().powi(2) * 20.0) as usize
    }
}
