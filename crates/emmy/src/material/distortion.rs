//! The deformation as a mean, a distortion and a volume.
//!
//! The right Cauchy-Green tensor is divided into its mean and a traceless distortion,
//!
//! ```math
//! C = m (I + b),      m = tr C / 3,      tr b = 0
//! det(I + b) = 1 - w,      w = b:b/2 - det b,      J^2 = m^3 (1 - w)
//! ```
//!
//! because then nothing cancels at small strain: all that is isochoric is a function of b alone.

#![allow(non_snake_case)]

use super::invariants::commuting_product;
use crate::tensor::{Lane, Sym, double_dot, sym_cofactor, sym_det, sym_scaled, trace};

/// Mean, distortion and volume of a deformation.
pub(super) struct Distortion<L> {
    /// m.
    pub mean: L,
    /// b.
    pub b: Sym<L>,
    /// b:b / 2.
    pub q: L,
    /// det b.
    pub det: L,
    /// ln det(I + b).
    pub ln_det: L,
    /// ln J.
    pub ln_J: L,
}

/// Change of a deformation, each number without cancellation.
pub(super) struct DistortionChange<L> {
    /// Change of b:b / 2.
    pub q: L,
    /// Change of det b.
    pub det: L,
    /// Change of ln det(I + b).
    pub ln_det: L,
    /// Change of ln J.
    pub ln_J: L,
}

impl<L: Lane> Distortion<L> {
    #[inline(always)]
    pub(super) fn of(E: &Sym<L>) -> Self {
        let (a, deviator) = divided(E);
        let one = a.splat(1.0);
        let mean = one + a;
        let b = sym_scaled(one / mean, &deviator);
        let q = double_dot(&b, &b) * 0.5;
        let det = sym_det(&b);
        let ln_det = (det - q).ln_1p();
        let ln_J = (a.ln_1p() * 3.0 + ln_det) * 0.5;
        Distortion { mean, b, q, det, ln_det, ln_J }
    }

    /// Change by a change of the strain.
    ///
    /// ```math
    /// db = (dev dC - b dm) / (m + dm)
    /// ```
    #[inline(always)]
    pub(super) fn change(&self, dE: &Sym<L>) -> DistortionChange<L> {
        let (a, mut db) = divided(dE);
        let inverse = a.splat(1.0) / (self.mean + a);
        for i in 0..6 {
            db[i] = (db[i] - self.b[i] * a) * inverse;
        }
        let q = double_dot(&self.b, &db) + double_dot(&db, &db) * 0.5;
        let first = double_dot(&sym_cofactor(&self.b), &db);
        let det = first + (double_dot(&sym_cofactor(&db), &self.b) + sym_det(&db));
        let ln_det = ((det - q) / (a.splat(1.0) - self.q + self.det)).ln_1p();
        let ln_J = ((a / self.mean).ln_1p() * 3.0 + ln_det) * 0.5;
        DistortionChange { q, det, ln_det, ln_J }
    }

    /// b^2.
    #[inline(always)]
    pub(super) fn square(&self) -> Sym<L> {
        commuting_product(&self.b, &self.b)
    }

    /// C^-1.
    #[inline(always)]
    pub(super) fn inverse(&self) -> Sym<L> {
        let one = self.mean.splat(1.0);
        let b = &self.b;
        let cofactor = sym_cofactor(&[b[0] + one, b[1] + one, b[2] + one, b[3], b[4], b[5]]);
        sym_scaled(one / (self.mean * (one - self.q + self.det)), &cofactor)
    }
}

/// Mean and deviator of `2 E`.
#[inline(always)]
fn divided<L: Lane>(E: &Sym<L>) -> (L, Sym<L>) {
    let a = trace(E) * (2.0 / 3.0);
    (a, [E[0] * 2.0 - a, E[1] * 2.0 - a, E[2] * 2.0 - a, E[3] * 2.0, E[4] * 2.0, E[5] * 2.0])
}
