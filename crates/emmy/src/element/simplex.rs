//! Shape functions on the triangle and the tetrahedron, in barycentric coordinates.
//!
//! ```math
//! b_0 = 1 - xi_1 - ... - xi_D,      b_i = xi_i
//! ```

/// Nodes of the tetrahedra: 4 vertices, 6 edges.
pub(super) const TETRAHEDRON_NODES: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
];

/// Nodes of the triangles: 3 vertices, 3 edges.
pub(super) const TRIANGLE_NODES: [[f64; 2]; 6] =
    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];

/// Vertices at the ends of each edge, in the order of the mid-side nodes; the triangle's are the first three.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// Barycentric coordinate of a vertex.
fn barycentric<const D: usize>(vertex: usize, xi: [f64; D]) -> f64 {
    if vertex == 0 { 1.0 - xi.iter().sum::<f64>() } else { xi[vertex - 1] }
}

/// Gradient of the barycentric coordinate of a vertex.
fn barycentric_gradient<const D: usize>(vertex: usize) -> [f64; D] {
    if vertex == 0 { [-1.0; D] } else { std::array::from_fn(|i| f64::from(u8::from(i + 1 == vertex))) }
}

/// Linear functions `N_i = b_i`.
pub(super) fn linear_shape<const D: usize>(xi: [f64; D], N: &mut [f64]) {
    (0..=D).for_each(|vertex| N[vertex] = barycentric(vertex, xi));
}

/// Gradients of the linear functions, `dN: [n_nodes][D]`.
pub(super) fn linear_gradient<const D: usize>(dN: &mut [[f64; D]]) {
    (0..=D).for_each(|vertex| dN[vertex] = barycentric_gradient(vertex));
}

/// Quadratic functions.
///
/// ```math
/// vertex: N_i = b_i (2 b_i - 1),      edge: N_ij = 4 b_i b_j
/// ```
pub(super) fn quadratic_shape<const D: usize>(xi: [f64; D], N: &mut [f64]) {
    for vertex in 0..=D {
        let b = barycentric(vertex, xi);
        N[vertex] = b * (2.0 * b - 1.0);
    }
    for (N, [i, j]) in N[D + 1..].iter_mut().zip(EDGES) {
        *N = 4.0 * barycentric(i, xi) * barycentric(j, xi);
    }
}

/// Gradients of the quadratic functions, `dN: [n_nodes][D]`.
pub(super) fn quadratic_gradient<const D: usize>(xi: [f64; D], dN: &mut [[f64; D]]) {
    for vertex in 0..=D {
        let slope = 4.0 * barycentric(vertex, xi) - 1.0;
        dN[vertex] = barycentric_gradient(vertex).map(|g: f64| slope * g);
    }
    for (dN, [i, j]) in dN[D + 1..].iter_mut().zip(EDGES) {
        let (b_i, b_j) = (barycentric(i, xi), barycentric(j, xi));
        let (g_i, g_j): ([f64; D], [f64; D]) = (barycentric_gradient(i), barycentric_gradient(j));
        *dN = std::array::from_fn(|d| 4.0 * (b_i * g_j[d] + b_j * g_i[d]));
    }
}
