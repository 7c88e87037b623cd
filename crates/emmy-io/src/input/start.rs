//! The state from which a motion starts, as the input names it.

use std::path::{Path, PathBuf};

use super::fault::{Fault, Place};
use super::table::Table;

/// The state from which a motion starts.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// The undeformed body.
    Undeformed,
    /// Static equilibrium under the loads at the start.
    Equilibrium {
        /// Number of increments of the loads.
        load_steps: usize,
    },
    /// The last state of the run in a directory.
    Run(PathBuf),
}

/// The directory of `initial.state`, if it is there.
pub(super) fn read(root: &Table<'_>, directory: &Path) -> Result<Option<PathBuf>, Fault> {
    let Some(initial) = root.get("initial") else { return Ok(None) };
    let items = initial.one_or_more()?;
    let Some(place) = items.iter().find_map(|item| item.has_key("state")) else { return Ok(None) };
    let other = |place: &Place, what: &Place| {
        let message = "`state` gives the whole start, with its velocities: no other key of `[initial]` can stand beside it";
        Err(Fault::at(place, message, "the start").label(what, "and more"))
    };
    if let [_, second, ..] = &items[..] {
        return other(place, second.place());
    }
    let table = items[0].table(&super::initial::INITIAL)?;
    if let Some(key) =
        ["group", "velocity", "angular_velocity", "about", "gradient"].iter().find_map(|key| table.get(key))
    {
        return other(place, key.key_place);
    }
    if let Some(equilibrium) = root.get("equilibrium") {
        let message = "the motion starts from `initial.state` or from `[equilibrium]`, not from both";
        return Err(Fault::at(place, message, "this one").label(equilibrium.key_place, "and this one"));
    }
    let path = table.require("state")?.string()?;
    Ok(Some(directory.join(path)))
}
