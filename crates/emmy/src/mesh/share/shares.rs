//! The shares of all ranks of a mesh.

use std::collections::BTreeMap;

use super::Share;
use crate::mesh::{Bounds, Facet, Groups, Mesh};
use crate::team::Neighbour;

/// The shares of all ranks of a mesh, made one after another. All of them take a time in proportion to the mesh and its
/// groups.
///
/// ```
/// use emmy::mesh::{self, Shares};
/// let mesh = mesh::block([4.0, 1.0, 1.0], [4, 1, 1])?;
/// let owners = mesh::owners(&mesh, 2)?;
/// let shares = Shares::new(&mesh, &owners);
/// assert_eq!((0..2).map(|rank| shares.share(rank).n_own()).sum::<usize>(), mesh.n_nodes());
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct Shares<'a> {
    mesh: &'a Mesh,
    owners: &'a [u32],
    bounds: Bounds,
    /// Nodes that each rank owns, and cells that touch one of them.
    nodes: Lists,
    cells: Lists,
    groups: GroupLists<'a>,
}

/// Lists of numbers, one after another.
#[derive(Debug)]
struct Lists {
    offsets: Vec<usize>,
    numbers: Vec<u32>,
}

impl Lists {
    /// The lists of pairs (list, number), each in the order of the pairs.
    fn new<P: Iterator<Item = (u32, u32)>>(n: usize, pairs: impl Fn() -> P) -> Self {
        let mut offsets = vec![0; n + 1];
        pairs().for_each(|(list, _)| offsets[list as usize + 1] += 1);
        (0..n).for_each(|list| offsets[list + 1] += offsets[list]);
        let mut next = offsets.clone();
        let mut numbers = vec![0; offsets[n]];
        for (list, number) in pairs() {
            numbers[next[list as usize]] = number;
            next[list as usize] += 1;
        }
        Lists { offsets, numbers }
    }

    fn of(&self, list: usize) -> &[u32] {
        &self.numbers[self.offsets[list]..self.offsets[list + 1]]
    }
}

/// The groups of each entity of a mesh, by the numbers of their names.
#[derive(Debug)]
struct GroupLists<'a> {
    cell_names: Vec<&'a String>,
    of_cells: Lists,
    facet_names: Vec<&'a String>,
    /// Facets of each cell: number of the group, times 256, and number of the face.
    of_facets: Lists,
    node_names: Vec<&'a str>,
    of_nodes: Lists,
    /// Of names of several kinds: name, kind and nodes.
    of_kinds: Vec<(&'a str, &'static str, Vec<u32>)>,
}

