//! Serendipity wedge.

use super::kind::{CellInfo, CellShape, FacetKind, LocalFacet, facets};
use super::wedge::{WEDGE_NODES, linear, quadratic};
use super::{PressureSpace, ReferenceElement};
use crate::quadrature::{Quadrature, wedge};

/// Serendipity wedge on the triangle (0,0), (1,0), (0,1) by `[-1, 1]`: 15 nodes (6 corners, 9 edges), complete to
/// degree 2, 6x3 points.
///
/// With the linear and quadratic functions b_i, q_i of the triangle, and a = -1 in the base, 1 in the top:
///
/// ```math
/// edge of base or top: N_A = q_i (1 + a x_3)/2,      edge between them: N_A = b_i (1 - x_3^2)
/// corner: N_A = q_i (1 + a x_3)/2 - b_i (1 - x_3^2)/2
/// ```
///
/// The edges come in the order 01, 12, 20, 34, 45, 53, 03, 14, 25. The rule, of degree 4 in the triangle by 3 Gauss
/// points, is exact for stiffness and mass of an undistorted wedge. Source: Zienkiewicz and Taylor (2000), The Finite
/// Element Method, volume 1, chapter 8.
///
/// ```
/// use emmy::internals::element::{ReferenceElement, Wedge15};
/// let mut N = [0.0; 15];
/// Wedge15.shape([0.5, 0.0, 0.0], &mut N);
/// assert_eq!((N[0], N[6], N[12]), (-0.25, 0.5, 0.5));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wedge15;

pub(super) const INFO: CellInfo = CellInfo {
    name: "wedge15",
    description: "serendipity wedge, 15 nodes",
    shape: CellShape::Wedge,
    n_nodes: 15,
    vtk_type: 26,
    facets: facets![
        Tri6[0, 2, 1, 8, 7, 6],
        Tri6[3, 4, 5, 9, 10, 11],
        Quad8[0, 1, 4, 3, 6, 13, 9, 12],
        Quad8[1, 2, 5, 4, 7, 14, 10, 13],
        Quad8[2, 0, 3, 5, 8, 12, 11, 14]],
    element: &Wedge15,
    pressures: &[PressureSpace::Linear],
    point_share: 0.0,
    n_modes: 0,
};

impl ReferenceElement<3> for Wedge15 {
    fn nodes(&self) -> &'static [[f64; 3]] {
        &WEDGE_NODES
    }

    fn shape(&self, xi: [f64; 3], N: &mut [f64]) {
        let (b, _) = linear(xi);
        let (q, _) = quadratic(xi);
        let bubble = 1.0 - xi[2] * xi[2];
        for A in 0..6 {
            let height = 0.5 * (1.0 + WEDGE_NODES[A][2] * xi[2]);
            N[A] = q[A % 3] * height - 0.5 * b[A % 3] * bubble;
            N[6 + A] = q[3 + A % 3] * height;
        }
        (0..3).for_each(|i| N[12 + i] = b[i] * bubble);
    }

    fn gradient(&self, xi: [f64; 3], dN: &mut [[f64; 3]]) {
        let (b, db) = linear(xi);
        let (q, dq) = quadratic(xi);
        let bubble = 1.0 - xi[2] * xi[2];
        let slope = -2.0 * xi[2];
        for i in 0..3 {
            dN[12 + i] = [db[i][0] * bubble, db[i][1] * bubble, b[i] * slope];
        }
        for A in 0..6 {
            let i = A % 3;
            let a = WEDGE_NODES[A][2];
            let height = 0.5 * (1.0 + a * xi[2]);
            let product = |j: usize| [dq[j][0] * height, dq[j][1] * height, 0.5 * a * q[j]];
            let corner = product(i);
            let side = dN[12 + i];
            dN[A] = [0, 1, 2].map(|d| corner[d] - 0.5 * side[d]);
            dN[6 + A] = product(3 + i);
        }
    }

    fn quadrature(&self) -> Quadrature<3> {
        wedge(4, 3)
    }
}
