//! `[mesh]`: a built-in shape or a mesh file.

use std::path::{Path, PathBuf};

use emmy::mesh::Mesh;

use super::fault::{Fault, Place};
use super::keys;
use super::table::{Item, Table, spelled};

/// Where the mesh comes from.
#[derive(Debug)]
pub(super) struct Shape {
    source: Source,
    /// Place of the source's value.
    place: Place,
    scale: Option<f64>,
}

#[derive(Debug)]
enum Source {
    LBlock { cell_size: f64 },
    Box { size: [f64; 3], cells: [usize; 3] },
    Rectangle { size: [f64; 2], cells: [usize; 2] },
    File(PathBuf),
}

/// More cells than this are more likely a slip than a wish, and would not fit into memory.
const MAX_CELLS: f64 = 2e7;

/// Reads the table; paths are relative to `directory`.
pub(super) fn read(item: Item<'_>, directory: &Path) -> Result<Shape, Fault> {
    let table = item.table(keys::MESH)?;
    let source = table.exactly_one("one source", &["l-block", "box", "rectangle", "file"])?;
    let scale = table.get("scale").map(|scale| scale.positive()).transpose()?;
    let place = source.place().clone();
    let source = match source.key() {
        "l-block" => l_block(source.table(keys::L_BLOCK)?)?,
        "box" => {
            let (size, cells) = size_and_cells(source.table(keys::BOX)?)?;
            Source::Box { size, cells }
        }
        "rectangle" => {
            let (size, cells) = size_and_cells(source.table(keys::RECTANGLE)?)?;
            Source::Rectangle { size, cells }
        }
        _ => Source::File(directory.join(source.string()?)),
    };
    Ok(Shape { source, place, scale })
}

fn l_block(table: Table<'_>) -> Result<Source, Fault> {
    let item = table.require("cell_size")?;
    let cell_size = item.positive()?;
    few_cells(117.0 / cell_size.powi(3), &item)?;
    Ok(Source::LBlock { cell_size })
}

/// Edges and numbers of cells along them.
fn size_and_cells<const N: usize>(table: Table<'_>) -> Result<([f64; N], [usize; N]), Fault> {
    let (size, cells) = (table.require("size")?, table.require("cells")?);
    let lengths: [f64; N] = size.numbers()?;
    if let Some(length) = lengths.iter().find(|&&length| length <= 0.0) {
        return Err(size.fault(format!("`size` must be positive, not {}", spelled(*length)), "not positive"));
    }
    let counts: [usize; N] = cells.wholes(1)?;
    few_cells(counts.iter().map(|&n| n as f64).product(), &cells)?;
    Ok((lengths, counts))
}

fn few_cells(count: f64, item: &Item<'_>) -> Result<(), Fault> {
    if count <= MAX_CELLS {
        return Ok(());
    }
    Err(item.fault(format!("this makes {count:.1e} cells; the most is {MAX_CELLS:.0e}"), "too many cells"))
}

/// What to do about an inverted cell of a file.
const INVERTED: &str = "cells count from 0 in the order of the file; check the orientation of this one (the order of its \
                        nodes) and its shape in the mesher";

impl Shape {
    /// The mesh, scaled, with what its reader remarked.
    pub(super) fn mesh(&self) -> Result<(Mesh, Vec<String>), Fault> {
        let at = |error: &dyn std::fmt::Display| Fault::at(&self.place, error.to_string(), "from here");
        let (mesh, notes) = match &self.source {
            Source::LBlock { cell_size } => {
                (emmy::mesh::l_block(*cell_size).map_err(|e| at(&e))?, Vec::new())
            }
            Source::Box { size, cells } => {
                (emmy::mesh::block(*size, *cells).map_err(|e| at(&e))?, Vec::new())
            }
            Source::Rectangle { size, cells } => {
                (emmy::mesh::rectangle(*size, *cells).map_err(|e| at(&e))?, Vec::new())
            }
            Source::File(path) => {
                let file = crate::mesh::read(path).map_err(|error| at(&error))?;
                (file.mesh, file.notes)
            }
        };
        let mesh = mesh.scaled(self.scale.unwrap_or(1.0)).map_err(|error| at(&error))?;
        Ok((mesh, notes))
    }

    /// The fault of a mesh that no body can be made of.
    pub(super) fn fault(&self, error: &emmy::Error) -> Fault {
        let Source::File(path) = &self.source else {
            return Fault::at(&self.place, error.to_string(), "this mesh");
        };
        let fault = Fault::at(&self.place, format!("{}: {error}", path.display()), "this mesh");
        match error {
            emmy::Error::InvertedCell { .. } => fault.help(INVERTED),
            _ => fault,
        }
    }

    /// The mesh file as a path that can be opened from everywhere.
    pub(super) fn absolute_file(&self) -> Option<PathBuf> {
        match &self.source {
            Source::File(path) => Some(std::path::absolute(path).unwrap_or_else(|_| path.clone())),
            _ => None,
        }
    }
}
