//! Linear pyramid.

use super::kind::{CellInfo, CellShape, FacetKind, LocalFacet, facets};
use super::{PressureSpace, ReferenceElement};
use crate::quadrature::{Quadrature, pyramid};

/// Linear pyramid on the base `[-1, 1]^2` with the apex (0, 0, 1), rational shape functions: 5 nodes, 2x2 points for
/// the internal force, 2x2x2 for the mass.
///
/// ```math
/// N_A = (w + a_1 x_1) (w + a_2 x_2) / (4 w),      w = 1 - x_3,      node A of the base at (a_1, a_2);      N_4 = x_3
/// ```
///
/// On its faces these are the functions of the triangle and the quadrilateral, so pyramids join hexahedra to
/// tetrahedra. The gradients depend on `u = x_1/w, v = x_2/w` alone, that is on the ray from the apex; so do dX/dxi and
/// the deformation gradient. One layer of points in the height therefore integrates the internal force of any pyramid
/// and material as well as many layers. In u and v, `dN_A dN_B det(dX/dxi)` has the degree of the trilinear hexahedron:
/// 2x2 Gauss points are exact for the stiffness of a pyramid over a parallelogram and for the volume of any pyramid.
///
/// At the apex the gradient has no single value; the value along the axis (u = v = 0) is returned. No quadrature point
/// lies there. Source: Bedrosian (1992), IJNME 35, 95-108.
///
/// ```
/// use emmy::internals::element::{Pyramid5, ReferenceElement};
/// let mut N = [0.0; 5];
/// Pyramid5.shape([0.0, 0.0, 0.5], &mut N);
/// assert_eq!(N, [0.125, 0.125, 0.125, 0.125, 0.5]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pyramid5;

pub(super) const INFO: CellInfo = CellInfo {
    name: "pyramid5",
    description: "linear pyramid with rational shape functions, 5 nodes",
    shape: CellShape::Pyramid,
    n_nodes: 5,
    vtk_type: 14,
    // Order of the faces: base, then the sides over the edges 01, 12, 23, 30 of the base.
    facets: facets![
        Quad4[0, 3, 2, 1], Tri3[0, 1, 4], Tri3[1, 2, 4], Tri3[2, 3, 4], Tri3[3, 0, 4]],
    element: &Pyramid5,
    pressures: &[PressureSpace::Constant],
    point_share: 0.0,
    n_modes: 0,
};

const NODES: [[f64; 3]; 5] =
    [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The ray from the apex through a point, `(u, v)`; at the apex itself the axis.
pub(super) fn ray([x, y, z]: [f64; 3]) -> [f64; 2] {
    let w = 1.0 - z;
    if w == 0.0 { [0.0, 0.0] } else { [x / w, y / w] }
}

impl ReferenceElement<3> for Pyramid5 {
    fn nodes(&self) -> &'static [[f64; 3]] {
        &NODES
    }

    fn shape(&self, xi: [f64; 3], N: &mut [f64]) {
        let [u, v] = ray(xi);
        for (N, [a, b, _]) in N.iter_mut().zip(&NODES[..4]) {
            *N = 0.25 * (1.0 - xi[2]) * (1.0 + a * u) * (1.0 + b * v);
        }
        N[4] = xi[2];
    }

    fn gradient(&self, xi: [f64; 3], dN: &mut [[f64; 3]]) {
        let [u, v] = ray(xi);
        for (dN, [a, b, _]) in dN.iter_mut().zip(&NODES[..4]) {
            *dN = [0.25 * a * (1.0 + b * v), 0.25 * b * (1.0 + a * u), 0.25 * (a * b * u * v - 1.0)];
        }
        dN[4] = [0.0, 0.0, 1.0];
    }

    fn quadrature(&self) -> Quadrature<3> {
        pyramid(2, 1)
    }

    fn mass_quadrature(&self) -> Quadrature<3> {
        pyramid(2, 2)
    }
}
