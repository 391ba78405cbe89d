//! Sparse cells of a table of counts, pooled until the chi-square approximation holds for each.

/// Assigns cells of these `sizes` to pools of at least `least` each, smallest cells first: the pool of
/// each cell, and the number of pools. What remains in the end joins the last pool. With less than
/// `least` in all there are no pools and the number is 0.
///
/// A test keeps its level if sizes do not depend on what it asks for: expected counts, or totals of
/// the groups that it compares.
pub(super) fn pool_sparse(sizes: &[f64], least: f64) -> (Vec<usize>, usize) {
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|&i, &j| sizes[i].total_cmp(&sizes[j]));
    let mut pool_of = vec![0; sizes.len()];
    let (mut pools, mut size, mut rest) = (0, 0.0, sizes.iter().sum::<f64>());
    for i in order {
        size += sizes[i];
        rest -= sizes[i];
        pool_of[i] = pools;
        // Close a pool only if the rest suffices for another one; sums of sizes are not exact.
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
    fn pools_are_large_enough_and_lose_no_cell() {
        let (pool_of, pools) = pool_sparse(&[9.0, 1.0, 2.0, 3.0, 7.0, 0.0], 5.0);
        assert_eq!((pool_of, pools), (vec![2, 0, 0, 0, 1, 0], 3));
        // The last two cells are too few for a pool of their own.
        let (pool_of, pools) = pool_sparse(&[3.0, 3.0, 3.0], 5.0);
        assert_eq!((pool_of, pools), (vec![0, 0, 0], 1));
        assert_eq!(pool_sparse(&[1.0, 2.0], 5.0).1, 0);
        assert_eq!(pool_sparse(&[], 5.0).1, 0);
    }
}
