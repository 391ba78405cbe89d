//! Sparse cells of a table of counts, pooled until the chi-square approximation holds for each.

/// Assigns cells of these `sizes` to pools of at least `least` each, smallest cells first: the pool of
/// each cell, and the number of pools. The remainder joins the last pool. If all cells together are smaller
/// than `least`, the number of pools is 0.
///
/// A test keeps its level if the sizes are independent of its statistic under the null hypothesis: expected
/// counts, or totals of the compared groups.
pub(super) fn pool_sparse(sizes: &[f64], least: f64) -> (Vec<usize>, usize) {
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|&i, &j| sizes[i].total_cmp(&sizes[j]));
    let mut pool_of = vec![0; sizes.len()];
    let (mut pools, mut size, mut rest) = (0, 0.0, sizes.iter().sum::<f64>());
    for i in order {
        size += sizes[i];
        rest -= sizes[i];
        pool_of[i] = pools;
        // Close a pool only if the rest suffices for another; sums of sizes have rounding errors.
        if size >= least && rest >= least * (1.0 - 1e-9) {
            pools += 1;
            size = 0.0;
        }
    }
    let enough = size >= least * (1.0 - 1e-6);
    (pool_of, if enough { pools + 1 } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pools_are_large_enough_and_include_every_cell() {
        let (pool_of, pools) = pool_sparse(&[9.0, 1.0, 2.0, 3.0, 7.0, 0.0], 5.0);
        assert_eq!((pool_of, pools), (vec![2, 0, 0, 0, 1, 0], 3));
        // The last two cells are too few for a pool of their own.
        let (pool_of, pools) = pool_sparse(&[3.0, 3.0, 3.0], 5.0);
        assert_eq!((pool_of, pools), (vec![0, 0, 0], 1));
        assert_eq!(pool_sparse(&[1.0, 2.0], 5.0).1, 0);
        assert_eq!(pool_sparse(&[], 5.0).1, 0);
    }
}
