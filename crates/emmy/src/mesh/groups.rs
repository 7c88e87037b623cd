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

/// Named groups. An entity may be in several groups, and one name may denote cells, facets and nodes.
///
/// ```
/// let mesh = emmy::mesh::rectangle([2.0, 1.0], [2, 1])?;
/// assert_eq!(mesh.groups().names(), ["body", "x-max", "x-min", "y-max", "y-min"]);
/// assert!(mesh.groups().facets("z-max").is_err());
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
        self.cells.get(name).map(Vec::as_slice).ok_or_else(|| unknown("cell", name, self.cells.keys()))
    }

    /// Facets of a group.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`] with the existing names.
    pub fn facets(&self, name: &str) -> Result<&[Facet]> {
        self.facets.get(name).map(Vec::as_slice).ok_or_else(|| unknown("facet", name, self.facets.keys()))
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

fn unknown<'a>(what: &'static str, group: &str, names: impl Iterator<Item = &'a String>) -> Error {
    let available = names.map(String::as_str).collect::<Vec<_>>().join(", ");
    let available = if available.is_empty() { "none".to_string() } else { available };
    Error::UnknownGroup { what, group: group.to_string(), available }
}
