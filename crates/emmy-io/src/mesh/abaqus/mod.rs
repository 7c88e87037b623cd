//! Abaqus: keyword input with nodes, solid elements, sets and surfaces (Abaqus Keywords Guide, "Input syntax rules").

pub(super) mod assembled;
mod body;
mod deck;
mod element;
mod keyword;
mod placement;

use std::path::Path;

pub(super) use body::{At, Element, Of};
pub(super) use deck::Deck;

use super::{MeshFile, Result, without_mark};

/// Element types of a kind of cell.
#[cfg(test)]
pub(super) fn types(kind: emmy::mesh::CellKind) -> &'static [&'static str] {
    element::types(kind)
}

/// The mesh in the bytes of an input file; `links`: groups of lines that are cells.
pub(super) fn mesh(file: &Path, bytes: &[u8], links: &[String]) -> Result<MeshFile> {
    let deck = Deck::read(file, without_mark(bytes), links)?;
    Ok(MeshFile { files: deck.files.clone(), ..assembled::mesh(file, &deck)? })
}
