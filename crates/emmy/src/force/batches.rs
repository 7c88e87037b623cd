//! Cells of one kind in batches: one cell per lane, all at the same quadrature point.

use crate::error::Result;
use crate::space::CellTable;
use crate::space::geometry::reserved;
use crate::tensor::{LANES, Packed};

/// Cells in batches of [`LANES`], in the order of their table. The last batch is completed by repeating its last cell.
#[derive(Debug)]
pub(crate) struct CellBatches {
    /// Indices of the cells in the mesh.
    pub cells: Vec<u32>,
    /// Nodes, `[cell][n_nodes]`: those of the mesh, then the internal ones.
    pub nodes: Vec<u32>,
    /// Number of nodes of a cell.
    pub n_nodes: usize,
    /// Number of internal nodes among them.
    pub n_modes: usize,
    /// Number of quadrature points of a cell.
    pub n_points: usize,
    /// Gradients of the shape functions by the reference coordinates, `[point][n_nodes - n_modes]`: the same for all
    /// cells.
    reference_gradients: Vec<[f64; 3]>,
    /// Gradients of the incompatible modes by the reference coordinates, `[batch][point][n_modes]`.
    mode_gradients: Vec<[Packed; 3]>,
    /// `[batch][point]`.
    geometry: Vec<PointGeometry>,
}

/// Geometry of the cells of a batch at a quadrature point. With the reference gradients it gives the gradients of the
/// shape functions, with less memory traffic than a table of them.
#[derive(Debug, Clone)]
pub(crate) struct PointGeometry {
    /// dxi/dX, `[xi component][X component]` \[1/length\].
    pub inverse_jacobian: [[Packed; 3]; 3],
    /// Weight times det(dX/dxi) and the thickness of plane cells \[length^3\].
    pub weight: Packed,
}

impl CellBatches {
    /// The batches of a table.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub(crate) fn new(table: CellTable) -> Result<Self> {
        let n_points = table.reference_gradients.len() / (table.n_nodes - table.n_modes);
        let n_batches = table.cells.len().div_ceil(LANES);
        let mut geometry = reserved(n_batches * n_points)?;
        let mut mode_gradients = reserved(n_batches * n_points * table.n_modes)?;
        let last = table.cells.len().saturating_sub(1);
        for batch in 0..n_batches {
            for point in 0..n_points {
                let at = |lane: usize| (batch * LANES + lane).min(last) * n_points + point;
                let pack = |of: &dyn Fn(usize) -> f64| Packed(std::array::from_fn(|lane| of(at(lane))));
                geometry.push(PointGeometry {
                    inverse_jacobian: [0, 1, 2]
                        .map(|i| [0, 1, 2].map(|j| pack(&|at| table.inverse_jacobians[at][i][j]))),
                    weight: pack(&|at| table.weights[at]),
                });
                for m in 0..table.n_modes {
                    let gradient = |at: usize| table.mode_gradients[at * table.n_modes + m];
                    mode_gradients.push([0, 1, 2].map(|i| pack(&|at| gradient(at)[i])));
                }
            }
        }
        Ok(CellBatches {
            cells: table.cells,
            nodes: table.nodes,
            n_nodes: table.n_nodes,
            n_modes: table.n_modes,
            n_points,
            reference_gradients: table.reference_gradients,
            mode_gradients,
            geometry,
        })
    }

    /// Number of batches.
    pub(crate) fn len(&self) -> usize {
        self.cells.len().div_ceil(LANES)
    }

    /// Cells of a batch, the repeated one left out.
    #[inline(always)]
    pub(crate) fn cells_of(&self, batch: usize) -> std::ops::Range<usize> {
        batch * LANES..((batch + 1) * LANES).min(self.cells.len())
    }

    /// Nodes of a cell.
    #[inline(always)]
    pub(crate) fn nodes_of(&self, cell: usize) -> &[u32] {
        &self.nodes[cell * self.n_nodes..(cell + 1) * self.n_nodes]
    }

    /// Number of nodes of a cell that are nodes of the mesh.
    #[inline(always)]
    pub(crate) fn n_corners(&self) -> usize {
        self.n_nodes - self.n_modes
    }

    /// Reference gradients at a point, `[n_nodes - n_modes]`.
    #[inline(always)]
    pub(crate) fn reference_gradients_at(&self, point: usize) -> &[[f64; 3]] {
        let n = self.n_corners();
        &self.reference_gradients[point * n..(point + 1) * n]
    }

    /// Reference gradients of the modes of a batch at a point, `[n_modes]`.
    #[inline(always)]
    pub(crate) fn mode_gradients_at(&self, batch: usize, point: usize) -> &[[Packed; 3]] {
        let first = (batch * self.n_points + point) * self.n_modes;
        &self.mode_gradients[first..first + self.n_modes]
    }

    /// Geometry of a batch, `[point]`.
    #[inline(always)]
    pub(crate) fn geometry_of(&self, batch: usize) -> &[PointGeometry] {
        &self.geometry[batch * self.n_points..(batch + 1) * self.n_points]
    }

    /// Copies a field to the nodes of a batch, `nodal: [n_nodes][3]`; `value`: of a node. At internal nodes it is the
    /// field less its mean over the corners.
    #[inline(always)]
    pub(crate) fn gather(&self, batch: usize, nodal: &mut [[Packed; 3]], value: impl Fn(usize) -> [f64; 3]) {
        let last = self.cells.len() - 1;
        for lane in 0..LANES {
            let nodes = self.nodes_of((batch * LANES + lane).min(last));
            for (&node, nodal) in nodes.iter().zip(&mut *nodal) {
                let value = value(node as usize);
                for i in 0..3 {
                    nodal[i].0[lane] = value[i];
                }
            }
        }
        if self.n_modes > 0 {
            self.subtract_means(nodal);
        }
    }

    fn subtract_means(&self, nodal: &mut [[Packed; 3]]) {
        let (corners, modes) = nodal.split_at_mut(self.n_corners());
        let share = 1.0 / corners.len() as f64;
        for i in 0..3 {
            let mut mean = [0.0; LANES];
            for corner in &*corners {
                mean.iter_mut().zip(&corner[i].0).for_each(|(mean, value)| *mean += share * value);
            }
            for mode in &mut *modes {
                mode[i].0.iter_mut().zip(&mean).for_each(|(mode, mean)| *mode -= mean);
            }
        }
    }
}
