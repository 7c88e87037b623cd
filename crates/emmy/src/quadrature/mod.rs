//! Quadrature rules, in space and in time.

mod interval;
mod pyramid;
mod simplex;
mod tensor_product;
mod wedge;

pub use interval::{gauss, lobatto};
pub use pyramid::pyramid;
pub use simplex::{tetrahedron, triangle};
pub use tensor_product::{cube, square};
pub use wedge::wedge;

/// Points and weights on a reference domain of dimension `D`.
///
/// ```
/// let rule = emmy::internals::quadrature::gauss(2);
/// let integral: f64 = rule.points.iter().zip(&rule.weights).map(|([x], w)| w * x.powi(3)).sum();
/// assert!((integral - 0.25).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature<const D: usize> {
    /// Points of the reference domain.
    pub points: Vec<[f64; D]>,
    /// Weights; they sum to the measure of the domain.
    pub weights: Vec<f64>,
}

impl<const D: usize> Quadrature<D> {
    /// Number of points.
    pub fn n_points(&self) -> usize {
        self.weights.len()
    }

    /// Points with their weights.
    pub fn iter(&self) -> impl Iterator<Item = (&[f64; D], f64)> {
        self.points.iter().zip(self.weights.iter().copied())
    }
}

#[cfg(test)]
mod conformance {
    use super::Quadrature;

    /// Checks a rule against the integrals of all monomials up to a degree (of each factor, or in total).
    pub(super) fn integrates_monomials<const D: usize>(
        rule: &Quadrature<D>,
        exponents: impl Iterator<Item = [i32; D]>,
        exact: impl Fn([i32; D]) -> f64,
    ) {
        assert_eq!(rule.points.len(), rule.weights.len());
        assert!(rule.weights.iter().all(|&w| w > 0.0), "a weight is not positive");
        for exponent in exponents {
            let monomial = |x: &[f64; D]| (0..D).map(|i| x[i].powi(exponent[i])).product::<f64>();
            let integral: f64 = rule.iter().map(|(x, w)| w * monomial(x)).sum();
            let error = integral - exact(exponent);
            assert!(error.abs() < 1e-15, "{} points, {exponent:?}: error {error:e}", rule.n_points());
        }
    }
}
