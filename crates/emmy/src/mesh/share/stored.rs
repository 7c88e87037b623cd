//! A share as it is sent or stored.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Share;
use crate::mesh::{Bounds, CellKind, Facet, Groups, Mesh};
use crate::team::Neighbour;

/// The numbers of a share.
#[derive(Serialize, Deserialize)]
pub(super) struct Stored {
    points: Vec<[f64; 3]>,
    /// Places of the kinds in [`CellKind::ALL`].
    kinds: Vec<u8>,
    offsets: Vec<u32>,
    connectivity: Vec<u32>,
    cell_groups: BTreeMap<String, Vec<u32>>,
    facet_groups: BTreeMap<String, Vec<(u32, u8)>>,
    node_groups: BTreeMap<String, Vec<u32>>,
    bounds: [[f64; 3]; 2],
    is_plane: bool,
    facet_bounds: BTreeMap<String, [[f64; 3]; 2]>,
    nodes_of_kinds: BTreeMap<String, BTreeMap<String, Vec<u32>>>,
    n_own: usize,
    n_nodes_of_ranks: usize,
    nodes: Vec<u32>,
    cells: Vec<u32>,
    counts: Vec<bool>,
    /// Rank, outgoing and incoming nodes.
    neighbours: Vec<(usize, Vec<u32>, Vec<u32>)>,
    rank: usize,
}

impl From<Share> for Stored {
    fn from(share: Share) -> Self {
        let Share { mesh, n_own, n_nodes_of_ranks, nodes, cells, counts, neighbours, rank } = share;
        let Mesh { points, kinds, offsets, connectivity, groups, whole } = mesh;
        let none = Bounds {
            mesh: [[0.0; 3]; 2],
            is_plane: false,
            facet_groups: BTreeMap::new(),
            of_kinds: BTreeMap::new(),
        };
        let Bounds { mesh: bounds, is_plane, facet_groups: facet_bounds, of_kinds } = whole.unwrap_or(none);
        let facets = |facets: Vec<Facet>| facets.into_iter().map(|facet| (facet.cell, facet.local)).collect();
        let neighbour = |own: Neighbour| (own.rank, own.outgoing, own.incoming);
        Stored {
            points,
            kinds: kinds.into_iter().map(place).collect(),
            offsets,
            connectivity,
            cell_groups: groups.cells,
            facet_groups: groups.facets.into_iter().map(|(name, own)| (name, facets(own))).collect(),
            node_groups: groups.nodes,
            bounds,
            is_plane,
            facet_bounds,
            nodes_of_kinds: of_kinds,
            n_own,
            n_nodes_of_ranks,
            nodes,
            cells,
            counts,
            neighbours: neighbours.into_iter().map(neighbour).collect(),
            rank,
        }
    }
}

/// Place of a kind in [`CellKind::ALL`].
fn place(kind: CellKind) -> u8 {
    CellKind::ALL.iter().position(|own| *own == kind).unwrap_or_default() as u8
}

impl TryFrom<Stored> for Share {
    type Error = &'static str;

    fn try_from(stored: Stored) -> Result<Self, Self::Error> {
        let kinds: Option<Vec<CellKind>> =
            stored.kinds.iter().map(|&place| CellKind::ALL.get(usize::from(place)).copied()).collect();
        let kinds = kinds.ok_or("unknown kind of a cell")?;
        stored.check(&kinds).then_some(()).ok_or("numbers that no share has")?;
        let facets =
            |facets: Vec<(u32, u8)>| facets.into_iter().map(|(cell, local)| Facet { cell, local }).collect();
        let bounds = Bounds {
            mesh: stored.bounds,
            is_plane: stored.is_plane,
            facet_groups: stored.facet_bounds,
            of_kinds: stored.nodes_of_kinds,
        };
        let mesh = Mesh {
            points: stored.points,
            kinds,
            offsets: stored.offsets,
            connectivity: stored.connectivity,
            groups: Groups {
                cells: stored.cell_groups,
                facets: stored.facet_groups.into_iter().map(|(name, own)| (name, facets(own))).collect(),
                nodes: stored.node_groups,
            },
            whole: Some(bounds),
        };
        let neighbour = |(rank, outgoing, incoming)| Neighbour { rank, outgoing, incoming };
        Ok(Share {
            mesh,
            n_own: stored.n_own,
            n_nodes_of_ranks: stored.n_nodes_of_ranks,
            nodes: stored.nodes,
            cells: stored.cells,
            counts: stored.counts,
            neighbours: stored.neighbours.into_iter().map(neighbour).collect(),
            rank: stored.rank,
        })
    }
}

impl Stored {
    /// Whether all numbers point to something, as in every mesh.
    fn check(&self, kinds: &[CellKind]) -> bool {
        let (n_nodes, n_cells) = (self.points.len(), kinds.len());
        let below = |n: usize, numbers: &[u32]| numbers.iter().all(|&number| (number as usize) < n);
        let is_facet = |&(cell, local): &(u32, u8)| {
            kinds.get(cell as usize).is_some_and(|kind| usize::from(local) < kind.facets().len())
        };
        let ends = kinds.iter().scan(0, |end, kind| {
            *end += kind.n_nodes() as u32;
            Some(*end)
        });
        let has_corners = std::iter::once(0).chain(ends).eq(self.offsets.iter().copied())
            && self.offsets.last().is_some_and(|&end| end as usize == self.connectivity.len());
        let is_neighbour = |(_, outgoing, incoming): &(usize, Vec<u32>, Vec<u32>)| {
            below(self.n_own, outgoing) && below(n_nodes, incoming)
        };
        has_corners
            && below(n_nodes, &self.connectivity)
            && (1..=n_nodes).contains(&self.n_own)
            && [self.nodes.len(), self.cells.len(), self.counts.len()] == [n_nodes, n_cells, n_cells]
            && below(self.n_nodes_of_ranks, &self.nodes)
            && self.cell_groups.values().all(|group| below(n_cells, group))
            && self.node_groups.values().all(|group| below(n_nodes, group))
            && self.nodes_of_kinds.values().flat_map(BTreeMap::values).all(|group| below(n_nodes, group))
            && self.facet_groups.values().flatten().all(is_facet)
            && self.neighbours.iter().all(is_neighbour)
    }
}
