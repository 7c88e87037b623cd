//! Rules on the wedge: a triangle by an interval.

use super::{Quadrature, gauss, triangle};

/// Product of a triangle rule and an n-point Gauss rule on the wedge, the triangle (0,0), (1,0), (0,1) by `[-1, 1]`:
/// exact to a total degree in the first two coordinates and to degree 2n - 1 in the third.
///
/// # Panics
/// If the degree exceeds 5 or n = 0.
///
/// ```
/// let rule = emmy::internals::quadrature::wedge(2, 2);
/// assert_eq!(rule.n_points(), 6);
/// assert!((rule.weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
/// ```
pub fn wedge(degree: usize, n: usize) -> Quadrature<3> {
    let plane = triangle(degree);
    let line = gauss(n);
    let mut rule = Quadrature { points: Vec::new(), weights: Vec::new() };
    for ([t], w) in line.iter() {
        for ([x, y], v) in plane.iter() {
            rule.points.push([*x, *y, 2.0 * t - 1.0]);
            rule.weights.push(2.0 * v * w);
        }
    }
    rule
}

#[cfg(test)]
mod tests {
    use super::super::conformance::integrates_monomials;
    use super::*;

    /// `integral x^i y^j z^k = i! j! / (i + j + 2)! 2 / (k + 1)` for even k.
    fn exact([i, j, k]: [i32; 3]) -> f64 {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        let line = if k % 2 == 0 { 2.0 / f64::from(k + 1) } else { 0.0 };
        factorial(i) * factorial(j) / factorial(i + j + 2) * line
    }

    #[test]
    fn products_are_exact_to_the_degrees_of_their_factors() {
        for (degree, n) in [(1, 1), (2, 2), (4, 3), (5, 4)] {
            let plane = (0..=degree).flat_map(|i| (0..=degree - i).map(move |j| [i, j]));
            let exponents = plane.flat_map(|[i, j]| (0..2 * n).map(move |k| [i, j, k]));
            integrates_monomials(&wedge(degree as usize, n as usize), exponents, exact);
        }
    }
}
