//! Coefficients of dissipative time elements.

#![allow(non_snake_case)]

use crate::average::Rule;

/// The coefficients of a dissipative time element.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SchemeDamping {
    /// chi.
    pub(super) strength: f64,
    /// beta.
    pub excess: f64,
    /// `b_j p_j`.
    pub(super) highest_mode: Vec<f64>,
    /// eta_j.
    pub(super) eta: Vec<f64>,
    /// `beta mu_i / (1 + chi)`, `mu_i = sum_j (a^-1)_ij p_j`: coefficients of U lambda in the stage equations.
    pub(super) stage_weights: Vec<f64>,
    /// Coefficient of U lambda in the new velocity.
    pub(super) end_weight: f64,
}

impl SchemeDamping {
    /// The dissipation of a rule with a spectral radius at infinity; `inverse`: a^-1, `[i k + j]`.
    pub(crate) fn new(rule: &Rule, inverse: &[f64], spectral_radius: f64) -> Self {
        let k = rule.degree();
        let b = rule.weights();
        let p = rule.highest_mode();
        let strength = (1.0 - spectral_radius) / (1.0 + spectral_radius);
        let excess = strength / (2 * (2 * k - 1)) as f64;
        let row = |i: usize| (0..k).map(|j| inverse[i * k + j] * p[j]).sum::<f64>();
        let stage_weights: Vec<f64> = (0..k).map(|i| excess * row(i) / (1.0 + strength)).collect();
        SchemeDamping {
            strength,
            excess,
            highest_mode: (0..k).map(|j| b[j] * p[j]).collect(),
            eta: (0..k).map(|j| (0..k).map(|i| b[i] * p[i] * inverse[i * k + j]).sum()).collect(),
            end_weight: stage_weights.iter().zip(b).map(|(weight, b)| weight * b).sum(),
            stage_weights,
        }
    }

    /// Coefficients that replace a, `[i k + j]`.
    pub(crate) fn coefficients(&self, rule: &Rule) -> Vec<f64> {
        let k = rule.degree();
        let p = rule.highest_mode();
        let excess = |n: usize| self.excess * p[n / k] * self.highest_mode[n % k];
        rule.coefficients().iter().enumerate().map(|(n, a)| a + excess(n)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparse::inverse;

    /// `1 + z b^T (1 - z a)^-1 1` for a real z, by the inverse of the matrix.
    fn stability(rule: &Rule, a: &[f64], z: f64) -> f64 {
        let k = rule.degree();
        let matrix: Vec<f64> =
            (0..k * k).map(|n| (if n / k == n % k { 1.0 } else { 0.0 }) - z * a[n]).collect();
        let inverse = inverse(&matrix);
        let rows = (0..k).map(|i| rule.weights()[i] * (0..k).map(|j| inverse[i * k + j]).sum::<f64>());
        1.0 + z * rows.sum::<f64>()
    }

    fn dissipation(k: usize, radius: f64) -> (Rule, SchemeDamping) {
        let rule = Rule::discrete_gradient(k);
        let dissipation = SchemeDamping::new(&rule, &inverse(rule.coefficients()), radius);
        (rule, dissipation)
    }

    #[test]
    fn the_spectral_radius_at_infinity_matches_the_request() {
        for (k, radius) in (1..=5).flat_map(|k| [0.0, 0.3, 0.8, 1.0].map(|radius| (k, radius))) {
            let (rule, dissipation) = dissipation(k, radius);
            let found = stability(&rule, &dissipation.coefficients(&rule), -1e9).abs();
            assert!((found - radius).abs() < 1e-6, "{k}: {found} is not {radius}");
        }
    }

    #[test]
    fn full_dissipation_is_radau_iia() {
        // Its stability functions are the subdiagonal Pade approximants of exp: 1/(1 - z), (1 + z/3)/(1 - 2 z/3 +
        // z^2/6).
        for z in [-3.0, -0.7, 0.4] {
            let (rule, full) = dissipation(1, 0.0);
            assert!((stability(&rule, &full.coefficients(&rule), z) - 1.0 / (1.0 - z)).abs() < 1e-14);
            let (rule, full) = dissipation(2, 0.0);
            let pade = (1.0 + z / 3.0) / (1.0 - 2.0 / 3.0 * z + z * z / 6.0);
            assert!((stability(&rule, &full.coefficients(&rule), z) - pade).abs() < 1e-14);
        }
    }
}
