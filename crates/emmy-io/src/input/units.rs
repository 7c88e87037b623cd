//! `[units]`: the system of units of the input.

use super::description::{Described, Kind, Section};
use super::fault::Fault;
use super::table::Item;
use crate::units::{SYSTEMS, UnitSystem, Units};

/// `[units]`.
pub(super) static UNITS: Described = Described::new(|| {
    Section::new("[units]", "Units of all numbers of the input").must(
        "system",
        Kind::Word(names().collect()),
        "",
        "Units of length, mass and time; the units of force and stress that follow may be written behind them",
    )
});

fn names() -> impl Iterator<Item = &'static str> {
    SYSTEMS.iter().flat_map(|system| [system.name, system.full_name])
}

pub(super) fn read(item: Item<'_>) -> Result<Units, Fault> {
    let item = item.table(&UNITS)?.require("system")?;
    let text = item.text().unwrap_or_default();
    if let Some(system) = UnitSystem::named(text) {
        return Ok(system.into());
    }
    let meant = SYSTEMS.iter().find(|system| begins_with(text, system.name));
    if let Some(system) = meant {
        let message = format!(
            "in `{}`, the unit of force is {} and the unit of stress {}",
            system.name,
            system.unit("force"),
            system.unit("stress")
        );
        return Err(item.fault(message, format!("did you mean `{}`?", system.full_name)));
    }
    if let Some(name) = names().find(|name| sorted(name) == sorted(text)) {
        let message = format!("`{text}` is in another order: length, mass, time, force, stress");
        return Err(item.fault(message, format!("did you mean `{name}`?")));
    }
    item.word("a system of units", &names().collect::<Vec<_>>()).map(|_| Units::default())
}

/// Whether a text is a name with more behind it.
fn begins_with(text: &str, name: &str) -> bool {
    text.strip_prefix(name).is_some_and(|rest| rest.starts_with('-'))
}

fn sorted(name: &str) -> Vec<&str> {
    let mut parts: Vec<&str> = name.split('-').collect();
    parts.sort_unstable();
    parts
}
