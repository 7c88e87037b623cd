//! Lagrange bases on given nodes of the unit interval, and their integrals.

/// Lagrange basis polynomial `l_i` on `nodes` at a point (inside the interval or beyond it).
///
/// ```math
/// l_i(alpha) = prod_{j != i} (alpha - c_j) / (c_i - c_j)
/// ```
///
/// ```
/// assert_eq!(emmy::internals::polynomial::lagrange(&[0.0, 1.0], 1, 0.25), 0.25);
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
/// assert_eq!(emmy::internals::polynomial::lagrange_rate(&[0.0, 1.0], 0, 0.25), -1.0);
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
/// assert!((emmy::internals::polynomial::lagrange_integral(&[0.0, 1.0], 1, 0.5) - 0.125).abs() < 1e-16);
/// ```
pub fn lagrange_integral(nodes: &[f64], i: usize, alpha: f64) -> f64 {
    let rule = crate::quadrature::gauss(nodes.len().div_ceil(2).max(1));
    let terms = rule.points.iter().zip(&rule.weights);
    alpha * terms.map(|(&[s], w)| w * lagrange(nodes, i, s * alpha)).sum::<f64>()
}

/// Legendre polynomial of a degree on the unit interval, with the mean square 1.
///
/// ```math
/// p_n(alpha) = sqrt(2 n + 1) P_n(2 alpha - 1),    integral_0^1 p_m p_n dalpha = delta_mn
/// ```
///
/// ```
/// assert_eq!(emmy::internals::polynomial::legendre(1, 1.0), f64::sqrt(3.0));
/// ```
pub fn legendre(degree: usize, alpha: f64) -> f64 {
    let x = 2.0 * alpha - 1.0;
    let mut before = 0.0;
    let mut value = 1.0;
    for n in 0..degree {
        // Bonnet: (n + 1) P_(n+1) = (2 n + 1) x P_n - n P_(n-1)
        (before, value) = (value, ((2 * n + 1) as f64 * x * value - n as f64 * before) / (n + 1) as f64);
    }
    ((2 * degree + 1) as f64).sqrt() * value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legendre_polynomials_are_orthonormal() {
        let rule = crate::quadrature::gauss(8);
        for (m, n) in (0..64).map(|index| (index / 8, index % 8)) {
            let terms = rule.points.iter().zip(&rule.weights);
            let sum: f64 = terms.map(|(&[s], w)| w * legendre(m, s) * legendre(n, s)).sum();
            assert!((sum - if m == n { 1.0 } else { 0.0 }).abs() < 1e-13, "{m} {n}");
        }
    }

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
