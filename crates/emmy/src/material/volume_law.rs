//! The part of a stored energy that depends on the volume alone, for cells that project it.

#![allow(non_snake_case)]

use super::Volumetric;
use super::invariants::{inverse_dyads, right_cauchy_green, volume_change};
use crate::tensor::{Elasticity, Lane, Sym, dot3, sym_cofactor, sym_det, sym_scaled, trace};

/// Measure theta of a change of volume, zero in the reference configuration.
///
/// ```
/// use emmy::material::VolumeMeasure;
/// let stretched = [0.625, 0.0, 0.0, 0.0, 0.0, 0.0]; // to 1.5 times its length
/// assert!((VolumeMeasure::Ratio.change(&stretched) - 0.5).abs() < 1e-15);
/// assert_eq!(VolumeMeasure::Trace.change(&stretched), 0.625);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumeMeasure {
    /// `theta = J - 1`.
    Ratio,
    /// `theta = tr E`, of St. Venant and Kirchhoff.
    Trace,
}

impl VolumeMeasure {
    /// theta at a Green-Lagrange strain, without cancellation at small strain.
    ///
    /// ```math
    /// J - 1 = z / (1 + sqrt(1 + z)),      z = det C - 1 = 2 tr E + 4 I_2(E) + 8 det E
    /// ```
    #[inline(always)]
    pub fn change<L: Lane>(self, strain: &Sym<L>) -> L {
        match self {
            VolumeMeasure::Ratio => {
                let one = strain[0].splat(1.0);
                let z = volume_change(&sym_scaled(one.splat(2.0), strain));
                z / (one + (one + z).sqrt())
            }
            VolumeMeasure::Trace => trace(strain),
        }
    }

    /// B = dtheta/dE: `J C^-1`, or the unit tensor. A pressure p has the second Piola-Kirchhoff stress `p B`.
    ///
    /// ```
    /// use emmy::material::VolumeMeasure;
    /// assert_eq!(VolumeMeasure::Ratio.direction(&[0.0; 6]), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    /// ```
    #[inline(always)]
    pub fn direction<L: Lane>(self, strain: &Sym<L>) -> Sym<L> {
        self.change_and_direction(strain).1
    }

    /// theta and B, which share most of their computation.
    #[inline(always)]
    pub(crate) fn change_and_direction<L: Lane>(self, strain: &Sym<L>) -> (L, Sym<L>) {
        let one = strain[0].splat(1.0);
        match self {
            VolumeMeasure::Ratio => {
                let A = sym_scaled(one.splat(2.0), strain);
                let C = right_cauchy_green(&A);
                let cofactor = sym_cofactor(&C);
                let J = dot3([C[0], C[3], C[5]], [cofactor[0], cofactor[3], cofactor[5]]).sqrt();
                let inverse = one / (J * (one + J));
                (volume_change(&A) * J * inverse, sym_scaled((one + J) * inverse, &cofactor))
            }
            VolumeMeasure::Trace => {
                let zero = one.splat(0.0);
                (trace(strain), [one, one, one, zero, zero, zero])
            }
        }
    }

    /// dB/dE.
    ///
    /// ```math
    /// dB/dE = (B (x) B - (B_ik B_jl + B_il B_jk)) / J
    /// ```
    ///
    /// ```
    /// use emmy::material::VolumeMeasure;
    /// assert_eq!(VolumeMeasure::Trace.curvature(&[0.1; 6]), [[0.0; 6]; 6]);
    /// ```
    #[inline(always)]
    pub fn curvature<L: Lane>(self, strain: &Sym<L>) -> Elasticity<L> {
        let one = strain[0].splat(1.0);
        match self {
            VolumeMeasure::Ratio => {
                let C = right_cauchy_green(&sym_scaled(one.splat(2.0), strain));
                let inverse_J = one / sym_det(&C).sqrt();
                inverse_dyads(&sym_scaled(inverse_J, &sym_cofactor(&C)), inverse_J, -inverse_J)
            }
            VolumeMeasure::Trace => [[one.splat(0.0); 6]; 6],
        }
    }
}

/// Volumetric energy U(theta) of a material, which a cell with a projected volume takes at the projected theta.
///
/// Every law of [`Volumetric`] is written in `theta = J - 1`, with a relative error at round-off for any theta.
///
/// ```
/// use emmy::material::{VolumeLaw, VolumeMeasure, Volumetric};
/// let law = VolumeLaw::new(VolumeMeasure::Ratio, Volumetric::Miehe, 100.0).unwrap();
/// assert!((law.energy(0.5) - 100.0 * (0.5 - 1.5f64.ln())).abs() < 1e-13);
/// assert!((law.pressure(0.5) - 100.0 * (1.0 - 1.0 / 1.5)).abs() < 1e-13);
/// assert!((law.stiffness(0.0) - 100.0).abs() < 1e-13);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeLaw {
    measure: VolumeMeasure,
    law: Volumetric,
    modulus: f64,
}

