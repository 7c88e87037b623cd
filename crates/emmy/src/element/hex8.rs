//! Trilinear hexahedron.

use super::kind::{CellInfo, CellShape, FacetKind, LocalFacet, facets};
use super::tensor_product::{CUBE_NODES, gradient, linear, shape};
use super::{PressureSpace, ReferenceElement};
use crate::quadrature::{Quadrature, cube};

/// Trilinear hexahedron on `[-1, 1]^3`, 8 nodes, 2x2x2 Gauss points.
///
/// ```math
/// N_A = (1 + a_1 x_1) (1 + a_2 x_2) (1 + a_3 x_3) / 8,      node A at (a_1, a_2, a_3)
/// ```
///
/// Source: Hughes (1987), The Finite Element Method, section 3.5.
///
/// ```
/// use emmy::internals::element::{Hex8, ReferenceElement};
/// let mut dN = [[0.0; 3]; 8];
/// Hex8.gradient([0.0; 3], &mut dN);
/// assert_eq!(dN[6], [0.125; 3]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hex8;

pub(super) const INFO: CellInfo = CellInfo {
    name: "hex8",
    description: "trilinear hexahedron, 8 nodes",
    shape: CellShape::Hexahedron,
    n_nodes: 8,
    vtk_type: 12,
    // Order of the faces: x-min, x-max, y-min, y-max, z-min, z-max of the reference cube.
    facets: facets![Quad4;
        [0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]],
    element: &Hex8,
    pressures: &[PressureSpace::Constant],
    point_share: 0.0,
    n_modes: 3,
};

impl ReferenceElement<3> for Hex8 {
    fn nodes(&self) -> &'static [[f64; 3]] {
        &CUBE_NODES[..8]
    }

    fn shape(&self, xi: [f64; 3], N: &mut [f64]) {
        shape(self.nodes(), linear, xi, N);
    }

    fn gradient(&self, xi: [f64; 3], dN: &mut [[f64; 3]]) {
        gradient(self.nodes(), linear, xi, dN);
    }

    fn quadrature(&self) -> Quadrature<3> {
        cube(2)
    }
}
