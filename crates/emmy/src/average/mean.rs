//! Stage averages of linear forces.

use super::TimePoint;

/// Stage averages of a polynomial path under a linear force.
///
/// ```math
/// (1/b_i) sum_m w_m l_i(alpha_m) u(alpha_m) = start_i u_1 + sum_j rates_ij x_j
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Mean {
    /// Coefficients of the displacement at the start, `[k]`.
    pub start: Vec<f64>,
    /// Coefficients of the rates, `[i k + j]`.
    pub rates: Vec<f64>,
}

impl Mean {
    pub(super) fn of(degree: usize, points: &[TimePoint]) -> Mean {
        let sum = |of: &dyn Fn(&TimePoint) -> f64| points.iter().map(of).sum::<f64>();
        let rate = |n: usize| sum(&|point| point.stage_weights[n / degree] * point.integrals[n % degree]);
        Mean {
            start: (0..degree).map(|i| sum(&|point| point.stage_weights[i])).collect(),
            rates: (0..degree * degree).map(rate).collect(),
        }
    }
}
