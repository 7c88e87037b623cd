//! Displacement gradients at the quadrature points and, recovered from them, at the nodes.

use std::sync::Arc;

use rayon::prelude::*;

use super::projected::Projections;
use crate::element::{element, extrapolation, jacobian};
use crate::mesh::{CellKind, Mesh};
use crate::nodal;
use crate::space::InternalNodes;
use crate::space::geometry::{ReferenceTable, inverse, positions};
use crate::space::internal_nodes::{ModeGradients, mode_displacement};
use crate::tensor::{Mat3, det};

/// Tables that the cells of each kind share.
#[derive(Debug)]
pub(super) struct Recovery {
    /// By kind, of those that the mesh has.
    kinds: [Option<KindTable>; CellKind::ALL.len()],
    internal: Arc<InternalNodes>,
    pub(super) projections: Projections,
}

#[derive(Debug)]
struct KindTable {
    reference: ReferenceTable<3>,
    /// `[n_nodes][n_points]`.
    extrapolation: Vec<f64>,
}

/// Sum of displacement gradients at a node by their weights.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct GradientSum {
    weight: f64,
    sum: Mat3<f64>,
    /// Projected volumes theta; 0 in cells without.
    volume: f64,
}

impl GradientSum {
    /// Mean of the projected volumes theta.
    pub(super) fn mean_volume(&self) -> f64 {
        self.volume / self.weight
    }

    pub(super) fn mean(&self) -> Mat3<f64> {
        self.sum.map(|row| row.map(|component| component / self.weight))
    }

    /// Adds another sum.
    pub(super) fn add(&mut self, other: &GradientSum) {
        self.weight += other.weight;
        self.volume += other.volume;
        (0..3).for_each(|i| (0..3).for_each(|j| self.sum[i][j] += other.sum[i][j]));
    }

    /// Whether nothing has been added.
    pub(super) fn is_empty(&self) -> bool {
        self.weight == 0.0
    }

    /// Returns the weight and resets the sum.
    pub(super) fn take(&mut self) -> f64 {
        std::mem::take(self).weight
    }
}

/// Empty sums.
pub(super) fn sums(n_nodes: usize) -> Vec<GradientSum> {
    vec![GradientSum::default(); n_nodes]
}

/// Cells that one thread takes at a time, and those whose gradients are kept until they are added up.
const RUN: usize = 256;
const WAVE: usize = 64 * RUN;

impl Recovery {
    pub(super) fn new(mesh: &Mesh, internal: Arc<InternalNodes>, projections: Projections) -> Self {
        let mut kinds: [Option<KindTable>; CellKind::ALL.len()] = Default::default();
        for kind in mesh.cells().map(|cell| cell.kind) {
            kinds[kind as usize].get_or_insert_with(|| KindTable {
                reference: ReferenceTable::new(element(kind), element(kind).quadrature(), kind.n_nodes()),
                extrapolation: extrapolation(kind),
            });
        }
        Recovery { kinds, internal, projections }
    }

    fn table(&self, kind: CellKind) -> &KindTable {
        self.kinds[kind as usize].as_ref().expect("every kind of the mesh has a table")
    }

    /// Volume of a solid cell, area of a plane one, length of a link.
    pub(super) fn measure(&self, mesh: &Mesh, cell: usize) -> f64 {
        let cell = mesh.cell(cell);
        let mut measure = 0.0;
        let X = positions(mesh, cell.nodes);
        let table = &self.table(cell.kind).reference;
        for (point, weight) in table.weights.iter().enumerate() {
            measure += weight * det(&jacobian(cell.kind, &X, table.gradients_at(point)));
        }
        measure
    }

    /// Displacement gradients and weights (volume, area or length) at the quadrature points of a cell.
    pub(super) fn points(
        &self,
        mesh: &Mesh,
        cell: usize,
        displacement: &[f64],
        points: &mut Vec<(Mat3<f64>, f64)>,
    ) {
        let internal = self.internal.of_cell(cell as u32);
        let cell = mesh.cell(cell);
        let X = positions(mesh, cell.nodes);
        let modes = (!internal.is_empty()).then(|| ModeGradients::new(cell.kind, &X));
        let table = &self.table(cell.kind).reference;
        points.clear();
        for (point, weight) in table.weights.iter().enumerate() {
            let dN = table.gradients_at(point);
            let J = jacobian(cell.kind, &X, dN);
            let det = det(&J);
            let mut H = [[0.0; 3]; 3];
            for (&node, dN) in cell.nodes.iter().zip(dN) {
                let u = nodal::at(displacement, node as usize);
                (0..3).for_each(|i| (0..3).for_each(|m| H[i][m] += u[i] * dN[m]));
            }
            let gradients = modes.iter().flat_map(|modes| modes.at(table.points[point], J, det));
            for (node, dN) in internal.clone().zip(gradients) {
                let a = mode_displacement(cell, node as usize, displacement);
                (0..3).for_each(|i| (0..3).for_each(|m| H[i][m] += a[i] * dN[m]));
            }
            let inverse = inverse(&J, det);
            let entry = |i: usize, j: usize| (0..3).map(|m| H[i][m] * inverse[m][j]).sum::<f64>();
            points.push(([0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j))), weight * det));
        }
    }

    /// Passes the displacement gradients of some cells at their nodes, weighted by cell volume, one cell after the
    /// other. `section`: factor from the measure of a cell of a kind to its volume.
    ///
    /// The gradients are computed in parallel.
    pub(super) fn for_each_gradient(
        &self,
        mesh: &Mesh,
        cells: &[u32],
        section: impl Fn(CellKind) -> f64 + Sync,
        displacement: &[f64],
        mut visit: impl FnMut(u32, &GradientSum),
    ) {
        let recovered = |run: &[u32]| self.run(mesh, run, &section, displacement);
        for wave in cells.chunks(WAVE) {
            let runs: Vec<Vec<GradientSum>> = wave.par_chunks(RUN).map(recovered).collect();
            let of_cells = wave.iter().flat_map(|&cell| mesh.cell(cell as usize).nodes);
            of_cells.zip(runs.iter().flatten()).for_each(|(&node, own)| visit(node, own));
        }
    }

    /// Contributions of some cells to their nodes, `[cell][n_nodes]`.
    fn run(
        &self,
        mesh: &Mesh,
        cells: &[u32],
        section: impl Fn(CellKind) -> f64,
        displacement: &[f64],
    ) -> Vec<GradientSum> {
        let (mut points, mut recovered) = (Vec::new(), Vec::new());
        for &cell in cells {
            let kind = mesh.cell(cell as usize).kind;
            self.points(mesh, cell as usize, displacement, &mut points);
            let weight = section(kind) * points.iter().map(|(_, weight)| weight).sum::<f64>();
            let projected = self.projections.of_cell(mesh, cell as usize);
            let volume = projected.map(|projected| projected.volume(mesh, cell as usize, &points));
            for (node, row) in self.table(kind).extrapolation.chunks_exact(points.len()).enumerate() {
                let mut sum = [[0.0; 3]; 3];
                for (x, (G, _)) in row.iter().zip(&points) {
                    let x = weight * x;
                    (0..3).for_each(|i| (0..3).for_each(|j| sum[i][j] += x * G[i][j]));
                }
                let volume = volume.as_ref().map_or(0.0, |volume| weight * volume.at_node(node));
                recovered.push(GradientSum { weight, sum, volume });
            }
        }
        recovered
    }
}
