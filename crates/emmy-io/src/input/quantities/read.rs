//! The keys of the quantities.

use emmy::body::{FieldName, Place as Members};

use super::{GroupValue, Measure, Probe, ProbeQuantity};
use crate::input::description::{Described, Kind, Section, vector};
use crate::input::fault::{Fault, Place};
use crate::input::table::{Item, Table};

/// Names that would repeat columns of the whole body.
const TAKEN: [&str; 2] = ["linear_momentum", "angular_momentum"];

const POSITION: &str = "position";

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
            Kind::Words(of_probes()),
            "",
            "What is written of it: its position in the columns `NAME_x`, `NAME_y`, `NAME_z`, or fields at nodes, such as \
             `\"displacement\"` in `NAME_displacement_x`",
        )
        .default("[\"position\"]")
});

/// A value of a group.
pub(in crate::input) static VALUE: Described = Described::new(|| {
    Section::new("a value of a group", "A number of a field in a group")
        .must("name", Kind::Column(&TAKEN), "", "Name of its column: letters, digits, `_` and `-`")
        .may("group", Kind::Text, "", "Group of cells, facets or nodes")
        .absent("all cells")
        .must(
            "quantity",
            Kind::Word(FieldName::ALL.map(FieldName::name).to_vec()),
            "",
            "The field; `total` and `mean` in a group of cells take its means in cells, where `emmy list fields` has them",
        )
        .may(
            "measure",
            Kind::Word(Measure::ALL.map(|(word, _)| word).to_vec()),
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
    pub(super) probes: Vec<(Probe, Place)>,
    pub(super) extremes: Vec<(FieldName, Place)>,
    pub(super) values: Vec<(GroupValue, Place)>,
}

/// Reads the quantities in `[output]`.
pub(in crate::input) fn read(table: &Table<'_>) -> Result<Requested, Fault> {
    let reactions = table.get("reactions").map(|item| {
        let groups = item.list_or("a list of groups, such as [\"foot\"]")?;
        distinct(groups.iter().map(|group| Ok((group.name()?, group.place().clone()))), |group| {
            format!("the group `{group}` is there twice")
        })
    });
    let extremes = table.get("extremes").map_or(Ok(Vec::new()), |item| item.list_or("a list of fields"))?;
    Ok(Requested {
        reactions: reactions.transpose()?,
        probes: named(table.require("probes")?, probe, |probe| &probe.name, "probes")?,
        extremes: distinct(extremes.iter().map(extreme), |field| {
            format!("the field `{field}` is there twice")
        })?,
        values: table
            .get("values")
            .map_or(Ok(Vec::new()), |item| named(item, value, |value| &value.name, "values"))?,
    })
}

fn extreme(item: &Item<'_>) -> Result<(FieldName, Place), Fault> {
    let word = item.word("a field with a largest value", &of_extremes())?;
    Ok((field(item, word)?, item.place().clone()))
}

fn field(item: &Item<'_>, word: &str) -> Result<FieldName, Fault> {
    FieldName::from_name(word).ok_or_else(|| item.fault(format!("`{word}` is not a field"), "not known"))
}

/// Entries of a list without repetitions; `message`: on the second of two.
fn distinct<T: PartialEq>(
    entries: impl Iterator<Item = Result<(T, Place), Fault>>,
    message: impl Fn(&T) -> String,
) -> Result<Vec<(T, Place)>, Fault> {
    let mut found: Vec<(T, Place)> = Vec::new();
    for entry in entries {
        let (entry, place) = entry?;
        if found.iter().any(|(other, _)| *other == entry) {
            return Err(Fault::at(&place, message(&entry), "again"));
        }
        found.push((entry, place));
    }
    Ok(found)
}

/// Entries of a list with different names.
fn named<T>(
    item: Item<'_>,
    read: fn(Item<'_>) -> Result<(T, Place), Fault>,
    name: fn(&T) -> &str,
    what: &str,
) -> Result<Vec<(T, Place)>, Fault> {
    let mut entries: Vec<(T, Place)> = Vec::new();
    for item in item.list()? {
        let entry = read(item)?;
        if let Some((_, first)) = entries.iter().find(|(other, _)| name(other) == name(&entry.0)) {
            let message = format!("two {what} are named `{}`", name(&entry.0));
            return Err(Fault::at(&entry.1, message, "second").label(first, "first"));
        }
        entries.push(entry);
    }
    Ok(entries)
}

fn probe(item: Item<'_>) -> Result<(Probe, Place), Fault> {
    let table = item.table(&PROBE)?;
    let (name, place) = column_name(&table, "a probe")?;
    let point = table.require("point")?.numbers()?;
    let group = table.get("group").map(|item| item.name()).transpose()?;
    let words = table.require("quantities")?;
    let words = words.list_or("a list of quantities, such as [\"position\", \"von_mises_stress\"]")?;
    let quantity = |item: &Item<'_>| {
        let quantity = match item.word("a quantity of a probe", &of_probes())? {
            POSITION => ProbeQuantity::Position,
            word => ProbeQuantity::Field(field(item, word)?),
        };
        Ok((quantity, item.place().clone()))
    };
    let twice = |_: &ProbeQuantity| "the quantity is there twice".to_string();
    let quantities = distinct(words.iter().map(quantity), twice)?;
    let quantities: Vec<ProbeQuantity> = quantities.into_iter().map(|(quantity, _)| quantity).collect();
    if quantities.is_empty() {
        let message = format!("the probe `{name}` has no `quantities`");
        return Err(Fault::at(&place, message, "such as [\"position\"]"));
    }
    Ok((Probe { name, point, group, node: 0, quantities }, place))
}

fn value(item: Item<'_>) -> Result<(GroupValue, Place), Fault> {
    let table = item.table(&VALUE)?;
    let (name, place) = column_name(&table, "a value")?;
    let group = table.get("group").map(|item| item.name()).transpose()?;
    let item = table.require("quantity")?;
    let word = item.word("a field", &FieldName::ALL.map(FieldName::name))?;
    let quantity = field(&item, word)?;
    let item = table.require("measure")?;
    let measure = item.one_of("a measure", &Measure::ALL)?;
    if measure == Measure::Max && !has_size(quantity) {
        let message = format!("`{word}` has no largest value: it has several components");
        return Err(item.fault(message, "not of this field").help("such as the quantity `von_mises_stress`"));
    }
    Ok((GroupValue { name, group, quantity, measure }, place))
}

/// The name of columns, and its place.
fn column_name(table: &Table<'_>, what: &str) -> Result<(String, Place), Fault> {
    let item = table.require("name")?;
    let name = item.string()?;
    if !name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-') {
        let message =
            format!("{what}'s name becomes a column: `{name}` may have letters, digits, `_` and `-` only");
        return Err(item.fault(message, "not a name"));
    }
    if TAKEN.contains(&name) {
        return Err(item.fault(format!("there is a column `{name}_x` already"), "taken"));
    }
    Ok((name.to_string(), item.place().clone()))
}
