//! The keys of the quantities.

use emmy::body::{FieldName, Place as Members};

use super::{GroupValue, Measure, Probe, ProbeQuantity};
use crate::input::description::{Described, Kind, Section, TAKEN, vector, word, words};
use crate::input::fault::{Fault, Faults, Place};
use crate::input::placed::Members as MemberKind;
use crate::input::placed::NamedGroup;
use crate::input::suggest::{did_you_mean, listed};
use crate::input::table::{Item, Table};

const POSITION: &str = "position";

/// Description of the keys `relative_to`.
pub(in crate::input) const RELATIVE_TO: &str = "Frame of reference of displacement, velocity, acceleration and position: a \
    group, which stands for the mean motion of its nodes; `\"base\"`, the mean motion of the nodes that supports drive; \
    `\"rigid-motion\"`, the rigid motion that fits the body best, with axes that rotate with it; `\"ground\"`, the frame at \
    rest. A group of one of these names takes precedence";

/// Quantities of a probe.
fn of_probes() -> Vec<&'static str> {
    let at_nodes = FieldName::ALL.into_iter().filter(|field| field.place() == Members::Nodes);
    std::iter::once(POSITION).chain(at_nodes.map(FieldName::name)).collect()
}

/// Fields of which there is a largest value: numbers, and vectors by their norm.
pub(in crate::input) fn of_extremes() -> Vec<&'static str> {
    FieldName::ALL.into_iter().filter(|field| has_size(*field)).map(FieldName::name).collect()
}

fn has_size(field: FieldName) -> bool {
    matches!(field.components(), [""] | ["x", "y", "z"])
}

/// A probe.
pub(in crate::input) static PROBE: Described = Described::new(|| {
    Section::new("a probe", "A node that is followed")
        .must("name", Kind::Column(&TAKEN), "", "Name of its columns: letters, digits, `_` and `-`")
        .must(
            "point",
            vector(),
            "length",
            "Reference position; the nearest node is taken, with a note if it lies elsewhere",
        )
        .may(
            "group",
            Kind::Text,
            "",
            "Group of cells whose nearest node is taken, with fields from these cells alone: one side where regions meet",
        )
        .absent("all cells; where regions meet, fields are means of the sides by volume")
        .may(
            "quantities",
            words("a quantity of a probe", of_probes()),
            "",
            "What is written of it: its position in the columns `NAME_x`, `NAME_y`, `NAME_z`, or fields at nodes, such as \
             `\"displacement\"` in `NAME_displacement_x`",
        )
        .default("[\"position\"]")
        .may("relative_to", Kind::Text, "", RELATIVE_TO)
        .absent("that of `[output]`")
});

/// A value of a group.
pub(in crate::input) static VALUE: Described = Described::new(|| {
    Section::new("a value of a group", "A number of a field in a group")
        .must("name", Kind::Column(&TAKEN), "", "Name of its column: letters, digits, `_` and `-`")
        .may("group", Kind::Text, "", "Group of cells, facets or nodes")
        .absent("all cells")
        .must(
            "quantity",
            word("a field", FieldName::ALL.map(FieldName::name)),
            "",
            "The field; `total` and `mean` in a group of cells take its means in cells, where `emmy list fields` has them",
        )
        .may(
            "measure",
            word("a measure", Measure::ALL.map(|(word, _)| word)),
            "",
            "`total`: integral over the reference volume of cells; `mean`: mean by this volume, at nodes the plain mean; \
             `max`: the largest value, of a vector its norm, with each region by itself where regions meet",
        )
        .default("\"mean\"")
});

/// Quantities as they are asked for, each with its place.
#[derive(Debug)]
pub(in crate::input) struct Requested {
    /// `None`: every support's group.
    pub(super) reactions: Option<Vec<(String, Place)>>,
    /// `None`: every joint.
    pub(super) joints: Option<Vec<(String, Place)>>,
    pub(super) probes: Vec<(Probe, Place)>,
    pub(super) extremes: Vec<(FieldName, Place)>,
    pub(super) values: Vec<(GroupValue, Place)>,
    /// Groups of the probes and the values.
    pub(super) groups: Vec<NamedGroup>,
    pub(super) relative_to: Option<String>,
    /// All frames of reference that are named.
    pub(super) references: Vec<(String, Place)>,
}

impl Requested {
    /// The groups of probes and values, which the mesh must have.
    pub(in crate::input) fn groups(&self) -> &[NamedGroup] {
        &self.groups
    }

    /// Names of columns: what they are, the name and its place.
    pub(in crate::input) fn names(&self) -> impl Iterator<Item = (&'static str, &str, &Place)> {
        let probes = self.probes.iter().map(|(probe, place)| ("probe", probe.name.as_str(), place));
        probes.chain(self.values.iter().map(|(value, place)| ("value", value.name.as_str(), place)))
    }

