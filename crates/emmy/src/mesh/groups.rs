//! Named groups of cells, facets and nodes.

use std::collections::BTreeMap;

use crate::error::{Error, Result};

/// A face of a cell of the mesh.
///
/// ```
/// let mesh = emmy::mesh::block([1.0; 3], [1; 3])?;
/// let facet = mesh.groups().facets("z-max")?[0];
/// assert_eq!((facet.cell, mesh.cell(0).kind.facets()[facet.local as usize].nodes.len()), (0, 4));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Facet {
    /// Index of the cell.
    pub cell: u32,
    /// Number of the face in [`crate::mesh::CellKind::facets`].
    pub local: u8,
}

/// Named groups. An entity may be in several groups, and one name may denote cells, facets and nodes: `cells:NAME`,
/// `facets:NAME` and `nodes:NAME` are one of these, unless that is itself the name of a group.
///
/// ```
/// let mesh = emmy::mesh::rectangle([2.0, 1.0], [2, 1])?;
/// assert_eq!(mesh.groups().names(), ["body", "x-max", "x-min", "y-max", "y-min"]);
/// assert!(mesh.groups().facets("z-max").is_err());
/// assert_eq!(mesh.groups().facets("facets:x-max")?.len(), 1);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Groups {
    /// Cells by name, ascending, without repetition.
    pub cells: BTreeMap<String, Vec<u32>>,
    /// Facets by name, ascending, without repetition.
    pub facets: BTreeMap<String, Vec<Facet>>,
    /// Nodes by name, ascending, without repetition.
    pub nodes: BTreeMap<String, Vec<u32>>,
}

impl Groups {
    /// Cells of a group.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`] with the existing names.
    pub fn cells(&self, name: &str) -> Result<&[u32]> {
        let cells = self.cells.get(self.plain("cells", name));
        cells.map(Vec::as_slice).ok_or_else(|| unknown("cell", name, self.cells.keys()))
    }

    /// Facets of a group.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`] with the existing names.
    pub fn facets(&self, name: &str) -> Result<&[Facet]> {
        let facets = self.facets.get(self.plain("facets", name));
        facets.map(Vec::as_slice).ok_or_else(|| unknown("facet", name, self.facets.keys()))
    }

    /// Returns the kinds of members that a group has: `cells`, `facets`, `nodes`. `cells:NAME` has cells alone.
    ///
    /// ```
    /// let mesh = emmy::mesh::block([1.0; 3], [1; 3])?.with_node_group("body", [0])?;
    /// assert_eq!(mesh.groups().kinds("body"), ["cells", "nodes"]);
    /// assert_eq!(mesh.groups().kinds("cells:body"), ["cells"]);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn kinds(&self, name: &str) -> Vec<&'static str> {
        let has = |kind| match kind {
            "cells" => self.cells.contains_key(self.plain(kind, name)),
            "facets" => self.facets.contains_key(self.plain(kind, name)),
            _ => self.nodes.contains_key(self.plain(kind, name)),
        };
        KINDS.into_iter().filter(|kind| has(kind)).collect()
    }

    /// The kind that a name chooses, and the name of the group.
    pub(super) fn chosen<'a>(&self, name: &'a str) -> (Option<&'static str>, &'a str) {
        let is_there =
            self.cells.contains_key(name) || self.facets.contains_key(name) || self.nodes.contains_key(name);
        let choice =
            KINDS.into_iter().find_map(|kind| Some((kind, name.strip_prefix(kind)?.strip_prefix(':')?)));
        match choice.filter(|_| !is_there) {
            Some((kind, plain)) => (Some(kind), plain),
            None => (None, name),
        }
    }

    /// The name of the group that a name denotes if it may choose a kind.
    pub(super) fn plain<'a>(&self, kind: &str, name: &'a str) -> &'a str {
        match self.chosen(name) {
            (Some(chosen), plain) if chosen == kind => plain,
            _ => name,
        }
    }

    /// The name of a group once the mesh with these groups is a part of another one ([`super::MeshBuilder::part`]).
    ///
    /// ```
    /// let mesh = emmy::mesh::block([1.0; 3], [1; 3])?;
    /// let name = |group| mesh.groups().name_in_part("left", mesh.n_cells(), group);
    /// assert_eq!([name("x-min"), name("body")], ["left-x-min", "left"]);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn name_in_part(&self, part: &str, n_cells: usize, group: &str) -> String {
        let is_whole = || self.cells.get(group).is_some_and(|cells| cells.len() == n_cells);
        let is_alone = || !self.facets.contains_key(group) && !self.nodes.contains_key(group);
        if group == WHOLE && is_whole() && is_alone() { part.to_string() } else { format!("{part}-{group}") }
    }

    /// Names of all groups, sorted, without repetition.
    pub fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self
            .cells
            .keys()
            .chain(self.facets.keys())
            .chain(self.nodes.keys())
            .map(String::as_str)
            .collect();
        names.sort_unstable();
        names.dedup();
        names
    }
}

/// Group of all cells of the built-in shapes.
const WHOLE: &str = "body";

/// Kinds of members.
const KINDS: [&str; 3] = ["cells", "facets", "nodes"];

fn unknown<'a>(what: &'static str, group: &str, names: impl Iterator<Item = &'a String>) -> Error {
    let available = names.map(String::as_str).collect::<Vec<_>>().join(", ");
    let available = if available.is_empty() { "none".to_string() } else { available };
    Error::UnknownGroup { what, group: group.to_string(), available }
}
