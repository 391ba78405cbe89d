//! Small systems of linear equations.

/// s' A^-1 s for a symmetric positive semidefinite A and s in its range, with the rank of A: by
/// Cholesky's factorisation with pivots from the diagonal (Higham 2002, "Accuracy and stability of
/// numerical algorithms", section 10.3). It ends where no pivot exceeds 1e-9 of the largest diagonal
/// element, so rows that depend on others are left out: as s lies in the range, the value is that of
/// the pseudo-inverse. `a` has the rows of A one after the other.
///
/// Scale rows and columns alike beforehand if their units differ: the limit is one for all. Costs
/// k^3 / 3. (0, 0) for A = 0 or without rows.
///
/// # Panics
/// If `a` does not have as many rows and columns as `s` has elements.
pub fn inverse_form(mut a: Vec<f64>, s: &[f64]) -> (f64, usize) {
    let k = s.len();
    assert_eq!(a.len(), k * k, "a square matrix of the vector's size");
    let mut s = s.to_vec();
    let mut left: Vec<usize> = (0..k).collect();
    let limit = 1e-9 * (0..k).map(|i| a[i * k + i]).fold(0.0, f64::max);
    let (mut form, mut rank) = (0.0, 0);
    while let Some(position) =
        (0..left.len()).max_by(|&x, &y| a[left[x] * (k + 1)].total_cmp(&a[left[y] * (k + 1)]))
    {
        let p = left.swap_remove(position);
        let pivot = a[p * k + p];
        if pivot <= limit || pivot.is_nan() {
            break;
        }
        form += s[p] * s[p] / pivot;
        rank += 1;
        // What is left of A and s beside what row p explains.
        for &i in &left {
            let factor = a[i * k + p] / pivot;
            s[i] -= factor * s[p];
            for &j in &left {
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
    fn forms_by_hand() {
        // The inverse of ((2, 1), (1, 3)) is ((3, -1), (-1, 2)) / 5: (1, 2) gives (3 - 4 + 8) / 5.
        let (form, rank) = inverse_form(vec![2.0, 1.0, 1.0, 3.0], &[1.0, 2.0]);
        assert!((form - 1.4).abs() < 1e-14 && rank == 2, "{form} {rank}");
        // A third row, the sum of the others, adds nothing.
        let singular = vec![2.0, 1.0, 3.0, 1.0, 3.0, 4.0, 3.0, 4.0, 7.0];
        let (form, rank) = inverse_form(singular, &[1.0, 2.0, 3.0]);
        assert!((form - 1.4).abs() < 1e-14 && rank == 2, "{form} {rank}");
        assert_eq!(inverse_form(vec![0.0; 4], &[0.0; 2]), (0.0, 0));
        assert_eq!(inverse_form(vec![], &[]), (0.0, 0));
    }
}
