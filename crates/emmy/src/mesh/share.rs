//! The part of a mesh that a rank of a team computes.

use std::collections::BTreeMap;

use super::{Bounds, Facet, Groups, Mesh};
use crate::error::{Error, Result};
use crate::sparse::{Pattern, partition};
use crate::team::Neighbour;

/// The rank that owns each node, for a team of a size: METIS divides the nodes by their numbers of couplings.
///
/// ```
/// use emmy::mesh;
/// let mesh = mesh::block([4.0, 1.0, 1.0], [4, 1, 1])?;
/// let owners = mesh::owners(&mesh, 2)?;
/// assert!(owners.iter().all(|&rank| rank < 2));
/// # Ok::<(), emmy::Error>(())
/// ```
///
/// # Errors
/// [`Error::NotOnTeam`] unless each rank gets a node; [`Error::Linear`] for a mesh too large for METIS.
pub fn owners(mesh: &Mesh, size: usize) -> Result<Vec<u32>> {
    if size == 0 || size > mesh.n_nodes() {
        let what = format!("a mesh of {} nodes on {size} ranks", mesh.n_nodes());
        return Err(Error::NotOnTeam { what });
    }
    let cells: Vec<&[u32]> = mesh.cells().map(|cell| cell.nodes).collect();
    partition(&Pattern::new(mesh.n_nodes(), cells.iter().copied()), size)
}

/// The part of a mesh for one rank: its own nodes, every cell that touches one of them, and the other nodes of those cells,
/// its guests. Cells that count on the rank come first.
///
/// ```
/// use emmy::mesh::{self, Share};
/// // Two cells along x; the middle layer of nodes belongs to rank 0.
/// let mesh = mesh::block([2.0, 1.0, 1.0], [2, 1, 1])?;
/// let owners: Vec<u32> = mesh.points().iter().map(|X| u32::from(X[0] > 1.5)).collect();
/// let share = Share::new(&mesh, &owners, 1);
/// assert_eq!((share.mesh().n_cells(), share.n_own(), share.mesh().n_nodes()), (1, 4, 8));
/// assert_eq!(share.neighbours().collect::<Vec<_>>(), [(0, 4, 4)]);
/// assert_eq!(share.n_counted_cells(), 0); // it counts on rank 0
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Share {
    pub(crate) mesh: Mesh,
    pub(crate) n_own: usize,
    /// Number of nodes of the whole mesh.
    pub(crate) n_nodes_of_ranks: usize,
    /// Numbers of nodes and cells in the whole mesh.
    pub(crate) nodes: Vec<u32>,
    pub(crate) cells: Vec<u32>,
    /// Whether each cell counts here: on the lowest rank among the owners of its nodes. Those that do come first.
    pub(crate) counts: Vec<bool>,
    pub(crate) neighbours: Vec<Neighbour>,
    pub(crate) rank: usize,
}

impl Share {
    /// The share of a rank; `owners`: rank of each node, as from [`owners`].
    ///
    /// # Panics
    /// If there is not one owner for each node, or if the rank owns none.
    pub fn new(mesh: &Mesh, owners: &[u32], rank: usize) -> Self {
        assert_eq!(owners.len(), mesh.n_nodes(), "one owner for each node");
        let is_own = |&node: &u32| owners[node as usize] as usize == rank;
        let mut cells: Vec<u32> = (0..mesh.n_cells() as u32)
            .filter(|&cell| mesh.cell(cell as usize).nodes.iter().any(is_own))
            .collect();
        let counts = |&cell: &u32| {
            let lowest = mesh.cell(cell as usize).nodes.iter().map(|&node| owners[node as usize]).min();
            lowest == Some(rank as u32)
        };
        cells.sort_by_key(|cell| !counts(cell));
        let counts = cells.iter().map(counts).collect();
        let mut nodes: Vec<u32> = (0..mesh.n_nodes() as u32).filter(is_own).collect();
        let n_own = nodes.len();
        assert!(n_own > 0, "rank {rank} owns no node");
        let of_cells = || cells.iter().map(|&cell| mesh.cell(cell as usize));
        let mut guests: Vec<u32> =
            of_cells().flat_map(|cell| cell.nodes).copied().filter(|node| !is_own(node)).collect();
        guests.sort_unstable();
        guests.dedup();
        nodes.extend(guests);
        Share {
            counts,
            neighbours: neighbours(mesh, owners, rank, &nodes, &cells),
            mesh: mesh.part(&nodes, &cells),
            n_own,
            n_nodes_of_ranks: mesh.n_nodes(),
            nodes,
            cells,
            rank,
        }
    }

