//! Ciarlet-Geymonat material: a polyconvex neo-Hooke material.

#![allow(non_snake_case)]

use super::elastic::ELASTIC_CONSTANTS;
use super::invariants::{
    commuting_product, inverse_dyads, right_cauchy_green, second_invariant, volume_change,
};
use super::model::{Model, ModelCells, Modelled, Values};
use super::{Material, VolumeLaw, VolumeMeasure, Volumetric, compiled_with_this_crate, lame, stable_lame};
use crate::error::Result;
use crate::tensor::{Elasticity, Lane, Sym, sym_cofactor, sym_det, sym_scaled};

/// Ciarlet-Geymonat material: neo-Hooke with a polyconvex law of volume, for large compression.
///
/// ```math
/// W = mu/2 (tr C - 3) + lambda/4 (J^2 - 1) - (lambda/2 + mu) ln J
/// S = mu (I - C^-1) + lambda/2 (J^2 - 1) C^-1
/// ```
///
/// Unlike (ln J)^2, its law of volume is convex in J: the material does not soften under any compression or stretch.
/// Polyconvex where lambda >= 0.
///
/// Source: Ciarlet and Geymonat (1982), C. R. Acad. Sci. Paris II 295, without the term in tr cof C. Parameters in
/// \[force/length^2\].
///
/// ```
/// use emmy::prelude::*;
/// let rubber = CiarletGeymonat::new(1000.0, 500.0)?;
/// let energy = rubber.strain_energy(&[1.5, 0.0, 0.0, 0.0, 0.0, 0.0]); // stretched to twice its length
/// assert!((energy - (750.0 + 750.0 - 1000.0 * std::f64::consts::LN_2)).abs() < 1e-10);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CiarletGeymonat {
    lambda: f64,
    mu: f64,
}

const NAME: &str = "ciarlet-geymonat";

impl CiarletGeymonat {
    /// The material with Lame parameters.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless mu > 0 and lambda > -2/3 mu.
    pub fn new(lambda: f64, mu: f64) -> Result<Self> {
        stable_lame(NAME, lambda, mu)?;
        Ok(CiarletGeymonat { lambda, mu })
    }

    /// The material whose small-strain Young's modulus and Poisson's ratio are given.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless E > 0 and -1 < nu < 1/2.
    pub fn from_engineering(youngs_modulus: f64, poissons_ratio: f64) -> Result<Self> {
        let (lambda, mu) = lame(NAME, youngs_modulus, poissons_ratio)?;
        Ok(CiarletGeymonat { lambda, mu })
    }

    /// Inverse of C, J^2 - 1, and the second Piola-Kirchhoff stress.
    #[inline(always)]
    fn state<L: Lane>(&self, E: &Sym<L>) -> (Sym<L>, L, Sym<L>) {
        let A = sym_scaled(E[0].splat(2.0), E);
        let C = right_cauchy_green(&A);
        let z = volume_change(&A);
        let one = E[0].splat(1.0);
        // Not 1 + z, which cancels under strong compression.
        let C_inv = sym_scaled(one / sym_det(&C), &sym_cofactor(&C));
        // S = C^-1 (mu A + lambda/2 (J^2 - 1) I): no difference of numbers near one.
        let mut M = sym_scaled(one.splat(self.mu), &A);
        for i in 0..3 {
            M[i] += z * (0.5 * self.lambda);
        }
        (C_inv, z, commuting_product(&C_inv, &M))
    }
}

impl Modelled for CiarletGeymonat {
    const MODEL: Model = Model {
        name: NAME,
        energy: "mu/2 (tr C - 3) + lambda/4 (J^2 - 1) - (lambda/2 + mu) ln J",
        purpose: "large strain, strong compression; polyconvex if lambda >= 0",
        parameters: &[ELASTIC_CONSTANTS],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let own = values.elastic(NAME)?;
        CiarletGeymonat::new(own.lambda, own.mu)
    }
}

impl Material for CiarletGeymonat {
    compiled_with_this_crate!();

    #[inline(always)]
    fn strain_energy<L: Lane>(&self, E: &Sym<L>) -> L {
        let A = sym_scaled(E[0].splat(2.0), E);
        let volume = volume_change(&A).minus_ln_1p();
        // mu/2 (tr A - ln(1 + z)) with tr A = z - I_2(A) - det A.
        let shape = volume - second_invariant(&A) - sym_det(&A);
        shape * (0.5 * self.mu) + volume * (0.25 * self.lambda)
    }

    #[inline(always)]
    fn stress<L: Lane>(&self, E: &Sym<L>) -> Sym<L> {
        self.state(E).2
    }

    #[inline(always)]
    fn stress_and_elasticity<L: Lane>(&self, E: &Sym<L>) -> (Sym<L>, Elasticity<L>) {
        let (C_inv, z, S) = self.state(E);
        let alpha = (z + z.splat(1.0)) * self.lambda;
        (S, inverse_dyads(&C_inv, alpha, z.splat(self.mu) - z * (0.5 * self.lambda)))
    }

    /// `U = lambda/4 (J^2 - 1 - 2 ln J)`; the rest has the bulk modulus 2/3 mu whatever the share.
    fn split(&self, _: f64) -> Option<(Self, VolumeLaw)> {
        let law = VolumeLaw::new(VolumeMeasure::Ratio, Volumetric::SimoTaylor, self.lambda)?;
        Some((CiarletGeymonat { lambda: 0.0, ..*self }, law))
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
        conforms(&CiarletGeymonat::new(lambda, mu).unwrap(), [lambda, mu], |C| {
            let ln_J = big_det(C).ln() / big(2.0);
            big(mu / 2.0) * (big_trace(C) - big(3.0)) + big(lambda / 4.0) * (big_det(C) - big(1.0))
                - big(lambda / 2.0 + mu) * ln_J
        });
    }

    #[test]
    fn bad_parameters_are_rejected() {
        rejects("mu", CiarletGeymonat::new(1.0, 0.0));
        rejects("lambda", CiarletGeymonat::new(-2.0, 3.0));
        rejects("youngs_modulus", CiarletGeymonat::from_engineering(-1.0, 0.3));
        rejects("poissons_ratio", CiarletGeymonat::from_engineering(1.0, 0.5));
    }
}
