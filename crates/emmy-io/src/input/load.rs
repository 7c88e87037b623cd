//! `[[load]]`.

use emmy::body::{History, Load, LoadKind};

use super::fault::Fault;
use super::region::{Placed, group};
use super::table::Item;
use super::{history, keys};

/// Kinds of loads. Attractions and drag are read elsewhere ([`super::nodal`]).
pub(super) const KINDS: &[&str] =
    &["traction", "force", "nodal_force", "pressure", "acceleration", "attraction", "drag"];

/// Reads one load.
pub(super) fn read(item: Item<'_>) -> Result<Placed<Load>, Fault> {
    let table = item.table(keys::LOAD)?;
    let load = table.exactly_one("one kind of load", KINDS)?;
    let group = group(&table)?.map(|(name, _)| name);
    let needed = |group: Option<String>| match group {
        Some(group) => Ok(group),
        None => table.require("group").map(|_| String::new()),
    };
    let kind = match load.key() {
        "traction" => LoadKind::Traction { group: needed(group)?, traction: load.numbers()? },
        "force" => LoadKind::Force { group: needed(group)?, force: load.numbers()? },
        "nodal_force" => LoadKind::NodalForce { group: needed(group)?, force: load.numbers()? },
        "pressure" => LoadKind::Pressure { group: needed(group)?, pressure: load.number()? },
        _ => LoadKind::Acceleration { group, acceleration: load.numbers()? },
    };
    let history = table.get("history").map(history::read).transpose()?.unwrap_or_else(History::constant);
    Placed::new(&table, Load { kind, history })
}
