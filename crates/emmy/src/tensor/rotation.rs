//! Rotations as 3 x 3 tensors.

use super::{Mat3, cross};

/// Identity.
pub(crate) const IDENTITY: Mat3<f64> = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A B.
pub(crate) fn product(A: &Mat3<f64>, B: &Mat3<f64>) -> Mat3<f64> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| A[i][0] * B[0][j] + A[i][1] * B[1][j] + A[i][2] * B[2][j]))
}

/// A B^T.
pub(crate) fn product_transposed(A: &Mat3<f64>, B: &Mat3<f64>) -> Mat3<f64> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| A[i][0] * B[j][0] + A[i][1] * B[j][1] + A[i][2] * B[j][2]))
}

/// Transpose.
pub(crate) fn transposed(A: &Mat3<f64>) -> Mat3<f64> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| A[j][i]))
}

/// A v.
pub(crate) fn image(A: &Mat3<f64>, v: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|i| A[i][0] * v[0] + A[i][1] * v[1] + A[i][2] * v[2])
}

/// The vector w with `w . c = c_x (W_zy - W_yz) + ..`: for `W = sum b a^T` it is `sum a x b`.
pub(crate) fn moment(W: &Mat3<f64>) -> [f64; 3] {
    [W[2][1] - W[1][2], W[0][2] - W[2][0], W[1][0] - W[0][1]]
}

/// Skew tensor `[w]` with `[w] v = w x v`.
pub(crate) fn skew(w: &[f64; 3]) -> Mat3<f64> {
    [[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]]
}

/// Rotation of a rotation vector, by the unit quaternion (cos, sin) of half the angle.
pub(crate) fn exp(w: &[f64; 3]) -> Mat3<f64> {
    let angle = (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt();
    let half = 0.5 * angle;
    // sin(half)/angle without division by zero.
    let s = if half < 1e-8 { 0.5 } else { half.sin() / angle };
    let c = half.cos();
    let [x, y, z] = w.map(|w| s * w);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - c * z), 2.0 * (x * z + c * y)],
        [2.0 * (x * y + c * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - c * x)],
        [2.0 * (x * z - c * y), 2.0 * (y * z + c * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// Rotation vector of a rotation, at most of length pi.
///
/// The quaternion from its largest component (Shepperd 1978): no cancellation at any angle.
pub(crate) fn log(R: &Mat3<f64>) -> [f64; 3] {
    let trace = R[0][0] + R[1][1] + R[2][2];
    let squares =
        [1.0 + trace, 1.0 - trace + 2.0 * R[0][0], 1.0 - trace + 2.0 * R[1][1], 1.0 - trace + 2.0 * R[2][2]];
    let largest = (1..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    let twist = moment(R);
    let mut quaternion = match largest {
        0 => [squares[0], twist[0], twist[1], twist[2]],
        i => {
            let axis = i - 1;
            let sum = |d: usize| if d == axis { squares[i] } else { R[d][axis] + R[axis][d] };
            [twist[axis], sum(0), sum(1), sum(2)]
        }
    };
    if quaternion[0] < 0.0 {
        quaternion = quaternion.map(|q| -q);
    }
    let [c, x, y, z] = quaternion;
    let sine = (x * x + y * y + z * z).sqrt();
    let factor = if sine == 0.0 { 0.0 } else { 2.0 * sine.atan2(c) / sine };
    [factor * x, factor * y, factor * z]
}

/// The rotation R of `A = R S`, with a symmetric positive semi-definite S; the identity if S has several directions
/// without stretch, as of points on a line.
///
/// Newton's iteration (Higham 1986) on `A + cof A`, each of unit size, which has the same R, also if A is singular, as
/// of points in a plane.
pub(crate) fn polar(A: &Mat3<f64>) -> Mat3<f64> {
    let unit = |A: &Mat3<f64>| {
        let size = A.iter().flatten().map(|a| a * a).sum::<f64>().sqrt();
        (size > 0.0).then(|| A.map(|row| row.map(|a| a / size)))
    };
    let Some(own) = unit(A) else { return IDENTITY };
    let Some(normal) = unit(&cofactors(&own)).filter(|_| size_of_cofactors(&own) > ON_A_LINE) else {
        return IDENTITY;
    };
    let mut R = [0, 1, 2].map(|i| [0, 1, 2].map(|j| own[i][j] + normal[i][j]));
    for _ in 0..ITERATIONS {
        let cofactors = cofactors(&R);
        let det: f64 = (0..3).map(|j| R[0][j] * cofactors[0][j]).sum();
        if det <= 0.0 {
            return IDENTITY;
        }
        let next = [0, 1, 2].map(|i| [0, 1, 2].map(|j| 0.5 * (R[i][j] + cofactors[i][j] / det)));
        let change = (0..9).map(|n| (next[n / 3][n % 3] - R[n / 3][n % 3]).abs()).fold(0.0, f64::max);
        R = next;
        if change < CONVERGED {
            break;
        }
    }
    R
}

/// Size of the cofactors of a tensor of unit size below which its points lie on a line.
const ON_A_LINE: f64 = 1e-10;

/// Steps of the iteration, which converges quadratically, and a change after which the next one is rounding.
const ITERATIONS: usize = 40;
const CONVERGED: f64 = 1e-9;

/// The cofactors of a tensor.
fn cofactors(A: &Mat3<f64>) -> Mat3<f64> {
    [cross(A[1], A[2]), cross(A[2], A[0]), cross(A[0], A[1])]
}

fn size_of_cofactors(A: &Mat3<f64>) -> f64 {
    cofactors(A).iter().flatten().map(|a| a * a).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polar_decomposition_finds_the_rotation() {
        for w in [[0.0; 3], [0.3, 0.5, -0.8], [0.0, 3.1, 0.4], [-1.0, -2.0, 2.0]] {
            let R = exp(&w);
            for stretch in [[1.0, 2.0, 3.0], [1e-3, 1.0, 1.0], [0.0, 2.0, 1.0]] {
                let turn = exp(&[0.4, -0.2, 0.9]);
                let scaled = turn.map(|row| [0, 1, 2].map(|d| row[d] * stretch[d]));
                let S = product_transposed(&scaled, &turn);
                let found = polar(&product(&R, &S));
                let error = (0..9).map(|n| (found[n / 3][n % 3] - R[n / 3][n % 3]).abs()).fold(0.0, f64::max);
                assert!(error < 1e-13, "{w:?} {stretch:?}: {error:e}");
            }
        }
        assert_eq!(polar(&[[2.0, 0.0, 0.0], [0.0; 3], [0.0; 3]]), IDENTITY);
        assert_eq!(polar(&[[0.0; 3]; 3]), IDENTITY);
    }

    #[test]
    fn the_rotation_vector_comes_back() {
        for w in [[0.0; 3], [1e-9, -2e-9, 0.0], [0.3, 0.5, -0.8], [0.0, 3.1, 0.4], [-1.0, -2.0, 2.0]] {
            let R = exp(&w);
            let unit = product_transposed(&R, &R);
            let back = log(&R);
            for i in 0..3 {
                assert!((back[i] - w[i]).abs() < 1e-15 + 2e-15 * w[i].abs().max(1.0), "{w:?}: {back:?}");
                assert!((0..3).all(|j| (unit[i][j] - IDENTITY[i][j]).abs() < 1e-15));
            }
        }
    }
}
