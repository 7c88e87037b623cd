//! The part of a mesh that a rank of a team computes.

mod shares;
mod stored;

pub use shares::Shares;

use serde::{Deserialize, Serialize};

use super::Mesh;
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

/// The part of a mesh for one rank: its own nodes, every cell that touches one of them, and the other nodes of those
/// cells, its guests. Cells that count on the rank come first.
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(into = "stored::Stored", try_from = "stored::Stored")]
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
    /// The share of a rank; `owners`: rank of each node, as from [`owners`]. [`Shares`] makes those of all ranks.
    ///
    /// # Panics
    /// If there is not one owner for each node, or if the rank owns none.
    pub fn new(mesh: &Mesh, owners: &[u32], rank: usize) -> Self {
        Shares::new(mesh, owners).share(rank)
    }

    /// A whole mesh as the share of a team of one.
    ///
    /// ```
    /// use emmy::mesh::{self, Share};
    /// let share = Share::whole(mesh::block([2.0, 1.0, 1.0], [2, 1, 1])?);
    /// assert_eq!((share.rank(), share.n_own(), share.n_counted_cells()), (0, 12, 2));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn whole(mesh: Mesh) -> Self {
        let (n_nodes, n_cells) = (mesh.n_nodes(), mesh.n_cells());
        Share {
            mesh,
            n_own: n_nodes,
            n_nodes_of_ranks: n_nodes,
            nodes: (0..n_nodes as u32).collect(),
            cells: (0..n_cells as u32).collect(),
            counts: vec![true; n_cells],
            neighbours: Vec::new(),
            rank: 0,
        }
    }

    /// Number of the rank.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// The mesh of the share: own nodes first, then guests. Its groups have the names of the whole mesh, and may be
    /// empty.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Number of own nodes.
    pub fn n_own(&self) -> usize {
        self.n_own
    }

    /// Number of nodes of the whole mesh.
    pub fn n_nodes_of_ranks(&self) -> usize {
        self.n_nodes_of_ranks
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::l_block;

    #[test]
    fn shares_have_every_node_once_and_every_cell_counts_once() {
        // A name of cells, facets and nodes: the last node is in neither of the others.
        let last = l_block(1.0).unwrap().n_nodes() as u32 - 1;
        let mesh = l_block(1.0).unwrap().with_node_group("face-a", [last]).unwrap();
        let mesh = mesh.with_node_group("body", [0]).unwrap();
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
                let plain = mesh.groups().names().into_iter().map(str::to_string);
                let chosen = ["nodes:face-a", "facets:face-a", "nodes:body", "cells:body", "facets:face-b"];
                for absent in ["cells:face-a", "nodes:face-b", "cells:cells:body"] {
                    assert!(mesh.group_nodes(absent).is_err() && share.mesh.group_nodes(absent).is_err());
                }
                for name in &plain.chain(chosen.map(str::to_string)).collect::<Vec<_>>() {
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

    /// Time in proportion to the mesh, whatever the number of ranks.
    #[test]
    #[ignore = "seconds and a gigabyte; `.ci/run` and `just validate` run it"]
    fn many_shares_of_a_large_mesh() {
        let mesh = crate::mesh::block([1.0; 3], [99; 3]).unwrap();
        for n in [4, 8, 16] {
            // Cubes of nodes: n x n x 4 ranks.
            let part = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
            let owner = |&[x, y, z]: &[f64; 3]| ((part(x, n) * n + part(y, n)) * 4 + part(z, 4)) as u32;
            let owners: Vec<u32> = mesh.points().iter().map(owner).collect();
            let begin = std::time::Instant::now();
            let shares = Shares::new(&mesh, &owners);
            let lists = begin.elapsed();
            let n_own: usize = (0..shares.size()).map(|rank| shares.share(rank).n_own()).sum();
            assert_eq!(n_own, mesh.n_nodes());
            println!("{} shares: {lists:?} for lists, {:?} in all", shares.size(), begin.elapsed());
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
