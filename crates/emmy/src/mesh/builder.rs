//! Construction of a mesh: the one place where nodes, cells and groups are checked against each other.

mod edges;
mod orientation;

use std::collections::{BTreeMap, HashMap};

use super::{CellKind, Facet, Groups, Mesh};
use crate::error::{Error, Result};

/// Collects nodes, cells and groups and checks them once, in [`MeshBuilder::build`].
///
/// ```
/// use emmy::prelude::*;
/// let mut builder = MeshBuilder::new();
/// for point in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
///     builder.point(point);
/// }
/// let cell = builder.cell(CellKind::Tet4, &[0, 1, 2, 3])?;
/// builder.cell_group("body", [cell]);
/// builder.facet_group_by_nodes("floor", vec![vec![0, 2, 1]]);
/// let mesh = builder.build()?;
/// assert_eq!(mesh.groups().facets("floor")?.len(), 1);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct MeshBuilder {
    points: Vec<[f64; 3]>,
    kinds: Vec<CellKind>,
    offsets: Vec<u32>,
    connectivity: Vec<u32>,
    groups: Groups,
    facets_by_nodes: Vec<(String, Vec<Vec<u32>>)>,
}

impl MeshBuilder {
    /// A builder without nodes or cells.
    pub fn new() -> Self {
        MeshBuilder { offsets: vec![0], ..Default::default() }
    }

    /// Adds a node at its reference position and returns its index.
    pub fn point(&mut self, point: [f64; 3]) -> u32 {
        self.points.push(point);
        (self.points.len() - 1) as u32
    }

    /// Adds a cell with its nodes in VTK order and returns its index.
    ///
    /// # Errors
    /// [`Error::WrongNodeCount`] if the kind has another number of nodes.
    pub fn cell(&mut self, kind: CellKind, nodes: &[u32]) -> Result<u32> {
        if nodes.len() != kind.n_nodes() {
            return Err(Error::WrongNodeCount { kind, expected: kind.n_nodes(), found: nodes.len() });
        }
        self.kinds.push(kind);
        self.connectivity.extend_from_slice(nodes);
        self.offsets.push(self.connectivity.len() as u32);
        Ok((self.kinds.len() - 1) as u32)
    }

    /// Adds cells to a named group.
    pub fn cell_group(&mut self, name: &str, cells: impl IntoIterator<Item = u32>) {
        self.groups.cells.entry(name.to_string()).or_default().extend(cells);
    }

    /// Adds facets, given as faces of cells, to a named group.
    pub fn facet_group(&mut self, name: &str, facets: impl IntoIterator<Item = Facet>) {
        self.groups.facets.entry(name.to_string()).or_default().extend(facets);
    }

    /// Adds facets, given by their nodes in any order (corners suffice), to a named group.
    pub fn facet_group_by_nodes(&mut self, name: &str, facets: Vec<Vec<u32>>) {
        self.facets_by_nodes.push((name.to_string(), facets));
    }

    /// Adds nodes to a named group.
    pub fn node_group(&mut self, name: &str, nodes: impl IntoIterator<Item = u32>) {
        self.groups.nodes.entry(name.to_string()).or_default().extend(nodes);
    }

