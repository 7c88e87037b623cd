//! The mesh: nodes, cells, named groups, quality, built-in shapes.

mod boundary;
mod builder;
mod connectivity;
mod groups;
mod mortar;
mod nearest;
mod placement;
pub(crate) mod quality;
pub(crate) mod shapes;
mod share;

pub use builder::MeshBuilder;
pub(crate) use connectivity::roots;
pub use groups::{Facet, Groups};
pub(crate) use mortar::mortar;
pub(crate) use nearest::{Nearest, Patch, distance};
pub use placement::Placement;
pub use quality::{Quality, Worst, check, quality};
pub use shapes::{MAX_CELLS, ball, block, cylinder, l_block, rectangle, ring};
pub use share::{Share, Shares, owners};

pub use crate::element::{CellKind, FacetKind};

use std::collections::{BTreeMap, HashMap};

use crate::error::{Error, Result};

/// A cell as it stands in the mesh.
///
/// ```
/// let mesh = emmy::mesh::block([1.0; 3], [1; 3])?;
/// assert_eq!(mesh.cell(0).nodes.len(), mesh.cell(0).kind.n_nodes());
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell<'a> {
    /// Kind of the cell.
    pub kind: CellKind,
    /// Nodes in VTK order, indices into [`Mesh::points`].
    pub nodes: &'a [u32],
}

/// Nodes, cells of any mix of kinds, and named groups. Built by a [`MeshBuilder`], so always consistent.
///
/// ```
/// let mesh = emmy::mesh::l_block(1.0)?;
/// assert_eq!((mesh.n_nodes(), mesh.n_cells()), (224, 117));
/// assert_eq!(mesh.groups().facets("face-a")?.len(), 9);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    points: Vec<[f64; 3]>,
    kinds: Vec<CellKind>,
    offsets: Vec<u32>,
    connectivity: Vec<u32>,
    groups: Groups,
    /// Bounds of the mesh that it is a part of; `None`: of none.
    whole: Option<Bounds>,
}

/// Smallest and largest coordinates of the nodes of a mesh, and of those of its facet groups, of which a part may have
/// none; and what else a part cannot know.
#[derive(Debug, Clone, PartialEq)]
struct Bounds {
    mesh: [[f64; 3]; 2],
    /// Whether all cells of the mesh are plane.
    is_plane: bool,
    facet_groups: BTreeMap<String, [[f64; 3]; 2]>,
    /// Of names of several kinds: the nodes of the part by name and kind.
    of_kinds: BTreeMap<String, BTreeMap<String, Vec<u32>>>,
}

/// Smallest and largest coordinates of some points.
fn bounds<'a>(points: impl Iterator<Item = &'a [f64; 3]>) -> [[f64; 3]; 2] {
    points.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[least, most], x| {
        [[0, 1, 2].map(|i| x[i].min(least[i])), [0, 1, 2].map(|i| x[i].max(most[i]))]
    })
}

impl Mesh {
    /// The mesh of cells of one kind; a [`MeshBuilder`] takes several.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let mesh = Mesh::from_cells(CellKind::Tet4, &points, &[[0, 1, 2, 3]])?.with_node_group("tip", [3])?;
    /// assert_eq!((mesh.n_cells(), mesh.group_nodes("tip")?), (1, vec![3]));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`MeshBuilder::cell`] and [`MeshBuilder::build`]; [`Error::UnusedPoint`].
    pub fn from_cells(kind: CellKind, points: &[[f64; 3]], cells: &[impl AsRef<[u32]>]) -> Result<Mesh> {
        let mut builder = MeshBuilder::new();
        points.iter().for_each(|&point| _ = builder.point(point));
        for nodes in cells {
            builder.cell(kind, nodes.as_ref())?;
        }
        let mesh = builder.build()?;
        // The builder leaves out unused points, which would renumber the nodes without telling the caller.
        let mut is_used = vec![false; points.len()];
        cells.iter().flat_map(AsRef::as_ref).for_each(|&node| is_used[node as usize] = true);
        match is_used.iter().position(|is_used| !is_used) {
            Some(node) => Err(Error::UnusedPoint { node }),
            None => Ok(mesh),
        }
    }

    /// The same mesh with a group of nodes.
    ///
    /// # Errors
    /// [`Error::GroupNodeOutOfRange`].
    pub fn with_node_group(mut self, name: &str, nodes: impl IntoIterator<Item = u32>) -> Result<Mesh> {
        let n_nodes = self.n_nodes();
        let group = self.groups.nodes.entry(name.to_string()).or_default();
        group.extend(nodes);
        group.sort_unstable();
        group.dedup();
        match group.last() {
            Some(&node) if node as usize >= n_nodes => {
                Err(Error::GroupNodeOutOfRange { group: name.to_string(), node: node as usize, n_nodes })
            }
            _ => Ok(self),
        }
    }

