//! Small tensors at a material point, generic over a lane number type: one point, or a batch of points side by side.

#![allow(non_snake_case)]

/// A closure that is inlined wherever it is called. Code over lanes must be inlined: a separate function would be
/// compiled for the oldest instruction set (see [`Batch`]).
macro_rules! inlined {
    ($($closure:tt)*) => {
        std::convert::identity(#[inline(always)] $($closure)*)
    };
}
pub(crate) use inlined;

mod batch;
mod eigen;
mod lane;
pub(crate) mod rotation;

pub use batch::{Batch, LANES, Packed, Register};
pub use eigen::eigen;
pub use lane::Lane;

/// Second-order tensor, `[row][column]`.
///
/// ```
/// let F: emmy::material::Mat3<f64> = [[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// assert_eq!(F[0][1], 0.5); // simple shear
/// ```
pub type Mat3<L> = [[L; 3]; 3];

/// Symmetric second-order tensor: components 11, 22, 33, 12, 23, 13 (plain tensor components, nothing doubled).
///
/// ```
/// use emmy::material::{Sym, trace};
/// let strain: Sym<f64> = [0.1, 0.2, 0.3, 0.0, 0.0, 0.05];
/// assert!((trace(&strain) - 0.6).abs() < 1e-15);
/// ```
pub type Sym<L> = [L; 6];

/// Derivative of a stress by a strain, `[stress component][strain component]`, in the order of [`Sym`]. As a shear
/// strain represents two tensor components, `dS_a = sum_b D_ab dE_b` runs over *doubled* shears `dE_b`.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::material::Elasticity;
/// let (_, D): (_, Elasticity<f64>) = SaintVenantKirchhoff::new(3.0, 2.0)?.stress_and_elasticity(&[0.0; 6]);
/// // dS_12 = 2 mu dE_12 = mu times the doubled shear.
/// assert_eq!((D[0][0], D[0][1], D[3][3]), (7.0, 3.0, 2.0));
/// # Ok::<(), emmy::Error>(())
/// ```
pub type Elasticity<L> = [[L; 6]; 6];

/// Derivative of a tensor by a tensor, `[3 i + J][3 k + L]`.
pub type Tangent<L> = [[L; 9]; 9];

/// Row and column of each component of [`Sym`].
pub const SYM: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

/// Component of [`Sym`] at each row and column.
pub const SYM_INDEX: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// Tensor from its components. Written out: the compiler does not always unroll `array::map` in a kernel.
#[inline(always)]
pub fn mat3<L>(entry: impl Fn(usize, usize) -> L) -> Mat3<L> {
    [
        [entry(0, 0), entry(0, 1), entry(0, 2)],
        [entry(1, 0), entry(1, 1), entry(1, 2)],
        [entry(2, 0), entry(2, 1), entry(2, 2)],
    ]
}

/// Vector product.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Three components.
#[inline(always)]
pub fn three<L>(entry: impl Fn(usize) -> L) -> [L; 3] {
    [entry(0), entry(1), entry(2)]
}

/// Nine components.
#[inline(always)]
pub fn nine<L>(entry: impl Fn(usize) -> L) -> [L; 9] {
    [entry(0), entry(1), entry(2), entry(3), entry(4), entry(5), entry(6), entry(7), entry(8)]
}

/// Symmetric tensor from its components.
#[inline(always)]
pub fn sym<L>(entry: impl Fn(usize, usize) -> L) -> Sym<L> {
    [entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(0, 2)]
}

/// Symmetric tensor times a number.
///
/// ```
/// assert_eq!(emmy::material::sym_scaled(2.0, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), [2.0, 4.0, 6.0, 8.0, 10.0, 12.0]);
/// ```
#[inline(always)]
pub fn sym_scaled<L: Lane>(s: L, A: &Sym<L>) -> Sym<L> {
    [s * A[0], s * A[1], s * A[2], s * A[3], s * A[4], s * A[5]]
}

/// Sum of three products.
#[inline(always)]
pub fn dot3<L: Lane>(a: [L; 3], b: [L; 3]) -> L {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// Determinant.
#[inline(always)]
pub fn det<L: Lane>(A: &Mat3<L>) -> L {
    let minor = inlined!(|i: usize, j: usize| A[1][i].mul_add(A[2][j], -(A[1][j] * A[2][i])));
    dot3([A[0][0], A[0][1], A[0][2]], [minor(1, 2), minor(2, 0), minor(0, 1)])
}

/// Determinant of the unit tensor plus a tensor.
#[inline(always)]
pub fn det_of_identity_plus<L: Lane>(G: &Mat3<L>) -> L {
    let one = G[0][0].splat(1.0);
    let mut F = *G;
    for i in 0..3 {
        F[i][i] += one;
    }
    det(&F)
}

/// Determinant of a symmetric tensor.
///
/// ```
/// assert_eq!(emmy::material::sym_det(&[2.0, 3.0, 4.0, 1.0, 0.0, 0.0]), 20.0); // (2*3 - 1)*4
/// ```
#[inline(always)]
pub fn sym_det<L: Lane>(A: &Sym<L>) -> L {
    let minor = inlined!(|a: usize, b: usize, c: usize, d: usize| A[a].mul_add(A[b], -(A[c] * A[d])));
    dot3([A[0], A[3], A[5]], [minor(1, 2, 4, 4), minor(4, 5, 3, 2), minor(3, 4, 1, 5)])
}

/// Cofactor of a symmetric tensor: its determinant times its inverse.
///
/// ```
/// assert_eq!(emmy::material::sym_cofactor(&[2.0, 3.0, 4.0, 0.0, 0.0, 0.0]), [12.0, 8.0, 6.0, 0.0, 0.0, 0.0]);
/// ```
#[inline(always)]
pub fn sym_cofactor<L: Lane>(A: &Sym<L>) -> Sym<L> {
    let minor = inlined!(|a: usize, b: usize, c: usize, d: usize| A[a].mul_add(A[b], -(A[c] * A[d])));
    [
        minor(1, 2, 4, 4),
        minor(0, 2, 5, 5),
        minor(0, 1, 3, 3),
        minor(4, 5, 3, 2),
        minor(3, 5, 4, 0),
        minor(3, 4, 5, 1),
    ]
}

/// Bilinear part of the cofactor of a sum, `cof(A + B) - cof A - cof B`.
///
/// ```
/// use emmy::internals::tensor::{mixed_cofactor, sym_cofactor};
/// let A = [1.0, 2.0, 3.0, 0.5, -0.5, 0.25];
/// assert_eq!(mixed_cofactor(&A, &A), sym_cofactor(&A).map(|a| 2.0 * a));
/// ```
#[inline(always)]
pub fn mixed_cofactor<L: Lane>(A: &Sym<L>, B: &Sym<L>) -> Sym<L> {
    let minor = inlined!(|a: usize, b: usize, c: usize, d: usize| {
        let off = A[c].mul_add(B[d], A[d] * B[c]);
        A[a].mul_add(B[b], A[b].mul_add(B[a], -off))
    });
    [
        minor(1, 2, 4, 4),
        minor(0, 2, 5, 5),
        minor(0, 1, 3, 3),
        minor(4, 5, 3, 2),
        minor(3, 5, 4, 0),
        minor(3, 4, 5, 1),
    ]
}

/// Derivative of the cofactor: the linear map of B to [`mixed_cofactor`] of A and B, as an [`Elasticity`].
///
/// ```
/// use emmy::internals::tensor::{cofactor_derivative, mixed_cofactor};
/// let A = [1.0, 2.0, 3.0, 0.5, -0.5, 0.25];
/// let B = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
/// let D = cofactor_derivative(&A);
/// assert!((0..6).all(|a| 2.0 * D[a][3] == mixed_cofactor(&A, &B)[a])); // 2: the doubled shear
/// ```
#[inline(always)]
pub fn cofactor_derivative<L: Lane>(A: &Sym<L>) -> Elasticity<L> {
    let zero = A[0].splat(0.0);
    let [a, b, c, d, e, f] = *A;
    let half = inlined!(|x: L| x * 0.5);
    [
        [zero, c, b, zero, -e, zero],
        [c, zero, a, zero, zero, -f],
        [b, a, zero, -d, zero, zero],
        [zero, zero, -d, -half(c), half(f), half(e)],
        [-e, zero, zero, half(f), -half(a), half(d)],
        [zero, -f, zero, half(e), half(d), -half(b)],
    ]
}

/// Trace.
///
/// ```
/// assert_eq!(emmy::material::trace(&[1.0, 2.0, 3.0, 9.0, 9.0, 9.0]), 6.0);
/// ```
#[inline(always)]
pub fn trace<L: Lane>(A: &Sym<L>) -> L {
    A[0] + A[1] + A[2]
}

/// Double contraction `A : B` of symmetric tensors.
///
/// ```
/// let A = [1.0, 0.0, 0.0, 2.0, 0.0, 0.0];
/// assert_eq!(emmy::material::double_dot(&A, &A), 9.0); // 1 + 2 * 2^2
/// ```
#[inline(always)]
pub fn double_dot<L: Lane>(A: &Sym<L>, B: &Sym<L>) -> L {
    let shears = dot3([A[3], A[4], A[5]], [B[3], B[4], B[5]]);
    dot3([A[0], A[1], A[2]], [B[0], B[1], B[2]]) + shears * 2.0
}

/// Sum `A + s B` of symmetric tensors.
///
/// ```
/// let identity = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
/// assert_eq!(emmy::material::sym_add_scaled(&[0.0; 6], 3.0, &identity), [3.0, 3.0, 3.0, 0.0, 0.0, 0.0]);
/// ```
#[inline(always)]
pub fn sym_add_scaled<L: Lane>(A: &Sym<L>, s: L, B: &Sym<L>) -> Sym<L> {
    sym(
        #[inline(always)]
        |i, j| s.mul_add(B[SYM_INDEX[i][j]], A[SYM_INDEX[i][j]]),
    )
}

/// Sum `A + s B`.
#[inline(always)]
pub fn add_scaled<L: Lane>(A: &Mat3<L>, s: f64, B: &Mat3<L>) -> Mat3<L> {
    mat3(
        #[inline(always)]
        |i, j| B[i][j].mul_add(A[0][0].splat(s), A[i][j]),
    )
}

/// Green-Lagrange strain `E = (C - I) / 2` from the displacement gradient `G = F - I`, without cancellation.
///
/// ```math
/// E = (G + G^T + G^T G) / 2
/// ```
#[inline(always)]
pub fn green_lagrange<L: Lane>(G: &Mat3<L>) -> Sym<L> {
    let column = inlined!(|i: usize| [G[0][i], G[1][i], G[2][i]]);
    sym(
        #[inline(always)]
        |i, j| (G[i][j] + G[j][i] + dot3(column(i), column(j))) * 0.5,
    )
}

/// Symmetric part of `F^T B` with `F = I + G`: the strain rate of the rate `B` of `F`.
#[inline(always)]
pub fn sym_transposed_product<L: Lane>(G: &Mat3<L>, B: &Mat3<L>) -> Sym<L> {
    let column = inlined!(|A: &Mat3<L>, i: usize| [A[0][i], A[1][i], A[2][i]]);
    let entry = inlined!(|i: usize, j: usize| B[i][j] + dot3(column(G, i), column(B, j)));
    sym(
        #[inline(always)]
        |i, j| if i == j { entry(i, i) } else { (entry(i, j) + entry(j, i)) * 0.5 },
    )
}

/// Product `(I + G) S` with a symmetric tensor: the first Piola-Kirchhoff stress of a second one.
#[inline(always)]
pub fn identity_plus_times_sym<L: Lane>(G: &Mat3<L>, S: &Sym<L>) -> Mat3<L> {
    let s = inlined!(|i: usize, j: usize| S[SYM_INDEX[i][j]]);
    mat3(
        #[inline(always)]
        |i, j| G[i][2].mul_add(s(2, j), G[i][1].mul_add(s(1, j), G[i][0].mul_add(s(0, j), s(i, j)))),
    )
}

/// `e^x - 1 - x` without cancellation: a series where x is small.
///
/// ```math
/// e^x - 1 - x = x^2 / 2! + x^3 / 3! + x^4 / 4! + ...
/// ```
///
/// ```
/// let x = 1e-9;
/// assert!((emmy::internals::tensor::exp_m1_minus(x) - 0.5e-18 * (1.0 + 1e-9 / 3.0)).abs() < 1e-33);
/// ```
#[inline(always)]
pub fn exp_m1_minus<L: Lane>(x: L) -> L {
    // 16 terms reach 1e-17 of the sum at |x| = 0.6; beyond, the direct form loses less than a digit.
    let one = x.splat(1.0);
    let mut sum = one;
    for n in (3..18).rev() {
        sum = one + x * sum * (1.0 / n as f64);
    }
    x.abs().select_below(x.splat(0.6), x * x * sum * 0.5, x.exp_m1() - x)
}

/// `(e^x - 1) / x`, 1 at zero.
///
/// ```
/// assert_eq!(emmy::internals::tensor::exp_m1_over(0.0), 1.0);
/// assert!((emmy::internals::tensor::exp_m1_over(1e-9) - (1.0 + 0.5e-9)).abs() < 1e-16);
/// ```
#[inline(always)]
pub fn exp_m1_over<L: Lane>(x: L) -> L {
    // Up to the bound the next term, x/2, is below rounding, but its derivative matters.
    x.abs().select_below(x.splat(1e-17), x.splat(1.0) + x * 0.5, x.exp_m1() / x)
}

/// `ln(1 + x) / x`, 1 at zero.
///
/// ```
/// assert_eq!(emmy::internals::tensor::ln_1p_over(0.0), 1.0);
/// assert!((emmy::internals::tensor::ln_1p_over(1e-9) - (1.0 - 0.5e-9)).abs() < 1e-16);
/// ```
#[inline(always)]
pub fn ln_1p_over<L: Lane>(x: L) -> L {
    x.abs().select_below(x.splat(1e-17), x.splat(1.0) - x * 0.5, x.ln_1p() / x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn full(A: &Sym<f64>) -> Mat3<f64> {
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| A[SYM_INDEX[i][j]]))
    }

    proptest! {
        #[test]
        fn symmetric_forms_agree_with_full_ones(a in prop::array::uniform6(-1.0..1.0f64)) {
            prop_assert!((sym_det(&a) - det(&full(&a))).abs() < 1e-14);
            let cofactor = full(&sym_cofactor(&a));
            let A = full(&a);
            for i in 0..3 {
                for j in 0..3 {
                    let product: f64 = (0..3).map(|k| A[i][k] * cofactor[k][j]).sum();
                    let expected = if i == j { det(&A) } else { 0.0 };
                    prop_assert!((product - expected).abs() < 1e-14);
                }
            }
        }

        #[test]
        fn strain_matches_its_definition(g in prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64))) {
            let mut F = g;
            (0..3).for_each(|i| F[i][i] += 1.0);
            let E = green_lagrange(&g);
            for (a, (i, j)) in SYM.into_iter().enumerate() {
                let C: f64 = (0..3).map(|k| F[k][i] * F[k][j]).sum();
                prop_assert!((2.0 * E[a] - C + f64::from(u8::from(i == j))).abs() < 1e-14);
            }
            // dE = sym(F^T dF): the strain is quadratic, so its central difference is exact.
            let plus = add_scaled(&g, 1.0, &F);
            let minus = add_scaled(&g, -1.0, &F);
            let rate = sym_transposed_product(&g, &F);
            for a in 0..6 {
                let difference = (green_lagrange(&plus)[a] - green_lagrange(&minus)[a]) / 2.0;
                prop_assert!((difference - rate[a]).abs() < 1e-13);
            }
        }

        #[test]
        fn series_of_the_logarithm_joins_the_direct_form(z in 0.03..0.0599f64) {
            for z in [z, -z] {
                let direct = z - z.ln_1p();
                prop_assert!((z.minus_ln_1p() - direct).abs() < 4.0 * f64::EPSILON * z.abs());
            }
        }

        #[test]
        fn series_of_the_exponential_joins_the_direct_form(x in 0.3..0.5999f64) {
            for x in [x, -x] {
                let direct = x.exp_m1() - x;
                prop_assert!((exp_m1_minus(x) - direct).abs() < 4.0 * f64::EPSILON * x.abs());
            }
        }
    }

    #[test]
    fn minimum_keeps_nan() {
        assert!(Lane::min(f64::NAN, 1.0).is_nan() && Lane::min(1.0, f64::NAN).is_nan());
        assert_eq!(Lane::min(2.0, 1.0), 1.0);
    }
}
