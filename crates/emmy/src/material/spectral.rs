//! Energies of the principal stretches: stress and elasticity of all these materials.
//!
//! With the eigenvalues `beta_i` of the distortion b (see [`super::distortion`]), which keep their digits at small
//! strain, the deviatoric logarithmic strains are
//!
//! ```math
//! e_i = ln lambda_i - ln J / 3 = 1/2 ln(1 + beta_i) - 1/6 sum_j ln(1 + beta_j)
//! ```
//!
//! The stress is a polynomial in b, so that only the elasticity needs principal directions. Derivatives of eigenvectors bring in divided differences. They are written as products of the functions
//! `ln(1 + x) / x` and `(e^x - 1) / x`, which hold for equal, nearly equal and distinct eigenvalues alike.

#![allow(non_snake_case)]

use super::VolumeLaw;
use super::principal::{Principal, StrainChange};
use super::volumetric::Volume;
use crate::tensor::{Elasticity, Lane, Mat3, Sym, inlined, ln_1p_over, sym, three};

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
    /// omega'.
    fn slope<L: Lane>(&self, e: L) -> L;
    /// omega''.
    fn curvature<L: Lane>(&self, e: L) -> L;
    /// (omega'(e + difference) - omega'(e)) / difference, or omega''(e) if the difference is zero.
    fn divided_difference<L: Lane>(&self, e: L, difference: L) -> L;
}

/// [`super::Material::split`], with the shear modulus `omega''(0) / 2`.
pub(super) fn split<M: Separable>(material: &M, share: f64) -> Option<(M, VolumeLaw)> {
    let shear_modulus = 0.5 * material.curvature(0.0);
    let (kept, law) = material.volume().split(share * shear_modulus)?;
    Some((material.with_volume(kept), law))
}

/// Principal Kirchhoff stresses tau_i = dW / d ln lambda_i.
#[inline(always)]
fn kirchhoff_stress<L: Lane>(material: &impl Separable, ln_J: L, e: &[L; 3]) -> [L; 3] {
    let slope = three(
        #[inline(always)]
        |i| material.slope(e[i]),
    );
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
    stress_of(&principal, &kirchhoff_stress(material, principal.distortion.ln_J, &principal.strains()))
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
    let tau = kirchhoff_stress(material, distortion.ln_J, &e);
    let inverse = principal.inverse_stretches();
    let curvature = three(
        #[inline(always)]
        |i| material.curvature(e[i]),
    );
    let all = (curvature[0] + curvature[1] + curvature[2]) * (1.0 / 9.0)
        + material.volume().stiffness(distortion.ln_J);
    // (tau_i - tau_j) / (E_i - E_j), with C_i / C_j - 1 and e_i - e_j.
    let shear_stiffness = inlined!(|i: usize, j: usize| {
        let ratio_m1 = (beta[i] - beta[j]) * distortion.mean * inverse[j];
        let difference = ratio_m1.ln_1p() * 0.5;
        material.divided_difference(e[j], difference) * ln_1p_over(ratio_m1) * inverse[j]
    });
    let mut D = [[all.splat(0.0); 6]; 6];
    for i in 0..3 {
        let own = dyad(&Q, i, i);
        let direct = (all + curvature[i] * (1.0 / 3.0) - tau[i] * 2.0) * inverse[i] * inverse[i];
        add_pair(&mut D, direct, &own, &own, 0.5);
        for j in 0..i {
            let (other, both) = (dyad(&Q, j, j), dyad(&Q, i, j));
            let product = inverse[i] * inverse[j];
            let cross = (all - (curvature[i] + curvature[j]) * (1.0 / 3.0)) * product;
            add_pair(&mut D, cross, &own, &other, 1.0);
            // (S_i - S_j) / (E_i - E_j), in a form that is symmetric in i and j.
            let shear = shear_stiffness(i, j) * (inverse[i] + inverse[j]) * 0.5 - (tau[i] + tau[j]) * product;
            add_pair(&mut D, shear, &both, &both, 1.0);
        }
    }
    (stress_of(&principal, &tau), D)
}

/// Adds `factor s (A (x) B + B (x) A)`.
#[inline(always)]
fn add_pair<L: Lane>(D: &mut Elasticity<L>, s: L, A: &Sym<L>, B: &Sym<L>, factor: f64) {
    let s = s * factor;
    for a in 0..6 {
        for b in 0..6 {
            D[a][b] = s.mul_add(A[a].mul_add(B[b], B[a] * A[b]), D[a][b]);
        }
    }
}
