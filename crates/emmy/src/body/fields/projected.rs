//! Projected volumes of cells, for output.

use crate::force::projection::{orthonormal, shapes};
use crate::input::Region;
use crate::material::{CompiledMaterial, VolumeLaw, VolumeMeasure};
use crate::mesh::{CellKind, Mesh};
use crate::space::geometry::positions;
use crate::tensor::{Mat3, green_lagrange};

/// The cells of each region and kind that project their volume.
#[derive(Debug)]
pub(super) struct Projections {
    kinds: Vec<ProjectedKind>,
    /// Index into `kinds` by region and kind.
    index: Vec<[Option<usize>; CellKind::ALL.len()]>,
    region_of_cell: Vec<u32>,
}

/// Cells of one kind in one region.
#[derive(Debug)]
pub(super) struct ProjectedKind {
    /// The material without the projected volume.
    pub(super) points: CompiledMaterial,
    pub(super) law: VolumeLaw,
    n_functions: usize,
    /// Shape functions at the quadrature points, `[point][n_nodes]`.
    shapes: Vec<Vec<f64>>,
}

/// The projected volume theta of a cell, and its pressures.
pub(super) struct CellVolume {
    /// theta at the quadrature points, then at the nodes.
    changes: Vec<f64>,
    /// pbar = dU/dtheta, projected, at the quadrature points.
    pressures: Vec<f64>,
}

impl Projections {
    pub(super) fn new(mesh: &Mesh, regions: &[Region], region_of_cell: &[u32]) -> Self {
        let index = vec![[None; CellKind::ALL.len()]; regions.len()];
        let mut all = Projections { kinds: Vec::new(), index, region_of_cell: region_of_cell.to_vec() };
        for (cell, &region) in mesh.cells().zip(region_of_cell) {
            let index = &mut all.index[region as usize][cell.kind as usize];
            if index.is_none()
                && let Some(kind) = ProjectedKind::new(&regions[region as usize], cell.kind)
            {
                *index = Some(all.kinds.len());
                all.kinds.push(kind);
            }
        }
        all
    }

    /// The kind of a cell; `None` for a cell without a projection.
    pub(super) fn of_cell(&self, mesh: &Mesh, cell: usize) -> Option<&ProjectedKind> {
        let index = self.index[self.region_of_cell[cell] as usize][mesh.cell(cell).kind as usize];
        index.map(|index| &self.kinds[index])
    }

    /// The measure of the volume in a region; `None` without a projection.
    pub(super) fn measure(&self, region: u32) -> Option<VolumeMeasure> {
        let index = self.index[region as usize].iter().flatten().next();
        index.map(|&index| self.kinds[index].law.measure())
    }
}

impl ProjectedKind {
    fn new(region: &Region, kind: CellKind) -> Option<Self> {
        let (space, points, law) = region.material.split(region.formulation, kind).ok()??;
        let n_functions = space.n_functions(kind.dimension());
        Some(ProjectedKind { points, law, n_functions, shapes: shapes(kind) })
    }

    /// The volume of a cell with displacement gradients and weights at its quadrature points.
    ///
    /// ```math
    /// theta = sum_a psi_a sum_q w_q psi_qa theta(G_q),      pbar = sum_a psi_a sum_q w_q psi_qa U'(theta_q)
    /// ```
    pub(super) fn volume(&self, mesh: &Mesh, cell: usize, points: &[(Mat3<f64>, f64)]) -> CellVolume {
        let X = positions(mesh, mesh.cell(cell).nodes);
        let position = |N: &Vec<f64>| [0, 1, 2].map(|d| X.iter().zip(N).map(|(X, N)| N * X[d]).sum::<f64>());
        // Nodes have no weight: there the functions are evaluated only.
        let places: Vec<[f64; 3]> = self.shapes.iter().map(position).chain(X.iter().copied()).collect();
        let mut weights: Vec<f64> = points.iter().map(|(_, weight)| *weight).collect();
        weights.resize(places.len(), 0.0);
        let psi = orthonormal(&places, &weights, self.n_functions);
        let n = self.n_functions;
        let projected = |values: &[f64], place: usize| -> f64 {
            let part =
                |a: usize| values.iter().enumerate().map(|(q, v)| weights[q] * psi[q * n + a] * v).sum();
            (0..n)
                .map(|a| {
                    let part: f64 = part(a);
                    psi[place * n + a] * part
                })
                .sum()
        };
        let local: Vec<f64> =
            points.iter().map(|(G, _)| self.law.measure().change(&green_lagrange(G))).collect();
        let changes: Vec<f64> = (0..places.len()).map(|place| projected(&local, place)).collect();
        let slopes: Vec<f64> =
            changes[..points.len()].iter().map(|theta| self.law.pressure(*theta)).collect();
        let pressures = (0..points.len()).map(|place| projected(&slopes, place)).collect();
        CellVolume { changes, pressures }
    }
}

impl CellVolume {
    /// theta and pbar at a quadrature point.
    pub(super) fn at_point(&self, point: usize) -> (f64, f64) {
        (self.changes[point], self.pressures[point])
    }

    /// theta at a node of the cell.
    pub(super) fn at_node(&self, node: usize) -> f64 {
        self.changes[self.pressures.len() + node]
    }
}