    /// The mesh of the share: own nodes first, then guests. Its groups have the names of the whole mesh, and may be empty.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Number of own nodes.
    pub fn n_own(&self) -> usize {
        self.n_own
    }

    /// Number of each node of the share in the whole mesh.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The ranks with which nodes are exchanged: number of the rank, of own nodes for it, and of guests from it.
    pub fn neighbours(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let numbers = |own: &Neighbour| (own.rank, own.outgoing.len(), own.incoming.len());
        self.neighbours.iter().map(numbers)
    }

    /// Number of cells that count on this rank; the others of the mesh are computed here and on another rank.
    pub fn n_counted_cells(&self) -> usize {
        self.counts.iter().filter(|counts| **counts).count()
    }
}

/// Own nodes that are guests of each neighbour, and guests that it owns, both in the order of the whole mesh: a node of a cell
/// is a guest of every rank that owns another node of it.
fn neighbours(mesh: &Mesh, owners: &[u32], rank: usize, nodes: &[u32], cells: &[u32]) -> Vec<Neighbour> {
    let mut shared: BTreeMap<u32, [Vec<u32>; 2]> = BTreeMap::new();
    for &cell in cells {
        let of_cell = mesh.cell(cell as usize).nodes;
        for &node in of_cell {
            let owner = owners[node as usize];
            if owner as usize != rank {
                shared.entry(owner).or_default()[1].push(node);
                continue;
            }
            for &other in of_cell {
                let other = owners[other as usize];
                if other as usize != rank {
                    shared.entry(other).or_default()[0].push(node);
                }
            }
        }
    }
    let own_numbers: BTreeMap<u32, u32> = nodes.iter().copied().zip(0..).collect();
    let local = |mut nodes: Vec<u32>| -> Vec<u32> {
        nodes.sort_unstable();
        nodes.dedup();
        nodes.iter().map(|node| own_numbers[node]).collect()
    };
    let neighbour = |(rank, [outgoing, incoming]): (u32, [Vec<u32>; 2])| Neighbour {
        rank: rank as usize,
        outgoing: local(outgoing),
        incoming: local(incoming),
    };
    shared.into_iter().map(neighbour).collect()
}

impl Mesh {
    fn all_bounds(&self) -> Bounds {
        let of_group = |name: &String| Some((name.clone(), self.facet_bounds(name).ok()?));
        Bounds {
            mesh: self.bounds(),
            is_plane: self.is_plane(),
            facet_groups: self.groups.facets.keys().filter_map(of_group).collect(),
        }
    }

