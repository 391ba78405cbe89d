//! Small systems of linear equations.

/// The quadratic form s^T A^-1 s for a symmetric positive semidefinite A and s in its range, and
/// the rank of A. Computed by Cholesky factorisation with diagonal pivoting (Higham 2002, "Accuracy
/// and stability of numerical algorithms", section 10.3). `a` is A in row-major order.
///
/// The factorisation stops when no pivot exceeds 1e-9 of the largest diagonal element, so linearly
/// dependent rows are skipped. Since s lies in the range of A, the value is that of the
/// pseudo-inverse. This limit is the same for all rows: if their units differ, scale rows and
/// columns first. Costs k^3 / 3 operations. Returns (0, 0) if A is zero or empty.
///
/// # Panics
/// If `a` is not a square matrix of the size of `s`.
pub fn inverse_form(mut a: Vec<f64>, s: &[f64]) -> (f64, usize) {
    let k = s.len();
    assert_eq!(a.len(), k * k, "a square matrix of the size of the vector");
    let mut s = s.to_vec();
    let mut remaining: Vec<usize> = (0..k).collect();
    let limit = 1e-9 * (0..k).map(|i| a[i * k + i]).fold(0.0, f64::max);
    let (mut form, mut rank) = (0.0, 0);
    while let Some(position) = (0..remaining.len())
        .max_by(|&x, &y| a[remaining[x] * (k + 1)].total_cmp(&a[remaining[y] * (k + 1)]))
    {
        let p = remaining.swap_remove(position);
        let pivot = a[p * k + p];
        if pivot <= limit || pivot.is_nan() {
            break;
        }
        form += s[p] * s[p] / pivot;
        rank += 1;
        // The Schur complement of the pivot, and the right-hand side that belongs to it.
        for &i in &remaining {
            let factor = a[i * k + p] / pivot;
            s[i] -= factor * s[p];
            for &j in &remaining {
                a[i * k + j] -= factor * a[p * k + j];
            }
        }
    }
    (form, rank)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadratic_forms_match_values_by_hand() {
        // The inverse of ((2, 1), (1, 3)) is ((3, -1), (-1, 2)) / 5: (1, 2) gives (3 - 4 + 8) / 5.
        let (form, rank) = inverse_form(vec![2.0, 1.0, 1.0, 3.0], &[1.0, 2.0]);
        assert!((form - 1.4).abs() < 1e-14 && rank == 2, "{form} {rank}");
        // A third row that is the sum of the others does not change the value.
        let singular = vec![2.0, 1.0, 3.0, 1.0, 3.0, 4.0, 3.0, 4.0, 7.0];
        let (form, rank) = inverse_form(singular, &[1.0, 2.0, 3.0]);
        assert!((form - 1.4).abs() < 1e-14 && rank == 2, "{form} {rank}");
        assert_eq!(inverse_form(vec![0.0; 4], &[0.0; 2]), (0.0, 0));
        assert_eq!(inverse_form(vec![], &[]), (0.0, 0));
    }
}
