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
    pub(super) fn new(table: &Table<'_>, value: T) -> Self {
        Placed { value, group: table.group(), place: table.place.clone() }
    }
}

/// The name of a group with its place and the members that it needs.
#[derive(Debug, Clone)]
pub(super) struct NamedGroup {
    pub(super) name: String,
    pub(super) place: Place,
    pub(super) members: Members,
    /// Whether it may also be the name of a rigid body.
    pub(super) or_body: bool,
}

impl NamedGroup {
    /// The name of a group of the mesh.
    pub(super) fn of_mesh(name: String, place: Place, members: Members) -> Self {
        NamedGroup { name, place, members, or_body: false }
    }
}

/// Groups with the places of their names.
pub(super) fn groups<'a>(all: impl Iterator<Item = &'a Option<(String, Place)>>) -> Vec<(String, Place)> {
    all.flatten().cloned().collect()
}

/// The fault at the name of a group.
pub(super) fn fault(
    error: &emmy::Error,
    group: &str,
    groups: &[(String, Place)],
    label: &str,
) -> Option<Fault> {
    let (_, place) = groups.iter().find(|(name, _)| name == group)?;
    Some(Fault::at(place, error.to_string(), label))
}

/// Required members of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Members {
    Cells,
    Facets,
    /// Facets, or cells for those on the boundary.
    FacetsOrCells,
    Nodes,
}
