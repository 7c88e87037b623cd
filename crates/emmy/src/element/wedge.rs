//! Shape functions on the wedge: the triangle in the first two coordinates, the interval `[-1, 1]` in the third.

use super::simplex::{linear_gradient, linear_shape, quadratic_gradient, quadratic_shape};

/// Nodes of the wedges: 3 corners of the base, 3 of the top, 3 edges of the base, 3 of the top, 3 between them.
pub(super) const WEDGE_NODES: [[f64; 3]; 15] = [
    [0.0, 0.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.5, 0.0, -1.0],
    [0.5, 0.5, -1.0],
    [0.0, 0.5, -1.0],
    [0.5, 0.0, 1.0],
    [0.5, 0.5, 1.0],
    [0.0, 0.5, 1.0],
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
];

/// The plane coordinates of a point.
fn plane([x, y, _]: [f64; 3]) -> [f64; 2] {
    [x, y]
}

/// Linear functions of the triangle: values and gradients.
pub(super) fn linear(xi: [f64; 3]) -> ([f64; 3], [[f64; 2]; 3]) {
    let mut b = [0.0; 3];
    let mut db = [[0.0; 2]; 3];
    linear_shape(plane(xi), &mut b);
    linear_gradient(&mut db);
    (b, db)
}

/// Quadratic functions of the triangle: values and gradients.
pub(super) fn quadratic(xi: [f64; 3]) -> ([f64; 6], [[f64; 2]; 6]) {
    let mut q = [0.0; 6];
    let mut dq = [[0.0; 2]; 6];
    quadratic_shape(plane(xi), &mut q);
    quadratic_gradient(plane(xi), &mut dq);
    (q, dq)
}
