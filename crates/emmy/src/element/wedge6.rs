//! Linear wedge.

use super::kind::{CellInfo, CellShape, FacetKind, LocalFacet, facets};
use super::wedge::{WEDGE_NODES, linear};
use super::{PressureSpace, ReferenceElement};
use crate::quadrature::{Quadrature, wedge};

/// Linear wedge (prism) on the triangle (0,0), (1,0), (0,1) by `[-1, 1]`: 6 nodes, 3x2 points.
///
/// ```math
/// N_A = b_i(x_1, x_2) (1 + a x_3)/2,      b = (1 - x_1 - x_2, x_1, x_2),      a = -1 in the base, 1 in the top
/// ```
///
/// The rule, of degree 2 in the triangle by 2 Gauss points, is exact for stiffness and mass of an undistorted wedge.
/// Source: Hughes (1987), The Finite Element Method, chapter 3.
///
/// ```
/// use emmy::internals::element::{ReferenceElement, Wedge6};
/// let mut N = [0.0; 6];
/// Wedge6.shape([0.25, 0.25, 0.0], &mut N);
/// assert_eq!(N, [0.25, 0.125, 0.125, 0.25, 0.125, 0.125]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wedge6;

pub(super) const INFO: CellInfo = CellInfo {
    name: "wedge6",
    description: "linear wedge, 6 nodes",
    shape: CellShape::Wedge,
    n_nodes: 6,
    vtk_type: 13,
    // Order of the faces: base, top, then the sides over the edges 01, 12, 20 of the base.
    facets: facets![
        Tri3[0, 2, 1], Tri3[3, 4, 5], Quad4[0, 1, 4, 3], Quad4[1, 2, 5, 4], Quad4[2, 0, 3, 5]],
    element: &Wedge6,
    pressures: &[PressureSpace::Constant],
    point_share: 0.0,
    n_modes: 0,
};

impl ReferenceElement<3> for Wedge6 {
    fn nodes(&self) -> &'static [[f64; 3]] {
        &WEDGE_NODES[..6]
    }

    fn shape(&self, xi: [f64; 3], N: &mut [f64]) {
        let (b, _) = linear(xi);
        for (A, N) in N.iter_mut().enumerate() {
            *N = b[A % 3] * 0.5 * (1.0 + WEDGE_NODES[A][2] * xi[2]);
        }
    }

    fn gradient(&self, xi: [f64; 3], dN: &mut [[f64; 3]]) {
        let (b, db) = linear(xi);
        for (A, dN) in dN.iter_mut().enumerate() {
            let i = A % 3;
            let a = WEDGE_NODES[A][2];
            let height = 0.5 * (1.0 + a * xi[2]);
            *dN = [db[i][0] * height, db[i][1] * height, 0.5 * a * b[i]];
        }
    }

    fn quadrature(&self) -> Quadrature<3> {
        wedge(2, 2)
    }
}
