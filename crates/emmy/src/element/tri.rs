//! Triangles: the facets of tetrahedra.

use super::kind::{CellInfo, CellShape, FacetKind, LocalFacet, facets};
use super::simplex::{TRIANGLE_NODES, linear_gradient, linear_shape, quadratic_gradient, quadratic_shape};
use super::{PressureSpace, ReferenceElement, lifted};
use crate::quadrature::{Quadrature, triangle};

/// Linear triangle (0,0), (1,0), (0,1): 3 nodes, 3 quadrature points.
///
/// Its quadrature has degree 2, so that a traction interpolated from the nodes is integrated exactly.
///
/// ```math
/// N = (1 - x_1 - x_2, x_1, x_2)
/// ```
///
/// ```
/// use emmy::internals::element::{ReferenceElement, Tri3};
/// let mut N = [0.0; 3];
/// Tri3.shape([0.5, 0.25], &mut N);
/// assert_eq!(N, [0.25, 0.5, 0.25]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tri3;

pub(super) const TRI3: CellInfo = CellInfo {
    name: "tri3",
    description: "linear triangle in plane strain, 3 nodes",
    shape: CellShape::Triangle,
    n_nodes: 3,
    vtk_type: 5,
    facets: facets![Line2; [0, 1], [1, 2], [2, 0]],
    element: &lifted::TRI3,
    pressures: &[],
    point_share: 0.0,
    n_modes: 0,
};

impl ReferenceElement<2> for Tri3 {
    fn nodes(&self) -> &'static [[f64; 2]] {
        &TRIANGLE_NODES[..3]
    }

    fn shape(&self, xi: [f64; 2], N: &mut [f64]) {
        linear_shape(xi, N);
    }

    fn gradient(&self, _: [f64; 2], dN: &mut [[f64; 2]]) {
        linear_gradient(dN);
    }

    fn quadrature(&self) -> Quadrature<2> {
        triangle(2)
    }
}

/// Quadratic triangle (0,0), (1,0), (0,1): 3 vertices and 3 edges, 6 quadrature points.
///
/// Its quadrature has degree 4: exact for a pressure on a curved facet, whose vector area (the cross product of two
/// tangents) has degree 2, as well as for a traction interpolated from the nodes of a straight one.
///
/// ```math
/// vertex: N_i = b_i (2 b_i - 1),      edge: N_ij = 4 b_i b_j,      b = (1 - x_1 - x_2, x_1, x_2)
/// ```
///
/// ```
/// use emmy::internals::element::{ReferenceElement, Tri6};
/// let mut N = [0.0; 6];
/// Tri6.shape([0.25, 0.25], &mut N);
/// assert_eq!((N[0], N[4]), (0.0, 0.25));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tri6;

pub(super) const TRI6: CellInfo = CellInfo {
    name: "tri6",
    description: "quadratic triangle in plane strain, 6 nodes",
    shape: CellShape::Triangle,
    n_nodes: 6,
    vtk_type: 22,
    facets: facets![Line3; [0, 1, 3], [1, 2, 4], [2, 0, 5]],
    element: &lifted::TRI6,
    pressures: &[PressureSpace::Constant],
    point_share: 0.0,
    n_modes: 0,
};

impl ReferenceElement<2> for Tri6 {
    fn nodes(&self) -> &'static [[f64; 2]] {
        &TRIANGLE_NODES
    }

    fn shape(&self, xi: [f64; 2], N: &mut [f64]) {
        quadratic_shape(xi, N);
    }

    fn gradient(&self, xi: [f64; 2], dN: &mut [[f64; 2]]) {
        quadratic_gradient(xi, dN);
    }

    fn quadrature(&self) -> Quadrature<2> {
        triangle(4)
    }
}
