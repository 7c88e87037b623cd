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

/// The directory of the state that one of the tables `[initial]` names, if one does; `equilibrium`: place of this
/// key.
pub(super) fn read(
    initial: &[Table<'_>],
    equilibrium: Option<&Place>,
    directory: &Path,
) -> Result<Option<PathBuf>, Fault> {
    let named = initial.iter().find_map(|table| Some((table, table.item("state")?)));
    let Some((table, state)) = named else { return Ok(None) };
    let others = table.items().filter(|item| item.key != state.key).map(|item| item.key_place);
    let other_tables = initial.iter().map(|own| own.place).filter(|place| !std::ptr::eq(*place, table.place));
    if let Some(other) = other_tables.chain(others).next() {
        let message =
            "`state` gives the whole start, velocities included: `[initial]` takes no other key beside it";
        return Err(Fault::at(state.key_place, message, "the start").label(other, "and more"));
    }
    if let Some(equilibrium) = equilibrium {
        let message = "the motion starts from `initial.state` or from `[equilibrium]`, not from both";
        return Err(Fault::at(state.key_place, message, "this one").label(equilibrium, "and this one"));
    }
    Ok(Some(directory.join(table.must::<&str>("state"))))
}
