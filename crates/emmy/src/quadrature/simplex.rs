//! Symmetric rules on the triangle and the tetrahedron, all weights positive and all points inside.
//!
//! A rule is a sum of orbits: a point in barycentric coordinates, its permutations, and their common weight.

#![allow(clippy::excessive_precision)] // digits of the sources

use super::Quadrature;

/// Symmetric rule on the triangle (0,0), (1,0), (0,1), exact for polynomials of a total degree: 1, 3, 6 or 7 points
/// for degrees 1, 2, 4 and 5.
///
/// Sources: Strang and Fix (1973), table 4.1 (degree 2); Dunavant (1985), IJNME 21, 1129-1148 (degree 4);
/// Radon (1948), Monatsh. Math. 52, 286-300 (degree 5).
///
/// # Panics
/// If the degree exceeds 5.
///
/// ```
/// let rule = emmy::internals::quadrature::triangle(2);
/// assert_eq!(rule.n_points(), 3);
/// assert!((rule.weights.iter().sum::<f64>() - 0.5).abs() < 1e-16);
/// ```
pub fn triangle(degree: usize) -> Quadrature<2> {
    let mut points = Vec::new();
    let mut vertex = |a: f64, weight: f64| {
        let b = 1.0 - 2.0 * a;
        points.extend([[a, a], [b, a], [a, b]].map(|point| (point, weight)));
    };
    match degree {
        0 | 1 => points.push(([1.0 / 3.0; 2], 1.0)),
        2 => vertex(1.0 / 6.0, 1.0 / 3.0),
        3 | 4 => {
            vertex(0.445_948_490_915_964_886_32, 0.223_381_589_678_011_465_70);
            vertex(0.091_576_213_509_770_743_460, 0.109_951_743_655_321_867_64);
        }
        5 => {
            let root = 15f64.sqrt();
            vertex((6.0 - root) / 21.0, (155.0 - root) / 1200.0);
            vertex((6.0 + root) / 21.0, (155.0 + root) / 1200.0);
            points.push(([1.0 / 3.0; 2], 9.0 / 40.0));
        }
        _ => panic!("there is no triangle rule of degree {degree}; the highest is 5"),
    }
    rule(points, 1.0 / 2.0)
}

/// Symmetric rule on the tetrahedron (0,0,0), (1,0,0), (0,1,0), (0,0,1), exact for polynomials of a total degree:
/// 1, 4 or 14 points for degrees 1, 2 and 5.
///
/// Sources: Hammer and Stroud (1956), MTAC 10, 137-139 (degree 2); Walkington (2000), Quadrature on simplices of
/// arbitrary dimension, after Grundmann and Moeller (1978), SIAM J. Numer. Anal. 15, 282-290 (degree 5).
///
/// # Panics
/// If the degree exceeds 5.
///
/// ```
/// let rule = emmy::internals::quadrature::tetrahedron(5);
/// assert_eq!(rule.n_points(), 14);
/// assert!((rule.weights.iter().sum::<f64>() - 1.0 / 6.0).abs() < 1e-16);
/// ```
pub fn tetrahedron(degree: usize) -> Quadrature<3> {
    let mut points = Vec::new();
    match degree {
        0 | 1 => points.push(([1.0 / 4.0; 3], 1.0)),
        2 => points.extend(vertex_orbit((5.0 - 5f64.sqrt()) / 20.0, 1.0 / 4.0)),
        3..=5 => {
            points.extend(vertex_orbit(0.310_885_919_263_300_609_80, 0.112_687_925_718_015_850_80));
            points.extend(vertex_orbit(0.092_735_250_310_891_226_402, 0.073_493_043_116_361_949_544));
            points.extend(edge_orbit(0.045_503_704_125_649_649_492, 0.042_546_020_777_081_466_438));
        }
        _ => panic!("there is no tetrahedron rule of degree {degree}; the highest is 5"),
    }
    rule(points, 1.0 / 6.0)
}

/// The four points with barycentric coordinates (a, a, a, 1 - 3a) and their weight.
fn vertex_orbit(a: f64, weight: f64) -> [([f64; 3], f64); 4] {
    let b = 1.0 - 3.0 * a;
    [[a, a, a], [b, a, a], [a, b, a], [a, a, b]].map(|point| (point, weight))
}

/// The six points with barycentric coordinates (a, a, 1/2 - a, 1/2 - a) and their weight.
fn edge_orbit(a: f64, weight: f64) -> [([f64; 3], f64); 6] {
    let b = 0.5 - a;
    [[b, a, a], [a, b, a], [a, a, b], [a, b, b], [b, a, b], [b, b, a]].map(|point| (point, weight))
}

/// Rule whose weights, given for a domain of measure one, are scaled to its measure.
fn rule<const D: usize>(points: Vec<([f64; D], f64)>, measure: f64) -> Quadrature<D> {
    let (points, weights) = points.into_iter().map(|(point, weight)| (point, weight * measure)).unzip();
    Quadrature { points, weights }
}

#[cfg(test)]
mod tests {
    use super::super::conformance::integrates_monomials;
    use super::*;

    fn factorial(n: i32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    /// Integral of a monomial over the reference simplex: `i! j! k! / (i + j + k + D)!`.
    fn exact<const D: usize>(exponent: [i32; D]) -> f64 {
        exponent.map(factorial).iter().product::<f64>() / factorial(exponent.iter().sum::<i32>() + D as i32)
    }

    fn exponents<const D: usize>(degree: i32) -> impl Iterator<Item = [i32; D]> {
        let n = degree + 1;
        (0..n.pow(D as u32))
            .map(move |index| std::array::from_fn(|i| index / n.pow(i as u32) % n))
            .filter(move |exponent: &[i32; D]| exponent.iter().sum::<i32>() <= degree)
    }

    #[test]
    fn triangle_rules_are_exact_to_their_degree() {
        for (degree, n_points) in [(1, 1), (2, 3), (4, 6), (5, 7)] {
            let rule = triangle(degree as usize);
            assert_eq!(rule.n_points(), n_points);
            integrates_monomials(&rule, exponents(degree), exact);
        }
    }

    #[test]
    fn tetrahedron_rules_are_exact_to_their_degree() {
        for (degree, n_points) in [(1, 1), (2, 4), (5, 14)] {
            let rule = tetrahedron(degree as usize);
            assert_eq!(rule.n_points(), n_points);
            integrates_monomials(&rule, exponents(degree), exact);
        }
    }

    /// Every exchange of two vertices maps the rule onto itself.
    fn is_symmetric<const D: usize>(rule: &Quadrature<D>) {
        for i in 0..=D {
            for j in 0..i {
                for (x, w) in rule.iter() {
                    let mut image: Vec<f64> =
                        std::iter::once(1.0 - x.iter().sum::<f64>()).chain(*x).collect();
                    image.swap(i, j);
                    let near = |y: &[f64; D]| (0..D).all(|d| (y[d] - image[d + 1]).abs() < 1e-15);
                    assert!(rule.iter().any(|(y, v)| near(y) && v == w));
                    assert!(image.iter().all(|&b| b > 0.0), "a point lies outside");
                }
            }
        }
    }

    #[test]
    fn rules_are_symmetric_in_the_vertices_and_lie_inside() {
        [1, 2, 4, 5].into_iter().for_each(|degree| is_symmetric(&triangle(degree)));
        [1, 2, 5].into_iter().for_each(|degree| is_symmetric(&tetrahedron(degree)));
    }
}
