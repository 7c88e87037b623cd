//! Quadratic pyramid.

use super::kind::{CellInfo, CellShape, FacetKind, LocalFacet, facets};
use super::pyramid5::ray;
use super::{PressureSpace, ReferenceElement};
use crate::quadrature::{Quadrature, pyramid};

/// Serendipity pyramid on the base `[-1, 1]^2` with the apex (0, 0, 1), rational shape functions: 13 nodes, 3x3x2
/// points for the internal force, 3x3x3 for the mass.
///
/// ```math
/// corner of the base:   N_A = (a_1 x_1 + a_2 x_2 - 1) (w + a_1 x_1) (w + a_2 x_2) / (4 w),      w = 1 - x_3
/// edge of the base:     N_A = (w^2 - x_1^2) (w + a_2 x_2) / (2 w) at (0, a_2),  (w + a_1 x_1) (w^2 - x_2^2) / (2 w) at (a_1, 0)
/// edge to the apex:     N_A = x_3 (w + a_1 x_1) (w + a_2 x_2) / w at (a_1/2, a_2/2, 1/2)
/// apex:                 N_4 = x_3 (2 x_3 - 1)
/// ```
///
/// They reproduce all polynomials of degree 2 in the reference coordinates, that is in space where the base is a
/// parallelogram and edges are straight with their nodes in the middle. On the faces they are the functions of `tri6`
/// and `quad8`, so these pyramids join `hex20` to `tet10`.
///
/// With `u = x_1/w, v = x_2/w` gradients are polynomials in u, v and w, of degree 1 in w. The products of two in an
/// undistorted pyramid have the degrees 4, 4 and 2, the volume of any pyramid, also a curved one, 5, 5 and 3: the
/// quadrature is exact for both. At the apex the gradient has no value of its own; the value along the axis is
/// returned. Source: Bedrosian (1992), IJNME 35, 95-108.
///
/// ```
/// use emmy::internals::element::{Pyramid13, ReferenceElement};
/// let mut N = [0.0; 13];
/// Pyramid13.shape([0.0, 0.0, 0.5], &mut N);
/// assert_eq!((N[0], N[4], N[5], N[9]), (-0.125, 0.0, 0.125, 0.25));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pyramid13;

pub(super) const INFO: CellInfo = CellInfo {
    name: "pyramid13",
    description: "serendipity pyramid with rational shape functions, 13 nodes",
    shape: CellShape::Pyramid,
    n_nodes: 13,
    vtk_type: 27,
    facets: facets![
        Quad8[0, 3, 2, 1, 8, 7, 6, 5],
        Tri6[0, 1, 4, 5, 10, 9],
        Tri6[1, 2, 4, 6, 11, 10],
        Tri6[2, 3, 4, 7, 12, 11],
        Tri6[3, 0, 4, 8, 9, 12]],
    element: &Pyramid13,
    pressures: &[PressureSpace::Linear],
    point_share: 0.0,
    n_modes: 0,
};

/// Corners of the base, apex, edges of the base, edges to the apex.
const NODES: [[f64; 3]; 13] = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, -1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
    [-0.5, -0.5, 0.5],
    [0.5, -0.5, 0.5],
    [0.5, 0.5, 0.5],
    [-0.5, 0.5, 0.5],
];

/// A function of u, v and w with its derivatives.
type Jet = (f64, [f64; 3]);

/// `N/w` of the node at a corner of the base.
fn corner([a, b, _]: [f64; 3], [u, v, w]: [f64; 3]) -> Jet {
    let f = 1.0 + a * u;
    let g = 1.0 + b * v;
    let s = a * u + b * v;
    let c = 0.25 * (w * s - 1.0);
    (c * f * g, [a * g * (c + 0.25 * w * f), b * f * (c + 0.25 * w * g), 0.25 * s * f * g])
}

/// `N/w` of the node in the middle of an edge of the base along x_1, at (0, b).
fn base_edge(b: f64, [u, v, w]: [f64; 3]) -> Jet {
    let f = 1.0 - u * u;
    let g = 1.0 + b * v;
    (0.5 * w * f * g, [-w * u * g, 0.5 * w * b * f, 0.5 * f * g])
}

/// `N/w` of the node on the edge from the corner (a, b) of the base to the apex.
fn side_edge([a, b, _]: [f64; 3], [u, v, w]: [f64; 3]) -> Jet {
    let f = 1.0 + a * u;
    let g = 1.0 + b * v;
    let z = 1.0 - w;
    (z * f * g, [z * a * g, z * b * f, -f * g])
}

/// `N/w` of every node but the apex, with its number.
fn functions(xi: [f64; 3]) -> impl Iterator<Item = (usize, Jet)> {
    let [u, v] = ray(xi);
    let (at, turned) = ([u, v, 1.0 - xi[2]], [v, u, 1.0 - xi[2]]);
    (0..13).filter(|&node| node != 4).map(move |node| {
        let jet = match node {
            0..=3 => corner(NODES[node], at),
            5 | 7 => base_edge(NODES[node][1], at),
            6 | 8 => {
                let (n, [n_v, n_u, n_w]) = base_edge(NODES[node][0], turned);
                (n, [n_u, n_v, n_w])
            }
            _ => side_edge(NODES[node - 9], at),
        };
        (node, jet)
    })
}

impl ReferenceElement<3> for Pyramid13 {
    fn nodes(&self) -> &'static [[f64; 3]] {
        &NODES
    }

    fn shape(&self, xi: [f64; 3], N: &mut [f64]) {
        functions(xi).for_each(|(node, (n, _))| N[node] = (1.0 - xi[2]) * n);
        N[4] = xi[2] * (2.0 * xi[2] - 1.0);
    }

    fn gradient(&self, xi: [f64; 3], dN: &mut [[f64; 3]]) {
        let [u, v] = ray(xi);
        let w = 1.0 - xi[2];
        for (node, (n, [n_u, n_v, n_w])) in functions(xi) {
            dN[node] = [n_u, n_v, u * n_u + v * n_v - n - w * n_w];
        }
        dN[4] = [0.0, 0.0, 4.0 * xi[2] - 1.0];
    }

    fn quadrature(&self) -> Quadrature<3> {
        pyramid(3, 2)
    }

    fn mass_quadrature(&self) -> Quadrature<3> {
        pyramid(3, 3)
    }
}
