//! Rules on the interval `[0, 1]`.

use std::f64::consts::PI;
use std::num::NonZeroUsize;

use gauss_quad::legendre::GaussLegendre;

use super::Quadrature;

/// Gauss rule with n points on `[0, 1]`, in ascending order: exact for polynomials of degree 2n - 1.
///
/// The points lie exactly symmetric about 1/2. Source: Bogaert (2014), SIAM J. Sci. Comput. 36, A1008-A1026.
///
/// # Panics
/// If n = 0.
///
/// ```
/// let rule = emmy::internals::quadrature::gauss(2);
/// assert!((rule.points[0][0] - 0.21132486540518712).abs() < 1e-16);
/// assert_eq!(rule.weights, [0.5, 0.5]);
/// ```
pub fn gauss(n: usize) -> Quadrature<1> {
    let rule = GaussLegendre::new(NonZeroUsize::new(n).expect("a Gauss rule has at least one point"));
    symmetric(rule.nodes().copied().collect(), rule.weights().copied().collect())
}

/// Gauss-Lobatto rule with n points on `[0, 1]`, both ends among them: exact for polynomials of degree 2n - 3.
///
/// ```math
/// (1 - x_i^2) P'_m(x_i) = 0,      w_i = 2 / (m (m + 1) P_m(x_i)^2),      m = n - 1,   on [-1, 1]
/// ```
///
/// Source: Abramowitz and Stegun (1964), equation 25.4.32. n = 2 is the trapezoidal rule, n = 3 Simpson's.
///
/// # Panics
/// If n < 2.
///
/// ```
/// assert_eq!(emmy::internals::quadrature::lobatto(3).points, [[0.0], [0.5], [1.0]]);
/// ```
pub fn lobatto(n: usize) -> Quadrature<1> {
    assert!(n >= 2, "a Lobatto rule has at least two points");
    let m = n - 1;
    let nodes: Vec<f64> = (0..n).map(|i| lobatto_node(m, -(PI * i as f64 / m as f64).cos())).collect();
    let weight = |&x: &f64| 2.0 / ((m * n) as f64 * legendre(m, x).0.powi(2));
    let weights = nodes.iter().map(weight).collect();
    symmetric(nodes, weights)
}

/// Zero of `(1 - x^2) P'_m` next to a guess, by Newton's iteration; from Chebyshev points it takes about five steps.
fn lobatto_node(m: usize, guess: f64) -> f64 {
    let mut x = guess;
    for _ in 0..30 {
        let (p, p_before) = legendre(m, x);
        // (1 - x^2) P'_m = m (P_{m-1} - x P_m), and its derivative is -m (m + 1) P_m.
        let step = (p_before - x * p) / ((m + 1) as f64 * p);
        x += step;
        if step.abs() < f64::EPSILON {
            break;
        }
    }
    x
}

/// Legendre polynomials of degrees m and m - 1 at a point.
fn legendre(m: usize, x: f64) -> (f64, f64) {
    let mut p = x;
    let mut p_before = 1.0;
    for j in 1..m {
        let j = j as f64;
        (p, p_before) = (((2.0 * j + 1.0) * x * p - j * p_before) / (j + 1.0), p);
    }
    (p, p_before)
}

/// Rule on `[0, 1]` from nodes and weights on `[-1, 1]`, made symmetric about 1/2 to the last bit.
fn symmetric(nodes: Vec<f64>, weights: Vec<f64>) -> Quadrature<1> {
    let n = nodes.len();
    let point = |i: usize| {
        // The upper half is rounded first: 1 - x is exact there.
        let upper = |low: usize, high: usize| 0.5 + 0.25 * (nodes[high] - nodes[low]);
        if 2 * i + 1 < n { [1.0 - upper(i, n - 1 - i)] } else { [upper(n - 1 - i, i)] }
    };
    let weight = |i: usize| 0.25 * (weights[i] + weights[n - 1 - i]);
    Quadrature { points: (0..n).map(point).collect(), weights: (0..n).map(weight).collect() }
}

#[cfg(test)]
mod tests {
    use super::super::conformance::integrates_monomials;
    use super::*;

    fn is_accurate(rule: &Quadrature<1>, degree: i32) {
        integrates_monomials(rule, (0..=degree).map(|p| [p]), |[p]| 1.0 / f64::from(p + 1));
        let n = rule.n_points();
        for i in 0..n {
            assert_eq!(rule.points[i][0] + rule.points[n - 1 - i][0], 1.0);
            assert_eq!(rule.weights[i], rule.weights[n - 1 - i]);
        }
        assert!(rule.points.is_sorted());
    }

    #[test]
    fn gauss_rules_are_exact_to_degree_2n_minus_1() {
        (1..=24).for_each(|n| is_accurate(&gauss(n), 2 * n as i32 - 1));
    }

    #[test]
    fn lobatto_rules_are_exact_to_degree_2n_minus_3() {
        (2..=24).for_each(|n| is_accurate(&lobatto(n), 2 * n as i32 - 3));
    }

    #[test]
    fn points_and_weights_match_the_closed_forms() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1.2e-16, "{a} is not {b}");
        near(gauss(1).points[0][0], 0.5);
        near(gauss(2).points[1][0], 0.788_675_134_594_812_9);
        near(gauss(3).points[2][0], 0.887_298_334_620_741_7);
        near(gauss(3).weights[0], 5.0 / 18.0);
        near(gauss(4).points[3][0], 0.930_568_155_797_026_3);
        near(gauss(4).weights[0], 0.173_927_422_568_726_93);
        near(gauss(5).points[3][0], 0.769_234_655_052_841_5);
        near(gauss(5).weights[2], 64.0 / 225.0);
        near(lobatto(3).weights[1], 2.0 / 3.0);
        near(lobatto(4).points[2][0], 0.723_606_797_749_979);
        near(lobatto(5).points[3][0], 0.827_326_835_353_988_6);
        near(lobatto(5).weights[1], 49.0 / 180.0);
        assert_eq!(lobatto(9).points[0], [0.0]);
    }

    #[test]
    fn many_points_are_allowed() {
        let integral: f64 = gauss(500).iter().map(|([x], w)| w * x.exp()).sum();
        assert!((integral - 1f64.exp_m1()).abs() < 1e-14);
    }
}
