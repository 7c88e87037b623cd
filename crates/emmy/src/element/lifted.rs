//! Elements of lower dimension in additional coordinates: plane cells in space, edges among the faces.

use super::line::LINE_NODES;
use super::simplex::TRIANGLE_NODES;
use super::tensor_product::SQUARE_NODES;
use super::{Line2, Line3, Quad4, Quad8, Quad9, ReferenceElement, Tri3, Tri6};
use crate::quadrature::{Quadrature, square, triangle};

/// An element of dimension `D` in `T` coordinates; nothing depends on the last ones.
pub(super) struct Lifted<E, const D: usize, const T: usize> {
    element: E,
    nodes: &'static [[f64; T]],
    /// Quadrature of the internal force.
    quadrature: fn() -> Quadrature<D>,
}

const TRIANGLE: [[f64; 3]; 6] = lifted(TRIANGLE_NODES);
const SQUARE: [[f64; 3]; 9] = lifted(SQUARE_NODES);
const LINE: [[f64; 2]; 3] = lifted(LINE_NODES);
const LINK_NODES: [[f64; 3]; 3] = lifted(LINE_NODES);

// As cells triangles need fewer points than as facets: the gradients of their shape functions are of degree p - 1.
pub(super) static TRI3: Lifted<Tri3, 2, 3> =
    Lifted { element: Tri3, nodes: TRIANGLE.split_at(3).0, quadrature: || triangle(1) };
pub(super) static TRI6: Lifted<Tri6, 2, 3> =
    Lifted { element: Tri6, nodes: &TRIANGLE, quadrature: || triangle(2) };
pub(super) static QUAD4: Lifted<Quad4, 2, 3> =
    Lifted { element: Quad4, nodes: SQUARE.split_at(4).0, quadrature: || square(2) };
pub(super) static QUAD8: Lifted<Quad8, 2, 3> =
    Lifted { element: Quad8, nodes: SQUARE.split_at(8).0, quadrature: || square(3) };
pub(super) static QUAD9: Lifted<Quad9, 2, 3> =
    Lifted { element: Quad9, nodes: &SQUARE, quadrature: || square(3) };
pub(super) static LINE2: Lifted<Line2, 1, 2> =
    Lifted { element: Line2, nodes: LINE.split_at(2).0, quadrature: || Line2.quadrature() };
pub(super) static LINE3: Lifted<Line3, 1, 2> =
    Lifted { element: Line3, nodes: &LINE, quadrature: || Line3.quadrature() };

pub(super) static LINK: Lifted<Line2, 1, 3> =
    Lifted { element: Line2, nodes: LINK_NODES.split_at(2).0, quadrature: || super::line::line(1) };

/// Points with zeros as further coordinates.
const fn lifted<const D: usize, const T: usize, const N: usize>(points: [[f64; D]; N]) -> [[f64; T]; N] {
    let mut lifted = [[0.0; T]; N];
    let mut at = 0;
    while at < N * D {
        lifted[at / D][at % D] = points[at / D][at % D];
        at += 1;
    }
    lifted
}

fn projected<const D: usize, const T: usize>(point: [f64; T]) -> [f64; D] {
    std::array::from_fn(|i| point[i])
}

fn lifted_rule<const D: usize, const T: usize>(rule: Quadrature<D>) -> Quadrature<T> {
    let lift = |point: [f64; D]| lifted::<D, T, 1>([point])[0];
    Quadrature { points: rule.points.into_iter().map(lift).collect(), weights: rule.weights }
}

impl<E: ReferenceElement<D>, const D: usize, const T: usize> ReferenceElement<T> for Lifted<E, D, T> {
    fn nodes(&self) -> &'static [[f64; T]] {
        self.nodes
    }

    fn shape(&self, xi: [f64; T], N: &mut [f64]) {
        self.element.shape(projected(xi), N);
    }

    fn gradient(&self, xi: [f64; T], dN: &mut [[f64; T]]) {
        let mut own = [[0.0; D]; 9];
        self.element.gradient(projected(xi), &mut own[..dN.len()]);
        dN.iter_mut().zip(own).for_each(|(dN, own)| *dN = lifted::<D, T, 1>([own])[0]);
    }

    fn quadrature(&self) -> Quadrature<T> {
        lifted_rule((self.quadrature)())
    }

    fn mass_quadrature(&self) -> Quadrature<T> {
        lifted_rule(self.element.mass_quadrature())
    }
}
