//! Which nodes act on each other.

use crate::mesh::{Cell, Mesh};
use crate::space::{InternalNodes, Ties};
use crate::sparse::Pattern;
use crate::unknowns::Mechanism;

/// The nodes of each cell, with those that its tied nodes follow.
pub(super) fn of_cells(mesh: &Mesh, internal: &InternalNodes, ties: &Ties) -> Vec<Vec<u32>> {
    let nodes = |(index, cell): (usize, Cell<'_>)| -> Vec<u32> {
        let leaders = cell.nodes.iter().filter_map(|&node| ties.leaders_of(node)).flatten();
        let others = leaders.map(|(leader, _)| *leader).chain(internal.of_cell(index as u32));
        cell.nodes.iter().copied().chain(others).collect()
    };
    mesh.cells().enumerate().map(nodes).collect()
}

/// The pattern of the nodes that cells, rigid bodies and springs of joints couple.
pub(super) fn pattern(mesh: &Mesh, internal: &InternalNodes, ties: &Ties, mechanism: &Mechanism) -> Pattern {
    if internal.dofs().is_empty() && ties.is_empty() && mechanism.is_empty() {
        return Pattern::new(internal.n_all(), mesh.cells().map(|cell| cell.nodes));
    }
    let lists: Vec<Vec<u32>> =
        of_cells(mesh, internal, ties).into_iter().chain(mechanism.coupled_nodes()).collect();
    Pattern::new(internal.n_all(), lists.iter().map(Vec::as_slice))
}
