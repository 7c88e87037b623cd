//! Triquadratic hexahedron.

use super::kind::{CellInfo, CellShape, FacetKind, LocalFacet, facets};
use super::tensor_product::{CUBE_NODES, gradient, quadratic, shape};
use super::{PressureSpace, ReferenceElement};
use crate::quadrature::{Quadrature, cube};

/// Triquadratic hexahedron on `[-1, 1]^3`, 27 nodes (8 corners, 12 edges, 6 faces, centre), 3x3x3 Gauss points.
///
/// ```math
/// N_A = l_{a_1}(x_1) l_{a_2}(x_2) l_{a_3}(x_3),      l_a(x) = x (x + a)/2 for a = -1, 1,   l_0(x) = 1 - x^2
/// ```
///
/// Source: Hughes (1987), The Finite Element Method, section 3.6. The faces come in the order x-min, x-max, y-min,
/// y-max, z-min, z-max.
///
/// ```
/// use emmy::internals::element::{Hex27, ReferenceElement};
/// assert_eq!(Hex27.nodes()[21], [1.0, 0.0, 0.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hex27;

pub(super) const INFO: CellInfo = CellInfo {
    name: "hex27",
    description: "triquadratic hexahedron, 27 nodes",
    shape: CellShape::Hexahedron,
    n_nodes: 27,
    vtk_type: 29,
    facets: facets![Quad9;
        [0, 4, 7, 3, 16, 15, 19, 11, 20],
        [1, 2, 6, 5, 9, 18, 13, 17, 21],
        [0, 1, 5, 4, 8, 17, 12, 16, 22],
        [3, 7, 6, 2, 19, 14, 18, 10, 23],
        [0, 3, 2, 1, 11, 10, 9, 8, 24],
        [4, 5, 6, 7, 12, 13, 14, 15, 25]],
    element: &Hex27,
    pressures: &[PressureSpace::Linear],
    point_share: 0.0,
    n_modes: 0,
};

impl ReferenceElement<3> for Hex27 {
    fn nodes(&self) -> &'static [[f64; 3]] {
        &CUBE_NODES
    }

    fn shape(&self, xi: [f64; 3], N: &mut [f64]) {
        shape(self.nodes(), quadratic, xi, N);
    }

    fn gradient(&self, xi: [f64; 3], dN: &mut [[f64; 3]]) {
        gradient(self.nodes(), quadratic, xi, dN);
    }

    fn quadrature(&self) -> Quadrature<3> {
        cube(3)
    }
}
