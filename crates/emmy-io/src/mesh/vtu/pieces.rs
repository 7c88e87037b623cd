//! A frame in pieces (`.pvtu`): they are joined by the numbers of their nodes and cells in the whole mesh.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use emmy::body::Place;
use roxmltree::Document;

use super::super::{MeshError, Place as Line, Result, without_mark};
use super::file::{Parts, document, no_cells};
use super::frame::{Frame, fields, frame};
use crate::vtk::{CELL, NODE};
use crate::whole_file;

/// Ending of the list of the pieces.
const ENDING: &str = "pvtu";

/// Whether a frame is in pieces, which a file lists.
pub(crate) fn are_in(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending == ENDING)
}

/// Points, cells and names of the fields of a frame in pieces, as [`frame`] has them.
pub(crate) fn joined_frame(list: &Path) -> Result<Frame> {
    let (mut points, mut cells, mut names) = (BTreeMap::new(), BTreeMap::new(), Vec::new());
    for path in pieces(list)? {
        let bytes = read(&path)?;
        let piece = frame(&path, &bytes)?;
        let nodes = numbers(&path, &bytes, Place::Nodes, NODE, piece.points.len())?;
        let of_cells = numbers(&path, &bytes, Place::Cells, CELL, piece.cells.len())?;
        let whole = |of_piece: Vec<u32>| -> Vec<u32> {
            of_piece.into_iter().map(|node| nodes[node as usize]).collect()
        };
        let regions = piece.regions.into_iter().map(Some).chain(std::iter::repeat(None));
        let of_piece = piece.cells.into_iter().map(|(kind, nodes)| (kind, whole(nodes))).zip(regions);
        cells.extend(of_cells.into_iter().zip(of_piece));
        points.extend(nodes.iter().copied().zip(piece.points));
        names = piece.fields;
    }
    let index: BTreeMap<u32, u32> = points.keys().copied().zip(0..).collect();
    let joined = |of_cell: Vec<u32>| of_cell.into_iter().map(|node| index[&node]).collect();
    Ok(Frame {
        points: points.into_values().collect(),
        regions: cells.values().filter_map(|(_, region)| *region).collect(),
        cells: cells.into_values().map(|((kind, nodes), _)| (kind, joined(nodes))).collect(),
        fields: names,
    })
}

/// Arrays of a frame in pieces at its nodes, as [`fields`] has them.
pub(crate) fn joined_fields(list: &Path, names: &[&str]) -> Result<Vec<Vec<f64>>> {
    let mut read_pieces = Vec::new();
    for path in pieces(list)? {
        let bytes = read(&path)?;
        let arrays = fields(&path, &bytes, Place::Nodes, names)?;
        let [nodes] = &fields(&path, &bytes, Place::Nodes, &[NODE])?[..] else { continue };
        read_pieces.push((nodes.iter().map(|&node| node as u32).collect::<Vec<u32>>(), arrays));
    }
    let mut all: Vec<u32> = read_pieces.iter().flat_map(|(nodes, _)| nodes).copied().collect();
    all.sort_unstable();
    all.dedup();
    let joined = |index: usize| {
        let sizes = read_pieces.iter().map(|(nodes, arrays)| arrays[index].len() / nodes.len().max(1));
        let n = sizes.min().unwrap_or(0);
        let mut numbers = vec![f64::NAN; n * all.len()];
        for (nodes, arrays) in read_pieces.iter().filter(|_| n > 0) {
            for (node, own) in nodes.iter().zip(arrays[index].chunks_exact(n)) {
                let place = all.binary_search(node).unwrap_or(0);
                numbers[n * place..n * (place + 1)].copy_from_slice(own);
            }
        }
        numbers
    };
    Ok((0..names.len()).map(joined).collect())
}

/// Paths of the pieces in a list.
fn pieces(list: &Path) -> Result<Vec<PathBuf>> {
    let bytes = read(list)?;
    let parts = Parts::new(list, without_mark(&bytes))?;
    let paths = sources(list, &document(list, &parts)?);
    if paths.is_empty() { Err(no_cells(list)) } else { Ok(paths) }
}

/// Paths of the pieces that a document lists, if it is a list.
pub(super) fn sources(list: &Path, document: &Document<'_>) -> Vec<PathBuf> {
    let folder = list.parent().unwrap_or(Path::new(""));
    let grids = document.root_element().children().filter(|node| node.has_tag_name("PUnstructuredGrid"));
    let pieces = grids.flat_map(|grid| grid.children()).filter(|node| node.has_tag_name("Piece"));
    pieces.filter_map(|piece| Some(folder.join(piece.attribute("Source")?))).collect()
}

pub(super) fn read(path: &Path) -> Result<Vec<u8>> {
    whole_file::read(path).map_err(|reason| MeshError::Unreadable { file: path.to_path_buf(), reason })
}

/// Numbers of the nodes or cells of a piece in the whole mesh.
fn numbers(path: &Path, bytes: &[u8], place: Place, name: &str, n: usize) -> Result<Vec<u32>> {
    let numbers = fields(path, bytes, place, &[name])?.concat();
    if numbers.len() == n {
        return Ok(numbers.into_iter().map(|number| number as u32).collect());
    }
    Err(MeshError::Malformed {
        place: Line::line(path, 1),
        problem: format!(
            "a piece of a frame without the array \"{name}\" of its {n} numbers in the whole mesh"
        ),
        advice: "use the files that Emmy has written",
    })
}
