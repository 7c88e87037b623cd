//! Linear tetrahedron.

use super::ReferenceElement;
use super::kind::{CellInfo, CellShape, FacetKind, LocalFacet, facets};
use super::simplex::{TETRAHEDRON_NODES, linear_gradient, linear_shape};
use crate::quadrature::{Quadrature, tetrahedron};

/// Linear tetrahedron (0,0,0), (1,0,0), (0,1,0), (0,0,1): 4 nodes, one point for the internal force, 4 for the mass.
///
/// ```math
/// N_0 = 1 - x_1 - x_2 - x_3,      N_i = x_i
/// ```
///
/// Source: Hughes (1987), The Finite Element Method, appendix 3.I.
///
/// ```
/// use emmy::internals::element::{ReferenceElement, Tet4};
/// assert_eq!(Tet4.quadrature().points, [[0.25; 3]]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tet4;

pub(super) const INFO: CellInfo = CellInfo {
    name: "tet4",
    description: "linear tetrahedron, 4 nodes",
    shape: CellShape::Tetrahedron,
    n_nodes: 4,
    vtk_type: 10,
    facets: facets![Tri3; [1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]],
    element: &Tet4,
    pressures: &[],
    point_share: 0.0,
    n_modes: 0,
};

impl ReferenceElement<3> for Tet4 {
    fn nodes(&self) -> &'static [[f64; 3]] {
        &TETRAHEDRON_NODES[..4]
    }

    fn shape(&self, xi: [f64; 3], N: &mut [f64]) {
        linear_shape(xi, N);
    }

    fn gradient(&self, _: [f64; 3], dN: &mut [[f64; 3]]) {
        linear_gradient(dN);
    }

    fn quadrature(&self) -> Quadrature<3> {
        tetrahedron(1)
    }

    fn mass_quadrature(&self) -> Quadrature<3> {
        tetrahedron(2)
    }
}
