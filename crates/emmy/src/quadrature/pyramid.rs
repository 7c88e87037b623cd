//! Conical product rules on the pyramid.

use super::{Quadrature, square};

/// Conical product rule on the pyramid with the base `[-1, 1]^2` and the apex (0, 0, 1): n x n Gauss points in the
/// plane (1 or more) by m points in the height (1 to 3).
///
/// ```math
/// integral f dx dy dz = integral_0^1 integral_-1^1 integral_-1^1 f(w u, w v, 1 - w) w^2 du dv dw
/// ```
///
/// The rule in w has the weight `w^2`. So the whole is exact for `u^i v^j w^k` with i, j <= 2n - 1 and 0 <= k <= 2m -
/// 1: for polynomials of total degree `2 min(n, m) - 1`, and for the rational shape functions of the pyramid, which are
/// such products. Sources: Stroud (1971), Approximate Calculation of Multiple Integrals, chapter 2; Abramowitz and
/// Stegun (1964), table 25.8.
///
/// # Panics
/// If n = 0, or m is not 1, 2 or 3.
///
/// ```
/// let rule = emmy::internals::quadrature::pyramid(1, 1);
/// assert_eq!(rule.points, [[0.0, 0.0, 0.25]]);
/// assert!((rule.weights[0] - 4.0 / 3.0).abs() < 1e-15);
/// ```
pub fn pyramid(n: usize, m: usize) -> Quadrature<3> {
    let base = square(n);
    let mut rule = Quadrature { points: Vec::new(), weights: Vec::new() };
    for (w, height_weight) in moment_rule(m) {
        for ([u, v], base_weight) in base.iter() {
            rule.points.push([w * u, w * v, 1.0 - w]);
            rule.weights.push(base_weight * height_weight);
        }
    }
    rule
}

/// Points w and weights of the Gauss rule for `integral_0^1 w^2 f(w) dw`.
fn moment_rule(m: usize) -> Vec<(f64, f64)> {
    match m {
        1 => vec![(3.0 / 4.0, 1.0 / 3.0)],
        2 => {
            // Zeros of w^2 - 4/3 w + 2/5, the polynomial orthogonal to 1 and w; weights from the moments 1/3 and 1/4.
            let middle = 2.0 / 3.0;
            let half = (2.0 / 45.0f64).sqrt();
            let difference = (1.0 / 4.0 - middle / 3.0) / (2.0 * half);
            vec![(middle - half, 1.0 / 6.0 - difference), (middle + half, 1.0 / 6.0 + difference)]
        }
        // Zeros of w^3 - 15/8 w^2 + 15/14 w - 5/28, and weights from the moments 1/3, 1/4 and 1/5.
        3 => vec![
            (0.294_997_790_111_501_6, 0.029_950_703_008_580_697),
            (0.652_996_233_961_648_1, 0.146_246_269_259_866_03),
            (0.927_005_975_926_850_3, 0.157_136_361_064_886_6),
        ],
        _ => panic!("there is no conical rule with {m} points in the height; there are 1 to 3"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::conformance::integrates_monomials;
    use super::*;

    /// `integral w^(i + j + 2) (1 - w)^k dw` by the beta function, times the integrals over the base.
    fn exact([i, j, k]: [i32; 3]) -> f64 {
        let line = |p: i32| if p % 2 == 0 { 2.0 / f64::from(p + 1) } else { 0.0 };
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        let n = i + j + 2;
        line(i) * line(j) * factorial(n) * factorial(k) / factorial(n + k + 1)
    }

    #[test]
    fn rules_are_exact_to_their_total_degree() {
        for (n, degree) in [(1, 1), (2, 3), (3, 5)] {
            let range = 0..=degree;
            let exponents = range.clone().flat_map(|i| {
                let range = range.clone();
                range.clone().flat_map(move |j| (0..=degree).map(move |k| [i, j, k]))
            });
            let exponents = exponents.filter(|[i, j, k]| i + j + k <= degree);
            integrates_monomials(&pyramid(n, n), exponents, exact);
        }
    }

    #[test]
    fn rational_functions_of_the_rays_are_integrated_too() {
        // (x y / w)^2 = w^2 u^2 v^2: its integral is (2/3)^2 / 5.
        let square: f64 = pyramid(2, 2).iter().map(|(&[x, y, z], w)| w * (x * y / (1.0 - z)).powi(2)).sum();
        assert!((square - 4.0 / 45.0).abs() < 1e-15);
    }

    #[test]
    fn points_match_the_table() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-10, "{a} is not {b}");
        let rule = moment_rule(2);
        near(rule[0].0, 0.455_848_155_988_8);
        near(rule[1].1, 0.232_547_451_253_5);
    }
}
