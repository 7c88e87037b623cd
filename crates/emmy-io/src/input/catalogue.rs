//! All tables of the input, and advice on words that are not keys.

use std::sync::LazyLock;

use super::description::{Described, Key, Kind, Rule, Section, tables};
use super::{
    contact, coupling, equilibrium, expect, initial, joint, load, material, nodal, parameters, region, rigid,
    settings, shape, support, tie, time, units,
};

/// The whole input.
pub(super) static ROOT: Described = Described::new(|| {
    let section = Section::new(
        "the input",
        "Motion of elastic and rigid bodies; units are any consistent set",
    )
    .may("title", Kind::Text, "", "Any text; it goes into the summary")
    .may("units", Kind::Table(&units::UNITS), "", "System of units, for results with units")
    .may(
        "parameters",
        Kind::Table(&parameters::PARAMETERS),
        "",
        "Numbers by name, for values that are computed",
    )
    .may("mesh", Kind::Table(&shape::MESH), "", "Source of the cells")
    .absent("required, unless there is `rigid`")
    .may("region", tables(1, &region::REGION), "", "Material of the cells; one or more")
    .absent("required with `mesh`")
    .may("mass", tables(0, &nodal::MASS), "", "Masses besides those of the cells; none, one or more")
    .may("load", tables(0, &load::LOAD), "", "Loads on the body; none, one or more")
    .may("support", tables(0, &support::SUPPORT), "", "Nodes that are held or driven; none, one or more")
    .may("tie", tables(0, &tie::TIE), "", "Nodes that follow other parts of the body; none, one or more")
    .may(
        "rigid",
        tables(0, &rigid::RIGID),
        "",
        "Rigid bodies, without cells or of groups of the mesh; none, one or more",
    )
    .may(
        "coupling",
        tables(0, &coupling::COUPLING),
        "",
        "Points that move with groups of the mesh, rigidly or with their mean; none, one or more",
    )
    .may("joint", tables(0, &joint::JOINT), "", "Joints between bodies; none, one or more")
    .may(
        "contact",
        tables(0, &contact::CONTACT),
        "",
        "Surfaces that meet obstacles or each other; none, one or more",
    )
    .may("initial", tables(0, &initial::INITIAL), "", "Velocities at the start; none, one or more")
    .absent("at rest")
    .may(
        "equilibrium",
        Kind::Table(&equilibrium::EQUILIBRIUM),
        "",
        "Start from the static equilibrium under the loads at t = 0; without `time` a static analysis",
    )
    .absent("starts undeformed")
    .may("time", Kind::Table(&time::TIME), "", "Scheme, degree and steps")
    .absent("a static analysis, which needs `equilibrium`")
    .may("newton", Kind::Table(&settings::NEWTON), "", "End of the iteration of a step")
    .default("{}")
    .may("solver", Kind::Table(&settings::SOLVER), "", "Solver of the linear systems")
    .may("output", Kind::Table(&settings::OUTPUT), "", "Files of the results, and their place")
    .default("{}")
    .may("limits", Kind::Table(&settings::LIMITS), "", "Limits that end a run early")
    .may("expect", Kind::Table(&expect::EXPECT), "", "Mass and volume that the body must have");
    Section { rule: Rule::Input(&["time", "equilibrium"]), ..section }
});

/// The kind of the whole input.
pub(super) static ROOT_KIND: LazyLock<Kind> = LazyLock::new(|| Kind::Table(&ROOT));

/// Keys that a table does not have yet.
const PLANNED: [(&str, &[&str]); 1] = [("[[contact]]", &["friction", "slip_velocity", "damping"])];

/// Whether a word is such a key.
pub(super) fn is_planned(section: &Section, word: &str) -> bool {
    PLANNED.iter().any(|(table, keys)| *table == section.name && keys.contains(&word))
}

/// Largest number of materials in a message about the tables of a key.
const MAX_MODELS: usize = 3;

/// Says in which table a key stands: the one around a table, if that has it; all of them if a few materials have it.
pub(super) fn elsewhere(section: &Section, word: &str) -> Option<String> {
    let mut tables = all().into_iter().filter(|table| table.key_of(word).is_some());
    let around = tables.clone().find(|table| table.key_of(section.name).is_some());
    let models: Vec<&Section> = material::sections().filter(|table| table.key_of(word).is_some()).collect();
    // A tolerance or a kind alone is seldom that of a tie, and a name seldom that of a rigid body or of a part.
    let seldom =
        [&*shape::PARTS, &*shape::TURN, &*tie::TIE, &*rigid::RIGID, &*coupling::COUPLING, &*joint::JOINT];
    let other = tables.clone().find(|table| !seldom.iter().any(|own| std::ptr::eq(*own, *table)));
    let table = around.or(other).or_else(|| tables.next())?;
    let name = match models.len() {
        _ if !models.iter().any(|model| model.name == table.name) => table.title(),
        0..=MAX_MODELS => models.iter().map(|model| model.title()).collect::<Vec<_>>().join(" or "),
        _ => "a material".to_string(),
    };
    Some(format!("`{word}` belongs in {name}"))
}

/// The kind of a table of the input, by the key under which it stands, if need be with the table that has the key:
/// `obstacle.plane`.
pub(super) fn kind_of(key: &str) -> Option<&'static Kind> {
    let (table, key) = key.rsplit_once('.').map_or((None, key), |(table, key)| (Some(table), key));
    let tables = all().into_iter().filter(|section| table.is_none_or(|table| section.name == table));
    let keys = tables.flat_map(|section| &section.keys).filter(|own| own.name == key);
    let kind = |own: &'static Key| match own.kind {
        Kind::Tables(..) => own.kind.inner(),
        _ => &own.kind,
    };
    keys.map(kind).find(|kind| kind.section().is_some())
}

/// Every table, each before the tables in it.
pub(super) fn all() -> Vec<&'static Section> {
    fn add(section: &'static Section, all: &mut Vec<&'static Section>) {
        if all.iter().any(|other| std::ptr::eq(*other, section)) {
            return;
        }
        all.push(section);
        section.keys.iter().filter_map(|key| key.kind.section()).for_each(|inner| add(inner, all));
    }
    let mut sections = Vec::new();
    add(&ROOT, &mut sections);
    sections
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_keys_are_unique_and_described() {
        for section in all() {
            for (index, key) in section.keys.iter().enumerate() {
                assert!(section.keys[..index].iter().all(|other| other.name != key.name), "{}", key.name);
                assert!(
                    !key.doc.is_empty() && !key.doc.trim_end_matches("...").ends_with('.'),
                    "{} {}",
                    section.name,
                    key.name
                );
            }
        }
    }
}
