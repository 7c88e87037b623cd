//! Standard rules: one quadrature for everything (section 4.4.1).

use super::{Average, Request, Rule};
use crate::material::Response;
use crate::tensor::{
    Elasticity, Lane, Mat3, SYM_INDEX, Sym, Tangent, add_scaled, det_of_identity_plus, dot3, green_lagrange,
    identity_plus_times_sym, inlined, nine,
};

impl Rule {
    /// ```math
    /// P_i = (1/b_i) sum_l w_l l_i(alpha_l) F(alpha_l) S(C(alpha_l))
    /// ```
    #[inline(always)]
    pub(super) fn average_standard<L: Lane>(
        &self,
        material: &dyn Response<L>,
        start: &Mat3<L>,
        rates: &[Mat3<L>],
        request: Request,
        average: &mut Average<L>,
    ) {
        let k = self.degree();
        let zero = start[0][0].splat(0.0);
        average.min_det = zero.splat(f64::INFINITY);
        let mut S = [zero; 6];
        let mut D = [[zero; 6]; 6];
        for (index, point) in self.points.iter().enumerate() {
            let is_first = index == 0;
            let G = Rule::gradient_at(start, &point.integrals, rates);
            average.min_det = average.min_det.min(det_of_identity_plus(&G));
            let E = green_lagrange(&G);
            if request == Request::Stress {
                material.stress(&E, &mut S);
                add_stress(&mut average.stress, &point.stage_weights, is_first, &G, &S);
                continue;
            }
            material.stress_and_elasticity(&E, &mut S, &mut D);
            add_stress(&mut average.stress, &point.stage_weights, is_first, &G, &S);
            let A = first_elasticity(&G, &S, &D);
            for i in 0..k {
                for j in 0..k {
                    let weight = zero.splat(point.stage_weights[i] * point.integrals[j]);
                    add_tangent(&mut average.tangent[i * k + j], weight, is_first, &A);
                }
            }
        }
    }
}

/// Adds `(I + G) S` times the stage weights, or sets it.
#[inline(always)]
fn add_stress<L: Lane>(stress: &mut [Mat3<L>], stage_weights: &[f64], sets: bool, G: &Mat3<L>, S: &Sym<L>) {
    let P = identity_plus_times_sym(G, S);
    let zero = [[G[0][0].splat(0.0); 3]; 3];
    for (average, &weight) in stress.iter_mut().zip(stage_weights) {
        *average = add_scaled(if sets { &zero } else { average }, weight, &P);
    }
}

/// Adds `w A`, or sets it.
#[inline(always)]
fn add_tangent<L: Lane>(sum: &mut Tangent<L>, weight: L, sets: bool, A: &Tangent<L>) {
    for (sum, A) in sum.iter_mut().zip(A) {
        for c in 0..9 {
            sum[c] = if sets { A[c] * weight } else { A[c].mul_add(weight, sum[c]) };
        }
    }
}

/// Derivative of P = F S by F: the usual geometric and material parts. It is symmetric, as D is.
#[inline(always)]
pub(super) fn first_elasticity<L: Lane>(G: &Mat3<L>, S: &Sym<L>, D: &Elasticity<L>) -> Tangent<L> {
    let F = with_identity(G);
    let Y = strain_response(D, &F);
    // The upper half, then its mirror image.
    let entry = inlined!(|row: usize, c: usize| {
        let r = row / 3;
        let J = row % 3;
        let material = dot3(F[r], [Y[SYM_INDEX[0][J]][c], Y[SYM_INDEX[1][J]][c], Y[SYM_INDEX[2][J]][c]]);
        if c / 3 == r { material + S[SYM_INDEX[J][c % 3]] } else { material }
    });
    let upper = nine(
        #[inline(always)]
        |row| {
            nine(
                #[inline(always)]
                |c| if c >= row { entry(row, c) } else { F[0][0] },
            )
        },
    );
    nine(
        #[inline(always)]
        |row| {
            nine(
                #[inline(always)]
                |c| if c >= row { upper[row][c] } else { upper[c][row] },
            )
        },
    )
}

/// Adds `factor delta_ik S_JL`, the derivative of `F S` by F at fixed S.
#[inline(always)]
pub(super) fn add_geometric<L: Lane>(A: &mut Tangent<L>, factor: f64, S: &Sym<L>) {
    for i in 0..3 {
        for J in 0..3 {
            for K in 0..3 {
                A[3 * i + J][3 * i + K] += S[SYM_INDEX[J][K]] * factor;
            }
        }
    }
}

/// F = I + G.
#[inline(always)]
pub(super) fn with_identity<L: Lane>(G: &Mat3<L>) -> Mat3<L> {
    let one = G[0][0].splat(1.0);
    let mut F = *G;
    for i in 0..3 {
        F[i][i] += one;
    }
    F
}

/// `X B(H)`: the response of S (through X, on doubled shears) to `dE = sym(H^T dF)`, `[component][3 k + L]`.
#[inline(always)]
pub(super) fn strain_response<L: Lane>(X: &Elasticity<L>, H: &Mat3<L>) -> [[L; 9]; 6] {
    // Doubled-shear strain of dF = e_k (x) e_L is: H_kI at (I, L), twice the normal where I = L.
    let mut Y = [[X[0][0]; 9]; 6];
    for a in 0..6 {
        for k in 0..3 {
            for l in 0..3 {
                let x = inlined!(|j: usize| X[a][SYM_INDEX[l][j]]);
                Y[a][3 * k + l] = dot3([x(0), x(1), x(2)], H[k]);
            }
        }
    }
    Y
}

/// `F Y`: the response of P = F S from the response Y of S.
#[inline(always)]
pub(super) fn first_from_second<L: Lane>(G: &Mat3<L>, Y: &[[L; 9]; 6]) -> Tangent<L> {
    let F = with_identity(G);
    let mut A = [[F[0][0]; 9]; 9];
    for r in 0..3 {
        for J in 0..3 {
            for c in 0..9 {
                let y = inlined!(|i: usize| Y[SYM_INDEX[i][J]][c]);
                A[3 * r + J][c] = dot3(F[r], [y(0), y(1), y(2)]);
            }
        }
    }
    A
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tensor::SYM;

    #[test]
    fn shear_convention_matches_the_elasticity() {
        // For X = unit response to one strain component, strain_response must give that component of sym(H^T dF).
        let H = [[1.0, 2.0, -1.0], [0.5, 3.0, 0.2], [0.1, -0.4, 2.0]];
        for (a, (i, j)) in SYM.into_iter().enumerate() {
            let mut X = [[0.0; 6]; 6];
            X[0][a] = 1.0;
            let row = strain_response(&X, &H)[0];
            for k in 0..3 {
                for l in 0..3 {
                    // component (i, j) of sym(H^T e_k (x) e_l), shears doubled
                    let doubled = if i == j { 1.0 } else { 2.0 };
                    let entry = |i: usize, j: usize| if j == l { H[k][i] } else { 0.0 };
                    let expected = doubled * 0.5 * (entry(i, j) + entry(j, i));
                    assert!((row[3 * k + l] - expected).abs() < 1e-15, "{a} {k} {l}");
                }
            }
        }
    }
}
