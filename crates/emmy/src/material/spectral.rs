//! Energies of the principal stretches: stress and elasticity of all these materials.
//!
//! With the eigenvalues `beta_i` of the distortion b (see [`super::distortion`]), which keep their digits at small
//! strain, the deviatoric logarithmic strains are
//!
//! ```math
//! e_i = ln lambda_i - ln J / 3 = 1/2 ln(1 + beta_i) - 1/6 sum_j ln(1 + beta_j)
//! ```
//!
//! The stress is a polynomial in b, so that only the elasticity needs principal directions. Derivatives of eigenvectors
//! bring in divided differences. They are written as products of the functions `ln(1 + x) / x` and `(e^x - 1) / x`,
//! which hold for equal, nearly equal and distinct eigenvalues alike.

#![allow(non_snake_case)]

use super::VolumeLaw;
use super::principal::{Principal, StrainChange};
use super::volumetric::Volume;
use crate::tensor::{Elasticity, Lane, Mat3, Sym, dot3, inlined, ln_1p_over, sym, sym_scaled, three};

/// A material whose energy is a sum over the principal stretches and one of the volume: the form of Valanis and Landel
/// (1967), J. Appl. Phys. 38, in deviatoric logarithmic strains.
///
/// ```math
/// W = omega(e_1) + omega(e_2) + omega(e_3) + W_vol(J),      e_1 + e_2 + e_3 = 0
/// ```
///
/// omega'(0) must be zero; any linear part of omega adds nothing to W.
pub(super) trait Separable {
    /// Law of volume.
    fn volume(&self) -> &Volume;
    /// The same material with another law of volume.
    fn with_volume(&self, volume: Volume) -> Self;
    /// omega.
    fn energy<L: Lane>(&self, e: L) -> L;
    /// Change of omega(e_1) + omega(e_2) + omega(e_3), without cancellation.
    fn energy_change<L: Lane>(&self, change: &StrainChange<L>) -> L;
    /// omega' and omega''.
    fn derivatives<L: Lane>(&self, e: L) -> [L; 2];
    /// (omega'(e + difference) - omega'(e)) / difference, or omega''(e) if the difference is zero.
    fn divided_difference<L: Lane>(&self, e: L, difference: L) -> L;
}

/// [`super::Material::split`], with the shear modulus `omega''(0) / 2`.
pub(super) fn split<M: Separable>(material: &M, share: f64) -> Option<(M, VolumeLaw)> {
    let shear_modulus = 0.5 * material.derivatives(0.0)[1];
    let (kept, law) = material.volume().split(share * shear_modulus)?;
    Some((material.with_volume(kept), law))
}

/// Principal Kirchhoff stresses tau_i = dW / d ln lambda_i, of the slopes omega'(e_i).
#[inline(always)]
fn kirchhoff_stress<L: Lane>(material: &impl Separable, ln_J: L, slope: [L; 3]) -> [L; 3] {
    let all = material.volume().pressure(ln_J) - (slope[0] + slope[1] + slope[2]) * (1.0 / 3.0);
    [slope[0] + all, slope[1] + all, slope[2] + all]
}

/// Dyad of principal directions, `(q_i q_j^T + q_j q_i^T) / 2`.
#[inline(always)]
fn dyad<L: Lane>(Q: &Mat3<L>, i: usize, j: usize) -> Sym<L> {
    sym(
        #[inline(always)]
        |r, c| (Q[r][i] * Q[c][j] + Q[r][j] * Q[c][i]) * 0.5,
    )
}

#[inline(always)]
pub(super) fn strain_energy<L: Lane>(material: &impl Separable, E: &Sym<L>) -> L {
    let principal = Principal::of(E);
    let e = principal.strains();
    let [a, b, c] = three(
        #[inline(always)]
        |i| material.energy(e[i]),
    );
    a + b + c + material.volume().energy(principal.distortion.ln_J)
}

#[inline(always)]
pub(super) fn energy_change<L: Lane>(material: &impl Separable, E: &Sym<L>, dE: &Sym<L>) -> L {
    let principal = Principal::of(E);
    let change = principal.distortion.change(dE);
    let of_volume = material.volume().energy_change(principal.distortion.ln_J, change.ln_J);
    material.energy_change(&StrainChange::of(&principal, &change)) + of_volume
}

#[inline(always)]
pub(super) fn stress<L: Lane>(material: &impl Separable, E: &Sym<L>) -> Sym<L> {
    let principal = Principal::of(E);
    let e = principal.strains();
    let slope = three(
        #[inline(always)]
        |i| material.derivatives(e[i])[0],
    );
    stress_of(&principal, &kirchhoff_stress(material, principal.distortion.ln_J, slope))
}

