//! Derivatives of the stage forces by the displacement at the start of a step, times adjoint vectors. Cell by cell in plain
//! numbers: an adjoint asks for it once a step.

use rayon::prelude::*;

use super::SolidTerm;
use crate::average::StartTangent;
use crate::body::StepInput;
use crate::material::Material;
use crate::tensor::{LANES, Mat3};

/// What is needed for a cell.
struct CellMemory {
    /// Gradients of the shape functions at a point, `[n_nodes][3]`.
    gradients: Vec<[f64; 3]>,
    rates: Vec<Mat3<f64>>,
    start_tangent: StartTangent,
}

impl<M: Material> SolidTerm<M> {
    /// Adds `sum_i (df_i/du_1)^T mu_i`; cells are worked through side by side and added up in their order.
    pub(super) fn add_start_gradient_of_cells(
        &self,
        step: &StepInput<'_>,
        adjoint: &[f64],
        gradient: &mut [f64],
    ) {
        let (n, k) = (self.cells.n_nodes, step.rule.degree());
        let mut of_cells = vec![[0.0; 3]; self.cells.nodes.len()];
        let memory = || CellMemory {
            gradients: vec![[0.0; 3]; n],
            rates: vec![[[0.0; 3]; 3]; k],
            start_tangent: StartTangent::new(k),
        };
        of_cells.par_chunks_mut(n).enumerate().for_each_init(memory, |memory, (cell, sums)| {
            (0..self.cells.n_points).for_each(|point| {
                self.add_point((cell, point), step, adjoint, memory, sums);
            });
        });
        for (&node, sum) in self.cells.nodes.iter().zip(&of_cells) {
            (0..3).for_each(|i| gradient[3 * node as usize + i] += sum[i]);
        }
    }

    /// Adds what a quadrature point of a cell gives, to `sums: [n_nodes]`.
    fn add_point(
        &self,
        (cell, point): (usize, usize),
        step: &StepInput<'_>,
        adjoint: &[f64],
        memory: &mut CellMemory,
        sums: &mut [[f64; 3]],
    ) {
        let CellMemory { gradients, rates, start_tangent } = memory;
        let weight = self.set_gradients(cell, point, gradients);
        let (nodes, n_dofs) = (self.cells.nodes_of(cell), step.displacement.len());
        let start = gradient_of(step.displacement, nodes, gradients);
        for (rate, x) in rates.iter_mut().zip(step.rates.chunks_exact(n_dofs)) {
            *rate = gradient_of(x, nodes, gradients);
        }
        step.rule.start_tangent(self.material(cell), &start, rates, start_tangent);
        let mut T = [0.0; 9];
        for (tangent, mu) in start_tangent.tangent.iter().zip(adjoint.chunks_exact(n_dofs)) {
            let mu = gradient_of(mu, nodes, gradients);
            for (row, mu) in tangent.iter().zip(mu.as_flattened()) {
                T.iter_mut().zip(row).for_each(|(sum, entry)| *sum += weight * mu * entry);
            }
        }
        for (sum, dN) in sums.iter_mut().zip(gradients) {
            (0..3).for_each(|i| sum[i] += (0..3).map(|J| T[3 * i + J] * dN[J]).sum::<f64>());
        }
    }

    /// Sets the gradients of the shape functions at a point, `[n_nodes][3]`; returns the weight.
    fn set_gradients(&self, cell: usize, point: usize, gradients: &mut [[f64; 3]]) -> f64 {
        let (geometry, lane) = (&self.cells.geometry_of(cell / LANES)[point], cell % LANES);
        let inverse = &geometry.inverse_jacobian;
        for (gradient, dN) in gradients.iter_mut().zip(self.cells.reference_gradients_at(point)) {
            *gradient = [0, 1, 2].map(|J| (0..3).map(|m| dN[m] * inverse[m][J].0[lane]).sum());
        }
        geometry.weight.0[lane]
    }
}

/// Gradient `sum_A u_A (x) grad N_A` of a nodal field.
fn gradient_of(field: &[f64], nodes: &[u32], gradients: &[[f64; 3]]) -> Mat3<f64> {
    let mut G = [[0.0; 3]; 3];
    for (&node, dN) in nodes.iter().zip(gradients) {
        let u = &field[3 * node as usize..3 * node as usize + 3];
        (0..9).for_each(|at| G[at / 3][at % 3] += u[at / 3] * dN[at % 3]);
    }
    G
}
