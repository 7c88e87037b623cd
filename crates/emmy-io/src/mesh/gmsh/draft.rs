//! Contents of an MSH file, until it is complete and can be checked.

use std::collections::{BTreeMap, HashMap, HashSet};

use emmy::mesh::MeshBuilder;

use super::super::plane::Surfaces;
use super::super::{MeshError, MeshFile, Origin, Result, finished, note_on_free_lines};
use super::Version;
use super::cursor::Cursor;
use super::partition::Partitions;
use super::shape::Shape;
use crate::message::counted;

/// No cell: an element of lower dimension than the body.
const NONE: u32 = u32::MAX;

/// Nodes and elements with the numbers of the file, and physical groups by dimension and number.
pub(super) struct Draft {
    pub(super) names: HashMap<(u8, u64), String>,
    /// Remarks on the names.
    pub(super) notes: Vec<String>,
    pub(super) partitions: Partitions,
    version: Version,
    points: Vec<[f64; 3]>,
    node_numbers: Vec<u64>,
    node_index: HashMap<u64, u32>,
    elements: Vec<Element>,
    element_index: HashMap<u64, u32>,
    connectivity: Vec<u64>,
    groups: BTreeMap<(u8, u64), Vec<u32>>,
    n_ignored: [usize; 3],
    /// Dimension of the body: 3, or 2 until there is an element of dimension 3.
    dim: u8,
    /// Whether an element is a line that is a cell.
    is_link: Vec<bool>,
}

/// The groups of an element.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tags<'a> {
    /// Its physical groups.
    pub(super) groups: &'a [u64],
    /// Its partition; 0: none, or several.
    pub(super) partition: u64,
}

#[derive(Debug, Clone, Copy)]
struct Element {
    number: u64,
    shape: &'static Shape,
    /// The physical group up to MSH 2.2, which repeats the element for each group; 0: none.
    group: u64,
    /// Its partition; 0: none, or several.
    partition: u64,
    /// Offset in the file.
    start: usize,
    /// Start of the nodes in the connectivity.
    nodes: usize,
}

impl Draft {
    pub(super) fn new(version: Version) -> Self {
        Draft {
            names: HashMap::new(),
            notes: Vec::new(),
            partitions: Partitions::default(),
            version,
            points: Vec::new(),
            node_numbers: Vec::new(),
            node_index: HashMap::new(),
            elements: Vec::new(),
            element_index: HashMap::new(),
            connectivity: Vec::new(),
            groups: BTreeMap::new(),
            n_ignored: [0; 3],
            dim: 2,
            is_link: Vec::new(),
        }
    }

    pub(super) fn node(&mut self, cursor: &Cursor, start: usize, number: u64, point: [f64; 3]) -> Result<()> {
        if point.iter().any(|x| !x.is_finite()) {
            return Err(MeshError::CoordinateNotFinite { place: cursor.place(start), node: number });
        }
        if self.node_index.insert(number, self.points.len() as u32).is_some() {
            return Err(MeshError::Duplicate { place: cursor.place(start), what: "node", number });
        }
        self.points.push(point);
        self.node_numbers.push(number);
        Ok(())
    }

    /// Adds an element; one of lower dimension without a group is only counted, once the dimension of the body is
    /// known.
    pub(super) fn element(
        &mut self,
        cursor: &Cursor,
        start: usize,
        number: u64,
        shape: &'static Shape,
        tags: Tags<'_>,
        nodes: &[u64],
    ) -> Result<()> {
        let Tags { groups, partition } = tags;
        self.dim = self.dim.max(shape.dim);
        if shape.dim < self.dim && groups.is_empty() {
            self.n_ignored[shape.dim as usize] += 1;
            return Ok(());
        }
        if shape.dim == 3 && shape.cell().is_none() {
            return Err(other_order(cursor, start, shape));
        }
        let index = self.elements.len() as u32;
        let first = *self.element_index.entry(number).or_insert(index);
        if first != index && !self.is_repeated(first, shape, nodes) {
            return Err(MeshError::Duplicate { place: cursor.place(start), what: "element", number });
        }
        for &group in groups {
            self.groups.entry((shape.dim, group)).or_default().push(index);
        }
        let group = groups.first().copied().unwrap_or(0);
        self.elements.push(Element {
            number,
            shape,
            group,
            partition,
            start,
            nodes: self.connectivity.len(),
        });
        self.connectivity.extend_from_slice(nodes);
        Ok(())
    }

