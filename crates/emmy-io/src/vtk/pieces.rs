//! The piece of a frame that a rank of a team writes: the cells that count on it, with all their nodes.

use std::sync::Arc;

use emmy::body::{FieldValues, Place};
use emmy::mesh::Mesh;
use emmy::team::Subdomain;

use super::Precision;
use super::frame::Frame;
use super::grid::Grid;

/// The own piece and the ranks that have one.
#[derive(Debug)]
pub(super) struct Pieces {
    pub(super) subdomain: Arc<Subdomain>,
    /// Ranks with a piece: those on which a cell counts.
    pub(super) ranks: Vec<usize>,
    /// Nodes and cells of the own piece, by their numbers in the share.
    nodes: Vec<u32>,
    cells: Vec<u32>,
}

impl Pieces {
    /// The pieces of a mesh of shares; a call of all ranks.
    pub(super) fn new(mesh: &Mesh, subdomain: &Arc<Subdomain>) -> Self {
        let counts = subdomain.counts();
        let cells: Vec<u32> = (0..mesh.n_cells() as u32).filter(|&cell| counts[cell as usize]).collect();
        let mut nodes: Vec<u32> =
            cells.iter().flat_map(|&cell| mesh.cell(cell as usize).nodes).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let n_cells = subdomain.gather("cells of pieces", &[cells.len() as f64]);
        let ranks = (0..subdomain.size()).filter(|&rank| n_cells[rank] > 0.0).collect();
        Pieces { subdomain: subdomain.clone(), ranks, nodes, cells }
    }

    /// The static parts of the own piece, with the numbers of nodes and cells in the whole mesh.
    pub(super) fn frame(&self, precision: Precision, mesh: &Mesh, region_of_cell: &[u32]) -> Frame {
        let regions: Vec<u32> = self.cells.iter().map(|&cell| region_of_cell[cell as usize]).collect();
        let whole = |members: &[u32], numbers: &[u32]| -> Vec<u32> {
            members.iter().map(|&member| numbers[member as usize]).collect()
        };
        let nodes = whole(&self.nodes, self.subdomain.nodes());
        let cells = whole(&self.cells, self.subdomain.cells());
        let part = mesh.part(&self.nodes, &self.cells);
        Frame::new(precision, &Grid::new(&part, Some(&regions))).numbered(
            &nodes,
            &cells,
            self.subdomain.rank(),
        )
    }

    /// Whether this rank has a piece.
    pub(super) fn has_own(&self) -> bool {
        !self.cells.is_empty()
    }

    /// The fields of a share in the own piece.
    pub(super) fn fields(&self, fields: &[FieldValues]) -> Vec<FieldValues> {
        let own = |field: &FieldValues| {
            let members = match field.name.place() {
                Place::Nodes => &self.nodes,
                Place::Cells => &self.cells,
            };
            let n = field.name.components().len();
            let numbers = |&member: &u32| &field.numbers[n * member as usize..][..n];
            FieldValues { name: field.name, numbers: members.iter().flat_map(numbers).copied().collect() }
        };
        fields.iter().map(own).collect()
    }
}
