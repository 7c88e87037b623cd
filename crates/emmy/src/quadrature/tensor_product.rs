//! Products of Gauss rules on the square and the cube.

use super::{Quadrature, gauss};

/// Product of n-point Gauss rules on the square `[-1, 1]^2`: exact to degree 2n - 1 in each coordinate.
///
/// ```
/// assert_eq!(emmy::internals::quadrature::square(2).weights, [1.0; 4]);
/// ```
pub fn square(n: usize) -> Quadrature<2> {
    product(n)
}

/// Product of n-point Gauss rules on the cube `[-1, 1]^3`: exact to degree 2n - 1 in each coordinate.
///
/// ```
/// assert_eq!(emmy::internals::quadrature::cube(1).points, [[0.0; 3]]);
/// assert_eq!(emmy::internals::quadrature::cube(2).weights, [1.0; 8]);
/// ```
pub fn cube(n: usize) -> Quadrature<3> {
    product(n)
}

/// Points with the first coordinate running fastest.
fn product<const D: usize>(n: usize) -> Quadrature<D> {
    let line = gauss(n);
    let digits = |index: usize| std::array::from_fn::<usize, D, _>(|i| index / n.pow(i as u32) % n);
    let indices = || (0..n.pow(D as u32)).map(digits);
    Quadrature {
        points: indices().map(|digits| digits.map(|d| 2.0 * line.points[d][0] - 1.0)).collect(),
        weights: indices().map(|digits| digits.map(|d| 2.0 * line.weights[d]).iter().product()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::conformance::integrates_monomials;
    use super::*;

    /// Integral of `x^p` over `[-1, 1]`.
    fn line(p: i32) -> f64 {
        if p % 2 == 0 { 2.0 / f64::from(p + 1) } else { 0.0 }
    }

    #[test]
    fn products_are_exact_to_degree_2n_minus_1_in_each_coordinate() {
        for n in 1..=4 {
            let degrees = 0..2 * n as i32;
            let pairs: Vec<_> = degrees.clone().flat_map(|i| degrees.clone().map(move |j| [i, j])).collect();
            integrates_monomials(&scaled(square(n)), pairs.iter().copied(), |[i, j]| line(i) * line(j) / 4.0);
            let triples = pairs.iter().flat_map(|&[i, j]| degrees.clone().map(move |k| [i, j, k]));
            integrates_monomials(&scaled(cube(n)), triples, |[i, j, k]| line(i) * line(j) * line(k) / 8.0);
        }
    }

    /// The rule with weights that sum to one, so that one tolerance fits all.
    fn scaled<const D: usize>(mut rule: Quadrature<D>) -> Quadrature<D> {
        rule.weights.iter_mut().for_each(|w| *w /= 2f64.powi(D as i32));
        rule
    }
}