    /// Whether an element repeats the first one of its number, as MSH 2.2 permits.
    fn is_repeated(&self, first: u32, shape: &Shape, nodes: &[u64]) -> bool {
        let first = &self.elements[first as usize];
        self.repeats_elements() && first.shape == shape && self.nodes(first) == nodes
    }

    /// Whether the version repeats an element once for each of its groups.
    fn repeats_elements(&self) -> bool {
        matches!(self.version, Version::V1 | Version::V20 | Version::V2)
    }

    fn nodes(&self, element: &Element) -> &[u64] {
        &self.connectivity[element.nodes..][..element.shape.n_nodes]
    }

    /// Finds the lines that are cells: lines of two nodes in some groups.
    fn find_links(&mut self, links: &[String]) {
        self.is_link = vec![false; self.elements.len()];
        let links: HashSet<&str> = links.iter().map(String::as_str).collect();
        for (&(dim, tag), members) in &self.groups {
            if dim == 1 && links.contains(&*self.name(dim, tag)) {
                let lines = members.iter().map(|&member| member as usize);
                lines
                    .filter(|&at| self.elements[at].shape.n_nodes == 2)
                    .for_each(|at| self.is_link[at] = true);
            }
        }
    }

    /// Name of a physical group; its number if it has none.
    fn name(&self, dim: u8, tag: u64) -> String {
        self.names.get(&(dim, tag)).cloned().unwrap_or_else(|| tag.to_string())
    }

    /// Whether an element is a cell of the body.
    fn is_cell(&self, index: usize) -> bool {
        self.elements[index].shape.dim == self.dim || self.is_link[index]
    }

    /// Leaves out copies of elements of other partitions, and faces without a group that were read before the first
    /// solid element.
    fn choose_elements(&mut self) {
        let cells = self.elements.iter().filter(|element| element.shape.dim == self.dim);
        let home = self.partitions.home(cells.map(|element| (element.number, element.partition)));
        let mut n_ghosts = 0;
        let mut in_group = vec![false; self.elements.len()];
        self.groups.values().flatten().for_each(|&member| in_group[member as usize] = true);
        let mut kept = Vec::with_capacity(self.elements.len());
        let mut new_index = vec![NONE; self.elements.len()];
        for (index, element) in self.elements.iter().enumerate() {
            if home.is_some_and(|home| self.partitions.is_ghost(element.number, home)) {
                n_ghosts += 1;
            } else if element.shape.dim == self.dim || in_group[index] {
                new_index[index] = kept.len() as u32;
                kept.push(*element);
            } else {
                self.n_ignored[element.shape.dim as usize] += 1;
            }
        }
        self.elements = kept;
        for members in self.groups.values_mut() {
            members.iter_mut().for_each(|member| *member = new_index[*member as usize]);
            members.retain(|&member| member != NONE);
        }
        self.notes.extend(home.into_iter().flat_map(|home| self.partitions.notes(home, n_ghosts)));
    }

    /// The mesh of all elements read.
    pub(super) fn mesh(mut self, cursor: &Cursor, links: &[String]) -> Result<MeshFile> {
        self.choose_elements();
        self.find_links(links);
        let mut builder = MeshBuilder::new();
        for &point in &self.points {
            builder.point(point);
        }
        let cells = self.cells(cursor, &mut builder)?;
        for (&(dim, tag), members) in &self.groups {
            self.add_group(cursor, &mut builder, dim, &self.name(dim, tag), members, &cells)?;
        }
        let free_lines = self.free_lines(cursor, &builder)?;
        self.notes.extend(note_on_free_lines(&free_lines));
        let elements = self.elements_of_cells(&cells);
        let name = |cell: usize| format!("element {}", self.elements[elements[cell] as usize].number);
        let origin = Origin { file: cursor.file(), n_nodes: self.points.len(), name: &name };
        finished(builder, &origin, self.notes()).map_err(|error| self.in_numbers_of_the_file(error))
    }

