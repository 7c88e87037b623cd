//! Projection of the volume of cells on few functions of each cell (Simo, Taylor and Pister 1985).

use crate::element::{PressureSpace, element};
use crate::material::VolumeLaw;
use crate::mesh::{CellKind, Mesh};
use crate::space::CellTable;
use crate::space::geometry::positions;
use crate::tensor::{LANES, Packed};

/// Projection of the volume of the cells of a term.
///
/// ```math
/// theta_q = sum_a psi_a(X_q) sum_p w_p psi_a(X_p) (J_p - 1),      sum_q w_q psi_a psi_b = delta_ab
/// ```
///
/// The functions are linear in the reference position: functions of the reference coordinates lose the order of
/// accuracy on general quadrilaterals and hexahedra (Arnold, Boffi and Falk 2002).
#[derive(Debug)]
pub(crate) struct Projection {
    /// The energy of the projected volume.
    pub law: VolumeLaw,
    /// Number of functions of a cell.
    pub n_functions: usize,
    /// Functions at the quadrature points, `[batch][point][function]`.
    functions: Vec<Packed>,
    n_points: usize,
}

impl Projection {
    /// The projection of the cells of a table, before they are batched.
    pub(crate) fn new(
        mesh: &Mesh,
        kind: CellKind,
        space: PressureSpace,
        law: VolumeLaw,
        table: &CellTable,
    ) -> Self {
        let n_functions = space.n_functions(kind.dimension());
        let n_points = table.weights.len() / table.cells.len();
        let n_batches = table.cells.len().div_ceil(LANES);
        let mut functions = vec![Packed([0.0; LANES]); n_batches * n_points * n_functions];
        let shapes = shapes(kind);
        for lane in 0..n_batches * LANES {
            let cell = lane.min(table.cells.len() - 1);
            let points = points(mesh, table, cell, &shapes);
            let weights = &table.weights[cell * n_points..(cell + 1) * n_points];
            let of_cell = orthonormal(&points, weights, n_functions);
            let of_batch = &mut functions[lane / LANES * n_points * n_functions..];
            of_batch.iter_mut().zip(of_cell).for_each(|(packed, value)| packed.0[lane % LANES] = value);
        }
        Projection { law, n_functions, functions, n_points }
    }

    /// Functions of a batch at a point, `[function]`.
    #[inline(always)]
    pub(crate) fn at(&self, batch: usize, point: usize) -> &[Packed] {
        let first = (batch * self.n_points + point) * self.n_functions;
        &self.functions[first..first + self.n_functions]
    }
}

/// Shape functions at the quadrature points of a kind, `[point][n_nodes]`.
pub(crate) fn shapes(kind: CellKind) -> Vec<Vec<f64>> {
    let shapes = |xi: &[f64; 3]| {
        let mut shapes = vec![0.0; kind.n_nodes()];
        element(kind).shape(*xi, &mut shapes);
        shapes
    };
    element(kind).quadrature().points.iter().map(shapes).collect()
}

/// Reference positions of the quadrature points of a cell.
fn points(mesh: &Mesh, table: &CellTable, cell: usize, shapes: &[Vec<f64>]) -> Vec<[f64; 3]> {
    let X = positions(mesh, &table.nodes[cell * table.n_nodes..(cell + 1) * table.n_nodes]);
    let position = |N: &Vec<f64>| [0, 1, 2].map(|d| X.iter().zip(N).map(|(X, N)| N * X[d]).sum::<f64>());
    shapes.iter().map(position).collect()
}

/// The first of the functions 1, X, Y, Z, made orthonormal in the order given, `[point][function]`.
pub(crate) fn orthonormal(points: &[[f64; 3]], weights: &[f64], n: usize) -> Vec<f64> {
    let volume: f64 = weights.iter().sum();
    let centre = [0, 1, 2].map(|d| points.iter().zip(weights).map(|(X, w)| w * X[d]).sum::<f64>() / volume);
    let mut functions: Vec<Vec<f64>> = Vec::new();
    for a in 0..n {
        let value = |X: &[f64; 3]| if a == 0 { 1.0 } else { X[a - 1] - centre[a - 1] };
        let mut function: Vec<f64> = points.iter().map(value).collect();
        let dot = |f: &[f64], g: &[f64]| -> f64 { (0..f.len()).map(|q| weights[q] * f[q] * g[q]).sum() };
        // The second pass removes the rounding of the first.
        for other in functions.iter().chain(&functions) {
            let part = dot(&function, other);
            function.iter_mut().zip(other).for_each(|(f, g)| *f -= part * g);
        }
        let norm = dot(&function, &function).sqrt();
        functions.push(function.iter().map(|f| f / norm).collect());
    }
    (0..points.len()).flat_map(|q| functions.iter().map(move |f| f[q])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_orthonormal_and_span_linear_functions() {
        let points = [[0.1, 0.2, 0.3], [1.0, 0.1, 0.0], [0.2, 1.3, 0.1], [0.0, 0.4, 1.1], [0.9, 0.8, 0.7]];
        let weights = [0.3, 0.2, 0.4, 0.25, 0.1];
        let functions = orthonormal(&points, &weights, 4);
        let sum = |of: &dyn Fn(usize) -> f64| (0..5).map(|q| weights[q] * of(q)).sum::<f64>();
        for (a, b) in (0..16).map(|n| (n / 4, n % 4)) {
            let product = sum(&|q| functions[4 * q + a] * functions[4 * q + b]);
            assert!((product - if a == b { 1.0 } else { 0.0 }).abs() < 1e-14);
        }
        let linear = |q: usize| 0.7 - 2.0 * points[q][0] + 0.4 * points[q][1] + 3.0 * points[q][2];
        for q in 0..5 {
            let part = |a: usize| functions[4 * q + a] * sum(&|p| functions[4 * p + a] * linear(p));
            assert!(((0..4).map(part).sum::<f64>() - linear(q)).abs() < 1e-13);
        }
    }
}
