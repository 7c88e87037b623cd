//! Quadrature points of a step.

use crate::polynomial::{lagrange, lagrange_integral, legendre};
use crate::quadrature::Quadrature;
use crate::sparse::accurate_sum;

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

/// Coefficients `a_ij = L_j(c_i)` of Gauss' method with points c and weights b, `[i k + j]`.
///
/// With the Legendre polynomials p_n of norm one (Hairer and Wanner 1981),
///
/// ```math
/// a_ij = b_j (1/2 + sigma_ij),      sigma_ij = sum_(n=1)^(k-1) [p_n(c_i) p_(n-1)(c_j) - p_(n-1)(c_i) p_n(c_j)] / (2 sqrt(4 n^2 - 1))
/// ```
///
/// All conservation rests on `b_i a_ij + b_j a_ji = b_i b_j`. An error of these sums acts in every step with the same
/// sign (Hairer, McLachlan and Razakarivony 2008). So sigma is antisymmetric to the last bit, and among its neighbours
/// in rounding it is one whose products with b happen to keep the sum.
pub(super) fn coefficients(c: &[f64], b: &[f64]) -> Vec<f64> {
    let k = c.len();
    let mut a: Vec<f64> = (0..k * k).map(|at| 0.5 * b[at % k]).collect();
    for (i, j) in (0..k).flat_map(|i| (0..i).map(move |j| (i, j))) {
        let p = |n: usize, i: usize| legendre(n, c[i]);
        let term = |n: usize| {
            (p(n, i) * p(n - 1, j) - p(n - 1, i) * p(n, j)) / (2.0 * ((4 * n * n - 1) as f64).sqrt())
        };
        let sigma: f64 = (1..k).map(term).sum();
        // A multiple of eps/2: its sums with 1/2 are exact.
        let sigma = (sigma + 1.0) - 1.0;
        // The first of equal ones is the nearest.
        let neighbours = (0..=NEIGHBOURS).flat_map(|n| [n, -n]).map(|n| {
            let sigma = sigma + f64::from(n) * 0.5 * f64::EPSILON;
            [b[j] * (0.5 + sigma), b[i] * (0.5 - sigma)]
        });
        let defect = |a: &[f64; 2]| identity_defect([b[i], b[j]], *a).abs();
        let best = neighbours.min_by(|x, y| defect(x).total_cmp(&defect(y)));
        [a[i * k + j], a[j * k + i]] = best.unwrap_or_default();
    }
    a
}

/// Neighbours of a coefficient on each side. Their distance of 1e-13 moves a stage by as small a part of the step; the
/// sums are taken to the inverse of a, which magnifies their defect a hundredfold.
const NEIGHBOURS: i32 = 1024;

/// `b_i a_ij + b_j a_ji - b_i b_j` in twice the precision.
fn identity_defect([b_i, b_j]: [f64; 2], [a_ij, a_ji]: [f64; 2]) -> f64 {
    accurate_sum([[b_i, a_ij], [-b_i, b_j], [b_j, a_ji]])[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::gauss;

    #[test]
    fn coefficients_are_those_of_gauss_and_keep_their_identity() {
        for k in 1..=8 {
            let rule = gauss(k);
            let c: Vec<f64> = rule.points.iter().map(|point| point[0]).collect();
            let a = coefficients(&c, &rule.weights);
            for (i, j) in (0..k * k).map(|at| (at / k, at % k)) {
                assert!((a[i * k + j] - lagrange_integral(&c, j, c[i])).abs() < 2e-13, "{k}");
                let b = [rule.weights[i], rule.weights[j]];
                let defect = identity_defect(b, [a[i * k + j], a[j * k + i]]);
                // Of 2049 neighbours, some have a defect below 1/500 of the rounding; rounded coefficients have all of
                // it. The weights of three points are ninths: after nine neighbours the defects repeat, and the least
                // is 1/27.
                let part = if k == 3 { 25.0 } else { 500.0 };
                assert!(defect.abs() < f64::EPSILON / part * b[0] * b[1], "{k}: {defect:e}");
            }
        }
    }
}
