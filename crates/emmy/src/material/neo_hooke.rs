//! Compressible neo-Hooke material.

#![allow(non_snake_case)]

use super::invariants::{
    commuting_product, inverse_dyads, right_cauchy_green, second_invariant, volume_change,
};
use super::{Material, lame, stable_lame};
use crate::error::Result;
use crate::tensor::{
    Elasticity, Lane, SYM_INDEX, Sym, double_dot, inlined, minus_ln_1p, sym, sym_cofactor, sym_det,
    sym_scaled,
};

/// Compressible neo-Hooke material.
///
/// ```math
/// W = mu/2 (tr C - 3) + lambda/2 (ln J)^2 - mu ln J,      S = mu (I - C^-1) + lambda ln J C^-1
/// ```
///
/// Source: Betsch and Steinmann (2001), equation (81). Parameters in \[force/length^2\].
///
/// ```
/// use emmy::material::{Material, NeoHooke};
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let energy = rubber.strain_energy(&[1.5, 0.0, 0.0, 0.0, 0.0, 0.0]); // stretched to twice its length
/// let ln_2 = std::f64::consts::LN_2;
/// assert!((energy - (750.0 + 500.0 * ln_2 * ln_2 - 500.0 * ln_2)).abs() < 1e-10);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeoHooke {
    lambda: f64,
    mu: f64,
}

const NAME: &str = "neo-hooke";

impl NeoHooke {
    /// The material with Lame parameters.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless mu > 0 and lambda > -2/3 mu.
    pub fn new(lambda: f64, mu: f64) -> Result<Self> {
        stable_lame(NAME, lambda, mu)?;
        Ok(NeoHooke { lambda, mu })
    }

    /// The material whose small-strain Young's modulus and Poisson's ratio are given.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless E > 0 and -1 < nu < 1/2.
    pub fn from_engineering(youngs_modulus: f64, poissons_ratio: f64) -> Result<Self> {
        let (lambda, mu) = lame(NAME, youngs_modulus, poissons_ratio)?;
        Ok(NeoHooke { lambda, mu })
    }

    /// Inverse of C, ln J, and the second Piola-Kirchhoff stress.
    #[inline(always)]
    fn state<L: Lane>(&self, E: &Sym<L>) -> (Sym<L>, L, Sym<L>) {
        let A = sym_scaled(E[0].splat(2.0), E);
        let (C, z) = (right_cauchy_green(&A), volume_change(&A));
        // Not 1 + z, which cancels under strong compression.
        let inverse_det = C[0].splat(1.0) / sym_det(&C);
        let C_inv = sym_scaled(inverse_det, &sym_cofactor(&C));
        let ln_J = z.ln_1p() * 0.5;
        // S = mu C^-1 A + lambda ln J C^-1: no difference of numbers near one.
        let product = commuting_product(&C_inv, &A);
        let pressure = ln_J * self.lambda;
        let component = inlined!(|a: usize| product[a].mul_add(pressure.splat(self.mu), pressure * C_inv[a]));
        (
            C_inv,
            ln_J,
            sym(
                #[inline(always)]
                |i, j| component(SYM_INDEX[i][j]),
            ),
        )
    }
}

impl Material for NeoHooke {
    #[inline(always)]
    fn strain_energy<L: Lane>(&self, E: &Sym<L>) -> L {
        let A = sym_scaled(E[0].splat(2.0), E);
        let z = volume_change(&A);
        let ln_J = z.ln_1p() * 0.5;
        // mu/2 (tr A - ln(1 + z)) with tr A = z - I_2(A) - det A.
        let isochoric = minus_ln_1p(z) - second_invariant(&A) - sym_det(&A);
        isochoric * (0.5 * self.mu) + ln_J * ln_J * (0.5 * self.lambda)
    }

    /// With `B = 2 dE` and `zeta = det(C + B)/det C - 1 = C^-1 : B + [C : adj B + det B]/det C`,
    ///
    /// ```math
    /// dW = mu/2 [(I - C^-1) : B - [C : adj B + det B]/det C + zeta - ln(1 + zeta)] + lambda/8 ln(1 + zeta) [2 ln det C + ln(1 + zeta)]
    /// ```
    #[inline(always)]
    fn energy_change<L: Lane>(&self, E: &Sym<L>, dE: &Sym<L>) -> Option<L> {
        let two = E[0].splat(2.0);
        let (A, B) = (sym_scaled(two, E), sym_scaled(two, dE));
        let C = right_cauchy_green(&A);
        let inverse_det = E[0].splat(1.0) / sym_det(&C);
        let C_inv = sym_scaled(inverse_det, &sym_cofactor(&C));
        let curved = (double_dot(&C, &sym_cofactor(&B)) + sym_det(&B)) * inverse_det;
        let zeta = double_dot(&C_inv, &B) + curved;
        let bent = minus_ln_1p(zeta);
        let ln = zeta - bent;
        let isochoric = double_dot(&commuting_product(&C_inv, &A), &B) - curved + bent;
        let pressure = ln * (volume_change(&A).ln_1p() * 2.0 + ln);
        Some(isochoric * (0.5 * self.mu) + pressure * (0.125 * self.lambda))
    }

    #[inline(always)]
    fn stress<L: Lane>(&self, E: &Sym<L>) -> Sym<L> {
        self.state(E).2
    }

    #[inline(always)]
    fn stress_and_elasticity<L: Lane>(&self, E: &Sym<L>) -> (Sym<L>, Elasticity<L>) {
        let (C_inv, ln_J, S) = self.state(E);
        // D_ijkl = lambda C^-1_ij C^-1_kl + (mu - lambda ln J) (C^-1_ik C^-1_jl + C^-1_il C^-1_jk)
        let factor = ln_J.splat(self.mu) - ln_J * self.lambda;
        (S, inverse_dyads(&C_inv, ln_J.splat(self.lambda), factor))
    }
}

#[cfg(test)]
mod tests {
    use super::super::conformance::{big, big_det, big_trace, conforms};
    use super::super::tests::refuses;
    use super::*;

    #[test]
    fn conforms_to_its_textbook_form() {
        let [lambda, mu] = [1000.0, 500.0];
        conforms(&NeoHooke::new(lambda, mu).unwrap(), [lambda, mu], |C| {
            let ln_J = big_det(C).ln() / big(2.0);
            big(mu / 2.0) * (big_trace(C) - big(3.0)) + big(lambda / 2.0) * &ln_J * &ln_J - big(mu) * ln_J
        });
    }

    #[test]
    fn bad_parameters_are_refused() {
        refuses("mu", NeoHooke::new(1.0, 0.0));
        refuses("lambda", NeoHooke::new(-2.0, 3.0));
        refuses("youngs_modulus", NeoHooke::from_engineering(-1.0, 0.3));
        refuses("poissons_ratio", NeoHooke::from_engineering(1.0, 0.5));
    }
}
