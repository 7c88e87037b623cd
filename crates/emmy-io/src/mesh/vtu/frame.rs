//! A frame of a run: cells and fields as in the file, without groups.

use std::path::Path;

use emmy::body::Place;
use emmy::mesh::CellKind;

use super::super::{MeshError, Result, without_mark};
use super::Draft;
use super::file::{Grid, Parts, document};

/// Contents of a frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Frame {
    /// Reference positions of the nodes.
    pub(crate) points: Vec<[f64; 3]>,
    /// Cells with their nodes.
    pub(crate) cells: Vec<(CellKind, Vec<u32>)>,
    /// Names of the arrays at the nodes, with their numbers of components.
    pub(crate) fields: Vec<(String, usize)>,
}

/// Points, cells and names of the fields of a frame.
pub(crate) fn frame(file: &Path, bytes: &[u8]) -> Result<Frame> {
    with_grid(file, bytes, |grid| {
        let draft = Draft::new(file, grid)?;
        let cells = draft.shapes.iter().enumerate();
        let cells = cells.filter_map(|(index, (_, shape))| Some((shape.kind?, draft.nodes(index).to_vec())));
        let fields = grid.arrays("PointData").into_iter().map(|a| (a.name.to_string(), a.components));
        Ok(Frame { cells: cells.collect(), fields: fields.collect(), points: draft.points.clone() })
    })
}

/// Arrays of a frame at its nodes or in its cells, in the order of their names; a missing array is empty.
pub(crate) fn fields(file: &Path, bytes: &[u8], place: Place, names: &[&str]) -> Result<Vec<Vec<f64>>> {
    with_grid(file, bytes, |grid| {
        let (section, n) = match place {
            Place::Nodes => ("PointData", grid.n_points),
            Place::Cells => ("CellData", grid.n_cells),
        };
        let arrays = grid.arrays(section);
        let field = |name: &&str| match arrays.iter().find(|array| array.name == *name) {
            Some(array) => Ok(grid.numbers(array, Some(array.components.saturating_mul(n)))?.into_reals()),
            None => Ok(Vec::new()),
        };
        names.iter().map(field).collect()
    })
}

fn with_grid<T>(
    file: &Path,
    bytes: &[u8],
    read: impl FnOnce(&Grid<'_, '_>) -> Result<T, MeshError>,
) -> Result<T> {
    let parts = Parts::new(file, without_mark(bytes))?;
    let document = document(file, &parts)?;
    read(&Grid::new(file, &parts, &document)?)
}
