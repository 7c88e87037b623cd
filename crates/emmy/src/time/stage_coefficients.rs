//! Coefficients of the stage equations.

use super::scheme_force::SchemeDamping;
use crate::average::Rule;
use crate::force::Sampling;
use crate::sparse::{accurate_sum, split};

/// Coefficients of the stage equations: the only difference between implicit steppers.
///
/// ```math
/// R_i = sum_j m_ij M x_j - g_i + s^2 (f_i - f_i^ext) = 0
/// ```
///
/// with the stage averages f_i of a rule, and a known vector g_i and a time s that are set for every step. Drag adds `s
/// alpha M x_i` to this, a dissipative scheme `s weight_i M U lambda`.
#[derive(Debug)]
pub(crate) struct StageCoefficients {
    /// The rule that averages the internal force.
    pub rule: Rule,
    /// How the equations take what is given over time.
    pub sampling: Sampling,
    /// m_ij, `[i k + j]`.
    pub mass: Vec<f64>,
    /// Rounding errors of m_ij.
    pub mass_low: Vec<f64>,
    /// Inverse of m, `[i k + j]`.
    pub inverse_mass: Vec<f64>,
    /// Response of the averages to the rates: `df_i/dx_j ~ w_ij K` with one matrix K, `[i k + j]`. A time element has
    /// `w = m^-1`.
    pub response: Vec<f64>,
    /// Dissipation of the scheme.
    pub damping: Option<SchemeDamping>,
}

impl StageCoefficients {
    /// Whether the step has no inertia; then neither drag nor viscosity acts.
    pub(crate) fn is_static(&self) -> bool {
        self.mass.iter().all(|m| *m == 0.0)
    }

    /// Factor beta of the scheme's damping on the elasticity at rest.
    pub(crate) fn scheme_excess(&self) -> f64 {
        self.damping.as_ref().map_or(0.0, |damping| damping.excess)
    }

    /// A coefficient with its rounding error, as the two parts that products take: what a scheme of a degree above 1
    /// conserves does not depend on rounded coefficients. At degree 1 they are 1/2, 1 and 2.
    pub(crate) fn parts(&self, coefficient: [f64; 2]) -> [f64; 2] {
        if self.rule.degree() == 1 { [coefficient[0], 0.0] } else { split(coefficient) }
    }

    /// Weights of rate j in displacement and velocity at the end of a time element's step: `b_j` and `sum_i b_i
    /// (a^-1)_ij`.
    pub(crate) fn end_weights(&self, j: usize) -> [f64; 2] {
        [self.rule.weights()[j], self.velocity_sum(j)[0]]
    }

    /// The second of these weights, in [`StageCoefficients::parts`].
    pub(crate) fn velocity_weight(&self, j: usize) -> [f64; 2] {
        self.parts(self.velocity_sum(j))
    }

    fn velocity_sum(&self, j: usize) -> [f64; 2] {
        let k = self.rule.degree();
        let parts = [&self.mass, &self.mass_low].into_iter();
        let b = self.rule.weights();
        accurate_sum(parts.flat_map(|mass| (0..k).map(move |i| [b[i], mass[i * k + j]])))
    }

    /// The sums `h sum_j m_ij`, in [`StageCoefficients::parts`].
    pub(crate) fn mass_sums(&self, h: f64) -> impl Iterator<Item = [f64; 2]> {
        let k = self.rule.degree();
        let rows = self.mass.chunks_exact(k).zip(self.mass_low.chunks_exact(k));
        rows.map(move |(row, low)| self.parts(accurate_sum(row.iter().chain(low).map(|m| [*m, h]))))
    }
}
