//! VTK: unstructured grids in XML (`.vtu`, `.pvtu`), including Emmy's own frames, legacy files (`.vtk`), and grids in
//! memory.

mod array;
mod cell;
mod draft;
mod file;
mod frame;
mod grid;
mod groups;
mod legacy;
mod pieces;

use std::path::Path;

use super::{MeshError, MeshFile, Origin, Place, Result, finished, kinds, without_mark};
pub(crate) use frame::{Frame, fields, frame};
#[cfg(test)]
pub(crate) use grid::TABLE;
pub use grid::{Grid, GridArray, Numbers};
pub(crate) use pieces::{are_in as are_pieces_in, joined_fields, joined_frame};

use draft::Draft;
use file::{Parts, document, no_cells};

/// The mesh in the bytes of an XML file; lines in the groups `links` are cells.
pub(super) fn mesh(file: &Path, bytes: &[u8], links: &[String]) -> Result<MeshFile> {
    let parts = Parts::new(file, without_mark(bytes))?;
    let document = document(file, &parts)?;
    let sources = pieces::sources(file, &document);
    let mut grids = Vec::new();
    for source in &sources {
        let bytes = pieces::read(source)?;
        let parts = Parts::new(source, without_mark(&bytes))?;
        let document = file::document(source, &parts)?;
        grids.extend(file::grids(source, &parts, &document)?);
    }
    if sources.is_empty() {
        grids = file::grids(file, &parts, &document)?;
    }
    let (grid, note) = grid::joined(grids);
    let mut mesh = of_grid(file, grid, links)?;
    mesh.notes.splice(0..0, note);
    mesh.files.extend(sources);
    Ok(mesh)
}

/// The mesh in the bytes of a legacy file.
pub(super) fn legacy(file: &Path, bytes: &[u8], links: &[String]) -> Result<MeshFile> {
    of_grid(file, legacy::grid(file, bytes)?, links)
}

/// The mesh of a grid; `file` is its name in messages.
pub(super) fn of_grid(file: &Path, grid: Grid, links: &[String]) -> Result<MeshFile> {
    let mut draft = Draft::new(file, &grid)?;
    let is_link = groups::links(&grid, &draft, links);
    draft.add_cells(&is_link)?;
    groups::add(&grid, &mut draft)?;
    let cells = (0..draft.shapes.len()).filter(|&index| draft.cell(index).is_some());
    let numbers: Vec<usize> = cells.collect();
    let name = |cell: usize| format!("cell {} (counted from 0)", numbers[cell]);
    let origin = Origin { file, n_nodes: grid.points.len(), name: &name };
    finished(draft.builder, &origin, draft.notes).map_err(|error| match error {
        MeshError::Mesh { reason: emmy::Error::EmptyMesh, .. } => no_cells(file),
        error => error,
    })
}
