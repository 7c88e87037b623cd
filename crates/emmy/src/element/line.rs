//! Lines: the edges of plane cells, and links.

use super::kind::{CellInfo, CellShape};
use super::tensor_product::{gradient, linear, quadratic, shape};
use super::{ReferenceElement, lifted};
use crate::quadrature::{Quadrature, gauss};

/// Nodes of the lines: the ends, then the middle.
pub(super) const LINE_NODES: [[f64; 1]; 3] = [[-1.0], [1.0], [0.0]];

/// Linear line on `[-1, 1]`: 2 nodes, 2 Gauss points.
///
/// ```math
/// N_A = (1 + a x) / 2,      node A at a
/// ```
///
/// ```
/// use emmy::internals::element::{Line2, ReferenceElement};
/// let mut N = [0.0; 2];
/// Line2.shape([0.5], &mut N);
/// assert_eq!(N, [0.25, 0.75]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Line2;

pub(super) const LINE2: CellInfo = CellInfo {
    name: "line2",
    description: "link: bar, spring or attraction, 2 nodes",
    shape: CellShape::Line,
    n_nodes: 2,
    vtk_type: 3,
    facets: &[],
    element: &lifted::LINK,
    pressures: &[],
    point_share: 0.0,
    n_modes: 0,
};

impl ReferenceElement<1> for Line2 {
    fn nodes(&self) -> &'static [[f64; 1]] {
        &LINE_NODES[..2]
    }

    fn shape(&self, xi: [f64; 1], N: &mut [f64]) {
        shape(self.nodes(), linear, xi, N);
    }

    fn gradient(&self, xi: [f64; 1], dN: &mut [[f64; 1]]) {
        gradient(self.nodes(), linear, xi, dN);
    }

    fn quadrature(&self) -> Quadrature<1> {
        line(2)
    }
}

/// Quadratic line on `[-1, 1]`: its ends and the middle, 3 Gauss points.
///
/// ```math
/// N_A = x (x + a)/2 for a = -1, 1,      N = 1 - x^2 in the middle
/// ```
///
/// ```
/// use emmy::internals::element::{Line3, ReferenceElement};
/// let mut N = [0.0; 3];
/// Line3.shape([0.5], &mut N);
/// assert_eq!(N, [-0.125, 0.375, 0.75]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Line3;

impl ReferenceElement<1> for Line3 {
    fn nodes(&self) -> &'static [[f64; 1]] {
        &LINE_NODES
    }

    fn shape(&self, xi: [f64; 1], N: &mut [f64]) {
        shape(self.nodes(), quadratic, xi, N);
    }

    fn gradient(&self, xi: [f64; 1], dN: &mut [[f64; 1]]) {
        gradient(self.nodes(), quadratic, xi, dN);
    }

    fn quadrature(&self) -> Quadrature<1> {
        line(3)
    }
}

/// Gauss rule on `[-1, 1]`.
pub(super) fn line(n: usize) -> Quadrature<1> {
    let Quadrature { points, weights } = gauss(n);
    Quadrature {
        points: points.into_iter().map(|[x]| [2.0 * x - 1.0]).collect(),
        weights: weights.into_iter().map(|w| 2.0 * w).collect(),
    }
}
