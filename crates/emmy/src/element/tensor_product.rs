//! Shape functions on `[-1, 1]^D` as products of functions of one coordinate: the hexahedra and the quadrilaterals.

/// Nodes of the hexahedra: 8 corners, 12 edges, 6 faces (x-min, x-max, y-min, ...), centre.
pub(super) const CUBE_NODES: [[f64; 3]; 27] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, -1.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, 0.0],
];

/// Nodes of the quadrilaterals: 4 corners, 4 edges, centre.
pub(super) const SQUARE_NODES: [[f64; 2]; 9] = [
    [-1.0, -1.0],
    [1.0, -1.0],
    [1.0, 1.0],
    [-1.0, 1.0],
    [0.0, -1.0],
    [1.0, 0.0],
    [0.0, 1.0],
    [-1.0, 0.0],
    [0.0, 0.0],
];

/// Value and derivative at x of the function of one coordinate that belongs to a node at a.
pub(super) type Factor = fn(a: f64, x: f64) -> [f64; 2];

/// Linear Lagrange function of the nodes -1 and 1.
pub(super) fn linear(a: f64, x: f64) -> [f64; 2] {
    [0.5 * (1.0 + a * x), 0.5 * a]
}

/// Quadratic Lagrange function of the nodes -1, 0 and 1.
pub(super) fn quadratic(a: f64, x: f64) -> [f64; 2] {
    if a == 0.0 { [1.0 - x * x, -2.0 * x] } else { [0.5 * x * (x + a), x + 0.5 * a] }
}

/// Linear function for a node at an end, quadratic bubble for a node between them.
fn serendipity_factor(a: f64, x: f64) -> [f64; 2] {
    if a == 0.0 { [1.0 - x * x, -2.0 * x] } else { linear(a, x) }
}

/// Products of one factor per coordinate, `N: [n_nodes]`.
pub(super) fn shape<const D: usize>(nodes: &[[f64; D]], factor: Factor, xi: [f64; D], N: &mut [f64]) {
    for (N, a) in N.iter_mut().zip(nodes) {
        *N = (0..D).map(|i| factor(a[i], xi[i])[0]).product();
    }
}

/// Gradients of the products, `dN: [n_nodes][D]`.
pub(super) fn gradient<const D: usize>(
    nodes: &[[f64; D]],
    factor: Factor,
    xi: [f64; D],
    dN: &mut [[f64; D]],
) {
    for (dN, a) in dN.iter_mut().zip(nodes) {
        let derivative = |j: usize| (0..D).map(|i| factor(a[i], xi[i])[usize::from(i == j)]).product();
        *dN = std::array::from_fn(derivative);
    }
}

/// Quadratic serendipity functions: nodes at corners and in the middle of edges only.
///
/// ```math
/// corner: N = prod_i (1 + a_i x_i)/2 (sum_i a_i x_i - (D - 1))
/// edge along j: N = (1 - x_j^2) prod_{i != j} (1 + a_i x_i)/2
/// ```
pub(super) fn serendipity_shape<const D: usize>(nodes: &[[f64; D]], xi: [f64; D], N: &mut [f64]) {
    shape(nodes, serendipity_factor, xi, N);
    for (N, a) in N.iter_mut().zip(nodes).filter(|(_, a)| is_corner(a)) {
        *N *= corner_plane(a, xi);
    }
}

/// Gradients of the serendipity functions, `dN: [n_nodes][D]`.
pub(super) fn serendipity_gradient<const D: usize>(nodes: &[[f64; D]], xi: [f64; D], dN: &mut [[f64; D]]) {
    gradient(nodes, serendipity_factor, xi, dN);
    for (dN, a) in dN.iter_mut().zip(nodes).filter(|(_, a)| is_corner(a)) {
        let product: f64 = (0..D).map(|i| linear(a[i], xi[i])[0]).product();
        (0..D).for_each(|i| dN[i] = dN[i] * corner_plane(a, xi) + product * a[i]);
    }
}

fn is_corner<const D: usize>(node: &[f64; D]) -> bool {
    node.iter().all(|&a| a != 0.0)
}

/// The linear function that makes a corner's product vanish in the middle of its edges.
fn corner_plane<const D: usize>(a: &[f64; D], xi: [f64; D]) -> f64 {
    (0..D).map(|i| a[i] * xi[i]).sum::<f64>() - (D - 1) as f64
}
