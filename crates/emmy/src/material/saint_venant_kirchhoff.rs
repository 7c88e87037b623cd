//! St. Venant-Kirchhoff material.

#![allow(non_snake_case)]

use super::elastic::ELASTIC_CONSTANTS;
use super::model::{Model, ModelCells, Modelled, Values};
use super::{Material, VolumeLaw, VolumeMeasure, Volumetric, compiled_with_this_crate, lame, stable_lame};
use crate::error::Result;
use crate::tensor::{Elasticity, Lane, Sym, double_dot, inlined, sym_add_scaled, sym_scaled, trace};

/// St. Venant-Kirchhoff material: linear elasticity in the Green-Lagrange strain, for large rotation and small strain.
///
/// ```math
/// W = lambda/2 (tr E)^2 + mu E : E,      S = lambda tr(E) I + 2 mu E
/// ```
///
/// Source: Betsch and Steinmann (2001), equation (59). Parameters in \[force/length^2\].
///
/// ```
/// use emmy::prelude::*;
/// let material = SaintVenantKirchhoff::new(1.0, 2.0)?;
/// assert_eq!(material.strain_energy(&[0.5, 0.0, 0.0, 0.0, 0.0, 0.0]), 0.125 + 0.5);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SaintVenantKirchhoff {
    lambda: f64,
    mu: f64,
}

const NAME: &str = "saint-venant-kirchhoff";

impl SaintVenantKirchhoff {
    /// The material with Lame parameters.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless mu > 0 and lambda > -2/3 mu.
    pub fn new(lambda: f64, mu: f64) -> Result<Self> {
        stable_lame(NAME, lambda, mu)?;
        Ok(SaintVenantKirchhoff { lambda, mu })
    }

    /// The material with Young's modulus and Poisson's ratio.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless E > 0 and -1 < nu < 1/2.
    pub fn from_engineering(youngs_modulus: f64, poissons_ratio: f64) -> Result<Self> {
        let (lambda, mu) = lame(NAME, youngs_modulus, poissons_ratio)?;
        Ok(SaintVenantKirchhoff { lambda, mu })
    }
}

impl Modelled for SaintVenantKirchhoff {
    const MODEL: Model = Model {
        name: NAME,
        energy: "lambda/2 (tr E)^2 + mu E : E",
        purpose: "large rotation, small strain; it softens under strong compression",
        parameters: &[ELASTIC_CONSTANTS],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let own = values.elastic(NAME)?;
        SaintVenantKirchhoff::new(own.lambda, own.mu)
    }
}

impl Material for SaintVenantKirchhoff {
    compiled_with_this_crate!();

    #[inline(always)]
    fn strain_energy<L: Lane>(&self, E: &Sym<L>) -> L {
        let tr = trace(E);
        tr * tr * (0.5 * self.lambda) + double_dot(E, E) * self.mu
    }

    /// The work of the mean stress, which is the stress at the mean strain.
    #[inline(always)]
    fn energy_change<L: Lane>(&self, E: &Sym<L>, dE: &Sym<L>) -> Option<L> {
        let mean = sym_add_scaled(E, E[0].splat(0.5), dE);
        Some(double_dot(&self.stress(&mean), dE))
    }

    #[inline(always)]
    fn stress<L: Lane>(&self, E: &Sym<L>) -> Sym<L> {
        let pressure = trace(E) * self.lambda;
        let mut S = sym_scaled(E[0].splat(2.0 * self.mu), E);
        for i in 0..3 {
            S[i] += pressure;
        }
        S
    }

    /// The stress of the mean strain.
    #[inline(always)]
    fn stress_along<L: Lane>(&self, E: &Sym<L>, dE: &Sym<L>, points: &[[f64; 2]]) -> Sym<L> {
        let (mut weight, mut moment) = (0.0, 0.0);
        for &[alpha, w] in points {
            (weight, moment) = (weight + w, moment + w * alpha);
        }
        let constant = inlined!(|value| E[0].splat(value));
        self.stress(&sym_add_scaled(&sym_scaled(constant(weight), E), constant(moment), dE))
    }

    #[inline(always)]
    fn stress_and_elasticity<L: Lane>(&self, E: &Sym<L>) -> (Sym<L>, Elasticity<L>) {
        let constant = inlined!(|value| E[0].splat(value));
        let mut D = [[constant(0.0); 6]; 6];
        for a in 0..3 {
            for b in 0..3 {
                D[a][b] = constant(self.lambda);
            }
            D[a][a] = constant(self.lambda + 2.0 * self.mu);
            D[a + 3][a + 3] = constant(self.mu);
        }
        (self.stress(E), D)
    }

    /// `U = lambda/2 (tr E)^2`; the rest has the bulk modulus 2/3 mu whatever the share.
    fn split(&self, _: f64) -> Option<(Self, VolumeLaw)> {
        let law = VolumeLaw::new(VolumeMeasure::Trace, Volumetric::Quadratic, self.lambda)?;
        Some((SaintVenantKirchhoff { lambda: 0.0, ..*self }, law))
    }
}

#[cfg(test)]
mod tests {
    use super::super::conformance::{big, big_trace, conforms};
    use super::super::tests::rejects;
    use super::*;

    #[test]
    fn conforms_to_its_textbook_form() {
        let [lambda, mu] = [1000.0, 500.0];
        conforms(&SaintVenantKirchhoff::new(lambda, mu).unwrap(), [lambda, mu], |C| {
            // With the invariants of C - I: E = (C - I) / 2.
            let tr = big_trace(C) - big(3.0);
            let unit = |i, j| big(if i == j { 1.0 } else { 0.0 });
            let squares = (0..9).map(|n| &C[n / 3][n % 3] - unit(n / 3, n % 3)).map(|a| &a * &a);
            big(lambda / 8.0) * &tr * &tr + big(mu / 4.0) * squares.fold(big(0.0), |sum, a| sum + a)
        });
    }

    #[test]
    fn bad_parameters_are_rejected() {
        rejects("mu", SaintVenantKirchhoff::new(1.0, 0.0));
        rejects("lambda", SaintVenantKirchhoff::new(-2.0, 3.0));
        rejects("youngs_modulus", SaintVenantKirchhoff::from_engineering(-1.0, 0.3));
        rejects("poissons_ratio", SaintVenantKirchhoff::from_engineering(1.0, 0.5));
    }
}
