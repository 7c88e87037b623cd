//! Quadrilaterals: the facets of hexahedra.
//!
//! The vector area (the cross product of two tangents) of a curved facet has degree 2p - 1 in each coordinate for shape
//! functions of degree p, so with one shape function more a pressure asks for degree 3p - 1, 2 or 5: the Gauss rules
//! with p + 1 points, exact to 2p + 1, integrate it exactly, and products of two shape functions on flat facets too.

use super::ReferenceElement;
use super::tensor_product::{
    SQUARE_NODES, gradient, linear, quadratic, serendipity_gradient, serendipity_shape, shape,
};
use crate::quadrature::{Quadrature, square};

/// Bilinear quadrilateral on `[-1, 1]^2`: 4 nodes, 2x2 Gauss points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quad4;

impl ReferenceElement<2> for Quad4 {
    fn nodes(&self) -> &'static [[f64; 2]] {
        &SQUARE_NODES[..4]
    }

    fn shape(&self, xi: [f64; 2], N: &mut [f64]) {
        shape(self.nodes(), linear, xi, N);
    }

    fn gradient(&self, xi: [f64; 2], dN: &mut [[f64; 2]]) {
        gradient(self.nodes(), linear, xi, dN);
    }

    fn quadrature(&self) -> Quadrature<2> {
        square(2)
    }
}

/// Serendipity quadrilateral on `[-1, 1]^2`: 4 corners and 4 edges, 3x3 Gauss points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quad8;

impl ReferenceElement<2> for Quad8 {
    fn nodes(&self) -> &'static [[f64; 2]] {
        &SQUARE_NODES[..8]
    }

    fn shape(&self, xi: [f64; 2], N: &mut [f64]) {
        serendipity_shape(self.nodes(), xi, N);
    }

    fn gradient(&self, xi: [f64; 2], dN: &mut [[f64; 2]]) {
        serendipity_gradient(self.nodes(), xi, dN);
    }

    fn quadrature(&self) -> Quadrature<2> {
        square(3)
    }
}

/// Biquadratic quadrilateral on `[-1, 1]^2`: 4 corners, 4 edges and the centre, 3x3 Gauss points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quad9;

impl ReferenceElement<2> for Quad9 {
    fn nodes(&self) -> &'static [[f64; 2]] {
        &SQUARE_NODES
    }

    fn shape(&self, xi: [f64; 2], N: &mut [f64]) {
        shape(self.nodes(), quadratic, xi, N);
    }

    fn gradient(&self, xi: [f64; 2], dN: &mut [[f64; 2]]) {
        gradient(self.nodes(), quadratic, xi, dN);
    }

    fn quadrature(&self) -> Quadrature<2> {
        square(3)
    }
}
