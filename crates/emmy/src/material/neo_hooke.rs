//! Compressible neo-Hooke material.

#![allow(non_snake_case)]

use super::elastic::ELASTIC_CONSTANTS;
use super::invariants::{
    commuting_product, inverse_dyads, right_cauchy_green, second_invariant, volume_change,
};
use super::model::{Model, ModelCells, Modelled, Values};
use super::{Material, VolumeLaw, VolumeMeasure, Volumetric, compiled_with_this_crate, lame, stable_lame};
use crate::error::Result;
use crate::tensor::{
    Elasticity, Lane, SYM_INDEX, Sym, double_dot, inlined, mixed_cofactor, sym, sym_cofactor, sym_det,
    sym_scaled, trace,
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
/// use emmy::prelude::*;
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
        let C = right_cauchy_green(&A);
        let z = volume_change(&A);
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

impl Modelled for NeoHooke {
    const MODEL: Model = Model {
        name: NAME,
        energy: "mu/2 (tr C - 3) + lambda/2 (ln J)^2 - mu ln J",
        purpose: "large strain",
        parameters: &[ELASTIC_CONSTANTS],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let own = values.elastic(NAME)?;
        NeoHooke::new(own.lambda, own.mu)
    }
}

impl Material for NeoHooke {
    compiled_with_this_crate!();

    #[inline(always)]
    fn strain_energy<L: Lane>(&self, E: &Sym<L>) -> L {
        let A = sym_scaled(E[0].splat(2.0), E);
        let z = volume_change(&A);
        let ln_J = z.ln_1p() * 0.5;
        // mu/2 (tr A - ln(1 + z)) with tr A = z - I_2(A) - det A.
        let isochoric = z.minus_ln_1p() - second_invariant(&A) - sym_det(&A);
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
        let bent = zeta.minus_ln_1p();
        let ln = zeta - bent;
        let isochoric = double_dot(&commuting_product(&C_inv, &A), &B) - curved + bent;
        let pressure = ln * (volume_change(&A).ln_1p() * 2.0 + ln);
        Some(isochoric * (0.5 * self.mu) + pressure * (0.125 * self.lambda))
    }

    #[inline(always)]
    fn stress<L: Lane>(&self, E: &Sym<L>) -> Sym<L> {
        self.state(E).2
    }

    /// Trace, cofactor and determinant of `A = C - I` are polynomials along the path, so that a point costs one
    /// logarithm:
    ///
    /// ```math
    /// S = [mu (A + (II_A + det A) I - cof A) + lambda ln J ((1 + tr A) I - A + cof A)] / det C
    /// ```
    #[inline(always)]
    fn stress_along<L: Lane>(&self, E: &Sym<L>, dE: &Sym<L>, points: &[[f64; 2]]) -> Sym<L> {
        let constant = inlined!(|value| E[0].splat(value));
        let (A, B) = (sym_scaled(constant(2.0), E), sym_scaled(constant(2.0), dE));
        let cofactors = [sym_cofactor(&A), mixed_cofactor(&A, &B), sym_cofactor(&B)];
        let [t_0, t_1] = [trace(&A), trace(&B)];
        // II_A + det A, by powers of alpha.
        let v_0 = trace(&cofactors[0]) + sym_det(&A);
        let v_1 = trace(&cofactors[1]) + double_dot(&cofactors[0], &B);
        let v_2 = trace(&cofactors[2]) + double_dot(&A, &cofactors[2]);
        let v_3 = sym_det(&B);
        let one = constant(1.0);
        let mut moments = [constant(0.0); 3];
        let mut pressure = constant(0.0);
        for &[alpha, weight] in points {
            let a = constant(alpha);
            let t = t_1.mul_add(a, t_0);
            let v = v_3.mul_add(a, v_2).mul_add(a, v_1).mul_add(a, v_0);
            let z = t + v;
            let factor = constant(weight) / (one + z);
            let p = factor * self.mu;
            let q = factor * (z.ln_1p() * (0.5 * self.lambda));
            let r = p - q;
            for (power, moment) in moments.iter_mut().enumerate() {
                *moment = r.mul_add(constant(alpha.powi(power as i32)), *moment);
            }
            pressure = p.mul_add(v, q.mul_add(one + t, pressure));
        }
        let [r_0, r_1, r_2] = moments;
        let component = inlined!(|a: usize| {
            let strain = r_0.mul_add(A[a], r_1 * B[a]);
            let cofactor = cofactors[2][a];
            strain - r_0.mul_add(cofactors[0][a], r_1.mul_add(cofactors[1][a], r_2 * cofactor))
        });
        [
            component(0) + pressure,
            component(1) + pressure,
            component(2) + pressure,
            component(3),
            component(4),
            component(5),
        ]
    }

    #[inline(always)]
    fn stress_and_elasticity<L: Lane>(&self, E: &Sym<L>) -> (Sym<L>, Elasticity<L>) {
        let (C_inv, ln_J, S) = self.state(E);
        // D_ijkl = lambda C^-1_ij C^-1_kl + (mu - lambda ln J) (C^-1_ik C^-1_jl + C^-1_il C^-1_jk)
        let factor = ln_J.splat(self.mu) - ln_J * self.lambda;
        (S, inverse_dyads(&C_inv, ln_J.splat(self.lambda), factor))
    }

    /// `U = lambda/2 (ln J)^2`; the rest has the bulk modulus 2/3 mu whatever the share.
    fn split(&self, _: f64) -> Option<(Self, VolumeLaw)> {
        let law = VolumeLaw::new(VolumeMeasure::Ratio, Volumetric::Logarithmic, self.lambda)?;
        Some((NeoHooke { lambda: 0.0, ..*self }, law))
    }
}

#[cfg(test)]
mod tests {
    use super::super::conformance::{big, big_det, big_trace, conforms};
    use super::super::tests::rejects;
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
    fn bad_parameters_are_rejected() {
        rejects("mu", NeoHooke::new(1.0, 0.0));
        rejects("lambda", NeoHooke::new(-2.0, 3.0));
        rejects("youngs_modulus", NeoHooke::from_engineering(-1.0, 0.3));
        rejects("poissons_ratio", NeoHooke::from_engineering(1.0, 0.5));
    }
}