    /// Adds a mesh as a part with a name: its nodes and cells after those that are there, a cell group of the name, and
    /// each of its groups with the name and a hyphen before its own. A cell group `body` of all its cells is not
    /// repeated. Parts share no nodes; [`Mesh::merged`] joins those that meet.
    ///
    /// ```
    /// use emmy::mesh::{MeshBuilder, Placement, ball, block};
    /// let mut builder = MeshBuilder::new();
    /// builder.part("base", &block([2.0, 2.0, 1.0], [2, 2, 1])?)?;
    /// builder.part("top", &ball(1.0, 2)?.placed(&Placement::default().shifted([1.0, 1.0, 2.5]))?)?;
    /// let mesh = builder.build()?;
    /// assert_eq!((mesh.groups().cells("base")?.len(), mesh.groups().cells("top")?.len()), (4, 32));
    /// assert_eq!(mesh.groups().facets("top-surface")?.len(), 24);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::PartName`] for a name that is empty or has other characters than letters, digits, `_` and `-`,
    /// [`Error::GroupOfPartExists`] if a group with one of its names is there already, [`Error::MixedParts`] for cells
    /// in plane strain beside solid ones; nothing is added then.
    pub fn part(&mut self, name: &str, mesh: &Mesh) -> Result<()> {
        if name.is_empty() || !name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-') {
            return Err(Error::PartName { part: name.to_string() });
        }
        let groups = mesh.groups();
        let own = |group: &str| groups.name_in_part(name, mesh.n_cells(), group);
        let mut names = groups.names().into_iter().map(own).chain([name.to_string()]);
        if let Some(group) = names.find(|group| self.has_group(group)) {
            return Err(Error::GroupOfPartExists { part: name.to_string(), group });
        }
        let has = |dimension: usize| {
            let is_of = |kind: CellKind| kind.dimension() == dimension;
            self.kinds.iter().any(|kind| is_of(*kind)) || mesh.cells().any(|cell| is_of(cell.kind))
        };
        if has(2) && has(3) {
            return Err(Error::MixedParts { part: name.to_string() });
        }
        let (first_node, first_cell) = (self.points.len() as u32, self.kinds.len() as u32);
        self.points.extend(mesh.points());
        for cell in mesh.cells() {
            self.kinds.push(cell.kind);
            self.connectivity.extend(cell.nodes.iter().map(|node| first_node + node));
            self.offsets.push(self.connectivity.len() as u32);
        }
        self.cell_group(name, first_cell..self.kinds.len() as u32);
        for (group, cells) in &groups.cells {
            self.cell_group(&own(group), cells.iter().map(|cell| first_cell + cell));
        }
        for (group, facets) in &groups.facets {
            let moved = |facet: &Facet| Facet { cell: first_cell + facet.cell, ..*facet };
            self.facet_group(&own(group), facets.iter().map(moved));
        }
        for (group, nodes) in &groups.nodes {
            self.node_group(&own(group), nodes.iter().map(|node| first_node + node));
        }
        Ok(())
    }

    fn has_group(&self, name: &str) -> bool {
        let Groups { cells, facets, nodes } = &self.groups;
        let is_by_nodes = self.facets_by_nodes.iter().any(|(own, _)| own == name);
        is_by_nodes || cells.contains_key(name) || facets.contains_key(name) || nodes.contains_key(name)
    }

    /// Leaves out the facets given by nodes that are no face of a cell, such as shells beside solids, and returns their
    /// numbers by group: their nodes form the group of nodes of the same name.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let mut builder = MeshBuilder::new();
    /// for point in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [2.0, 0.0, 0.0]] {
    ///     builder.point(point);
    /// }
    /// builder.cell(CellKind::Tet4, &[0, 1, 2, 3])?;
    /// builder.facet_group_by_nodes("cover", vec![vec![0, 2, 1], vec![1, 4, 2]]);
    /// assert_eq!(builder.drop_free_facets()["cover"], 1);
    /// let mesh = builder.build()?;
    /// assert_eq!((mesh.groups().facets("cover")?.len(), mesh.group_nodes("nodes:cover")?), (1, vec![1, 2]));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn drop_free_facets(&mut self) -> BTreeMap<String, usize> {
        let mut dropped = BTreeMap::new();
        if self.facets_by_nodes.is_empty() {
            return dropped;
        }
        let faces = self.faces_by_corners();
        for (name, facets) in std::mem::take(&mut self.facets_by_nodes) {
            let is_empty = facets.is_empty();
            let mut found = Vec::with_capacity(facets.len());
            for nodes in facets {
                let face = corner_keys(&nodes).find_map(|key| faces.get(&key)).copied();
                match face {
                    Some(facet) => found.push(facet),
                    None => {
                        *dropped.entry(name.clone()).or_default() += 1;
                        self.node_group(&name, nodes);
                    }
                }
            }
            if is_empty || !found.is_empty() {
                self.facet_group(&name, found);
            }
        }
        dropped
    }

    /// The mesh, checked. Nodes that no cell uses are left out: they would have no mass.
    ///
    /// # Errors
    /// [`Error::EmptyMesh`], [`Error::NodeOutOfRange`], [`Error::CoordinateNotFinite`], [`Error::FacetWithoutCell`],
    /// [`Error::NotInPlane`].
    pub fn build(mut self) -> Result<Mesh> {
        self.check()?;
        self.find_facets()?;
        self.drop_unused_nodes();
        let MeshBuilder { points, kinds, offsets, connectivity, mut groups, .. } = self;
        groups.cells.values_mut().for_each(sort_unique);
        groups.facets.values_mut().for_each(sort_unique);
        groups.nodes.values_mut().for_each(sort_unique);
        Ok(Mesh { points, kinds, offsets, connectivity, groups, whole: None })
    }

    fn check(&self) -> Result<()> {
        if self.kinds.is_empty() {
            return Err(Error::EmptyMesh);
        }
        let n_nodes = self.points.len();
        for (cell, range) in self.offsets.windows(2).enumerate() {
            let nodes = &self.connectivity[range[0] as usize..range[1] as usize];
            if let Some(&node) = nodes.iter().find(|&&node| node as usize >= n_nodes) {
                return Err(Error::NodeOutOfRange { cell, node: node as usize, n_nodes });
            }
        }
        match self.points.iter().position(|point| point.iter().any(|x| !x.is_finite())) {
            Some(node) => Err(Error::CoordinateNotFinite { node }),
            None => self.check_plane(),
        }
    }

    /// All nodes of plane cells must have one z, up to rounding of the coordinates.
    fn check_plane(&self) -> Result<()> {
        let cells = self.kinds.iter().zip(self.offsets.windows(2));
        let plane_cells = cells.filter(|(kind, _)| kind.dimension() == 2);
        let nodes =
            plane_cells.flat_map(|(_, range)| &self.connectivity[range[0] as usize..range[1] as usize]);
        let nodes: Vec<(usize, [f64; 3])> =
            nodes.map(|&node| (node as usize, self.points[node as usize])).collect();
        let Some(&(_, [.., plane])) = nodes.first() else { return Ok(()) };
        let size = nodes.iter().flat_map(|(_, point)| point).fold(0.0, |size: f64, x| size.max(x.abs()));
        match nodes.iter().find(|(_, [.., z])| (z - plane).abs() > 1e-9 * size) {
            Some(&(node, [.., z])) => Err(Error::NotInPlane { node, z, plane }),
            None => Ok(()),
        }
    }

    /// Whether each point is a node of a cell; [`MeshBuilder::build`] leaves out the others.
    pub fn used_points(&self) -> Vec<bool> {
        let mut is_used = vec![false; self.points.len()];
        // `build` reports nodes that are not there.
        let nodes =
            self.connectivity.iter().map(|&node| node as usize).filter(|&node| node < self.points.len());
        nodes.for_each(|node| is_used[node] = true);
        is_used
    }

    /// Finds the face of a cell for every facet given by its nodes so far, as [`MeshBuilder::build`] does.
    ///
    /// # Errors
    /// [`Error::FacetWithoutCell`].
    pub fn find_facets(&mut self) -> Result<()> {
        let wanted = std::mem::take(&mut self.facets_by_nodes);
        if wanted.is_empty() {
            return Ok(());
        }
        let faces = self.faces_by_corners();
        for (name, facets) in wanted {
            let group = self.groups.facets.entry(name.clone()).or_default();
            for nodes in facets {
                let found = corner_keys(&nodes).find_map(|key| faces.get(&key));
                let missing = || Error::FacetWithoutCell { group: name.clone(), nodes: nodes.clone() };
                group.push(*found.ok_or_else(missing)?);
            }
        }
        Ok(())
    }

    /// Every face of every cell by its sorted corners; an inner face belongs to the first of its two cells.
    fn faces_by_corners(&self) -> HashMap<[u32; 4], Facet> {
        let mut faces = HashMap::new();
        for (cell, (&kind, range)) in self.kinds.iter().zip(self.offsets.windows(2)).enumerate() {
            let nodes = &self.connectivity[range[0] as usize..range[1] as usize];
            for (local, facet) in kind.facets().iter().enumerate() {
                let mut key = [u32::MAX; 4];
                for (slot, &corner) in key.iter_mut().zip(&facet.nodes[..facet.kind.n_corners()]) {
                    *slot = nodes[corner];
                }
                key.sort_unstable();
                faces.entry(key).or_insert(Facet { cell: cell as u32, local: local as u8 });
            }
        }
        faces
    }

    fn drop_unused_nodes(&mut self) {
        let mut new_index: Vec<u32> =
            self.used_points().into_iter().map(|is_used| if is_used { 0 } else { u32::MAX }).collect();
        for (next, index) in new_index.iter_mut().filter(|index| **index == 0).enumerate() {
            *index = next as u32;
        }
        let mut node = 0;
        self.points.retain(|_| {
            node += 1;
            new_index[node - 1] != u32::MAX
        });
        self.connectivity.iter_mut().for_each(|node| *node = new_index[*node as usize]);
        for nodes in self.groups.nodes.values_mut() {
            let used = nodes.iter().filter_map(|&node| new_index.get(node as usize).copied());
            *nodes = used.filter(|&index| index != u32::MAX).collect();
        }
    }
}