/// ```math
/// S = sum_i tau_i / C_i q_i (x) q_i
/// ```
#[inline(always)]
fn stress_of<L: Lane>(principal: &Principal<L>, tau: &[L; 3]) -> Sym<L> {
    let inverse = principal.inverse_stretches();
    principal.tensor(&[tau[0] * inverse[0], tau[1] * inverse[1], tau[2] * inverse[2]])
}

/// ```math
/// D = sum_ij D_ij (q_i q_i^T) (x) (q_j q_j^T) + sum_(i<j) 2 (S_i - S_j)/(E_i - E_j) q_ij (x) q_ij
/// D_ij = (dtau_i/d ln lambda_j - 2 tau_i delta_ij) / (C_i C_j),      q_ij = (q_i q_j^T + q_j q_i^T) / 2
/// ```
///
/// Source: Ogden (1984), Non-Linear Elastic Deformations, chapter 6, in the variables of this file.
#[inline(always)]
pub(super) fn stress_and_elasticity<L: Lane>(
    material: &impl Separable,
    E: &Sym<L>,
) -> (Sym<L>, Elasticity<L>) {
    let principal = Principal::of(E);
    let (Q, e) = (principal.directions(), principal.strains());
    let Principal { distortion, beta, .. } = &principal;
    let derivatives = three(
        #[inline(always)]
        |i| material.derivatives(e[i]),
    );
    let [slope, curvature] = [0, 1].map(
        #[inline(always)]
        |n| [derivatives[0][n], derivatives[1][n], derivatives[2][n]],
    );
    let tau = kirchhoff_stress(material, distortion.ln_J, slope);
    let inverse = principal.inverse_stretches();
    let all = (curvature[0] + curvature[1] + curvature[2]) * (1.0 / 9.0)
        + material.volume().stiffness(distortion.ln_J);
    // (tau_i - tau_j) / (E_i - E_j), with C_i / C_j - 1 and e_i - e_j.
    let shear_stiffness = inlined!(|i: usize, j: usize| {
        let ratio_m1 = (beta[i] - beta[j]) * distortion.mean * inverse[j];
        let difference = ratio_m1.ln_1p() * 0.5;
        material.divided_difference(e[j], difference) * ln_1p_over(ratio_m1) * inverse[j]
    });
    let [direct_0, direct_1, direct_2] = three(
        #[inline(always)]
        |i| (all + curvature[i] * (1.0 / 3.0) - tau[i] * 2.0) * inverse[i] * inverse[i],
    );
    let cross = inlined!(|i: usize, j: usize| {
        (all - (curvature[i] + curvature[j]) * (1.0 / 3.0)) * (inverse[i] * inverse[j])
    });
    let (cross_01, cross_02, cross_12) = (cross(0, 1), cross(0, 2), cross(1, 2));
    // 2 (S_i - S_j) / (E_i - E_j), in a form that is symmetric in i and j.
    let shear = inlined!(|i: usize, j: usize| {
        let sum = (tau[i] + tau[j]) * (inverse[i] * inverse[j]);
        shear_stiffness(i, j) * (inverse[i] + inverse[j]) - sum * 2.0
    });
    let (own, both) =
        ([dyad(&Q, 0, 0), dyad(&Q, 1, 1), dyad(&Q, 2, 2)], [dyad(&Q, 1, 0), dyad(&Q, 2, 0), dyad(&Q, 2, 1)]);
    let rows = [
        combined(&own, [direct_0, cross_01, cross_02]),
        combined(&own, [cross_01, direct_1, cross_12]),
        combined(&own, [cross_02, cross_12, direct_2]),
    ];
    let sheared = [
        sym_scaled(shear(1, 0), &both[0]),
        sym_scaled(shear(2, 0), &both[1]),
        sym_scaled(shear(2, 1), &both[2]),
    ];
    let mut D = [[all; 6]; 6];
    for a in 0..6 {
        for b in a..6 {
            let column = inlined!(|of: &[Sym<L>; 3], a: usize| [of[0][a], of[1][a], of[2][a]]);
            D[a][b] = dot3(column(&own, a), column(&rows, b)) + dot3(column(&both, a), column(&sheared, b));
            D[b][a] = D[a][b];
        }
    }
    (stress_of(&principal, &tau), D)
}

/// `s_1 A_1 + s_2 A_2 + s_3 A_3`.
#[inline(always)]
fn combined<L: Lane>(A: &[Sym<L>; 3], s: [L; 3]) -> Sym<L> {
    let sum = inlined!(|a: usize| dot3([A[0][a], A[1][a], A[2][a]], s));
    [sum(0), sum(1), sum(2), sum(3), sum(4), sum(5)]
}
