//! Quadrature rules, in space and in time.

/// Points and weights on a reference domain of dimension `D`.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature<const D: usize> {
    /// Points of the reference domain.
    pub points: Vec<[f64; D]>,
    /// Weights; they sum to the measure of the domain.
    pub weights: Vec<f64>,
}