    /// Adds the cells, and returns the cell of each element.
    fn cells(&self, cursor: &Cursor, builder: &mut MeshBuilder) -> Result<Vec<u32>> {
        let originals = self.originals(cursor)?;
        let mut cells: Vec<u32> = Vec::with_capacity(self.elements.len());
        for (index, (element, &original)) in self.elements.iter().zip(&originals).enumerate() {
            let cell = match element.shape.cell() {
                _ if !self.is_cell(index) => NONE,
                None => {
                    return Err(other_order(cursor, element.start, element.shape));
                }
                Some(_) if (original as usize) < index => cells[original as usize],
                Some((kind, order)) => {
                    let nodes = self.node_indices(cursor, element, element.shape.n_nodes)?;
                    let nodes: Vec<u32> = order.iter().map(|&local| nodes[local]).collect();
                    let mesh_error = |reason| MeshError::Mesh { file: cursor.file().to_path_buf(), reason };
                    builder.cell(kind, &nodes).map_err(mesh_error)?
                }
            };
            cells.push(cell);
        }
        Ok(cells)
    }

    /// For each cell its element, the first one if it is repeated.
    fn elements_of_cells(&self, cells: &[u32]) -> Vec<u32> {
        let mut elements = Vec::new();
        for (element, &cell) in cells.iter().enumerate() {
            if cell as usize == elements.len() {
                elements.push(element as u32);
            }
        }
        elements
    }

    /// For each element the first one with the same nodes: MSH 2.2 repeats an element once for each of its groups.
    fn originals(&self, cursor: &Cursor) -> Result<Vec<u32>> {
        let mut originals: Vec<u32> = (0..self.elements.len() as u32).collect();
        if !self.repeats_elements() {
            return Ok(originals);
        }
        let mut order: Vec<u32> = originals.clone();
        order.retain(|&index| self.is_cell(index as usize));
        let nodes = |index: u32| self.nodes(&self.elements[index as usize]);
        let group = |index: u32| self.elements[index as usize].group;
        order.sort_by(|&a, &b| (nodes(a), group(a), a).cmp(&(nodes(b), group(b), b)));
        for run in order.chunk_by(|&a, &b| nodes(a) == nodes(b)) {
            if let Some(pair) = run.windows(2).find(|pair| group(pair[0]) == group(pair[1])) {
                return Err(self.twice(cursor, pair[0], pair[1]));
            }
            let original = run.iter().copied().fold(run[0], u32::min);
            run.iter().for_each(|&index| originals[index as usize] = original);
        }
        Ok(originals)
    }

    fn twice(&self, cursor: &Cursor, first: u32, second: u32) -> MeshError {
        let [first, second] = [first, second].map(|index| self.elements[index as usize]);
        MeshError::Malformed {
            place: cursor.place(second.start),
            problem: format!(
                "element {} has the nodes and the group of element {}",
                second.number, first.number
            ),
            advice: "remove one of the two",
        }
    }

    fn node_indices(&self, cursor: &Cursor, element: &Element, count: usize) -> Result<Vec<u32>> {
        let index = |&node: &u64| {
            let unknown = || MeshError::UnknownNode {
                place: cursor.place(element.start),
                element: element.number,
                node,
            };
            self.node_index.get(&node).copied().ok_or_else(unknown)
        };
        self.nodes(element)[..count].iter().map(index).collect()
    }

    fn add_group(
        &self,
        cursor: &Cursor,
        builder: &mut MeshBuilder,
        dim: u8,
        name: &str,
        members: &[u32],
        cells: &[u32],
    ) -> Result<()> {
        let elements = members.iter().map(|&index| &self.elements[index as usize]);
        let are_links = dim == 1 && members.iter().any(|&member| self.is_link[member as usize]);
        match self.dim - dim.min(self.dim) {
            _ if are_links => {
                let links = members.iter().map(|&index| cells[index as usize]);
                builder.cell_group(name, links.filter(|&cell| cell != NONE));
            }
            0 => builder.cell_group(name, members.iter().map(|&index| cells[index as usize])),
            1 => {
                let corners =
                    elements.map(|element| self.node_indices(cursor, element, element.shape.n_corners));
                builder.facet_group_by_nodes(name, corners.collect::<Result<_>>()?);
            }
            _ => {
                let nodes = elements.map(|element| self.node_indices(cursor, element, element.shape.n_nodes));
                builder.node_group(name, nodes.collect::<Result<Vec<_>>>()?.into_iter().flatten());
            }
        }
        Ok(())
    }

