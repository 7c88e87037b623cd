//! Serendipity hexahedron.

use super::kind::{CellInfo, CellShape, FacetKind, LocalFacet, facets};
use super::tensor_product::{CUBE_NODES, serendipity_gradient, serendipity_shape};
use super::{PressureSpace, ReferenceElement};
use crate::quadrature::{Quadrature, cube};

/// Serendipity hexahedron on `[-1, 1]^3`, 20 nodes (8 corners, 12 edges), complete to degree 2, 3x3x3 Gauss points.
///
/// ```math
/// corner: N_A = prod_i (1 + a_i x_i)/2 (a_1 x_1 + a_2 x_2 + a_3 x_3 - 2)
/// edge along j: N_A = (1 - x_j^2) prod_{i != j} (1 + a_i x_i)/2
/// ```
///
/// Source: Zienkiewicz and Taylor (2000), The Finite Element Method, volume 1, section 8.11.
///
/// ```
/// use emmy::internals::element::{Hex20, ReferenceElement};
/// let mut N = [0.0; 20];
/// Hex20.shape([0.0; 3], &mut N);
/// assert_eq!((N[0], N[8]), (-0.25, 0.25));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hex20;

pub(super) const INFO: CellInfo = CellInfo {
    name: "hex20",
    description: "serendipity hexahedron, 20 nodes",
    shape: CellShape::Hexahedron,
    n_nodes: 20,
    vtk_type: 25,
    facets: facets![Quad8;
        [0, 4, 7, 3, 16, 15, 19, 11],
        [1, 2, 6, 5, 9, 18, 13, 17],
        [0, 1, 5, 4, 8, 17, 12, 16],
        [3, 7, 6, 2, 19, 14, 18, 10],
        [0, 3, 2, 1, 11, 10, 9, 8],
        [4, 5, 6, 7, 12, 13, 14, 15]],
    element: &Hex20,
    pressures: &[PressureSpace::Linear],
    point_share: 0.0,
    n_modes: 0,
};

impl ReferenceElement<3> for Hex20 {
    fn nodes(&self) -> &'static [[f64; 3]] {
        &CUBE_NODES[..20]
    }

    fn shape(&self, xi: [f64; 3], N: &mut [f64]) {
        serendipity_shape(self.nodes(), xi, N);
    }

    fn gradient(&self, xi: [f64; 3], dN: &mut [[f64; 3]]) {
        serendipity_gradient(self.nodes(), xi, dN);
    }

    fn quadrature(&self) -> Quadrature<3> {
        cube(3)
    }
}
