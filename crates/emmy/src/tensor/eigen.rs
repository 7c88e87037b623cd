//! Eigenvalues and eigenvectors of a symmetric 3x3 tensor.

#![allow(non_snake_case)]

use super::{Mat3, SYM_INDEX, Sym};

/// Upper bound on the sweeps of Jacobi's method, which converges quadratically, in four or five.
const SWEEPS: usize = 30;

/// Eigenvalues and eigenvectors (in columns, orthonormal, in no order) of a symmetric tensor.
///
/// ```math
/// A = Q diag(values) Q^T
/// ```
///
/// Jacobi's method: backward stable, so that equal and nearly equal eigenvalues lose nothing. Source: Golub and Van
/// Loan (2013), Matrix Computations, section 8.5.
///
/// ```
/// let (values, Q) = emmy::internals::tensor::eigen(&[1.0, 1.0, 5.0, 2.0, 0.0, 0.0]);
/// assert!((values[0] + 1.0).abs() < 1e-15 && (values[1] - 3.0).abs() < 1e-15 && values[2] == 5.0);
/// assert!((Q[0][0].abs() - 0.5f64.sqrt()).abs() < 1e-15);
/// ```
pub fn eigen(A: &Sym<f64>) -> ([f64; 3], Mat3<f64>) {
    let mut a = [0, 1, 2].map(|i| [0, 1, 2].map(|j| A[SYM_INDEX[i][j]]));
    let mut Q = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let size = A.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    for _ in 0..SWEEPS {
        // Far below the rounding of the values: the vectors cannot be more accurate.
        if [(0, 1), (1, 2), (0, 2)].iter().all(|&(p, q)| a[p][q].abs() <= 1e-20 * size) {
            break;
        }
        rotate::<0, 1>(&mut a, &mut Q);
        rotate::<1, 2>(&mut a, &mut Q);
        rotate::<0, 2>(&mut a, &mut Q);
    }
    ([a[0][0], a[1][1], a[2][2]], Q)
}

/// The rotation in the plane of p and q that makes a_pq zero. Inlined with its constants, so that the tensors stay in
/// registers.
#[inline(always)]
fn rotate<const P: usize, const Q: usize>(a: &mut Mat3<f64>, vectors: &mut Mat3<f64>) {
    let p = P;
    let q = Q;
    if a[p][q] == 0.0 {
        return;
    }
    let tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = tau.signum() / (tau.abs() + (tau * tau + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    a[p][p] -= t * a[p][q];
    a[q][q] += t * a[p][q];
    (a[p][q], a[q][p]) = (0.0, 0.0);
    let r = 3 - p - q;
    let rp = a[r][p];
    let rq = a[r][q];
    (a[r][p], a[r][q]) = (c * rp - s * rq, s * rp + c * rq);
    (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
    for row in vectors {
        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::SYM;
    use super::*;
    use proptest::prelude::*;

    /// Q diag(values) Q^T = A and Q^T Q = I, up to a few roundings.
    fn assert_decomposed(A: &Sym<f64>) {
        let (values, Q) = eigen(A);
        let size = A.iter().fold(1e-300, |size: f64, x| size.max(x.abs()));
        for (component, (i, j)) in SYM.into_iter().enumerate() {
            let product: f64 = (0..3).map(|k| Q[i][k] * values[k] * Q[j][k]).sum();
            assert!((product - A[component]).abs() < 3e-15 * size, "{A:?}: {product}");
            let unit: f64 = (0..3).map(|k| Q[k][i] * Q[k][j]).sum();
            assert!((unit - f64::from(u8::from(i == j))).abs() < 2e-15, "{A:?}");
        }
    }

    proptest! {
        #[test]
        fn the_tensor_is_put_together_again(a in prop::array::uniform6(-1.0..1.0f64), power in -12..1i32) {
            assert_decomposed(&a);
            assert_decomposed(&a.map(|x| x * 1e-8));
            // Nearly equal eigenvalues: a multiple of the unit tensor and something small.
            let mut near = a.map(|x| x * 10f64.powi(power));
            (0..3).for_each(|i| near[i] += 0.7);
            assert_decomposed(&near);
        }
    }

    #[test]
    fn diagonal_and_zero_tensors_are_left_alone() {
        assert_eq!(eigen(&[0.0; 6]).0, [0.0; 3]);
        assert_eq!(eigen(&[2.0, -1.0, 2.0, 0.0, 0.0, 0.0]).0, [2.0, -1.0, 2.0]);
        assert_decomposed(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
        assert!(eigen(&[f64::NAN; 6]).0[0].is_nan());
    }
}
