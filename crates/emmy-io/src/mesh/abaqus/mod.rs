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

use super::{MeshFile, MeshOptions, Result, without_mark};

/// Element types of a kind of cell.
#[cfg(test)]
pub(super) fn types(kind: emmy::mesh::CellKind) -> &'static [&'static str] {
    element::types(kind)
}

/// The mesh in the bytes of an input file.
pub(super) fn mesh(file: &Path, bytes: &[u8], options: &MeshOptions) -> Result<MeshFile> {
    let deck = Deck::read(file, without_mark(bytes), &options.links)?;
    Ok(MeshFile { files: deck.files.clone(), ..assembled::mesh(file, &deck)? })
}
