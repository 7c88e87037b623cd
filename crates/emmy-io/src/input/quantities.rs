//! Quantities that `[output]` asks for in the history: reactions, probes, extremes, values of groups.

use emmy::body::{Body, FieldName, Fields, Place as Members};
use emmy::internals::number::{short, short_vector};
use emmy::mesh::Mesh;

use super::description::{Described, Kind, Section, vector};
use super::fault::{Fault, Place};
use super::suggest::{did_you_mean, listed};
use super::table::{Item, Table};
use crate::history::{ColumnInfo, fixed_names};

/// Quantities in the history besides those of the whole body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Quantities {
    /// Groups whose reactions are written, each with its place among [`Body::supported_groups`].
    pub reactions: Vec<(String, usize)>,
    /// Nodes that are followed.
    pub probes: Vec<Probe>,
    /// Fields whose largest value is written.
    pub extremes: Vec<FieldName>,
    /// Values of groups.
    pub values: Vec<GroupValue>,
}

/// A point that is followed: the nearest node.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Name in the columns of the history.
    pub name: String,
    /// The requested point, in the reference configuration \[length\].
    pub point: [f64; 3],
    /// Index of the nearest node.
    pub node: usize,
    /// What is written of it.
    pub quantities: Vec<ProbeQuantity>,
}

/// A quantity of a probe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProbeQuantity {
    /// Current position \[length\].
    Position,
    /// A field at nodes.
    Field(FieldName),
}

/// A number of a field in a group.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupValue {
    /// Name of its column.
    pub name: String,
    /// The group; `None`: all cells.
    pub group: Option<String>,
    /// The field: in cells where the group has cells and the quantity has such a field, else at nodes.
    pub quantity: FieldName,
    /// How the field becomes a number.
    pub measure: Measure,
}

/// How a field in a group becomes a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Integral over the reference volume of the cells.
    Total,
    /// Mean by reference volume in cells, plain mean at nodes.
    Mean,
    /// Largest value, of a vector its norm.
    Max,
}

impl Measure {
    const ALL: [(&str, Measure); 3] =
        [("total", Measure::Total), ("mean", Measure::Mean), ("max", Measure::Max)];
}

impl Probe {
    /// Its columns.
    fn columns(&self) -> Vec<ColumnInfo> {
        let of = |quantity: &ProbeQuantity| match quantity {
            ProbeQuantity::Position => {
                let meaning = format!("current position of the probe {}", self.name);
                columns(&self.name, FieldName::Displacement.components(), "length", &meaning)
            }
            ProbeQuantity::Field(field) => {
                let meaning = format!("{field} at the probe {}", self.name);
                columns(&format!("{}_{field}", self.name), field.components(), field.dimension(), &meaning)
            }
        };
        self.quantities.iter().flat_map(of).collect()
    }
}

impl Quantities {
    /// All columns, in their order.
    pub fn columns(&self) -> Vec<ColumnInfo> {
        let probes = self.probes.iter().flat_map(Probe::columns);
        let reactions = self.reactions.iter().flat_map(|(group, _)| reaction_columns(group));
        let extremes = self.extremes.iter().map(|field| extreme_column(*field));
        let values = self.values.iter().flat_map(value_columns);
        probes.chain(reactions).chain(extremes).chain(values).collect()
    }
}

fn reaction_columns(group: &str) -> Vec<ColumnInfo> {
    let force = format!("reaction of {group}: its mean force on the body over the step");
    let moment = format!("moment of the reaction of {group} about the origin");
    let mut all = columns(&format!("{group}_force"), &AXES, "force", &force);
    all.extend(columns(&format!("{group}_moment"), &AXES, "force·length", &moment));
    all
}

fn extreme_column(field: FieldName) -> ColumnInfo {
    let meaning = format!("largest value of {field} in the body");
    ColumnInfo { name: format!("max_{field}"), dimension: field.dimension().to_string(), meaning }
}

fn value_columns(value: &GroupValue) -> Vec<ColumnInfo> {
    let field = value.quantity;
    let group = value.group.as_deref().unwrap_or("all cells");
    let meaning = |measure: &str| format!("{measure} of {field} in {group}");
    match value.measure {
        Measure::Max => columns(&value.name, &[""], field.dimension(), &meaning("largest value")),
        Measure::Mean => columns(&value.name, field.components(), field.dimension(), &meaning("mean")),
        Measure::Total => {
            columns(&value.name, field.components(), &integrated(field.dimension()), &meaning("total"))
        }
    }
}

