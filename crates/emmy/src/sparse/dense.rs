//! Small dense matrices: inverse and eigenpairs of a k x k matrix.

use faer::linalg::solvers::PartialPivLu;
use faer::prelude::Solve;
use faer::{Mat, MatMut, MatRef, Side, c64};

use crate::error::{Error, Result};

/// Inverse of a small matrix given row by row, `[n n]`.
///
/// ```
/// let inverse = emmy::internals::sparse::inverse(&[2.0, 0.0, 0.0, 4.0]);
/// assert_eq!(inverse, [0.5, 0.0, 0.0, 0.25]);
/// ```
pub fn inverse(matrix: &[f64]) -> Vec<f64> {
    let n = matrix.len().isqrt();
    let A = Mat::from_fn(n, n, |i, j| matrix[i * n + j]);
    let inverse = A.partial_piv_lu().solve(Mat::<f64>::identity(n, n));
    (0..n * n).map(|at| inverse[(at / n, at % n)]).collect()
}

/// Inverse of a small matrix in twice the precision, as a matrix and its rounding errors, `[n n]` each: [`inverse`],
/// corrected by `B (1 - A B)`.
///
/// ```
/// let [third, low] = emmy::internals::sparse::accurate_inverse(&[3.0]);
/// assert_eq!(third, [1.0 / 3.0]);
/// assert_eq!(low, [f64::EPSILON / 12.0]); // 1/3 = 0.0101..b is rounded down
/// ```
pub fn accurate_inverse(matrix: &[f64]) -> [Vec<f64>; 2] {
    let n = matrix.len().isqrt();
    let mut B = inverse(matrix);
    let correction = |B: &[f64]| -> Vec<f64> {
        let defect = |at: usize| {
            let unit = if at / n == at % n { 1.0 } else { 0.0 };
            let terms = (0..n).map(|m| [-matrix[at / n * n + m], B[m * n + at % n]]);
            accurate_sum(terms.chain([[unit, 1.0]]))[0]
        };
        let defects: Vec<f64> = (0..n * n).map(defect).collect();
        let entry = |at: usize| (0..n).map(|m| B[at / n * n + m] * defects[m * n + at % n]).sum();
        (0..n * n).map(entry).collect()
    };
    for _ in 0..2 {
        let change = correction(&B);
        B.iter_mut().zip(change).for_each(|(entry, change)| *entry += change);
    }
    let low = correction(&B);
    [B, low]
}

/// Sum of products in twice the precision, as a number and its rounding error (Ogita, Rump and Oishi 2005, SIAM Journal
/// on Scientific Computing 26).
///
/// ```
/// let sum = emmy::internals::sparse::accurate_sum([[1.0, 1.0], [1e-17, 1.0]]);
/// assert_eq!(sum, [1.0, 1e-17]);
/// ```
pub fn accurate_sum(products: impl IntoIterator<Item = [f64; 2]>) -> [f64; 2] {
    let [mut sum, mut error] = [0.0; 2];
    for [x, y] in products {
        let product = x * y;
        let next = sum + product;
        let taken = next - sum;
        error += (sum - (next - taken)) + (product - taken) + x.mul_add(y, -product);
        sum = next;
    }
    let total = sum + error;
    [total, error - (total - sum)]
}

/// A number and its rounding error as two parts, of which the first has 26 bits (Dekker 1971): in products with both,
/// rounded and added, nothing of the error is lost.
///
/// ```
/// assert_eq!(emmy::internals::sparse::split([1.0 + 2f64.powi(-40), 1e-20]), [1.0, 2f64.powi(-40) + 1e-20]);
/// ```
pub fn split([number, error]: [f64; 2]) -> [f64; 2] {
    let shifted = 134_217_729.0 * number;
    let high = shifted - (shifted - number);
    [high, (number - high) + error]
}

/// Eigenvalues and eigenvectors of a small real matrix with distinct eigenvalues; complex numbers as (real, imaginary).
#[derive(Debug, Clone, PartialEq)]
pub struct Eigenpairs {
    /// Eigenvalues, `[n]`.
    pub values: Vec<(f64, f64)>,
    /// Eigenvectors V as columns, `[i n + m]`.
    pub vectors: Vec<(f64, f64)>,
    /// Inverse of V, `[m n + i]`.
    pub inverse: Vec<(f64, f64)>,
}

