//! Parts of the input with their places.

use super::fault::{Fault, Place};
use super::table::Table;

/// A part of the input with its place, and the place of its group's name, if it has one.
#[derive(Debug)]
pub(super) struct Placed<T> {
    pub(super) value: T,
    pub(super) group: Option<(String, Place)>,
    pub(super) place: Place,
}

impl<T> Placed<T> {
    pub(super) fn new(table: &Table<'_>, value: T) -> Result<Self, Fault> {
        Ok(Placed { value, group: group(table)?, place: table.place().clone() })
    }
}

/// The group of a table, if it names one.
pub(super) fn group(table: &Table<'_>) -> Result<Option<(String, Place)>, Fault> {
    let Some(item) = table.get("group") else { return Ok(None) };
    Ok(Some((item.name()?, item.place().clone())))
}

/// Required members of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Members {
    Cells,
    Facets,
    Nodes,
}
