//! Lagrange bases on given nodes of the unit interval, and their integrals.

/// Lagrange basis polynomial `l_i` on `nodes` at a point (inside the interval or beyond it).
///
/// ```math
/// l_i(alpha) = prod_{j != i} (alpha - c_j) / (c_i - c_j)
/// ```
///
/// ```
/// assert_eq!(emmy::polynomial::lagrange(&[0.0, 1.0], 1, 0.25), 0.25);
/// ```
pub fn lagrange(nodes: &[f64], i: usize, alpha: f64) -> f64 {
    let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
    others.map(|(_, c)| (alpha - c) / (nodes[i] - c)).product()
}

/// Derivative of the Lagrange basis polynomial `l_i` at a point.
///
/// ```math
/// l_i'(alpha) = sum_{m != i} 1/(c_i - c_m) prod_{j != i, m} (alpha - c_j) / (c_i - c_j)
/// ```
///
/// ```
/// assert_eq!(emmy::polynomial::lagrange_rate(&[0.0, 1.0], 0, 0.25), -1.0);
/// ```
pub fn lagrange_rate(nodes: &[f64], i: usize, alpha: f64) -> f64 {
    let others = |m: usize| (0..nodes.len()).filter(move |&j| j != i && j != m);
    let product =
        |m: usize| -> f64 { others(m).map(|j| (alpha - nodes[j]) / (nodes[i] - nodes[j])).product() };
    others(i).map(|m| product(m) / (nodes[i] - nodes[m])).sum()
}

/// Integral of the Lagrange basis polynomial from 0 to a point, by a quadrature that is exact for its degree.
///
/// ```math
/// L_i(alpha) = integral_0^alpha l_i(s) ds
/// ```
///
/// ```
/// assert!((emmy::polynomial::lagrange_integral(&[0.0, 1.0], 1, 0.5) - 0.125).abs() < 1e-16);
/// ```
pub fn lagrange_integral(nodes: &[f64], i: usize, alpha: f64) -> f64 {
    let rule = crate::quadrature::gauss(nodes.len().div_ceil(2).max(1));
    let terms = rule.points.iter().zip(&rule.weights);
    alpha * terms.map(|(&[s], w)| w * lagrange(nodes, i, s * alpha)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_and_rates_of_a_cubic_basis_are_exact() {
        // sum_i c_i^m l_i(alpha) = alpha^m for m <= 3, so sum_i c_i^m L_i(alpha) = alpha^(m+1) / (m+1).
        let nodes = [0.1f64, 0.3, 0.65, 0.9];
        for alpha in [0.2, 0.77, 1.0, 1.4] {
            for m in 0..4 {
                let sum: f64 = (0..4).map(|i| nodes[i].powi(m) * lagrange_integral(&nodes, i, alpha)).sum();
                assert!((sum - alpha.powi(m + 1) / f64::from(m + 1)).abs() < 1e-14);
                let rate: f64 = (0..4).map(|i| nodes[i].powi(m) * lagrange_rate(&nodes, i, alpha)).sum();
                assert!((rate - f64::from(m) * alpha.powi(m - 1)).abs() < 1e-12);
            }
        }
    }
}