/// Possible corner sets of a node list: the first four nodes, else the first three, else two.
fn corner_keys(nodes: &[u32]) -> impl Iterator<Item = [u32; 4]> + '_ {
    [4, 3, 2].into_iter().filter(|&n| n <= nodes.len()).map(|n| {
        let mut key = [u32::MAX; 4];
        key[..n].copy_from_slice(&nodes[..n]);
        key.sort_unstable();
        key
    })
}

fn sort_unique<T: Ord>(items: &mut Vec<T>) {
    items.sort_unstable();
    items.dedup();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> MeshBuilder {
        let mut builder = MeshBuilder::new();
        builder.point([9.0, 9.0, 9.0]); // no cell uses it
        for point in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            builder.point(point);
        }
        builder.cell(CellKind::Tet4, &[1, 2, 3, 4]).unwrap();
        builder
    }

    #[test]
    fn unused_nodes_are_dropped_and_groups_follow() {
        let mut builder = tetrahedron();
        builder.node_group("some", [0, 4, 4]);
        builder.facet_group_by_nodes("slope", vec![vec![4, 2, 3]]);
        let mesh = builder.build().unwrap();
        assert_eq!(mesh.n_nodes(), 4);
        assert_eq!(mesh.groups().nodes["some"], [3]);
        assert_eq!(mesh.group_nodes("slope").unwrap(), [1, 2, 3]);
    }

    #[test]
    fn cells_that_are_turned_over_keep_their_facets() {
        // A quad8 on the unit square, clockwise: facet 1 is its edge from (0, 1) over (0.5, 1) to (1, 1).
        let points =
            [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.5], [0.5, 1.0], [1.0, 0.5], [0.5, 0.0]];
        let mut builder = MeshBuilder::new();
        points.iter().for_each(|&[x, y]| {
            builder.point([x, y, 3.0]);
        });
        let cell = builder.cell(CellKind::Quad8, &[0, 1, 2, 3, 4, 5, 6, 7]).unwrap();
        builder.facet_group("top", [Facet { cell, local: 1 }]);
        builder.facet_group_by_nodes("left", vec![vec![0, 1, 4]]);
        assert_eq!((builder.orient_cells(), builder.orient_cells()), (1, 0));
        let mesh = builder.build().unwrap();
        assert_eq!(mesh.cell(0).nodes, [0, 3, 2, 1, 7, 6, 5, 4]);
        assert_eq!(mesh.group_nodes("top").unwrap(), [1, 2, 5]);
        assert_eq!(mesh.group_nodes("left").unwrap(), [0, 1, 4]);
        assert_eq!(crate::mesh::check(&mesh), Ok(()));
    }

    #[test]
    fn plane_cells_lie_in_one_plane() {
        let mut builder = MeshBuilder::new();
        for point in [[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.5]] {
            builder.point(point);
        }
        builder.cell(CellKind::Tri3, &[0, 1, 2]).unwrap();
        assert_eq!(builder.build().unwrap_err(), Error::NotInPlane { node: 2, z: 2.5, plane: 2.0 });
    }

    #[test]
    fn misfits_are_named() {
        assert_eq!(MeshBuilder::new().build().unwrap_err(), Error::EmptyMesh);
        let mut builder = tetrahedron();
        builder.facet_group_by_nodes("nowhere", vec![vec![0, 1, 2]]);
        assert!(
            matches!(builder.build().unwrap_err(), Error::FacetWithoutCell { group, .. } if group == "nowhere")
        );
        let mut builder = tetrahedron();
        builder.cell(CellKind::Tet4, &[1, 2, 3, 7]).unwrap();
        assert_eq!(builder.build().unwrap_err(), Error::NodeOutOfRange { cell: 1, node: 7, n_nodes: 5 });
        let mut builder = tetrahedron();
        builder.point([f64::NAN, 0.0, 0.0]);
        assert_eq!(builder.build().unwrap_err(), Error::CoordinateNotFinite { node: 5 });
    }
}
