//! A frame of a run: cells and fields as in the file, without groups.

use std::path::Path;

use emmy::body::Place;
use emmy::mesh::CellKind;

use super::super::{MeshError, Result, without_mark};
use super::cell::Type;
use super::file::{Parts, Piece, document, no_cells};
use crate::vtk::{REGION, VERTEX};

/// Contents of a frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Frame {
    /// Reference positions of the nodes.
    pub(crate) points: Vec<[f64; 3]>,
    /// Cells with their nodes; axes of rigid bodies are lines, their centres lines without length.
    pub(crate) cells: Vec<(CellKind, Vec<u32>)>,
    /// Region of each cell, negative for those of rigid bodies; empty if the frame does not have it.
    pub(crate) regions: Vec<i32>,
    /// Names of the arrays at the nodes, with their numbers of components.
    pub(crate) fields: Vec<(String, usize)>,
}

/// Points, cells and names of the fields of a frame.
pub(crate) fn frame(file: &Path, bytes: &[u8]) -> Result<Frame> {
    with_piece(file, bytes, |piece| {
        let (points, types, ends, connectivity) = piece.points_and_cells()?;
        let mut begin = 0;
        let mut cells = Vec::with_capacity(types.len());
        for (&id, &end) in types.iter().zip(&ends) {
            let end = usize::try_from(end).unwrap_or(0);
            let nodes = connectivity.get(std::mem::replace(&mut begin, end)..end);
            let nodes: Option<Vec<u32>> = nodes.and_then(|nodes| {
                let node =
                    |&node: &i64| u32::try_from(node).ok().filter(|&node| (node as usize) < points.len());
                nodes.iter().map(node).collect()
            });
            let cell = nodes.and_then(|nodes| match nodes[..] {
                [centre] if id == i64::from(VERTEX) => Some((CellKind::Line2, vec![centre; 2])),
                _ => Some((Type::of(id)?.kind(nodes.len())?, nodes)),
            });
            let wrong = || MeshError::Grid {
                file: file.to_path_buf(),
                problem: format!("cell {} is none that Emmy writes", cells.len()),
                advice: "use the files that Emmy has written",
            };
            cells.push(cell.filter(|(kind, nodes)| kind.n_nodes() == nodes.len()).ok_or_else(wrong)?);
        }
        let fields = piece.arrays("PointData").into_iter().map(|a| (a.name.to_string(), a.components));
        let regions = of_cells(piece, REGION)?.into_iter().map(|region| region as i32).collect();
        Ok(Frame { cells, regions, fields: fields.collect(), points })
    })
}

/// A number of each cell; empty if there is no such array.
fn of_cells(piece: &Piece<'_, '_>, name: &str) -> Result<Vec<f64>> {
    let array = piece.arrays("CellData").into_iter().find(|array| array.name == name);
    array.map_or(Ok(Vec::new()), |array| Ok(piece.numbers(&array, Some(piece.n_cells))?.into_reals()))
}

/// Arrays of a frame at its nodes or in its cells, in the order of their names; a missing array is empty.
pub(crate) fn fields(file: &Path, bytes: &[u8], place: Place, names: &[&str]) -> Result<Vec<Vec<f64>>> {
    with_piece(file, bytes, |piece| {
        let (section, n) = match place {
            Place::Nodes => ("PointData", piece.n_points),
            Place::Cells => ("CellData", piece.n_cells),
        };
        let arrays = piece.arrays(section);
        let field = |name: &&str| match arrays.iter().find(|array| array.name == *name) {
            Some(array) => Ok(piece.numbers(array, Some(array.components.saturating_mul(n)))?.into_reals()),
            None => Ok(Vec::new()),
        };
        names.iter().map(field).collect()
    })
}

fn with_piece<T>(
    file: &Path,
    bytes: &[u8],
    read: impl FnOnce(&Piece<'_, '_>) -> Result<T, MeshError>,
) -> Result<T> {
    let parts = Parts::new(file, without_mark(bytes))?;
    let document = document(file, &parts)?;
    match &Piece::all(file, &parts, &document)?[..] {
        [piece, ..] => read(piece),
        [] => Err(no_cells(file)),
    }
}