/// Eigenpairs of a small matrix given row by row.
///
/// # Errors
/// [`Error::Linear`] if the iteration does not converge.
pub fn eigenpairs(matrix: &[f64]) -> Result<Eigenpairs> {
    let n = matrix.len().isqrt();
    let A = Mat::from_fn(n, n, |i, j| matrix[i * n + j]);
    let eigen = A.eigen().map_err(|_| Error::Linear { reason: "eigenvalues of the time element".into() })?;
    let V = eigen.U();
    let V_inverse = V.to_owned().partial_piv_lu().solve(Mat::<c64>::identity(n, n));
    let pair = |z: c64| (z.re, z.im);
    Ok(Eigenpairs {
        values: (0..n).map(|m| pair(eigen.S()[m])).collect(),
        vectors: (0..n * n).map(|at| pair(V[(at / n, at % n)])).collect(),
        inverse: (0..n * n).map(|at| pair(V_inverse[(at / n, at % n)])).collect(),
    })
}

/// Orthonormal basis of the null space of a small symmetric matrix without negative eigenvalues, of a size about 1,
/// given row by row.
///
/// ```
/// let basis = emmy::internals::sparse::null_space(&[1.0, -1.0, -1.0, 1.0])?;
/// assert!((basis[0][0] - basis[0][1]).abs() < 1e-15 && basis.len() == 1);
/// # Ok::<(), emmy::Error>(())
/// ```
///
/// # Errors
/// [`Error::Linear`] if the iteration does not converge.
pub fn null_space(matrix: &[f64]) -> Result<Vec<Vec<f64>>> {
    null_space_within(matrix, NULL)
}

/// The same with the modulus below which eigenvalues count as zero.
///
/// # Errors
/// As [`null_space`].
pub fn null_space_within(matrix: &[f64], least: f64) -> Result<Vec<Vec<f64>>> {
    let n = matrix.len().isqrt();
    let A = Mat::from_fn(n, n, |i, j| matrix[i * n + j]);
    let failed = |_| Error::Linear { reason: "eigenvalues of a symmetric matrix".into() };
    let eigen = A.self_adjoint_eigen(Side::Lower).map_err(failed)?;
    let is_null = |&m: &usize| eigen.S()[m].abs() < least;
    Ok((0..n).filter(is_null).map(|m| (0..n).map(|i| eigen.U()[(i, m)]).collect()).collect())
}

/// An eigenvalue with its vector, (real, imaginary).
type Eigenpair = (f64, Vec<(f64, f64)>);

/// Eigenvalues `i omega` of a small real antisymmetric matrix of even size with omega >= 0, the smallest first, and
/// their vectors with `|z| = 1`, (real, imaginary); those of `-i omega` are conjugate.
///
/// # Errors
/// [`Error::Linear`] if the iteration does not converge.
pub(crate) fn antisymmetric_eigenpairs(matrix: &[f64]) -> Result<Vec<Eigenpair>> {
    let n = matrix.len().isqrt();
    // -i A is Hermitian.
    let H = Mat::from_fn(n, n, |i, j| c64::new(0.0, 0.5 * (matrix[j * n + i] - matrix[i * n + j])));
    let failed = |_| Error::Linear { reason: "eigenvalues of an antisymmetric matrix".into() };
    let eigen = H.self_adjoint_eigen(Side::Lower).map_err(failed)?;
    let vector = |m: usize| (0..n).map(|i| (eigen.U()[(i, m)].re, eigen.U()[(i, m)].im)).collect();
    Ok((n / 2..n).map(|m| (eigen.S()[m].re, vector(m))).collect())
}

/// Largest eigenvalue of a small symmetric matrix, given row by row.
///
/// # Errors
/// [`Error::Linear`] if the iteration does not converge.
pub(crate) fn largest_eigenvalue(matrix: &[f64]) -> Result<f64> {
    let n = matrix.len().isqrt();
    let A = Mat::from_fn(n, n, |i, j| matrix[i * n + j]);
    let failed = |_| Error::Linear { reason: "eigenvalues of a symmetric matrix".into() };
    Ok(A.self_adjoint_eigen(Side::Lower).map_err(failed)?.S()[n - 1])
}

/// Eigenvalues below this are zero but for rounding.
const NULL: f64 = 1e-12;

/// Factorisation of a dense matrix with row pivots, for many right-hand sides.
#[derive(Debug)]
pub(crate) struct DenseLu(PartialPivLu<f64>);

