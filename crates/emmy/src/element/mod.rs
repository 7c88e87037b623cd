//! Reference elements: shape functions N and their gradients, and the quadrature that goes with them. One element a file.

#![allow(non_snake_case)]

use crate::quadrature::Quadrature;

/// A reference element of dimension `D`.
pub trait ReferenceElement<const D: usize>: Send + Sync {
    /// Positions of the nodes in the reference domain, in VTK order.
    fn nodes(&self) -> Vec<[f64; D]>;
    /// Shape functions at a point, `N: [n_nodes]`.
    fn shape(&self, xi: [f64; D], N: &mut [f64]);
    /// Gradients of the shape functions by the reference coordinates, `dN: [n_nodes][D]`.
    fn gradient(&self, xi: [f64; D], dN: &mut [[f64; D]]);
    /// Quadrature for the internal force (full integration).
    fn quadrature(&self) -> Quadrature<D>;
    /// Quadrature that integrates the products of shape functions of an undistorted element exactly.
    fn mass_quadrature(&self) -> Quadrature<D>;
}
