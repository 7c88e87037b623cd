//! Internal nodes: the incompatible modes of cells as nodes without mass.
//!
//! A mode of a cell with n corners at q_A is a vector a_m. It is held as the position `y_m = sum_A q_A / n + a_m` of a
//! node, so that the gradients of all nodes of the cell sum to zero:
//!
//! ```math
//! F = sum_A q_A (x) (grad N_A - sum_m G_m / n) + sum_m y_m (x) G_m,    G_m = (det J_0 / det J) J_0^-T grad_xi (xi_m^2 / 2)
//! ```
//!
//! (Simo and Armero 1992; J_0: the Jacobian in the middle of the cell.) Then rigid motions, predictions, tangents,
//! adjoints, checkpoints and every scheme treat a mode like any other node. The integral of G_m over the cell is zero,
//! so a homogeneous deformation leaves `a_m = 0`.

use std::ops::Range;

use super::geometry::{CellTable, inverse, positions, reserved};
use crate::element::{element, jacobian};
use crate::error::Result;
use crate::input::Region;
use crate::mesh::{Cell, CellKind, Mesh};
use crate::nodal;
use crate::tensor::{Mat3, det};

/// The internal nodes of a body, numbered after the nodes of its mesh, cell by cell.
#[derive(Debug, Clone, Default)]
pub(crate) struct InternalNodes {
    /// Number of the first internal node: the number of nodes of the mesh.
    first: usize,
    /// Number of those of the cells that count here; they come first.
    n_counted: usize,
    /// Cell of each internal node, ascending.
    cells: Vec<u32>,
    /// Middle of the cell of each internal node.
    points: Vec<[f64; 3]>,
}

impl InternalNodes {
    /// The internal nodes of a mesh; `counts`: whether a cell counts here, as the first ones do.
    pub(crate) fn new(
        mesh: &Mesh,
        regions: &[Region],
        region_of_cell: &[u32],
        counts: impl Fn(u32) -> bool,
    ) -> Self {
        let mut nodes = InternalNodes { first: mesh.n_nodes(), ..InternalNodes::default() };
        for (cell, (own, &region)) in (0..).zip(mesh.cells().zip(region_of_cell)) {
            for _ in 0..regions[region as usize].formulation.n_modes(own.kind) {
                nodes.n_counted += usize::from(counts(cell));
                nodes.cells.push(cell);
                nodes.points.push(middle(own, |node| mesh.points()[node]));
            }
        }
        nodes
    }

    /// Number of nodes, those of the mesh included.
    pub(crate) fn n_all(&self) -> usize {
        self.first + self.cells.len()
    }

    /// Cell of each internal node, ascending among those that count here, which come first, and among the others.
    pub(crate) fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// Those of the cells that count here.
    pub(crate) fn counted(&self) -> Range<usize> {
        self.first..self.first + self.n_counted
    }

    /// Their degrees of freedom.
    pub(crate) fn dofs(&self) -> Range<usize> {
        3 * self.first..3 * self.n_all()
    }

    /// Their reference positions: the middles of their cells.
    pub(crate) fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Nodes of a cell.
    pub(crate) fn of_cell(&self, cell: u32) -> Range<u32> {
        let from = self.cells.partition_point(|&other| other < cell);
        let until = from + self.cells[from..].iter().take_while(|&&other| other == cell).count();
        (self.first + from) as u32..(self.first + until) as u32
    }