impl DenseLu {
    /// Factorises a matrix given row by row; `None` if it is singular or not finite.
    pub(crate) fn new(matrix: &[f64]) -> Option<Self> {
        let n = matrix.len().isqrt();
        let factor = MatRef::from_row_major_slice(matrix, n, n).partial_piv_lu();
        let is_regular = (0..n).all(|i| factor.U()[(i, i)] != 0.0 && factor.U()[(i, i)].is_finite());
        is_regular.then_some(DenseLu(factor))
    }

    /// Solves for columns in place, `x: [columns][n]`.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let n = self.0.U().nrows();
        let columns = x.len() / n.max(1);
        self.0.solve_in_place(MatMut::from_column_major_slice_mut(x, n, columns));
    }
}

/// Eigenvalues of a symmetric matrix given row by row, ascending.
///
/// # Errors
/// [`Error::Linear`] if the iteration does not converge.
pub(crate) fn eigenvalues(matrix: &[f64]) -> Result<Vec<f64>> {
    let n = matrix.len().isqrt();
    let values = MatRef::from_row_major_slice(matrix, n, n).self_adjoint_eigenvalues(Side::Lower);
    values.map_err(|_| Error::Linear { reason: "eigenvalues of a symmetric matrix".into() })
}

/// Solves a small system for several right-hand sides in place, by Gaussian elimination with row pivots; `x:
/// [n][columns]`. Returns `false` if the matrix is singular. Allocates nothing.
///
/// ```
/// let mut matrix = [0.0, 2.0, 4.0, 1.0];
/// let mut x = [2.0, 9.0];
/// assert!(emmy::internals::sparse::eliminate(&mut matrix, &mut x, 1));
/// assert_eq!(x, [2.0, 1.0]);
/// ```
pub fn eliminate(matrix: &mut [f64], x: &mut [f64], columns: usize) -> bool {
    let n = matrix.len().isqrt();
    for column in 0..n {
        let size = |row: usize| matrix[row * n + column].abs();
        let pivot = (column..n).fold(column, |best, row| if size(row) > size(best) { row } else { best });
        if size(pivot).is_nan() || size(pivot) == 0.0 {
            return false;
        }
        (0..n).for_each(|j| matrix.swap(pivot * n + j, column * n + j));
        (0..columns).for_each(|j| x.swap(pivot * columns + j, column * columns + j));
        let (above, below) = matrix.split_at_mut((column + 1) * n);
        let pivot = &above[column * n + column..];
        // Where the matrix is sparse, rows end early.
        let end = pivot.iter().rposition(|entry| *entry != 0.0).map_or(1, |last| last + 1);
        let pivot = &pivot[..end];
        for (row, own) in (column + 1..).zip(below.chunks_exact_mut(n)) {
            let factor = own[column] / pivot[0];
            if factor == 0.0 {
                continue;
            }
            own[column..].iter_mut().zip(pivot).for_each(|(entry, above)| *entry -= factor * above);
            (0..columns).for_each(|j| x[row * columns + j] -= factor * x[column * columns + j]);
        }
    }
    for row in (0..n).rev() {
        for j in 0..columns {
            let rest: f64 = (row + 1..n).map(|i| matrix[row * n + i] * x[i * columns + j]).sum();
            x[row * columns + j] = (x[row * columns + j] - rest) / matrix[row * n + row];
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn singular_matrices_have_no_factor() {
        assert!(DenseLu::new(&[1.0, 2.0, 2.0, 4.0]).is_none());
        assert!(DenseLu::new(&[f64::NAN]).is_none());
        let mut x = [2.0, 9.0, 4.0, 2.0];
        DenseLu::new(&[0.0, 2.0, 4.0, 1.0]).unwrap().solve(&mut x);
        assert_eq!(x, [2.0, 1.0, 0.0, 2.0]);
        assert_eq!(eigenvalues(&[1.0, 0.0, 0.0, -2.0]).unwrap(), [-2.0, 1.0]);
    }

    #[test]
    fn eigenvalues_of_a_rotation_are_a_conjugate_pair() {
        let eigen = eigenpairs(&[1.0, -2.0, 2.0, 1.0]).unwrap();
        for (re, im) in eigen.values {
            assert!((re - 1.0).abs() < 1e-14 && (im.abs() - 2.0).abs() < 1e-14);
        }
    }
}
