//! `[[load]]` and `[[support]]`.

use emmy::body::{History, Load, LoadKind, Support};

use super::fault::Fault;
use super::region::{Placed, group};
use super::table::Item;
use super::{history, keys};

/// Reads one load.
pub(super) fn read(item: Item<'_>) -> Result<Placed<Load>, Fault> {
    let table = item.table(keys::LOAD)?;
    let load = table.exactly_one("one kind of load", &["traction", "force", "acceleration"])?;
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

/// Reads one support.
pub(super) fn support(item: Item<'_>) -> Result<Placed<Support>, Fault> {
    let table = item.table(keys::SUPPORT)?;
    let (group, fix) = (table.require("group")?.string()?.to_string(), table.require("fix")?);
    let mut fixed = [false; 3];
    let components = fix.list()?;
    if components.is_empty() {
        return Err(
            fix.fault("`fix` is empty: it lists the components that do not move", "such as [\"x\", \"y\"]")
        );
    }
    for component in components {
        let word = component.word("a component", &["x", "y", "z"])?;
        fixed[(word.as_bytes()[0] - b'x') as usize] = true;
    }
    Placed::new(&table, Support { group, fix: fixed })
}
