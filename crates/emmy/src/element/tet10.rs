//! Quadratic tetrahedron.

use super::kind::{CellInfo, CellShape, FacetKind, LocalFacet, facets};
use super::simplex::{TETRAHEDRON_NODES, quadratic_gradient, quadratic_shape};
use super::{PressureSpace, ReferenceElement};
use crate::quadrature::{Quadrature, tetrahedron};

/// Quadratic tetrahedron (0,0,0), (1,0,0), (0,1,0), (0,0,1): 4 vertices and 6 edges, 4 points for the internal force,
/// 14 for the mass.
///
/// ```math
/// vertex: N_i = b_i (2 b_i - 1),      edge: N_ij = 4 b_i b_j,      b = (1 - x_1 - x_2 - x_3, x_1, x_2, x_3)
/// ```
///
/// Source: Hughes (1987), The Finite Element Method, appendix 3.I. The edges come in the order 01, 12, 20, 03, 13, 23.
///
/// ```
/// use emmy::internals::element::{ReferenceElement, Tet10};
/// let mut N = [0.0; 10];
/// Tet10.shape([0.25; 3], &mut N);
/// assert_eq!((N[0], N[9]), (-0.125, 0.25));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tet10;

pub(super) const INFO: CellInfo = CellInfo {
    name: "tet10",
    description: "quadratic tetrahedron, 10 nodes",
    shape: CellShape::Tetrahedron,
    n_nodes: 10,
    vtk_type: 24,
    facets: facets![Tri6;
        [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6], [0, 1, 3, 4, 8, 7], [0, 2, 1, 6, 5, 4]],
    element: &Tet10,
    pressures: &[PressureSpace::Constant],
    point_share: 2.0 / 3.0,
    n_modes: 0,
};

impl ReferenceElement<3> for Tet10 {
    fn nodes(&self) -> &'static [[f64; 3]] {
        &TETRAHEDRON_NODES
    }

    fn shape(&self, xi: [f64; 3], N: &mut [f64]) {
        quadratic_shape(xi, N);
    }

    fn gradient(&self, xi: [f64; 3], dN: &mut [[f64; 3]]) {
        quadratic_gradient(xi, dN);
    }

    fn quadrature(&self) -> Quadrature<3> {
        tetrahedron(2)
    }

    fn mass_quadrature(&self) -> Quadrature<3> {
        tetrahedron(5)
    }
}
