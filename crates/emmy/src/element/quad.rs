//! Quadrilaterals: the facets of hexahedra.
//!
//! The vector area (the cross product of two tangents) of a curved facet has degree 2p - 1 in each coordinate for shape
//! functions of degree p, so with one more shape function a pressure needs degree 3p - 1, 2 or 5. The Gauss rules with
//! p + 1 points, exact to degree 2p + 1, integrate it exactly, and also products of two shape functions on flat facets.

use super::kind::{CellInfo, CellShape, FacetKind, LocalFacet, facets};
use super::tensor_product::{
    SQUARE_NODES, gradient, linear, quadratic, serendipity_gradient, serendipity_shape, shape,
};
use super::{PressureSpace, ReferenceElement, lifted};
use crate::quadrature::{Quadrature, square};

/// Bilinear quadrilateral on `[-1, 1]^2`: 4 nodes, 2x2 Gauss points.
///
/// ```math
/// N_A = (1 + a_1 x_1) (1 + a_2 x_2) / 4,      node A at (a_1, a_2)
/// ```
///
/// ```
/// use emmy::internals::element::{Quad4, ReferenceElement};
/// let mut N = [0.0; 4];
/// Quad4.shape([0.5, 0.0], &mut N);
/// assert_eq!(N, [0.125, 0.375, 0.375, 0.125]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quad4;

pub(super) const QUAD4: CellInfo = CellInfo {
    name: "quad4",
    description: "bilinear quadrilateral in plane strain, 4 nodes",
    shape: CellShape::Quadrilateral,
    n_nodes: 4,
    vtk_type: 9,
    facets: facets![Line2; [0, 1], [1, 2], [2, 3], [3, 0]],
    element: &lifted::QUAD4,
    pressures: &[PressureSpace::Constant],
    point_share: 0.0,
    n_modes: 2,
};

impl ReferenceElement<2> for Quad4 {
    fn nodes(&self) -> &'static [[f64; 2]] {
        &SQUARE_NODES[..4]
    }

    fn shape(&self, xi: [f64; 2], N: &mut [f64]) {
        shape(self.nodes(), linear, xi, N);
    }

    fn gradient(&self, xi: [f64; 2], dN: &mut [[f64; 2]]) {
        gradient(self.nodes(), linear, xi, dN);
    }

    fn quadrature(&self) -> Quadrature<2> {
        square(2)
    }
}

/// Serendipity quadrilateral on `[-1, 1]^2`: 4 corners and 4 edges, 3x3 Gauss points.
///
/// ```math
/// corner: N_A = (1 + a_1 x_1) (1 + a_2 x_2) (a_1 x_1 + a_2 x_2 - 1) / 4
/// edge along 1: N_A = (1 - x_1^2) (1 + a_2 x_2) / 2
/// ```
///
/// ```
/// use emmy::internals::element::{Quad8, ReferenceElement};
/// let mut N = [0.0; 8];
/// Quad8.shape([0.0, 0.0], &mut N);
/// assert_eq!((N[0], N[4]), (-0.25, 0.5));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quad8;

const EDGES: &[LocalFacet] = facets![Line3; [0, 1, 4], [1, 2, 5], [2, 3, 6], [3, 0, 7]];

pub(super) const QUAD8: CellInfo = CellInfo {
    name: "quad8",
    description: "serendipity quadrilateral in plane strain, 8 nodes",
    shape: CellShape::Quadrilateral,
    n_nodes: 8,
    vtk_type: 23,
    facets: EDGES,
    element: &lifted::QUAD8,
    pressures: &[PressureSpace::Linear, PressureSpace::Constant],
    point_share: 0.0,
    n_modes: 0,
};

impl ReferenceElement<2> for Quad8 {
    fn nodes(&self) -> &'static [[f64; 2]] {
        &SQUARE_NODES[..8]
    }

    fn shape(&self, xi: [f64; 2], N: &mut [f64]) {
        serendipity_shape(self.nodes(), xi, N);
    }

    fn gradient(&self, xi: [f64; 2], dN: &mut [[f64; 2]]) {
        serendipity_gradient(self.nodes(), xi, dN);
    }

    fn quadrature(&self) -> Quadrature<2> {
        square(3)
    }
}

/// Biquadratic quadrilateral on `[-1, 1]^2`: 4 corners, 4 edges and the centre, 3x3 Gauss points.
///
/// ```math
/// N_A = l_{a_1}(x_1) l_{a_2}(x_2),      l_a(x) = x (x + a)/2 for a = -1, 1,   l_0(x) = 1 - x^2
/// ```
///
/// ```
/// use emmy::internals::element::{Quad9, ReferenceElement};
/// let mut N = [0.0; 9];
/// Quad9.shape([0.5, 0.0], &mut N);
/// assert_eq!((N[1], N[5], N[8]), (0.0, 0.375, 0.75));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quad9;

pub(super) const QUAD9: CellInfo = CellInfo {
    name: "quad9",
    description: "biquadratic quadrilateral in plane strain, 9 nodes",
    shape: CellShape::Quadrilateral,
    n_nodes: 9,
    vtk_type: 28,
    facets: EDGES,
    element: &lifted::QUAD9,
    pressures: &[PressureSpace::Linear, PressureSpace::Constant],
    point_share: 0.0,
    n_modes: 0,
};

impl ReferenceElement<2> for Quad9 {
    fn nodes(&self) -> &'static [[f64; 2]] {
        &SQUARE_NODES
    }

    fn shape(&self, xi: [f64; 2], N: &mut [f64]) {
        shape(self.nodes(), quadratic, xi, N);
    }

    fn gradient(&self, xi: [f64; 2], dN: &mut [[f64; 2]]) {
        gradient(self.nodes(), quadratic, xi, dN);
    }

    fn quadrature(&self) -> Quadrature<2> {
        square(3)
    }
}
