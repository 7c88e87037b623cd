//! VTK: unstructured grids in XML (`.vtu`), including Emmy's own frames.

mod array;
mod cell;
mod file;
mod frame;
mod groups;
mod pieces;

use std::path::Path;

use emmy::mesh::MeshBuilder;

use super::{MeshError, MeshFile, Origin, Place, Result, finished, kinds, without_mark};
pub(crate) use frame::{Frame, fields, frame};
pub(crate) use pieces::{are_in as are_pieces_in, joined_fields, joined_frame};

use crate::message::counted;
use cell::{MIRRORED_WEDGE, PIXEL, PIXEL_ORDER, Shape, VOXEL, VOXEL_ORDER, is_mirrored, shape};
use file::{Grid, Parts, document, no_cells};

/// The mesh in the bytes of a file; lines in the groups `links` are cells.
pub(super) fn mesh(file: &Path, bytes: &[u8], links: &[String]) -> Result<MeshFile> {
    let parts = Parts::new(file, without_mark(bytes))?;
    let document = document(file, &parts)?;
    let grid = Grid::new(file, &parts, &document)?;
    let mut draft = Draft::new(file, &grid)?;
    let is_link = groups::links(&grid, &draft, links)?;
    let cells = draft.add_cells(file, &is_link)?;
    groups::add(&grid, &mut draft, &cells)?;
    let numbers: Vec<usize> = (0..cells.len()).filter(|&index| cells[index].is_some()).collect();
    let name = |cell: usize| format!("cell {} (counted from 0)", numbers[cell]);
    let origin = Origin { file, n_nodes: grid.n_points, name: &name };
    finished(draft.builder, &origin, draft.notes).map_err(|error| match error {
        MeshError::Mesh { reason: emmy::Error::EmptyMesh, .. } => no_cells(file),
        MeshError::Mesh { reason: emmy::Error::FacetWithoutCell { group, nodes }, file } => {
            MeshError::FacetWithoutCell { file, group, nodes: nodes.into_iter().map(u64::from).collect() }
        }
        error => error,
    })
}

/// Data read so far.
struct Draft {
    builder: MeshBuilder,
    points: Vec<[f64; 3]>,
    shapes: Vec<(i64, Shape)>,
    /// Dimension of the body: 3, or 2 without solid cells.
    dim: u8,
    /// End of the nodes of each cell in the connectivity.
    ends: Vec<usize>,
    connectivity: Vec<u32>,
    notes: Vec<String>,
}

impl Draft {
    fn new(file: &Path, grid: &Grid<'_, '_>) -> Result<Self> {
        let coordinates = grid.required("Points", "", Some(3 * grid.n_points))?.into_reals();
        let points: Vec<[f64; 3]> = coordinates.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
        let mut builder = MeshBuilder::new();
        points.iter().for_each(|&point| {
            builder.point(point);
        });
        let types = grid.required_whole("Cells", "types", Some(grid.n_cells))?;
        let shapes = types.into_iter().map(|id| Ok((id, known(file, id)?))).collect::<Result<Vec<_>>>()?;
        let dim = shapes.iter().map(|(_, shape)| shape.dim).fold(2, u8::max);
        let offsets = grid.required_whole("Cells", "offsets", Some(grid.n_cells))?;
        let ends = ends(grid, &shapes, &offsets)?;
        let connectivity = grid.required_whole("Cells", "connectivity", ends.last().copied())?;
        let node = |&node: &i64| u32::try_from(node).ok().filter(|&node| (node as usize) < points.len());
        let unknown = |node: &i64| grid.malformed(format!("a cell names node {node}, of {}", points.len()));
        let connectivity =
            connectivity.iter().map(|id| node(id).ok_or_else(|| unknown(id))).collect::<Result<_>>()?;
        Ok(Draft { builder, points, shapes, dim, ends, connectivity, notes: Vec::new() })
    }

    fn nodes(&self, index: usize) -> &[u32] {
        let begin = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.connectivity[begin..self.ends[index]]
    }

    /// Adds the cells of the body, and returns the cell of each cell of the file.
    fn add_cells(&mut self, file: &Path, is_link: &[bool]) -> Result<Vec<Option<u32>>> {
        let mut cells = Vec::with_capacity(self.shapes.len());
        let mut n_mirrored = 0;
        for (index, &(id, shape)) in self.shapes.iter().enumerate() {
            let Some(kind) = shape.kind.filter(|_| shape.dim == self.dim || is_link[index]) else {
                cells.push(None);
                continue;
            };
            let mut nodes = self.nodes(index).to_vec();
            let corners = |nodes: &[u32]| -> Vec<[f64; 3]> {
                nodes[..kind.n_corners()].iter().map(|&node| self.points[node as usize]).collect()
            };
            if id == PIXEL {
                nodes = PIXEL_ORDER.map(|local| nodes[local]).to_vec();
            }
            if id == VOXEL {
                nodes = VOXEL_ORDER.map(|local| nodes[local]).to_vec();
            }
            if kind.n_corners() == 6 && is_mirrored(kind, &corners(&nodes)) {
                nodes = MIRRORED_WEDGE[..nodes.len()].iter().map(|&local| nodes[local]).collect();
                n_mirrored += 1;
            }
            let cell = self.builder.cell(kind, &nodes);
            let mesh_error = |reason| MeshError::Mesh { file: file.to_path_buf(), reason };
            cells.push(Some(cell.map_err(mesh_error)?));
        }
        if n_mirrored > 0 {
            let wedges = counted(n_mirrored, "wedge has its base", "wedges have their bases");
            self.notes.push(format!("{wedges} numbered the other way round, as in older VTK, and read so"));
        }
        Ok(cells)
    }
}

fn known(file: &Path, id: i64) -> Result<Shape> {
    shape(id).ok_or_else(|| MeshError::UnsupportedElement {
        place: Place::line(file, 1),
        kind: format!("{id} of VTK"),
        supported: kinds(),
    })
}

/// End of the nodes of each cell, checked against its type.
fn ends(grid: &Grid<'_, '_>, shapes: &[(i64, Shape)], offsets: &[i64]) -> Result<Vec<usize>> {
    let mut end = 0;
    let checked = |(index, (&offset, (id, shape))): (usize, (&i64, &(i64, Shape)))| {
        end += shape.n_nodes;
        let problem = || format!("cell {index} of type {id} ends at {offset} instead of {end}");
        if offset == end as i64 { Ok(end) } else { Err(grid.malformed(problem())) }
    };
    offsets.iter().zip(shapes).enumerate().map(checked).collect()
}
