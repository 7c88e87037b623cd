//! Abaqus: keyword input with nodes, solid elements, sets and surfaces (Abaqus Keywords Guide, "Input syntax rules").

pub(super) mod assembled;
mod body;
mod deck;
mod element;
mod faces;
mod keyword;
mod placement;
mod table;

use std::path::Path;

pub(super) use body::{At, Body, Element, Of};
pub(super) use deck::Deck;
pub(super) use table::TABLE;

use super::{MeshFile, MeshOptions, Result, without_mark};

/// Element types of a kind of cell.
#[cfg(test)]
pub(super) fn types(kind: emmy::mesh::CellKind) -> &'static [&'static str] {
    element::types(kind)
}

/// The mesh in the bytes of an input file.
pub(super) fn mesh(file: &Path, bytes: &[u8], options: &MeshOptions) -> Result<MeshFile> {
    let mut deck = Deck::default();
    let read = deck.read(file, without_mark(bytes), options).and_then(|()| assembled::mesh(file, &deck));
    let mesh = read.map_err(|error| error.with_suspects(deck.account.suspects(TABLE)))?;
    Ok(MeshFile { files: deck.files, ..mesh })
}