/// Dimension of a quantity times volume.
fn integrated(dimension: &str) -> String {
    match (dimension, dimension.strip_suffix("/length³")) {
        ("", _) => "length³".to_string(),
        (_, Some(whole)) => whole.to_string(),
        (_, None) => format!("{dimension}·length³"),
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// A column for each component; the component of a scalar has no name.
fn columns(name: &str, components: &[&str], dimension: &str, meaning: &str) -> Vec<ColumnInfo> {
    let column = |component: &&str| {
        let name = match *component {
            "" => name.to_string(),
            component => format!("{name}_{component}"),
        };
        ColumnInfo { name, dimension: dimension.to_string(), meaning: meaning.to_string() }
    };
    components.iter().map(column).collect()
}

/// Names that would repeat columns of the whole body.
const TAKEN: [&str; 2] = ["linear_momentum", "angular_momentum"];

const POSITION: &str = "position";

/// Quantities of a probe.
fn of_probes() -> Vec<&'static str> {
    let at_nodes = FieldName::ALL.into_iter().filter(|field| field.place() == Members::Nodes);
    std::iter::once(POSITION).chain(at_nodes.map(FieldName::name)).collect()
}

/// Fields of which there is a largest value: numbers, and vectors by their norm.
pub(super) fn of_extremes() -> Vec<&'static str> {
    FieldName::ALL.into_iter().filter(|field| has_size(*field)).map(FieldName::name).collect()
}

fn has_size(field: FieldName) -> bool {
    matches!(field.components(), [""] | ["x", "y", "z"])
}