    /// Number of the lines in each group that are no edge of a solid cell.
    fn free_lines(&self, cursor: &Cursor, builder: &MeshBuilder) -> Result<BTreeMap<String, usize>> {
        let (mut names, mut lines) = (Vec::new(), Vec::new());
        for (&(dim, tag), members) in self.groups.iter().filter(|((dim, _), _)| self.dim == 3 && *dim == 1) {
            for &member in members.iter().filter(|member| !self.is_link[**member as usize]) {
                let ends = self.node_indices(cursor, &self.elements[member as usize], 2)?;
                lines.push([ends[0], ends[1]]);
                names.push((dim, tag));
            }
        }
        let mut free: BTreeMap<String, usize> = BTreeMap::new();
        let are_edges = builder.are_edges(&lines);
        for ((dim, tag), _) in names.into_iter().zip(are_edges).filter(|(_, is_edge)| !is_edge) {
            *free.entry(self.name(dim, tag)).or_default() += 1;
        }
        Ok(free)
    }

    fn notes(&self) -> Vec<String> {
        let ignored = self.n_ignored.iter().enumerate().filter(|(_, count)| **count > 0);
        let note = |(dim, &count): (usize, &usize)| {
            let elements = counted(count, "element", "elements");
            let are = if count == 1 { "is" } else { "are" };
            format!("{elements} of dimension {dim} in no physical group {are} ignored")
        };
        self.notes.iter().cloned().chain(ignored.map(note)).collect()
    }

    fn surfaces(&self) -> Surfaces {
        let surfaces = || self.elements.iter().filter(|element| element.shape.dim == 2);
        let has = [3, 4].map(|n_corners| surfaces().any(|element| element.shape.n_corners == n_corners));
        let nodes = surfaces().flat_map(|element| self.nodes(element));
        let point = |node: &u64| self.node_index.get(node).map(|&at| self.points[at as usize]);
        Surfaces { has, points: nodes.filter_map(point).collect() }
    }

    fn in_numbers_of_the_file(&self, error: MeshError) -> MeshError {
        match error {
            MeshError::Mesh { file, reason: emmy::Error::EmptyMesh } => {
                let of_dim = |dim: usize| {
                    let read = self.elements.iter().filter(|element| usize::from(element.shape.dim) == dim);
                    self.n_ignored[dim] + read.count()
                };
                let found: Vec<String> = [(1, "line", "lines"), (0, "point", "points")]
                    .into_iter()
                    .filter(|(dim, ..)| of_dim(*dim) > 0)
                    .map(|(dim, one, many)| counted(of_dim(dim), one, many))
                    .collect();
                match found.is_empty() {
                    true => MeshError::NoCells { file, advice: NO_CELLS },
                    false => MeshError::NothingSolid {
                        file,
                        found: found.join(" and "),
                        advice: NO_CELLS.to_string(),
                    },
                }
            }
            MeshError::Mesh { file, reason: emmy::Error::NotInPlane { node, z, plane } } => {
                let node = format!("node {}", self.node_numbers[node]);
                self.surfaces().error(&file, &node, [z, plane], [TURN, SURFACE_ALONE])
            }
            error => error,
        }
    }
}

const TURN: &str = "all of them lie in another plane: turn the mesh into the x-y plane; or, for a solid body, put its volume into a \
                    physical group too and mesh it (`gmsh -3`)";

const SURFACE_ALONE: &str = "Gmsh saves only what is in a physical group: put the volume into one too, or set `Mesh.SaveAll = 1`, and mesh it \
                             (`gmsh -3`)";

const NO_CELLS: &str = "mesh the volume (`gmsh -3`) or the surface (`gmsh -2`), and where there are physical groups put it in one: \
                        Gmsh saves only what is in a group";

/// The error for an element type that has the shape of a cell, but other nodes.
fn other_order(cursor: &Cursor, start: usize, shape: &Shape) -> MeshError {
    let problem = format!("elements of type {} are not supported", shape.name);
    MeshError::Malformed { place: cursor.place(start), problem, advice: shape.cure() }
}

/// The error of an element type that is not a cell.
pub(super) fn unsupported(cursor: &Cursor, start: usize, kind: String) -> MeshError {
    MeshError::UnsupportedElement { place: cursor.place(start), kind, supported: super::super::kinds() }
}