impl<'a> GroupLists<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let Groups { cells, facets, .. } = mesh.groups();
        let node_names = mesh.groups().names();
        // A guest may belong to a group by a cell that is not in its share.
        let nodes: Vec<Vec<u32>> =
            node_names.iter().map(|name| mesh.group_nodes(name).unwrap_or_default()).collect();
        let of_kinds =
            node_names.iter().filter(|name| mesh.groups().kinds(name).len() > 1).flat_map(|&name| {
                let nodes = move |kind| Some((name, kind, mesh.group_nodes(&format!("{kind}:{name}")).ok()?));
                mesh.groups().kinds(name).into_iter().filter_map(nodes)
            });
        let of_lists = |lists: &[&Vec<u32>]| -> Vec<(u32, u32)> {
            let pairs =
                |(group, list): (u32, &&Vec<u32>)| list.iter().map(move |&number| (number, group)).collect();
            (0..).zip(lists).flat_map(|pair| -> Vec<(u32, u32)> { pairs(pair) }).collect()
        };
        let of_cells = of_lists(&cells.values().collect::<Vec<_>>());
        let of_nodes = of_lists(&nodes.iter().collect::<Vec<_>>());
        let of_facets = || {
            let groups = (0..).zip(facets.values());
            groups.flat_map(|(group, facets): (u32, _)| {
                facets.iter().map(move |facet: &Facet| (facet.cell, 256 * group + u32::from(facet.local)))
            })
        };
        GroupLists {
            cell_names: cells.keys().collect(),
            of_cells: Lists::new(mesh.n_cells(), || of_cells.iter().copied()),
            of_kinds: of_kinds.collect(),
            facet_names: facets.keys().collect(),
            of_facets: Lists::new(mesh.n_cells(), of_facets),
            node_names,
            of_nodes: Lists::new(mesh.n_nodes(), || of_nodes.iter().copied()),
        }
    }

    /// The nodes, among some, of names of several kinds.
    fn of_kinds(&self, nodes: &[u32]) -> BTreeMap<String, BTreeMap<String, Vec<u32>>> {
        let mut all: BTreeMap<String, BTreeMap<String, Vec<u32>>> = BTreeMap::new();
        for (name, kind, members) in &self.of_kinds {
            let own = (0..).zip(nodes).filter(|(_, node)| members.binary_search(node).is_ok());
            let own = own.map(|(own, _)| own).collect();
            all.entry(name.to_string()).or_default().insert(kind.to_string(), own);
        }
        all
    }

    /// The groups of some nodes and cells, with their numbers among these.
    fn part(&self, nodes: &[u32], cells: &[u32]) -> Groups {
        let mut of_cells = vec![Vec::new(); self.cell_names.len()];
        let mut of_facets = vec![Vec::new(); self.facet_names.len()];
        let mut of_nodes = vec![Vec::new(); self.node_names.len()];
        for (own, &cell) in (0..).zip(cells) {
            self.of_cells.of(cell as usize).iter().for_each(|&group| of_cells[group as usize].push(own));
            for &facet in self.of_facets.of(cell as usize) {
                let local = (facet % 256) as u8;
                of_facets[(facet / 256) as usize].push(Facet { cell: own, local });
            }
        }
        for (own, &node) in (0..).zip(nodes) {
            self.of_nodes.of(node as usize).iter().for_each(|&group| of_nodes[group as usize].push(own));
        }
        fn named<T>(names: impl Iterator<Item = String>, lists: Vec<Vec<T>>) -> BTreeMap<String, Vec<T>> {
            let exact = |mut list: Vec<T>| {
                list.shrink_to_fit();
                list
            };
            names.zip(lists.into_iter().map(exact)).collect()
        }
        Groups {
            cells: named(self.cell_names.iter().map(|name| name.to_string()), of_cells),
            facets: named(self.facet_names.iter().map(|name| name.to_string()), of_facets),
            nodes: named(self.node_names.iter().map(|name| name.to_string()), of_nodes),
        }
    }
}

/// The nodes of a share: own ones, then guests, both ascending.
struct Nodes<'a> {
    own: &'a [u32],
    guests: Vec<u32>,
}

impl Nodes<'_> {
    /// Number in the share of a node of the whole mesh.
    fn number(&self, node: u32) -> u32 {
        let place = self.own.binary_search(&node);
        place.unwrap_or_else(|_| self.own.len() + self.guests.partition_point(|&guest| guest < node)) as u32
    }
}

impl<'a> Shares<'a> {
    /// The shares of a mesh; `owners`: rank of each node, as from [`crate::mesh::owners`].
    ///
    /// # Panics
    /// If there is not one owner for each node.
    pub fn new(mesh: &'a Mesh, owners: &'a [u32]) -> Self {
        assert_eq!(owners.len(), mesh.n_nodes(), "one owner for each node");
        let size = owners.iter().max().map_or(0, |&rank| rank as usize + 1);
        let owned = || (0..).zip(owners).map(|(node, &owner)| (owner, node));
        let touched = || {
            (0..).zip(mesh.cells()).flat_map(|(index, cell)| {
                let owner = |place: usize| owners[cell.nodes[place] as usize];
                let is_first = move |&place: &usize| (0..place).all(|other| owner(other) != owner(place));
                (0..cell.nodes.len()).filter(is_first).map(move |place| (owner(place), index))
            })
        };
        Shares {
            mesh,
            owners,
            bounds: mesh.all_bounds(),
            nodes: Lists::new(size, owned),
            cells: Lists::new(size, touched),
            groups: GroupLists::new(mesh),
        }
    }

    /// Number of ranks.
    pub fn size(&self) -> usize {
        self.nodes.offsets.len() - 1
    }