/// A probe.
pub(super) static PROBE: Described = Described::new(|| {
    Section::new("a probe", "A node that is followed")
        .must("name", Kind::Column(&TAKEN), "", "Name of its columns: letters, digits, `_` and `-`")
        .must(
            "point",
            vector(),
            "length",
            "Reference position; the nearest node is taken, with a note if it lies elsewhere",
        )
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
pub(super) static VALUE: Described = Described::new(|| {
    Section::new("a value of a group", "A number of a field in a group")
        .must("name", Kind::Column(&TAKEN), "", "Name of its column: letters, digits, `_` and `-`")
        .may("group", Kind::Text, "", "Group of cells, facets or nodes")
        .absent("all cells")
        .must(
            "quantity",
            Kind::Word(FieldName::ALL.map(FieldName::name).to_vec()),
            "",
            "The field; in a group of cells, its means in cells where `emmy list fields` has them",
        )
        .may(
            "measure",
            Kind::Word(Measure::ALL.map(|(word, _)| word).to_vec()),
            "",
            "`total`: integral over the reference volume of cells; `mean`: mean by this volume, at nodes the plain mean; \
             `max`: the largest value, of a vector its norm",
        )
        .default("\"mean\"")
});

/// Quantities as they are asked for, each with its place.
#[derive(Debug)]
pub(super) struct Requested {
    /// `None`: every support's group.
    reactions: Option<Vec<(String, Place)>>,
    probes: Vec<(Probe, Place)>,
    extremes: Vec<(FieldName, Place)>,
    values: Vec<(GroupValue, Place)>,
}

/// Reads the quantities in `[output]`.
pub(super) fn read(table: &Table<'_>) -> Result<Requested, Fault> {
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
    Ok((Probe { name, point, node: 0, quantities }, place))
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

impl Requested {
    /// The quantities of a body, with notes on probes whose node is not at the requested point.
    pub(super) fn quantities(mut self, body: &Body, notes: &mut Vec<String>) -> Result<Quantities, Fault> {
        let mesh = body.mesh();
        for (probe, _) in &mut self.probes {
            find(mesh, probe, notes);
        }
        for (value, place) in &mut self.values {
            resolve(mesh, value, place)?;
        }
        self.check_fields(body)?;
        let reactions = self.reactions(body)?;
        self.check_columns(&reactions)?;
        Ok(Quantities {
            reactions,
            probes: values(self.probes),
            extremes: values(self.extremes),
            values: values(self.values),
        })
    }

    fn reactions(&self, body: &Body) -> Result<Vec<(String, usize)>, Fault> {
        let known: Vec<&str> = body.supported_groups().collect();
        let Some(requested) = &self.reactions else {
            return Ok(known.iter().enumerate().map(|(index, group)| (group.to_string(), index)).collect());
        };
        let find = |(group, place): &(String, Place)| match known.iter().position(|name| name == group) {
            Some(index) => Ok((group.clone(), index)),
            None => {
                let label = did_you_mean(group, known.iter().copied()).unwrap_or("not supported".into());
                let fault = Fault::at(place, format!("the group `{group}` has no support"), label);
                Err(match &known[..] {
                    [] => fault.help("no group has a support, so there are no reactions"),
                    known => fault.help(format!("groups with supports: {}", listed(known.iter().copied()))),
                })
            }
        };
        requested.iter().map(find).collect()
    }

    /// Every field must be one of the body.
    fn check_fields(&self, body: &Body) -> Result<(), Fault> {
        let of_probe = |(probe, place): &(Probe, Place)| {
            let fields = probe.quantities.iter().filter_map(|quantity| match quantity {
                ProbeQuantity::Position => None,
                ProbeQuantity::Field(field) => Some((*field, place.clone())),
            });
            fields.collect::<Vec<_>>()
        };
        let mut all: Vec<(FieldName, Place)> = self.probes.iter().flat_map(of_probe).collect();
        all.extend(self.extremes.iter().cloned());
        all.extend(self.values.iter().map(|(value, place)| (value.quantity, place.clone())));
        if all.is_empty() {
            return Ok(());
        }
        let fields = Fields::new(body);
        match all.into_iter().find(|(field, _)| !fields.has(*field)) {
            None => Ok(()),
            Some((field, place)) => {
                let message =
                    format!("the body has no field `{field}`: none of its cells has such a quantity");
                Err(Fault::at(&place, message, "not of this body"))
            }
        }
    }

    /// No two columns may have the same name.
    fn check_columns(&self, reactions: &[(String, usize)]) -> Result<(), Fault> {
        let mut taken: Vec<String> = fixed_names().map(str::to_string).collect();
        let names =
            |columns: Vec<ColumnInfo>| columns.into_iter().map(|column| column.name).collect::<Vec<_>>();
        taken.extend(reactions.iter().flat_map(|(group, _)| names(reaction_columns(group))));
        taken.extend(self.extremes.iter().map(|(field, _)| format!("max_{field}")));
        let probes = self.probes.iter().map(|(probe, place)| (names(probe.columns()), place));
        let values = self.values.iter().map(|(value, place)| (names(value_columns(value)), place));
        for (columns, place) in probes.chain(values) {
            if let Some(column) = columns.iter().find(|column| taken.contains(column)) {
                return Err(Fault::at(place, format!("there is a column `{column}` already"), "taken"));
            }
            taken.extend(columns);
        }
        Ok(())
    }
}

fn values<T>(placed: Vec<(T, Place)>) -> Vec<T> {
    placed.into_iter().map(|(value, _)| value).collect()
}

/// Takes the field in cells in a group of cells, and checks that the group has members for the field.
fn resolve(mesh: &Mesh, value: &mut GroupValue, place: &Place) -> Result<(), Fault> {
    let groups = mesh.groups();
    let has_cells = match &value.group {
        None => true,
        Some(group) => match mesh.group_nodes(group) {
            Ok(_) => groups.cells.contains_key(group),
            Err(_) => {
                let known = groups.names();
                let label = did_you_mean(group, known.iter().copied()).unwrap_or("not there".into());
                let fault = Fault::at(place, format!("the mesh has no group `{group}` with members"), label);
                return Err(fault.help(format!("groups: {}", listed(known.iter().copied()))));
            }
        },
    };
    let name = value.quantity;
    if has_cells {
        value.quantity = name.in_cells().unwrap_or(name);
    }
    let is_in_cells = value.quantity.place() == Members::Cells;
    if is_in_cells && !has_cells {
        let message = format!("`{name}` is a field in cells, and the group has none");
        return Err(Fault::at(place, message, "not in this group"));
    }
    if !is_in_cells && value.measure == Measure::Total {
        let message = format!("`{name}` has no total: only fields in cells are integrated");
        let fault = Fault::at(place, message, "not of this field and group");
        return Err(fault.help("`measure` may be `mean` or `max`, or the group one of cells"));
    }
    Ok(())
}

/// Distance between a probe's point and its node, relative to the size of the mesh, above which there is a remark.
const FAR: f64 = 1e-6;

/// Finds the node of a probe, with a note if it is not at the requested point.
fn find(mesh: &Mesh, probe: &mut Probe, notes: &mut Vec<String>) {
    probe.node = mesh.nearest_node(probe.point);
    let at = mesh.points()[probe.node];
    let distance = (0..3).map(|i| (at[i] - probe.point[i]).powi(2)).sum::<f64>().sqrt();
    if distance > FAR * size(mesh) {
        notes.push(format!(
            "probe `{}`: the nearest node, {}, is {} away, at {}",
            probe.name,
            probe.node,
            short(distance),
            short_vector(at)
        ));
    }
}

/// Diagonal of the box around the mesh.
fn size(mesh: &Mesh) -> f64 {
    let extent = |i: usize| {
        let coordinates = mesh.points().iter().map(|point| point[i]);
        let (low, high) =
            coordinates.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    (0..3).map(|i| extent(i).powi(2)).sum::<f64>().sqrt()
}