    /// Checks that the groups of the reactions are some of those with supports.
    pub(in crate::input) fn check_reactions(&self, supported: &[String], faults: &mut Faults) {
        for (group, place) in self.reactions.iter().flatten().filter(|(group, _)| !supported.contains(group))
        {
            let known = || supported.iter().map(String::as_str);
            let label = did_you_mean(group, known()).unwrap_or("not supported".into());
            let fault = Fault::at(place, format!("the group `{group}` has no support"), label);
            faults.push(match supported {
                [] => fault.help("no group has a support, so there are no reactions"),
                _ => fault.help(format!("groups with supports: {}", listed(known()))),
            });
        }
    }

    /// Checks that the joints with columns are some of those of the body.
    pub(in crate::input) fn check_joints(&self, joints: &[&str], faults: &mut Faults) {
        for (name, place) in self.joints.iter().flatten().filter(|(name, _)| !joints.contains(&name.as_str()))
        {
            let known = || joints.iter().copied();
            let label = did_you_mean(name, known()).unwrap_or("not there".into());
            let fault = Fault::at(place, format!("there is no joint `{name}`"), label);
            faults.push(match joints {
                [] => fault.help("there are no joints"),
                _ => fault.help(format!("joints: {}", listed(known()))),
            });
        }
    }
}

/// Reads the quantities in `[output]`.
pub(in crate::input) fn read(table: &Table<'_>, faults: &mut Faults) -> Requested {
    let extremes: Vec<Item<'_>> = table.may("extremes").unwrap_or_default();
    let groups = [("probes", MemberKind::Cells, false), ("values", MemberKind::Nodes, true)];
    let groups = groups.map(|(key, members, or_body)| {
        let tables: Vec<Table<'_>> = table.may(key).unwrap_or_default();
        let named = tables.into_iter().filter_map(|table| table.group());
        let group = |(name, place)| NamedGroup { name, place, members, or_body };
        named.map(group).collect::<Vec<_>>()
    });
    let probes: Vec<Table<'_>> = table.must("probes");
    let relative = std::iter::once(table).chain(&probes).filter_map(|table| table.item("relative_to"));
    Requested {
        groups: groups.concat(),
        relative_to: table.item("relative_to").map(|item| item.name()),
        references: relative.map(|item| (item.name(), item.place().clone())).collect(),
        reactions: table.may("reactions").map(names),
        joints: table.may("joints").map(names),
        probes: named(probes.clone(), probe, |probe| &probe.name, "probes", faults),
        extremes: extremes.into_iter().map(|item| (field(item), item.place().clone())).collect(),
        values: named(table.may("values").unwrap_or_default(), value, |value| &value.name, "values", faults),
    }
}

/// The field that a word names.
pub(in crate::input) fn field(word: Item<'_>) -> FieldName {
    word.one_of(FieldName::ALL.map(|field| (field.name(), field)))
}

/// Names with their places.
fn names(items: Vec<Item<'_>>) -> Vec<(String, Place)> {
    items.into_iter().map(|item| (item.name(), item.place().clone())).collect()
}

/// Entries of a list with different names.
fn named<T>(
    tables: Vec<Table<'_>>,
    read: fn(Table<'_>) -> Result<T, Fault>,
    name: fn(&T) -> &str,
    what: &str,
    faults: &mut Faults,
) -> Vec<(T, Place)> {
    let mut entries: Vec<(T, Place)> = Vec::new();
    for table in tables {
        let place = table.must::<Item<'_>>("name").place().clone();
        let Some(entry) = faults.keep(read(table)) else { continue };
        if let Some((_, first)) = entries.iter().find(|(other, _)| name(other) == name(&entry)) {
            let message = format!("two {what} are named `{}`", name(&entry));
            faults.push(Fault::at(&place, message, "second").label(first, "first"));
        }
        entries.push((entry, place));
    }
    entries
}

fn probe(table: Table<'_>) -> Result<Probe, Fault> {
    let name: Item<'_> = table.must("name");
    let words: Vec<Item<'_>> = table.must("quantities");
    if words.is_empty() {
        let message = format!("the probe `{}` has no `quantities`", name.text().unwrap_or_default());
        return Err(name.fault(message, "such as [\"position\"]"));
    }
    let quantity = |word: Item<'_>| match word.text() {
        Some(POSITION) => ProbeQuantity::Position,
        _ => ProbeQuantity::Field(field(word)),
    };
    Ok(Probe {
        name: table.must::<&str>("name").to_string(),
        point: table.must("point"),
        group: table.group().map(|(name, _)| name),
        node: 0,
        quantities: words.into_iter().map(quantity).collect(),
        relative_to: table.item("relative_to").map(|item| item.name()),
    })
}

fn value(table: Table<'_>) -> Result<GroupValue, Fault> {
    let quantity = field(table.must("quantity"));
    let item: Item<'_> = table.must("measure");
    let measure = item.one_of(Measure::ALL);
    if measure == Measure::Max && !has_size(quantity) {
        let message = format!("`{quantity}` has no largest value: it has several components");
        return Err(item.fault(message, "not of this field").help("such as the quantity `von_mises_stress`"));
    }
    let group = table.group().map(|(name, _)| name);
    Ok(GroupValue { name: table.must::<&str>("name").to_string(), group, quantity, measure })
}