    /// The share of a rank.
    ///
    /// # Panics
    /// If the rank owns no node.
    pub fn share(&self, rank: usize) -> Share {
        let own = if rank < self.size() { self.nodes.of(rank) } else { &[] };
        assert!(!own.is_empty(), "rank {rank} owns no node");
        let owner = |node: u32| self.owners[node as usize];
        let counts = |&cell: &u32| {
            let of_cell = self.mesh.cell(cell as usize).nodes.iter();
            of_cell.map(|&node| owner(node)).min() == Some(rank as u32)
        };
        let mut cells = self.cells.of(rank).to_vec();
        cells.sort_by_key(|cell| !counts(cell));
        let of_cells = || cells.iter().map(|&cell| self.mesh.cell(cell as usize).nodes);
        let mut guests: Vec<u32> =
            of_cells().flatten().copied().filter(|&node| owner(node) as usize != rank).collect();
        guests.sort_unstable();
        guests.dedup();
        let nodes = Nodes { own, guests };
        let numbers = [nodes.own, &nodes.guests].concat();
        Share {
            counts: cells.iter().map(counts).collect(),
            neighbours: self.neighbours(rank, &nodes),
            mesh: part(self.mesh, (&self.groups, self.bounds.clone()), (&numbers, &cells), |node| {
                nodes.number(node)
            }),
            n_own: own.len(),
            n_nodes_of_ranks: self.mesh.n_nodes(),
            nodes: numbers,
            cells,
            rank,
        }
    }

    /// Own nodes that are guests of each neighbour, and guests that it owns, both in the order of the whole mesh: a
    /// node of a cell is a guest of every rank that owns another node of it.
    fn neighbours(&self, rank: usize, nodes: &Nodes<'_>) -> Vec<Neighbour> {
        let mut shared: BTreeMap<u32, [Vec<u32>; 2]> = BTreeMap::new();
        let owner = |node: u32| self.owners[node as usize];
        for &cell in self.cells.of(rank) {
            let of_cell = self.mesh.cell(cell as usize).nodes;
            for &node in of_cell {
                if owner(node) as usize != rank {
                    shared.entry(owner(node)).or_default()[1].push(node);
                    continue;
                }
                for other in of_cell.iter().map(|&other| owner(other)).filter(|&other| other as usize != rank)
                {
                    shared.entry(other).or_default()[0].push(node);
                }
            }
        }
        let local = |mut of_neighbour: Vec<u32>| -> Vec<u32> {
            of_neighbour.sort_unstable();
            of_neighbour.dedup();
            of_neighbour.iter().map(|&node| nodes.number(node)).collect()
        };
        let neighbour = |(rank, [outgoing, incoming]): (u32, [Vec<u32>; 2])| Neighbour {
            rank: rank as usize,
            outgoing: local(outgoing),
            incoming: local(incoming),
        };
        shared.into_iter().map(neighbour).collect()
    }
}

/// Some nodes and cells of a mesh as a mesh of their own, with all groups; `number`: of a node among these.
fn part(
    whole: &Mesh,
    (groups, bounds): (&GroupLists<'_>, Bounds),
    (nodes, cells): (&[u32], &[u32]),
    number: impl Fn(u32) -> u32,
) -> Mesh {
    let n_corners = cells.iter().map(|&cell| whole.cell(cell as usize).nodes.len()).sum();
    let mut part = Mesh {
        points: nodes.iter().map(|&node| whole.points[node as usize]).collect(),
        kinds: cells.iter().map(|&cell| whole.kinds[cell as usize]).collect(),
        offsets: Vec::with_capacity(cells.len() + 1),
        connectivity: Vec::with_capacity(n_corners),
        groups: groups.part(nodes, cells),
        whole: Some(Bounds { of_kinds: groups.of_kinds(nodes), ..bounds }),
    };
    part.offsets.push(0);
    for &cell in cells {
        part.connectivity.extend(whole.cell(cell as usize).nodes.iter().map(|&node| number(node)));
        part.offsets.push(part.connectivity.len() as u32);
    }
    part
}

impl Mesh {
    /// Some nodes and cells as a mesh of their own, with the nodes of all groups.
    #[doc(hidden)]
    pub fn part(&self, nodes: &[u32], cells: &[u32]) -> Mesh {
        let numbers: BTreeMap<u32, u32> = nodes.iter().copied().zip(0..).collect();
        part(self, (&GroupLists::new(self), self.all_bounds()), (nodes, cells), |node| numbers[&node])
    }

    fn all_bounds(&self) -> Bounds {
        let of_group = |name: &String| Some((name.clone(), self.facet_bounds(name).ok()?));
        Bounds {
            mesh: self.bounds(),
            is_plane: self.is_plane(),
            facet_groups: self.groups.facets.keys().filter_map(of_group).collect(),
            of_kinds: BTreeMap::new(),
        }
    }
}
