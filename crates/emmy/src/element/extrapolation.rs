//! From the quadrature points of a cell to its nodes.

use super::{CellKind, CellShape, element};

/// Values at the nodes of a cell from those at its quadrature points, `[n_nodes][n_points]`.
///
/// The values at the points are projected onto few polynomials on the reference element, whose values at the nodes
/// these are:
///
/// ```math
/// f_A = sum_q X_Aq f_q,      X_Aq = sum_i b_i(xi_A) w_q b_i(xi_q),      sum_q w_q b_i(xi_q) b_j(xi_q) = delta_ij
/// ```
///
/// The polynomials belong to the linear element with the same corners: products of linear functions of each coordinate
/// of hexahedra and quadrilaterals, linear functions on simplices, and on a pyramid functions of the ray from the apex,
/// on which alone the gradients of the linear pyramid depend, and linear functions. Polynomials that the points of a
/// cell cannot distinguish are left out: one point gives a constant. Constants are exact, and with enough points also
/// linear functions, even in quadratic cells, whose own gradients oscillate about them. Source: Hinton and Campbell
/// (1974), IJNME 8, 461-480.
///
/// ```
/// use emmy::internals::element::extrapolation;
/// use emmy::mesh::CellKind;
/// let row: f64 = extrapolation(CellKind::Hex8)[..8].iter().sum();
/// assert!((row - 1.0).abs() < 1e-14);
/// assert!(extrapolation(CellKind::Tet4).iter().all(|x| (x - 1.0).abs() < 1e-14));
/// ```
pub fn extrapolation(kind: CellKind) -> Vec<f64> {
    let nodes = element(kind).nodes();
    let rule = element(kind).quadrature();
    let n_points = rule.points.len();
    let at = |i: usize| move |xi: &[f64; 3]| polynomials(kind, *xi)[i];
    let mut coefficients = vec![0.0; nodes.len() * n_points];
    let mut basis: Vec<[Vec<f64>; 2]> = Vec::new();
    for i in 0..polynomials(kind, nodes[0]).len() {
        // Values at the points and at the nodes, made orthonormal side by side.
        let mut own: [Vec<f64>; 2] =
            [rule.points.iter().map(at(i)).collect(), nodes.iter().map(at(i)).collect()];
        let size = norm(&own[0], &rule.weights);
        for other in &basis {
            let part = dot(&own[0], &other[0], &rule.weights);
            for (own, other) in own.iter_mut().zip(other) {
                own.iter_mut().zip(other).for_each(|(own, other)| *own -= part * other);
            }
        }
        let rest = norm(&own[0], &rule.weights);
        if rest <= 1e-6 * size || size == 0.0 {
            continue;
        }
        own.iter_mut().flatten().for_each(|value| *value /= rest);
        for (node, row) in coefficients.chunks_exact_mut(n_points).enumerate() {
            for (q, coefficient) in row.iter_mut().enumerate() {
                *coefficient += own[1][node] * rule.weights[q] * own[0][q];
            }
        }
        basis.push(own);
    }
    coefficients
}

/// The polynomials of a kind at a point, the constant first.
fn polynomials(kind: CellKind, [x, y, z]: [f64; 3]) -> Vec<f64> {
    match kind.info().shape {
        CellShape::Hexahedron => vec![1.0, x, y, z, x * y, y * z, x * z, x * y * z],
        CellShape::Wedge => vec![1.0, x, y, z, x * z, y * z],
        CellShape::Pyramid if z == 1.0 => vec![1.0, 0.0, 0.0, 0.0, x, y, z],
        CellShape::Pyramid => {
            let [u, v] = [x / (1.0 - z), y / (1.0 - z)];
            vec![1.0, u, v, u * v, x, y, z]
        }
        CellShape::Quadrilateral => vec![1.0, x, y, x * y],
        CellShape::Triangle => vec![1.0, x, y],
        CellShape::Line => vec![1.0],
        CellShape::Tetrahedron => vec![1.0, x, y, z],
    }
}

fn dot(a: &[f64], b: &[f64], weights: &[f64]) -> f64 {
    a.iter().zip(b).zip(weights).map(|((a, b), w)| w * a * b).sum()
}

fn norm(a: &[f64], weights: &[f64]) -> f64 {
    dot(a, a, weights).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Extrapolated values at the nodes less the true ones, the largest, of a function of the reference coordinates.
    fn error(kind: CellKind, f: impl Fn([f64; 3]) -> f64) -> f64 {
        let points = element(kind).quadrature().points;
        let X = extrapolation(kind);
        let nodes = element(kind).nodes().iter().zip(X.chunks_exact(points.len()));
        nodes
            .map(|(&node, row)| {
                let value: f64 = row.iter().zip(&points).map(|(x, &point)| x * f(point)).sum();
                (value - f(node)).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn constants_are_exact_in_every_kind() {
        for kind in CellKind::ALL {
            // Rounding of coefficients up to 5.
            assert!(error(kind, |_| 1.0) < 2e-14, "{kind}");
        }
    }

    /// All kinds with enough points; the pyramid has only one layer of them, and is linear along its base alone.
    #[test]
    fn linear_functions_are_exact_where_the_points_tell_them() {
        let few = [CellKind::Tet4, CellKind::Tri3, CellKind::Pyramid5, CellKind::Line2];
        for kind in CellKind::ALL.into_iter().filter(|kind| !few.contains(kind)) {
            let z = if kind.dimension() == 3 { 0.7 } else { 0.0 };
            assert!(error(kind, |xi| 1.0 + 2.0 * xi[0] - xi[1] + z * xi[2]) < 1e-13, "{kind}");
        }
        let ray = |[x, y, z]: [f64; 3]| if z == 1.0 { 1.0 } else { 1.0 + (2.0 * x - y) / (1.0 - z) };
        assert!(error(CellKind::Pyramid5, ray) < 1e-13);
    }

    /// Of a function at the 2x2x2 Gauss points of a brick: (1 + sqrt 3)/2 and (1 - sqrt 3)/2 along each edge.
    #[test]
    fn a_brick_takes_its_corner_from_the_nearest_point_most() {
        let [near, far] = [(1.0 + 3f64.sqrt()) / 2.0, (1.0 - 3f64.sqrt()) / 2.0];
        let mut row = extrapolation(CellKind::Hex8)[..8].to_vec();
        row.sort_by(f64::total_cmp);
        let mut expected: Vec<f64> = (0..8)
            .map(|i: usize| near.powi(3 - i.count_ones() as i32) * far.powi(i.count_ones() as i32))
            .collect();
        expected.sort_by(f64::total_cmp);
        assert!(row.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-14), "{row:?}");
    }
}
