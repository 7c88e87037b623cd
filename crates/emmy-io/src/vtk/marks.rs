//! Groups as arrays, with a number for every node or cell.

use emmy::body::Place;
use emmy::mesh::{Facet, Mesh};

use super::{FACETS, GROUP};

/// The array of a group.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Marks {
    /// `group:NAME` or `facets:NAME`.
    pub(super) name: String,
    pub(super) place: Place,
    /// 1 for the members of a group of nodes or cells, a bit for each facet of a cell in a group of facets.
    pub(super) bits: Vec<u8>,
}

/// The arrays of all groups of a mesh: of nodes, of cells, of facets.
pub(super) fn marks(mesh: &Mesh) -> Vec<Marks> {
    let groups = mesh.groups();
    let n_nodes = mesh.n_nodes();
    let n_cells = mesh.n_cells();
    let member = |&member: &u32| (member, 1);
    let facet = |facet: &Facet| (facet.cell, 1 << facet.local);
    let nodes = groups.nodes.iter().map(|(name, nodes)| {
        let bits = bits(n_nodes, nodes.iter().map(member));
        Marks { name: format!("{GROUP}{name}"), place: Place::Nodes, bits }
    });
    let cells = groups.cells.iter().map(|(name, cells)| {
        let bits = bits(n_cells, cells.iter().map(member));
        Marks { name: format!("{GROUP}{name}"), place: Place::Cells, bits }
    });
    let facets = groups.facets.iter().map(|(name, facets)| {
        let bits = bits(n_cells, facets.iter().map(facet));
        Marks { name: format!("{FACETS}{name}"), place: Place::Cells, bits }
    });
    nodes.chain(cells).chain(facets).collect()
}

fn bits(n: usize, members: impl Iterator<Item = (u32, u8)>) -> Vec<u8> {
    let mut values = vec![0; n];
    members.for_each(|(member, bits)| values[member as usize] |= bits);
    values
}
