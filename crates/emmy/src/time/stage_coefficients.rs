//! Coefficients of the stage equations.

use super::dissipation::Dissipation;
use crate::average::Rule;

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
    /// m_ij, `[i k + j]`.
    pub mass: Vec<f64>,
    /// Inverse of m, `[i k + j]`.
    pub inverse_mass: Vec<f64>,
    /// Response of the averages to the rates: `df_i/dx_j ~ w_ij K` with one matrix K, `[i k + j]`.
    pub response: Vec<f64>,
    /// Dissipation of the scheme.
    pub dissipation: Option<Dissipation>,
}

impl StageCoefficients {
    /// Weights of rate j in displacement and velocity at the end of a time element's step: `b_j` and `sum_i b_i
    /// (a^-1)_ij`.
    pub(crate) fn end_weights(&self, j: usize) -> [f64; 2] {
        let b = self.rule.weights();
        let k = self.rule.degree();
        [b[j], (0..k).map(|i| b[i] * self.mass[i * k + j]).sum()]
    }
}