    /// The internal nodes, each with its cell.
    pub(crate) fn with_cells<'a>(&'a self, mesh: &'a Mesh) -> impl Iterator<Item = (usize, Cell<'a>)> {
        (self.first..).zip(self.cells.iter().map(|&cell| mesh.cell(cell as usize)))
    }

    /// Sets a nodal field, `[n_nodes][3]`, to the mean over the corners of their cells: a field without modes.
    pub(crate) fn set_means(&self, mesh: &Mesh, field: &mut [f64]) {
        for (node, cell) in self.with_cells(mesh) {
            let mean = middle(cell, |node| nodal::at(field, node));
            *nodal::at_mut(field, node) = mean;
        }
    }

    /// Adds the forces on the internal nodes, `[n_nodes][3]`, to the nodes of their cells in equal parts: the forces at
    /// fixed modes a_m. With them the inertia and the reactions of a state whose modes are not in balance keep the
    /// momenta.
    ///
    /// ```math
    /// f_A + sum_m f_m / n
    /// ```
    pub(crate) fn share(&self, mesh: &Mesh, force: &mut [f64]) {
        for (node, cell) in self.with_cells(mesh) {
            let share = nodal::at(force, node).map(|f| f / cell.nodes.len() as f64);
            for &corner in cell.nodes {
                (0..3).for_each(|d| force[3 * corner as usize + d] += share[d]);
            }
        }
    }
}

/// Mean of a vector over the nodes of a cell.
fn middle(cell: Cell<'_>, vector: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for &node in cell.nodes {
        let vector = vector(node as usize);
        (0..3).for_each(|d| sum[d] += vector[d]);
    }
    sum.map(|sum| sum / cell.nodes.len() as f64)
}

/// The functions G_m of a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ModeGradients {
    n_modes: usize,
    /// `det J_0 J_0^-1`, `[xi component][X component]`.
    middle: Mat3<f64>,
}

impl ModeGradients {
    /// The functions of a cell with nodes at `X: [n_nodes]`.
    pub(crate) fn new(kind: CellKind, X: &[[f64; 3]]) -> Self {
        let mut dN = vec![[0.0; 3]; kind.n_nodes()];
        element(kind).gradient([0.0; 3], &mut dN);
        ModeGradients { n_modes: kind.info().n_modes, middle: inverse(&jacobian(kind, X, &dN), 1.0) }
    }

    /// `J^T G_m` at a point with the Jacobian J, `[m]`: the gradients by the reference coordinates, as those of the
    /// shape functions are stored.
    pub(crate) fn at(&self, xi: [f64; 3], J: Mat3<f64>, det: f64) -> impl Iterator<Item = [f64; 3]> {
        (0..self.n_modes).map(move |m| {
            let G = self.middle[m].map(|component| xi[m] * component / det);
            [0, 1, 2].map(|b| (0..3).map(|i| J[i][b] * G[i]).sum())
        })
    }
}

/// Displacement of the modes of a cell, `a_m`: the displacement of its internal nodes less the mean over its nodes.
pub(crate) fn mode_displacement(cell: Cell<'_>, node: usize, displacement: &[f64]) -> [f64; 3] {
    let mean = middle(cell, |node| nodal::at(displacement, node));
    [0, 1, 2].map(|d| nodal::at(displacement, node)[d] - mean[d])
}

impl CellTable {
    /// The table with the internal nodes of its cells, all of one kind and with the same number of modes.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub(crate) fn with_modes(self, mesh: &Mesh, kind: CellKind, internal: &InternalNodes) -> Result<Self> {
        let n_modes = self.cells.first().map_or(0, |&cell| internal.of_cell(cell).len());
        if n_modes == 0 {
            return Ok(self);
        }
        let quadrature = element(kind).quadrature();
        let n_nodes = kind.n_nodes() + n_modes;
        let mut nodes = reserved(self.cells.len() * n_nodes)?;
        let mut mode_gradients = reserved(self.cells.len() * quadrature.points.len() * n_modes)?;
        for (&cell, corners) in self.cells.iter().zip(self.nodes.chunks_exact(self.n_nodes)) {
            nodes.extend_from_slice(corners);
            nodes.extend(internal.of_cell(cell));
            let X = positions(mesh, corners);
            let modes = ModeGradients::new(kind, &X);
            for (&xi, dN) in quadrature.points.iter().zip(self.reference_gradients.chunks_exact(self.n_nodes))
            {
                let jacobian = jacobian(kind, &X, dN);
                mode_gradients.extend(modes.at(xi, jacobian, det(&jacobian)));
            }
        }
        Ok(CellTable { nodes, n_nodes, n_modes, mode_gradients, ..self })
    }
}
