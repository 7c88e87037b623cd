//! Reference elements: shape functions N, their gradients, and quadrature. Each element has its own file, with the
//! description of its kind of cell.

#![allow(non_snake_case)]

#[cfg(test)]
mod conformance;
mod extrapolation;
mod formulation;
mod hex20;
mod hex27;
mod hex8;
mod jacobian;
mod kind;
mod lifted;
mod line;
mod pyramid13;
mod pyramid5;
mod quad;
mod simplex;
mod tensor_product;
mod tet10;
mod tet4;
mod tri;
mod wedge;
mod wedge15;
mod wedge6;

pub use extrapolation::extrapolation;
pub use formulation::{Formulation, PressureSpace};
pub use hex8::Hex8;
pub use hex20::Hex20;
pub use hex27::Hex27;
pub use jacobian::{Jacobians, jacobian};
pub use kind::{CellInfo, CellShape, FacetKind, LocalFacet};
pub use line::{Line2, Line3};
pub use pyramid5::Pyramid5;
pub use pyramid13::Pyramid13;
pub use quad::{Quad4, Quad8, Quad9};
pub use tet4::Tet4;
pub use tet10::Tet10;
pub use tri::{Tri3, Tri6};
pub use wedge6::Wedge6;
pub use wedge15::Wedge15;

use crate::quadrature::Quadrature;

// A new kind has its line here.
kind::cell_kinds! {
    /// Trilinear hexahedron, 8 nodes.
    Hex8 = hex8::INFO;
    /// Serendipity hexahedron, 20 nodes.
    Hex20 = hex20::INFO;
    /// Triquadratic hexahedron, 27 nodes.
    Hex27 = hex27::INFO;
    /// Linear tetrahedron, 4 nodes.
    Tet4 = tet4::INFO;
    /// Quadratic tetrahedron, 10 nodes.
    Tet10 = tet10::INFO;
    /// Linear wedge, 6 nodes. The base 0, 1, 2 is seen counter-clockwise from the top 3, 4, 5.
    Wedge6 = wedge6::INFO;
    /// Serendipity wedge, 15 nodes.
    Wedge15 = wedge15::INFO;
    /// Linear pyramid with rational shape functions, 5 nodes. The base is seen counter-clockwise from the apex.
    Pyramid5 = pyramid5::INFO;
    /// Serendipity pyramid with rational shape functions, 13 nodes.
    Pyramid13 = pyramid13::INFO;
    /// Linear triangle of a body in plane strain, 3 nodes, counter-clockwise.
    Tri3 = tri::TRI3;
    /// Quadratic triangle of a body in plane strain, 6 nodes.
    Tri6 = tri::TRI6;
    /// Bilinear quadrilateral of a body in plane strain, 4 nodes, counter-clockwise.
    Quad4 = quad::QUAD4;
    /// Serendipity quadrilateral of a body in plane strain, 8 nodes.
    Quad8 = quad::QUAD8;
    /// Biquadratic quadrilateral of a body in plane strain, 9 nodes.
    Quad9 = quad::QUAD9;
    /// Link of two nodes: a bar, a spring, an attraction.
    Line2 = line::LINE2;
}

/// A reference element of dimension `D`.
///
/// ```math
/// X(xi) = sum_A N_A(xi) X_A,      N_A(xi_B) = delta_AB,      sum_A N_A = 1
/// ```
pub trait ReferenceElement<const D: usize>: Send + Sync {
    /// Positions of the nodes in the reference domain, in VTK order.
    fn nodes(&self) -> &'static [[f64; D]];

    /// Shape functions at a point, `N: [n_nodes]`.
    fn shape(&self, xi: [f64; D], N: &mut [f64]);

    /// Gradients of the shape functions by the reference coordinates, `dN: [n_nodes][D]`.
    fn gradient(&self, xi: [f64; D], dN: &mut [[f64; D]]);

    /// Quadrature for the internal force of a cell (full integration), or for the traction on a facet.
    fn quadrature(&self) -> Quadrature<D>;

    /// Quadrature that integrates the products of shape functions of an undistorted element exactly.
    fn mass_quadrature(&self) -> Quadrature<D> {
        self.quadrature()
    }
}

/// Reference element of a kind of cell, in three coordinates: nothing depends on coordinates that the cell does not
/// have.
///
/// ```
/// use emmy::internals::element::element;
/// use emmy::mesh::CellKind;
/// let mut N = [0.0; 8];
/// element(CellKind::Hex8).shape([0.0; 3], &mut N);
/// assert_eq!(N, [0.125; 8]);
/// ```
pub fn element(kind: CellKind) -> &'static dyn ReferenceElement<3> {
    kind.info().element
}

/// Reference element of a kind of facet, in two coordinates: nothing depends on the second one of an edge.
///
/// ```
/// use emmy::internals::element::facet_element;
/// use emmy::mesh::FacetKind;
/// let area: f64 = facet_element(FacetKind::Tri6).quadrature().weights.iter().sum();
/// assert!((area - 0.5).abs() < 1e-15);
/// ```
pub fn facet_element(kind: FacetKind) -> &'static dyn ReferenceElement<2> {
    match kind {
        FacetKind::Line2 => &lifted::LINE2,
        FacetKind::Line3 => &lifted::LINE3,
        FacetKind::Tri3 => &Tri3,
        FacetKind::Tri6 => &Tri6,
        FacetKind::Quad4 => &Quad4,
        FacetKind::Quad8 => &Quad8,
        FacetKind::Quad9 => &Quad9,
    }
}

/// Derivatives of the position by the two coordinates of a facet, `X: [n_nodes][3]`, `dN: [n_nodes][2]`; their cross
/// product is the outward normal times area per area. The second one of an edge is the unit vector along z.
///
/// ```
/// use emmy::internals::element::facet_tangents;
/// use emmy::mesh::FacetKind;
/// let along_x = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]]; // the cell lies above
/// let tangents = facet_tangents(FacetKind::Line2, &along_x, &[[-0.5, 0.0], [0.5, 0.0]]);
/// assert_eq!(tangents, [[2.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
/// ```
pub fn facet_tangents(kind: FacetKind, X: &[[f64; 3]], dN: &[[f64; 2]]) -> [[f64; 3]; 2] {
    let tangent = |j: usize| [0, 1, 2].map(|i| X.iter().zip(dN).map(|(X, dN)| X[i] * dN[j]).sum::<f64>());
    match kind {
        FacetKind::Line2 | FacetKind::Line3 => [tangent(0), [0.0, 0.0, 1.0]],
        FacetKind::Tri3 | FacetKind::Tri6 | FacetKind::Quad4 | FacetKind::Quad8 | FacetKind::Quad9 => {
            [tangent(0), tangent(1)]
        }
    }
}
