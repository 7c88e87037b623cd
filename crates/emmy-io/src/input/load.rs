//! `[[load]]`.

use emmy::body::{History, Load, LoadKind};

use super::fault::Fault;
use super::region::{Placed, group};
use super::table::Item;
use super::{history, keys};

/// Kinds of loads. Attractions are read elsewhere ([`super::nodal`]).
pub(super) const KINDS: &[&str] = &["traction", "force", "acceleration", "attraction"];

/// Reads one load.
pub(super) fn read(item: Item<'_>) -> Result<Placed<Load>, Fault> {
    let table = item.table(keys::LOAD)?;
    let load = table.exactly_one("one kind of load", KINDS)?;
    let vector = load.numbers()?;
    let group = group(&table)?.map(|(name, _)| name);
    let facets = |group: Option<String>| match group {
        Some(group) => Ok(group),
        None => table.require("group").map(|_| String::new()),
    };
    let kind = match load.key() {
        "traction" => LoadKind::Traction { group: facets(group)?, traction: vector },
        "force" => LoadKind::Force { group: facets(group)?, force: vector },
        _ => LoadKind::Acceleration { group, acceleration: vector },
    };
    let history = table.get("history").map(history::read).transpose()?.unwrap_or_else(History::constant);
    Placed::new(&table, Load { kind, history })
}
