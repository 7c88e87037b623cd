//! Tensors shared by materials: C, its volume change, and elasticity tensors as sums of dyads.

#![allow(non_snake_case)]

use crate::tensor::{
    Elasticity, Lane, SYM, SYM_INDEX, Sym, dot3, inlined, sym, sym_cofactor, sym_det, trace,
};

/// C = I + A.
#[inline(always)]
pub(super) fn right_cauchy_green<L: Lane>(A: &Sym<L>) -> Sym<L> {
    let one = A[0].splat(1.0);
    [A[0] + one, A[1] + one, A[2] + one, A[3], A[4], A[5]]
}

/// det C - 1, from the invariants of A = C - I.
#[inline(always)]
pub(super) fn volume_change<L: Lane>(A: &Sym<L>) -> L {
    trace(A) + (second_invariant(A) + sym_det(A))
}

/// Second invariant of A: the trace of its cofactor.
#[inline(always)]
pub(super) fn second_invariant<L: Lane>(A: &Sym<L>) -> L {
    let cofactor = sym_cofactor(A);
    cofactor[0] + cofactor[1] + cofactor[2]
}

/// Product of two symmetric tensors that commute, which is symmetric itself.
#[inline(always)]
pub(super) fn commuting_product<L: Lane>(A: &Sym<L>, B: &Sym<L>) -> Sym<L> {
    let row = inlined!(|A: &Sym<L>, i: usize| [A[SYM_INDEX[i][0]], A[SYM_INDEX[i][1]], A[SYM_INDEX[i][2]]]);
    sym(
        #[inline(always)]
        |i, j| dot3(row(A, i), row(B, j)),
    )
}

/// Elasticity tensor with the given components `(i, j, k, l)`, computed once for both of a symmetric pair.
#[inline(always)]
pub(super) fn elasticity<L: Lane>(entry: impl Fn(usize, usize, usize, usize) -> L) -> Elasticity<L> {
    let mut D = [[entry(0, 0, 0, 0); 6]; 6];
    for a in 0..6 {
        for b in a..6 {
            let ((i, j), (k, l)) = (SYM[a], SYM[b]);
            D[a][b] = entry(i, j, k, l);
            D[b][a] = D[a][b];
        }
    }
    D
}

/// `alpha B (x) B + beta (B_ik B_jl + B_il B_jk)` with B = C^-1: the elasticity of every law of volume.
#[inline(always)]
pub(super) fn inverse_dyads<L: Lane>(B: &Sym<L>, alpha: L, beta: L) -> Elasticity<L> {
    let b = inlined!(|i: usize, j: usize| B[SYM_INDEX[i][j]]);
    elasticity(
        #[inline(always)]
        |i, j, k, l| {
            let mixed = b(i, k).mul_add(b(j, l), b(i, l) * b(j, k));
            (alpha * b(i, j)).mul_add(b(k, l), beta * mixed)
        },
    )
}

/// Adds `s A (x) A`.
#[inline(always)]
pub(super) fn add_dyad<L: Lane>(D: &mut Elasticity<L>, s: L, A: &Sym<L>) {
    for a in 0..6 {
        for b in 0..6 {
            D[a][b] = s.mul_add(A[a] * A[b], D[a][b]);
        }
    }
}

/// Adds `A (x) B + B (x) A`.
#[inline(always)]
pub(super) fn add_dyads<L: Lane>(D: &mut Elasticity<L>, A: &Sym<L>, B: &Sym<L>) {
    for a in 0..6 {
        for b in 0..6 {
            D[a][b] = A[a].mul_add(B[b], B[a].mul_add(A[b], D[a][b]));
        }
    }
}