    /// Some nodes and cells as a mesh of their own, with the nodes of all groups.
    #[doc(hidden)]
    pub fn part(&self, nodes: &[u32], cells: &[u32]) -> Mesh {
        let absent = u32::MAX;
        let numbers = |chosen: &[u32], n: usize| {
            let mut numbers = vec![absent; n];
            chosen.iter().zip(0..).for_each(|(&whole, own)| numbers[whole as usize] = own);
            numbers
        };
        let node_numbers = numbers(nodes, self.n_nodes());
        let cell_numbers = numbers(cells, self.n_cells());
        let mut part = Mesh {
            points: nodes.iter().map(|&node| self.points[node as usize]).collect(),
            kinds: cells.iter().map(|&cell| self.kinds[cell as usize]).collect(),
            offsets: vec![0],
            connectivity: Vec::new(),
            groups: Groups::default(),
            whole: Some(self.all_bounds()),
        };
        for &cell in cells {
            let of_cell = self.cell(cell as usize).nodes.iter();
            part.connectivity.extend(of_cell.map(|&node| node_numbers[node as usize]));
            part.offsets.push(part.connectivity.len() as u32);
        }
        let of_cells = |whole: &[u32]| -> Vec<u32> {
            whole.iter().map(|&cell| cell_numbers[cell as usize]).filter(|&cell| cell != absent).collect()
        };
        for (name, whole) in &self.groups.cells {
            part.groups.cells.insert(name.clone(), of_cells(whole));
        }
        for (name, whole) in &self.groups.facets {
            let own = whole.iter().map(|facet| Facet { cell: cell_numbers[facet.cell as usize], ..*facet });
            part.groups.facets.insert(name.clone(), own.filter(|facet| facet.cell != absent).collect());
        }
        // A guest may belong to a group by a cell that is not here.
        for name in self.groups.names() {
            let whole = self.group_nodes(name).unwrap_or_default();
            let mut own: Vec<u32> = whole.iter().map(|&node| node_numbers[node as usize]).collect();
            own.retain(|&node| node != absent);
            own.sort_unstable();
            part.groups.nodes.insert(name.to_string(), own);
        }
        part
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::l_block;

    #[test]
    fn shares_have_every_node_once_and_every_cell_counts_once() {
        let mesh = l_block(1.0).unwrap();
        for size in 1..6 {
            let owners = owners(&mesh, size).unwrap();
            let shares: Vec<Share> = (0..size).map(|rank| Share::new(&mesh, &owners, rank)).collect();
            let n_own: usize = shares.iter().map(Share::n_own).sum();
            let counted: usize = shares.iter().map(Share::n_counted_cells).sum();
            assert_eq!((n_own, counted), (mesh.n_nodes(), mesh.n_cells()));
            for share in &shares {
                for (own, &whole) in share.nodes.iter().enumerate() {
                    assert_eq!(share.mesh.points()[own], mesh.points()[whole as usize]);
                    assert_eq!(owners[whole as usize] as usize == share.rank, own < share.n_own);
                }
                for name in mesh.groups().names() {
                    let whole: Vec<u32> = mesh.group_nodes(name).unwrap();
                    let mut own: Vec<u32> = share
                        .mesh
                        .group_nodes(name)
                        .unwrap()
                        .iter()
                        .map(|&node| share.nodes[node as usize])
                        .collect();
                    own.sort_unstable();
                    let expected = whole.iter().filter(|node| share.nodes.contains(node));
                    assert!(own.iter().eq(expected), "{name}");
                }
            }
        }
    }

    #[test]
    fn neighbours_have_the_same_nodes_in_the_same_order() {
        let mesh = l_block(1.0).unwrap();
        let owners = owners(&mesh, 4).unwrap();
        let shares: Vec<Share> = (0..4).map(|rank| Share::new(&mesh, &owners, rank)).collect();
        let whole = |share: &Share, nodes: &[u32]| -> Vec<u32> {
            nodes.iter().map(|&node| share.nodes[node as usize]).collect()
        };
        for share in &shares {
            let mut n_guests = 0;
            for neighbour in &share.neighbours {
                let other = &shares[neighbour.rank];
                let back = other.neighbours.iter().find(|back| back.rank == share.rank).unwrap();
                assert_eq!(whole(share, &neighbour.outgoing), whole(other, &back.incoming));
                n_guests += neighbour.incoming.len();
            }
            assert_eq!(n_guests, share.nodes.len() - share.n_own);
        }
    }

    #[test]
    fn one_rank_has_the_whole_mesh() {
        let mesh = l_block(1.0).unwrap();
        let share = Share::new(&mesh, &vec![0; mesh.n_nodes()], 0);
        assert_eq!((share.mesh.points(), share.neighbours.len()), (mesh.points(), 0));
        assert!(share.mesh.cells().eq(mesh.cells()));
        assert_eq!(
            owners(&mesh, 225).unwrap_err().to_string(),
            "a mesh of 224 nodes on 225 ranks is not possible on a team"
        );
    }
}
