//! Sources of forces: loads and user objects from which a body makes them.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use super::interface::Force;
use crate::error::Result;
use crate::input::Region;
use crate::mass::Spread;
use crate::mesh::Mesh;
use crate::space::geometry::MassKind;
use crate::sparse::Pattern;

/// Data of a force: a spring, a load, a new kind of force in a file of its own.
pub trait ForceSource: fmt::Debug + Send + Sync {
    /// The force on a body; `number`: among the sources of its kind.
    ///
    /// # Errors
    /// [`crate::Error::UnknownGroup`], and whatever is wrong with the data.
    fn force(&self, number: usize, site: &Site<'_>) -> Result<Arc<dyn Force>>;
}

/// A body, as far as it is made when its forces are.
#[derive(Debug, Clone, Copy)]
pub struct Site<'a> {
    pub mesh: &'a Mesh,
    /// Couplings of the nodes.
    pub pattern: &'a Pattern,
    /// Rows of each thread.
    pub parts: &'a [Range<usize>],
    /// Number of own nodes; they come first.
    pub n_own: usize,
    /// Thickness of each cell.
    pub section: &'a [f64],
    /// The regions, and the region of each cell.
    pub regions: &'a [Region],
    pub region_of_cell: &'a [u32],
    /// Mass per measure of each cell.
    pub density_of_cell: &'a [f64],
    /// The kind of mass on which the forces act.
    pub kind: MassKind,
    /// Consistent mass of each coupling, before ties; empty if nothing asks for it.
    pub mass: &'a [f64],
    /// Mass of each node; empty if nothing asks for it.
    pub masses: &'a [f64],
    /// Part of it that is not that of cells.
    pub other_masses: &'a [f64],
    /// Part of this that belongs to single nodes.
    pub point_masses: &'a [f64],
    /// The rest of it.
    pub spread: &'a Spread,
    /// Nodes of the rigid bodies, by their names.
    pub rigid: &'a [(String, Range<u32>)],
    /// Area on which each load acts by a total force, of all ranks \[length^2\].
    pub areas: &'a [f64],
}
