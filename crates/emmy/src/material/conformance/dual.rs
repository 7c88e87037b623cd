//! Dual numbers as lanes: exact derivatives of the materials.

use num_dual::Dual64;

use crate::tensor::{Lane, Mat3, SYM_INDEX, Sym, eigen, mat3};

impl Lane for Dual64 {
    fn splat(self, constant: f64) -> Self {
        Dual64::from_re(constant)
    }
    fn sqrt(self) -> Self {
        num_dual::DualNum::sqrt(&self)
    }
    fn ln_1p(self) -> Self {
        num_dual::DualNum::ln_1p(&self)
    }
    fn exp_m1(self) -> Self {
        num_dual::DualNum::exp_m1(&self)
    }
    fn abs(self) -> Self {
        if self.re < 0.0 { -self } else { self }
    }
    fn min(self, other: Self) -> Self {
        if self.re < other.re || self.re.is_nan() { self } else { other }
    }
    fn select_below(self, bound: Self, below: Self, otherwise: Self) -> Self {
        if self.re < bound.re { below } else { otherwise }
    }
    /// dq_i = sum_j q_j (q_j . dA q_i) / (a_i - a_j): right where eigenvalues differ, which random ones do.
    fn eigen(A: &Sym<Self>) -> ([Self; 3], Mat3<Self>) {
        let (values, Q) = eigen(&A.map(|a| a.re));
        let dA = |i: usize, j: usize| -> f64 {
            (0..9).map(|n| Q[n / 3][i] * A[SYM_INDEX[n / 3][n % 3]].eps * Q[n % 3][j]).sum()
        };
        let rotation = |r: usize, i: usize| -> f64 {
            (0..3).filter(|&j| j != i).map(|j| Q[r][j] * dA(j, i) / (values[i] - values[j])).sum()
        };
        let vector = |r: usize, i: usize| Dual64::new(Q[r][i], rotation(r, i));
        ([0, 1, 2].map(|i| Dual64::new(values[i], dA(i, i))), mat3(vector))
    }
}