impl VolumeLaw {
    /// The law with its modulus, the bulk modulus at rest \[force/length^2\]; `None` unless it is positive.
    pub fn new(measure: VolumeMeasure, law: Volumetric, modulus: f64) -> Option<Self> {
        (modulus > 0.0).then_some(VolumeLaw { measure, law, modulus })
    }

    /// Measure of the volume.
    pub fn measure(&self) -> VolumeMeasure {
        self.measure
    }

    /// Bulk modulus at rest \[force/length^2\].
    pub fn modulus(&self) -> f64 {
        self.modulus
    }

    /// Whether U is quadratic in theta.
    pub fn is_quadratic(&self) -> bool {
        self.law == Volumetric::Quadratic
    }

    /// U per reference volume \[energy/length^3\].
    #[inline(always)]
    pub fn energy<L: Lane>(&self, theta: L) -> L {
        let over_modulus = match self.law {
            Volumetric::Logarithmic => {
                let ln_J = theta.ln_1p();
                ln_J * ln_J * 0.5
            }
            Volumetric::Quadratic => theta * theta * 0.5,
            Volumetric::SimoTaylor => (theta * theta + theta.minus_ln_1p() * 2.0) * 0.25,
            Volumetric::Miehe => theta.minus_ln_1p(),
            // J ln J - J + 1
            Volumetric::Liu => theta * theta.ln_1p() - theta.minus_ln_1p(),
        };
        over_modulus * self.modulus
    }

    /// Energy change `U(theta + change) - U(theta)` in closed form, free of cancellation.
    ///
    /// ```math
    /// zeta = change / (1 + theta),      ln(J_2/J_1) = ln(1 + zeta),      change - ln(J_2/J_1) = theta zeta + zeta - ln(1 + zeta)
    /// ```
    ///
    /// ```
    /// use emmy::material::{VolumeLaw, VolumeMeasure, Volumetric};
    /// let law = VolumeLaw::new(VolumeMeasure::Ratio, Volumetric::SimoTaylor, 3.0).unwrap();
    /// let work = law.pressure(0.1) * 1e-12;
    /// assert!((law.energy_change(0.1, 1e-12) / work - 1.0).abs() < 1e-10);
    /// ```
    #[inline(always)]
    pub fn energy_change<L: Lane>(&self, theta: L, change: L) -> L {
        let J = theta.splat(1.0) + theta;
        let zeta = change / J;
        let quadratic = change * (theta * 2.0 + change);
        let over_modulus = match self.law {
            Volumetric::Logarithmic => {
                let ln = zeta.ln_1p();
                ln * (theta.ln_1p() * 2.0 + ln) * 0.5
            }
            Volumetric::Quadratic => quadratic * 0.5,
            Volumetric::SimoTaylor => (quadratic + (theta * zeta + zeta.minus_ln_1p()) * 2.0) * 0.25,
            Volumetric::Miehe => theta * zeta + zeta.minus_ln_1p(),
            Volumetric::Liu => change * theta.ln_1p() + J * (zeta * zeta.ln_1p() - zeta.minus_ln_1p()),
        };
        over_modulus * self.modulus
    }

    /// Pressure U' \[force/length^2\], positive in tension.
    #[inline(always)]
    pub fn pressure<L: Lane>(&self, theta: L) -> L {
        let one = theta.splat(1.0);
        let over_modulus = match self.law {
            Volumetric::Logarithmic => theta.ln_1p() / (one + theta),
            Volumetric::Quadratic => theta,
            // (J - 1/J) / 2
            Volumetric::SimoTaylor => theta * (theta * 0.5 + one) / (one + theta),
            Volumetric::Miehe => theta / (one + theta),
            Volumetric::Liu => theta.ln_1p(),
        };
        over_modulus * self.modulus
    }

    /// Stiffness U'' \[force/length^2\].
    #[inline(always)]
    pub fn stiffness<L: Lane>(&self, theta: L) -> L {
        let one = theta.splat(1.0);
        let inverse = one / (one + theta);
        let over_modulus = match self.law {
            Volumetric::Logarithmic => (one - theta.ln_1p()) * inverse * inverse,
            Volumetric::Quadratic => one,
            Volumetric::SimoTaylor => (one + inverse * inverse) * 0.5,
            Volumetric::Miehe => inverse * inverse,
            Volumetric::Liu => inverse,
        };
        over_modulus * self.modulus
    }
}

#[cfg(test)]
mod tests;
