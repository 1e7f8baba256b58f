//! Symmetric systems with two diagonals beside the main one on each side: factored in place, in time linear in their size.
//!
//! `A = L D Lᵀ`, L with ones on its diagonal and `l₁`, `l₂` below it, D diagonal:
//!
//! ```text
//! dᵢ = Aᵢᵢ - l₁ᵢ₋₁² dᵢ₋₁ - l₂ᵢ₋₂² dᵢ₋₂        l₁ᵢ = (Aᵢ₊₁ᵢ - l₂ᵢ₋₁ dᵢ₋₁ l₁ᵢ₋₁)/dᵢ        l₂ᵢ = Aᵢ₊₂ᵢ/dᵢ
//! ```
//!
//! No pivots: for a positive definite A none are needed (Golub and Van Loan, *Matrix Computations*, 4.3).

use alloc::vec::Vec;

/// A symmetric matrix with five diagonals: row i holds `Aᵢᵢ`, `Aᵢ₊₁ᵢ` and `Aᵢ₊₂ᵢ`; after [`factor`](Self::factor) `dᵢ`, `l₁ᵢ`, `l₂ᵢ`.
pub(crate) struct Pentadiagonal {
    rows: Vec<[f64; 3]>,
}

impl Pentadiagonal {
    /// The matrix of zeros.
    pub(crate) fn zeros(size: usize) -> Self {
        Self { rows: alloc::vec![[0.0; 3]; size] }
    }

    /// Makes all of it zero.
    pub(crate) fn clear(&mut self) {
        self.rows.fill([0.0; 3]);
    }

    /// Adds `scale w wᵀ`, w being zero but for `weights` from index `first` on. What lies beyond the matrix is left out.
    pub(crate) fn add_square(&mut self, first: usize, weights: &[f64; 3], scale: f64) {
        let [w0, w1, w2] = *weights;
        let Some([a, b, c, ..]) = self.rows.get_mut(first..) else { return };
        let (s0, s1) = (scale * w0, scale * w1);
        a[0] += s0 * w0;
        a[1] += s0 * w1;
        a[2] += s0 * w2;
        b[0] += s1 * w1;
        b[1] += s1 * w2;
        c[0] += scale * w2 * w2;
    }

    /// Factors the matrix in place; `false` if it is not positive definite, or a number is none.
    pub(crate) fn factor(&mut self) -> bool {
        let ([mut d1, mut first1, mut second1], [mut d2, mut second2]) = ([0.0; 3], [0.0; 2]);
        for row in &mut self.rows {
            let [diagonal, beside, beyond] = *row;
            let pivot = diagonal - first1 * first1 * d1 - second2 * second2 * d2;
            if !(pivot > 0.0 && pivot < f64::MAX) {
                return false;
            }
            let first = (beside - second1 * d1 * first1) / pivot;
            let second = beyond / pivot;
            *row = [pivot, first, second];
            (d2, second2) = (d1, second1);
            (d1, first1, second1) = (pivot, first, second);
        }
        true
    }

    /// Solves `A x = b` in place, once factored.
    pub(crate) fn solve(&self, values: &mut [f64]) {
        let (mut carry1, mut carry2) = (0.0, 0.0);
        for (value, [_, first, second]) in values.iter_mut().zip(&self.rows) {
            *value -= carry1;
            carry1 = carry2 + first * *value;
            carry2 = second * *value;
        }
        let (mut next, mut after) = (0.0, 0.0);
        for (value, [pivot, first, second]) in values.iter_mut().zip(&self.rows).rev() {
            *value = *value / pivot - first * next - second * after;
            (after, next) = (next, *value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Gaussian elimination with pivots.
    fn dense(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
        let n = b.len();
        for i in 0..n {
            let best = (i..n).max_by(|x, y| a[*x][i].abs().total_cmp(&a[*y][i].abs())).unwrap();
            a.swap(i, best);
            b.swap(i, best);
            for k in i + 1..n {
                let factor = a[k][i] / a[i][i];
                let pivot = a[i].clone();
                a[k].iter_mut().zip(&pivot).for_each(|(a, pivot)| *a -= factor * pivot);
                b[k] -= factor * b[i];
            }
        }
        for i in (0..n).rev() {
            for k in i + 1..n {
                b[i] -= a[i][k] * b[k];
            }
            b[i] /= a[i][i];
        }
        b
    }

    proptest! {
        #[test]
        fn it_solves_what_a_dense_elimination_solves(
            squares in prop::collection::vec((prop::array::uniform3(-1.0..1.0_f64), 0.01..10.0_f64), 1..40),
            right in prop::collection::vec(-1.0..1.0_f64, 42),
        ) {
            let n = squares.len() + 2;
            let mut banded = Pentadiagonal::zeros(n);
            let mut full = vec![vec![0.0; n]; n];
            for (i, row) in full.iter_mut().enumerate() {
                // A small share of the unit matrix keeps it definite.
                let (first, place) = if i + 3 <= n { (i, 0) } else { (n - 3, i + 3 - n) };
                let mut unit = [0.0; 3];
                unit[place] = 1.0;
                banded.add_square(first, &unit, 0.1);
                row[i] += 0.1;
            }
            for (first, (weights, scale)) in squares.iter().enumerate() {
                banded.add_square(first, weights, *scale);
                for i in 0..3 {
                    for k in 0..3 {
                        full[first + i][first + k] += scale * weights[i] * weights[k];
                    }
                }
            }
            let mut found = right[..n].to_vec();
            prop_assert!(banded.factor());
            banded.solve(&mut found);
            let expected = dense(full, right[..n].to_vec());
            for (found, expected) in found.iter().zip(&expected) {
                prop_assert!((found - expected).abs() <= 1e-10 * (1.0 + expected.abs()), "{found} {expected}");
            }
        }
    }

    #[test]
    fn an_indefinite_matrix_is_refused() {
        let mut matrix = Pentadiagonal::zeros(3);
        matrix.add_square(0, &[1.0, 1.0, 1.0], 1.0);
        assert!(!matrix.factor());
        let mut matrix = Pentadiagonal::zeros(3);
        matrix.add_square(0, &[f64::NAN, 1.0, 1.0], 1.0);
        assert!(!matrix.factor());
    }
}
