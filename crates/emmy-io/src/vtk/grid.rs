//! The cells of frames: those of the mesh, and marks of the rigid bodies, which have none.

use std::borrow::Cow;

use emmy::body::{Body, FieldValues, Place};
use emmy::mesh::Mesh;

use super::cell_type;
use super::marks::{Marks, marks};

/// Number of a vertex in VTK.
pub(crate) const VERTEX: u8 = 1;

/// Number of a line in VTK.
const LINE: u8 = 3;

/// Name of the array with the region of each cell.
pub(crate) const REGION: &str = "region";

/// Region of the cells of rigid bodies.
const NONE: i32 = -1;

/// The mesh of a body with its regions; then a vertex at the centre of each rigid body and lines along its axes.
#[derive(Debug)]
pub(super) struct Grid<'a> {
    pub(super) mesh: &'a Mesh,
    /// Region of each cell of the mesh; `None` in the file of a mesh.
    regions: Option<&'a [u32]>,
    /// Types and nodes of the cells of rigid bodies.
    rigid: Vec<(u8, Vec<u32>)>,
}

impl<'a> Grid<'a> {
    /// The grid of a mesh alone.
    pub(super) fn new(mesh: &'a Mesh, regions: Option<&'a [u32]>) -> Self {
        Grid { mesh, regions, rigid: Vec::new() }
    }

    /// The grid of a body.
    pub(super) fn of(body: &'a Body) -> Self {
        let nodes = body.rigid_bodies().filter_map(|own| body.nodes_of_rigid_body(&own.name));
        let cells = nodes.flat_map(|nodes| {
            let centre = nodes.start;
            let axes = nodes.skip(1).map(move |end| (LINE, vec![centre, end]));
            std::iter::once((VERTEX, vec![centre])).chain(axes)
        });
        Grid { rigid: cells.collect(), ..Grid::new(body.mesh(), Some(body.region_of_cell())) }
    }

    pub(super) fn n_cells(&self) -> usize {
        self.mesh.n_cells() + self.rigid.len()
    }

    /// Nodes of all cells.
    pub(super) fn connectivity(&self) -> Vec<i64> {
        self.cells().flatten().map(|&node| i64::from(node)).collect()
    }

    /// End of the nodes of each cell.
    pub(super) fn ends(&self) -> Vec<i64> {
        let end = |end: &mut i64, nodes: &[u32]| {
            *end += nodes.len() as i64;
            Some(*end)
        };
        self.cells().scan(0, end).collect()
    }

    /// VTK's number of the kind of each cell.
    pub(super) fn types(&self) -> Vec<u8> {
        let of_mesh = self.mesh.cells().map(|cell| cell_type(cell.kind));
        of_mesh.chain(self.rigid.iter().map(|(kind, _)| *kind)).collect()
    }

    /// Region of each cell.
    pub(super) fn regions(&self) -> Option<Vec<i32>> {
        let of_mesh = self.regions?.iter().map(|&region| region as i32);
        Some(of_mesh.chain(self.rigid.iter().map(|_| NONE)).collect())
    }

    /// The arrays of all groups.
    pub(super) fn marks(&self) -> Vec<Marks> {
        let mut marks = marks(self.mesh);
        let in_cells = marks.iter_mut().filter(|marks| marks.place == Place::Cells);
        in_cells.for_each(|marks| marks.bits.resize(self.n_cells(), 0));
        marks
    }

    fn cells(&self) -> impl Iterator<Item = &[u32]> {
        self.mesh.cells().map(|cell| cell.nodes).chain(self.rigid.iter().map(|(_, nodes)| nodes.as_slice()))
    }
}

/// The numbers of a field in a grid with some cells: those of rigid bodies have no value.
pub(super) fn on_grid(field: &FieldValues, n_cells: usize) -> Cow<'_, [f64]> {
    let n = n_cells * field.name.components().len();
    if field.name.place() == Place::Nodes || field.numbers.len() >= n {
        return Cow::Borrowed(&field.numbers);
    }
    let missing = n - field.numbers.len();
    field.numbers.iter().copied().chain(std::iter::repeat_n(f64::NAN, missing)).collect()
}
