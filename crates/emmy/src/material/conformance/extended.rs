//! Numbers with 400 bits, and the terms of reference energies.

use dashu_float::{FBig, round::mode::HalfEven};

use crate::tensor::Mat3;

/// A number with 400 bits, 120 decimal digits.
pub(crate) type Big = FBig<HalfEven, 2>;

/// Extended-precision number of a double, exactly.
pub(crate) fn big(x: f64) -> Big {
    Big::try_from(x).unwrap().with_precision(400).value()
}

/// Trace, for the reference energies.
pub(crate) fn big_trace(C: &Mat3<Big>) -> Big {
    &C[0][0] + &C[1][1] + &C[2][2]
}

/// Determinant, for the reference energies.
pub(crate) fn big_det(C: &Mat3<Big>) -> Big {
    let minor = |i: usize, j: usize| &C[1][i] * &C[2][j] - &C[1][j] * &C[2][i];
    &C[0][0] * minor(1, 2) - &C[0][1] * minor(0, 2) + &C[0][2] * minor(0, 1)
}

/// Isochoric invariants I1bar and I2bar, for the reference energies.
pub(crate) fn big_isochoric(C: &Mat3<Big>) -> [Big; 2] {
    let scale = (big_det(C).ln() / big(-3.0)).exp();
    let squares = C.iter().flatten().fold(big(0.0), |sum, c| sum + c * c);
    let I1 = big_trace(C);
    let scale_squared = &scale * &scale;
    let I2 = (&I1 * &I1 - squares) / big(2.0);
    [I1 * scale, I2 * scale_squared]
}

/// Principal stretches, for the reference energies: roots of the eigenvalues of C, by Jacobi's method.
pub(crate) fn big_principal_stretches(C: &Mat3<Big>) -> [Big; 3] {
    let mut a = C.clone();
    let negligible = big(2f64.powi(-420));
    while [(0, 1), (1, 2), (0, 2)].iter().any(|&(p, q)| &a[p][q] * &a[p][q] > negligible) {
        for (p, q) in [(0, 1), (1, 2), (0, 2)] {
            big_rotate(&mut a, p, q);
        }
    }
    [a[0][0].sqrt(), a[1][1].sqrt(), a[2][2].sqrt()]
}

/// The rotation in the plane of p and q that makes a_pq zero, without its effect on vectors.
fn big_rotate(a: &mut Mat3<Big>, p: usize, q: usize) {
    let apq = a[p][q].clone();
    let zero = big(0.0);
    let one = big(1.0);
    if apq == zero {
        return;
    }
    let half = (&a[q][q] - &a[p][p]) / big(2.0);
    let root = (&half * &half + &apq * &apq).sqrt();
    let t = if half < zero { &apq / (&half - root) } else { &apq / (&half + root) };
    let c = &one / (&t * &t + &one).sqrt();
    let s = &t * &c;
    a[p][p] -= &t * &apq;
    a[q][q] += &t * &apq;
    let r = 3 - p - q;
    let rp = &c * &a[r][p] - &s * &a[r][q];
    let rq = &s * &a[r][p] + &c * &a[r][q];
    (a[p][q], a[q][p]) = (zero.clone(), zero);
    (a[r][p], a[p][r]) = (rp.clone(), rp);
    (a[r][q], a[q][r]) = (rq.clone(), rq);
}
