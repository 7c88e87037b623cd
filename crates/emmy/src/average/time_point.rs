//! Quadrature points of a step.

use crate::polynomial::{lagrange, lagrange_integral};
use crate::quadrature::Quadrature;

/// A quadrature point inside the step with everything a rule needs there.
#[derive(Debug, Clone)]
pub(super) struct TimePoint {
    /// Point alpha.
    pub alpha: f64,
    /// Weight w.
    pub weight: f64,
    /// L_j(alpha), the integrals of the basis.
    pub integrals: Vec<f64>,
    /// l_j(alpha).
    pub basis: Vec<f64>,
    /// w l_i(alpha) / b_i, the weights of the point in the stage averages.
    pub stage_weights: Vec<f64>,
}

/// The points of a quadrature in a time element with Gauss points c and weights b.
pub(super) fn time_points(c: &[f64], b: &[f64], quadrature: &Quadrature<1>) -> Vec<TimePoint> {
    let degree = c.len();
    let points = quadrature.points.iter().zip(&quadrature.weights).map(|(&[alpha], &weight)| {
        let basis: Vec<f64> = (0..degree).map(|j| lagrange(c, j, alpha)).collect();
        let integrals = (0..degree).map(|j| lagrange_integral(c, j, alpha)).collect();
        let stage_weights = (0..degree).map(|i| weight * basis[i] / b[i]).collect();
        TimePoint { alpha, weight, integrals, basis, stage_weights }
    });
    points.collect()
}
