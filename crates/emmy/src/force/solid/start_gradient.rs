//! Derivatives of the stage forces by the displacement at the start of a step, times adjoint vectors. They are computed
//! cell by cell in scalars: an adjoint needs them once per step.

use rayon::prelude::*;

use super::SolidForce;
use super::start_pressure::VolumeMemory;
use crate::average::StartTangent;
use crate::force::integral::{self, RegisterCells};
use crate::force::step::StepInput;
use crate::nodal;
use crate::tensor::{LANES, Mat3, Packed};

/// Working memory for a batch of cells.
pub(super) struct CellMemory {
    /// Displacement and rates, then the adjoint vectors, `[1 + 2 k][n_nodes][3]`.
    pub(super) nodal: Vec<[Packed; 3]>,
    /// Gradients of those fields at a point, `[1 + 2 k]`.
    pub(super) gradients: Vec<Mat3<f64>>,
    /// Gradients of the shape functions at a point, `[n_nodes][3]`.
    shape_gradients: Vec<[Packed; 3]>,
    pub(super) start_tangent: StartTangent,
}

impl CellMemory {
    fn new(degree: usize, n_nodes: usize) -> Self {
        let n_fields = 1 + 2 * degree;
        let zero = Packed([0.0; LANES]);
        CellMemory {
            nodal: vec![[zero; 3]; n_fields * n_nodes],
            gradients: vec![[[0.0; 3]; 3]; n_fields],
            shape_gradients: vec![[zero; 3]; n_nodes],
            start_tangent: StartTangent::new(degree),
        }
    }
}

impl SolidForce {
    /// Adds `sum_i (df_i/du_1)^T mu_i`; batches are computed in parallel and summed in order.
    pub(super) fn add_start_gradient_of_cells(
        &self,
        step: &StepInput<'_>,
        adjoint: &[f64],
        gradient: &mut [f64],
    ) {
        let n = self.cells.n_nodes;
        let k = step.rule.degree();
        let mut of_cells = vec![[0.0; 3]; self.cells.nodes.len()];
        let batches = of_cells.par_chunks_mut(n * LANES).enumerate();
        batches.for_each_init(
            || {
                let volume = |projection| VolumeMemory::new(step.rule, projection);
                (CellMemory::new(k, n), self.projection.as_ref().map(volume))
            },
            |(memory, volume), (batch, sums)| {
                self.gather_fields(batch, step, adjoint, memory);
                for (part, (cell, sums)) in
                    self.cells.cells_of(batch).zip(sums.chunks_exact_mut(n)).enumerate()
                {
                    let cells = RegisterCells { cells: &self.cells, batch, part, zero: 0.0 };
                    if let (Some(volume), Some(projection)) = (&mut *volume, &self.projection) {
                        volume.set_cell(cells, projection, step, memory);
                    }
                    (0..self.cells.n_points).for_each(|point| {
                        self.add_point((cells, cell, point), step, (memory, volume), sums);
                    });
                }
            },
        );
        for (&node, sum) in self.cells.nodes.iter().zip(&of_cells) {
            nodal::add(gradient, node as usize, *sum);
        }
    }

    fn gather_fields(&self, batch: usize, step: &StepInput<'_>, adjoint: &[f64], memory: &mut CellMemory) {
        let n = self.cells.n_nodes;
        let n_dofs = step.displacement.len();
        let n_fields = integral::gather(&self.cells, batch, step, true, &mut memory.nodal);
        let adjoints = adjoint.chunks_exact(n_dofs).zip(memory.nodal[n_fields * n..].chunks_exact_mut(n));
        for (mu, nodal) in adjoints {
            self.cells.gather(batch, nodal, |node| mu.as_chunks().0[node]);
        }
    }

    /// Adds the contribution of a quadrature point of a cell, to `sums: [n_nodes]`.
    fn add_point(
        &self,
        (cells, cell, point): (RegisterCells<'_, f64>, usize, usize),
        step: &StepInput<'_>,
        (memory, volume): (&mut CellMemory, &mut Option<VolumeMemory>),
        sums: &mut [[f64; 3]],
    ) {
        let CellMemory { nodal, gradients, shape_gradients, start_tangent } = memory;
        cells.set_field_gradients(point, nodal, gradients);
        cells.set_shape_gradients(point, shape_gradients);
        let fields = &gradients[..1 + step.rule.degree()];
        step.rule.start_tangent(self.materials.response(cell), &fields[0], &fields[1..], start_tangent);
        let mut T = [0.0; 9];
        if let (Some(volume), Some(projection)) = (volume, &self.projection) {
            volume.add_point((cells, point), projection, step, memory, &mut T);
        }
        let CellMemory { gradients, shape_gradients, start_tangent, .. } = memory;
        let adjoints = &gradients[1 + step.rule.degree()..];
        let weight = cells.weight(point);
        for (tangent, mu) in start_tangent.tangent.iter().zip(adjoints) {
            for (row, mu) in tangent.iter().zip(mu.as_flattened()) {
                T.iter_mut().zip(row).for_each(|(sum, entry)| *sum += weight * mu * entry);
            }
        }
        for (sum, dN) in sums.iter_mut().zip(&*shape_gradients) {
            (0..3).for_each(|i| sum[i] += (0..3).map(|J| T[3 * i + J] * dN[J].0[cells.part]).sum::<f64>());
        }
    }
}
