//! `[units]`: the system of units of the input.

use super::description::{Described, Kind, Section};
use super::fault::Fault;
use super::table::Table;
use crate::units::{SYSTEMS, UnitSystem, Units};

/// `[units]`.
pub(super) static UNITS: Described = Described::new(|| {
    Section::new("[units]", "Units of all numbers of the input").must(
        "system",
        Kind::Word("a system of units", names().collect(), doubt),
        "",
        "Units of length, mass and time; the units of force and stress that follow may be written behind them",
    )
});

fn names() -> impl Iterator<Item = &'static str> {
    SYSTEMS.iter().flat_map(|system| [system.name, system.full_name])
}

pub(super) fn read(table: &Table<'_>) -> Units {
    UnitSystem::named(table.must("system")).map_or_else(Units::default, Units::from)
}

/// The fault of a name that is nearly one of a system.
fn doubt(text: &str) -> Option<(Fault, String)> {
    if let Some(system) = SYSTEMS.iter().find(|system| begins_with(text, system.name)) {
        let message = format!(
            "in `{}`, the unit of force is {} and the unit of stress {}",
            system.name,
            system.unit("force"),
            system.unit("stress")
        );
        return Some((Fault::new(message), format!("did you mean `{}`?", system.full_name)));
    }
    let name = names().find(|name| sorted(name) == sorted(text))?;
    let message = format!("`{text}` is in another order: length, mass, time, force, stress");
    Some((Fault::new(message), format!("did you mean `{name}`?")))
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