    /// Reference positions of the nodes, `[n_nodes][3]` \[length\].
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.points.len()
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.kinds.len()
    }

    /// Number of degrees of freedom: three per node.
    pub fn n_dofs(&self) -> usize {
        3 * self.n_nodes()
    }

    /// The cell with an index.
    pub fn cell(&self, index: usize) -> Cell<'_> {
        let range = self.offsets[index] as usize..self.offsets[index + 1] as usize;
        Cell { kind: self.kinds[index], nodes: &self.connectivity[range] }
    }

    /// All cells in order.
    pub fn cells(&self) -> impl Iterator<Item = Cell<'_>> {
        (0..self.n_cells()).map(|index| self.cell(index))
    }

    /// Named groups.
    pub fn groups(&self) -> &Groups {
        &self.groups
    }

    /// Nodes of a facet in the facet's own order.
    pub fn facet_nodes(&self, facet: Facet) -> impl Iterator<Item = u32> + '_ {
        let cell = self.cell(facet.cell as usize);
        cell.kind.facets()[facet.local as usize].nodes.iter().map(move |&local| cell.nodes[local])
    }

    /// Kind of a facet.
    pub(crate) fn facet_kind(&self, facet: Facet) -> FacetKind {
        self.cell(facet.cell as usize).kind.facets()[facet.local as usize].kind
    }

    /// Nodes of a group, ascending, without repetition: of its facets; if it has none its nodes, else those of its
    /// cells. `cells:NAME`, `facets:NAME` and `nodes:NAME` choose one of these ([`Groups`]).
    ///
    /// ```
    /// let mesh = emmy::mesh::block([2.0, 1.0, 1.0], [2, 1, 1])?.with_node_group("x-min", [11])?;
    /// assert_eq!(mesh.group_nodes("x-min")?, [0, 3, 4, 7]);
    /// assert_eq!(mesh.group_nodes("nodes:x-min")?, [11]);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownGroup`] with the existing names.
    pub fn group_nodes(&self, name: &str) -> Result<Vec<u32>> {
        let (chosen, plain) = self.groups.chosen(name);
        let nodes = match (&self.whole, chosen) {
            (Some(whole), Some(kind)) => self.nodes_of_part(whole, kind, plain),
            (Some(_), None) => self.groups.nodes.get(plain).cloned(),
            (None, Some(kind)) => self.nodes_of(kind, plain),
            (None, None) => {
                ["facets", "nodes", "cells"].into_iter().find_map(|kind| self.nodes_of(kind, plain))
            }
        };
        nodes.ok_or_else(|| {
            let available = self.groups.names().join(", ");
            Error::UnknownGroup { what: "node", group: name.to_string(), available }
        })
    }

    /// As [`Mesh::group_nodes`], but of its cells if it has any: where a volume is meant.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`] with the existing names.
    pub fn volume_nodes(&self, name: &str) -> Result<Vec<u32>> {
        self.group_nodes(&format!("cells:{name}")).or_else(|_| self.group_nodes(name))
    }

    /// Nodes of the members of one kind; `None` if there are none.
    fn nodes_of(&self, kind: &str, name: &str) -> Option<Vec<u32>> {
        let groups = &self.groups;
        let mut nodes: Vec<u32> = match kind {
            "facets" => groups.facets.get(name)?.iter().flat_map(|&facet| self.facet_nodes(facet)).collect(),
            "cells" => {
                let mut seen = vec![false; self.n_nodes()];
                let nodes = groups.cells.get(name)?.iter().flat_map(|&cell| self.cell(cell as usize).nodes);
                let is_new = |node: &u32| !std::mem::replace(&mut seen[*node as usize], true);
                nodes.copied().filter(is_new).collect()
            }
            _ => groups.nodes.get(name)?.clone(),
        };
        nodes.sort_unstable();
        nodes.dedup();
        (!nodes.is_empty()).then_some(nodes)
    }

    /// The same in a part, whose groups of nodes have those of all names.
    fn nodes_of_part(&self, whole: &Bounds, kind: &str, name: &str) -> Option<Vec<u32>> {
        let groups = &self.groups;
        let has = |kind: &str| match kind {
            "cells" => groups.cells.contains_key(name),
            "facets" => groups.facets.contains_key(name),
            _ => !groups.cells.contains_key(name) && !groups.facets.contains_key(name),
        };
        match whole.of_kinds.get(name) {
            Some(of_kinds) => of_kinds.get(kind).cloned(),
            None => groups.nodes.get(name).filter(|_| has(kind)).cloned(),
        }
    }

    /// The first facet, of some, that has a cell on its other side too.
    pub(crate) fn inner_facet(&self, facets: &[Facet]) -> Option<Facet> {
        let corners = |facet: Facet| {
            let n = self.cell(facet.cell as usize).kind.facets()[facet.local as usize].kind.n_corners();
            let mut key = [u32::MAX; 4];
            key.iter_mut().zip(self.facet_nodes(facet).take(n)).for_each(|(slot, node)| *slot = node);
            key.sort_unstable();
            key
        };
        let mut is_near = vec![false; self.n_nodes()];
        let mut cells: HashMap<[u32; 4], (u32, Facet)> = HashMap::new();
        for &facet in facets {
            self.facet_nodes(facet).for_each(|node| is_near[node as usize] = true);
            cells.insert(corners(facet), (facet.cell, facet));
        }
        let other = |cell: usize| {
            let nodes = self.cell(cell).nodes;
            nodes.iter().filter(|&&node| is_near[node as usize]).nth(1)?;
            let own = 0..self.cell(cell).kind.facets().len() as u8;
            let found = own.map(|local| corners(Facet { cell: cell as u32, local }));
            let others = found.filter_map(|key| cells.get(&key).filter(|(own, _)| *own != cell as u32));
            others.map(|(_, facet)| *facet).min()
        };
        (0..self.n_cells()).filter_map(other).min()
    }

    /// Smallest and largest coordinates of the mesh; of a part, those of the whole mesh.
    pub(crate) fn bounds(&self) -> [[f64; 3]; 2] {
        self.whole.as_ref().map_or_else(|| bounds(self.points.iter()), |whole| whole.mesh)
    }

    /// Whether all cells are plane; of a part, those of the whole mesh.
    pub(crate) fn is_plane(&self) -> bool {
        let own = || self.cells().all(|cell| cell.kind.dimension() == 2);
        self.whole.as_ref().map_or_else(own, |whole| whole.is_plane)
    }

    /// The bounds of a facet group.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`].
    pub(crate) fn facet_bounds(&self, group: &str) -> Result<[[f64; 3]; 2]> {
        let facets = self.groups.facets(group)?;
        let nodes = facets.iter().flat_map(|&facet| self.facet_nodes(facet));
        let own = || bounds(nodes.map(|node| &self.points[node as usize]));
        Ok(self
            .whole
            .as_ref()
            .and_then(|whole| whole.facet_groups.get(self.groups.plain("facets", group)))
            .copied()
            .unwrap_or_else(own))
    }

    /// A mesh without cells, for rigid bodies.
    #[doc(hidden)]
    pub fn without_cells() -> Mesh {
        let (points, kinds, connectivity, groups) = Default::default();
        Mesh { points, kinds, offsets: vec![0], connectivity, groups, whole: None }
    }

    /// Adds nodes without cells, after all others, and a group with the first of them.
    ///
    /// # Errors
    /// [`Error::GroupExists`].
    pub(crate) fn add_nodes(&mut self, group: &str, points: impl Iterator<Item = [f64; 3]>) -> Result<()> {
        if self.groups.names().contains(&group) {
            return Err(Error::GroupExists { group: group.to_string() });
        }
        self.groups.nodes.insert(group.to_string(), vec![self.points.len() as u32]);
        self.points.extend(points);
        Ok(())
    }

    /// Moves a node in the reference configuration.
    pub(crate) fn move_node(&mut self, node: usize, point: [f64; 3]) {
        self.points[node] = point;
    }

    /// The node nearest to a point in the reference configuration; the first of several.
    pub fn nearest_node(&self, point: [f64; 3]) -> usize {
        let distance = |p: &[f64; 3]| (0..3).map(|i| (p[i] - point[i]).powi(2)).sum::<f64>();
        let nodes = 0..self.n_nodes();
        nodes.min_by(|&a, &b| distance(&self.points[a]).total_cmp(&distance(&self.points[b]))).unwrap_or(0)
    }

    /// The mesh with every coordinate multiplied by a factor.
    ///
    /// # Errors
    /// [`Error::NotPositive`] unless the factor is positive and finite.
    pub fn scaled(mut self, factor: f64) -> Result<Mesh> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(Error::NotPositive { what: "mesh scale".into(), value: factor });
        }
        let of_whole =
            self.whole.iter_mut().flat_map(|whole| whole.facet_groups.values_mut().chain([&mut whole.mesh]));
        self.points.iter_mut().chain(of_whole.flatten()).flatten().for_each(|x| *x *= factor);
        Ok(self)
    }

    /// The mesh at another place.
    ///
    /// ```
    /// use emmy::mesh::{Placement, block};
    /// let beside = block([1.0; 3], [1; 3])?.placed(&Placement::default().shifted([2.0, 0.0, 0.0]))?;
    /// assert_eq!(beside.points()[6], [3.0, 1.0, 1.0]);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::TurnedPlane`] if a cell in plane strain is turned about another axis than z.
    pub fn placed(mut self, placement: &Placement) -> Result<Mesh> {
        let is_plane = self.cells().any(|cell| cell.kind.dimension() == 2);
        if is_plane && !placement.keeps_z() {
            return Err(Error::TurnedPlane);
        }
        if let Some(whole) = &mut self.whole {
            whole
                .facet_groups
                .values_mut()
                .chain([&mut whole.mesh])
                .for_each(|own| *own = placement.box_of(*own));
        }
        self.points.iter_mut().for_each(|point| *point = placement.point(*point));
        Ok(self)
    }
}
