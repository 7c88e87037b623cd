//! Quantities that `[output]` asks for in the history: reactions, probes, extremes, values of groups.

mod read;
mod resolve;

use emmy::body::{Body, FieldName, Fields, Selection};
use emmy::motion::ReferenceMotion;

pub(super) use read::{PROBE, RELATIVE_TO, Requested, VALUE, field, of_extremes, read};

use crate::history::{ColumnInfo, MechanismColumns};

/// Quantities in the history besides those of the whole body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Quantities {
    /// Groups whose reactions are written, each with its place among [`emmy::body::Body::supported_groups`].
    pub reactions: Vec<(String, usize)>,
    /// Whether the input names these groups; otherwise they are all supported groups.
    pub names_reactions: bool,
    /// Columns of joints and rigid bodies.
    pub(crate) mechanism: MechanismColumns,
    /// Nodes that are followed.
    pub probes: Vec<Probe>,
    /// Fields whose largest value is written.
    pub extremes: Vec<FieldName>,
    /// Values of groups.
    pub values: Vec<GroupValue>,
    /// Frame of reference of all quantities; `None`: at rest.
    pub relative_to: Option<String>,
    /// The motions of this frame and of those of the probes, but for `"ground"`.
    pub references: Vec<(String, ReferenceMotion)>,
}

/// A point that is followed: the nearest node.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Name in the columns of the history.
    pub name: String,
    /// The requested point, in the reference configuration \[length\].
    pub point: [f64; 3],
    /// Group of cells from which fields are recovered, and whose nearest node is taken; `None`: all cells.
    pub group: Option<String>,
    /// Index of the nearest node in the whole mesh or of the group, the lowest of several.
    pub node: usize,
    /// The quantities that are written.
    pub quantities: Vec<ProbeQuantity>,
    /// Their frame of reference; `None`: that of all quantities.
    pub relative_to: Option<String>,
}

/// A quantity of a probe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProbeQuantity {
    /// Current position \[length\].
    Position,
    /// A field at nodes.
    Field(FieldName),
}

/// Name of the frame at rest.
pub(crate) const GROUND: &str = "ground";

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
    /// Largest value, of a vector its norm; where regions meet, each of them has its own value.
    Max,
}

impl ProbeQuantity {
    /// Its components, as in [`FieldName::components`].
    pub(crate) fn components(self) -> &'static [&'static str] {
        match self {
            ProbeQuantity::Position => FieldName::Displacement.components(),
            ProbeQuantity::Field(field) => field.components(),
        }
    }
}

impl Measure {
    const ALL: [(&str, Measure); 3] =
        [("total", Measure::Total), ("mean", Measure::Mean), ("max", Measure::Max)];
}

impl Probe {
    /// The fields among its quantities.
    pub(crate) fn fields(&self) -> impl Iterator<Item = FieldName> + '_ {
        self.quantities.iter().filter_map(|quantity| match quantity {
            ProbeQuantity::Position => None,
            ProbeQuantity::Field(field) => Some(*field),
        })
    }

    /// Its node, for fields that are recovered from the cells of its group alone; `node`: the index in the mesh of the
    /// body.
    pub(crate) fn selection(&self, body: &Body, fields: &Fields, node: usize) -> Selection {
        let cells = self.group.as_deref().and_then(|group| body.mesh().groups().cells(group).ok());
        match cells {
            Some(cells) => fields.select_nodes_in(&[node as u32], cells.to_vec()),
            None => fields.select_nodes(&[node as u32]),
        }
    }

    /// Its columns; `relative_to`: of all quantities.
    fn columns(&self, relative_to: Option<&str>) -> Vec<ColumnInfo> {
        let relative = relation(self.relative_to.as_deref().or(relative_to));
        let of = |quantity: &ProbeQuantity| match quantity {
            ProbeQuantity::Position => {
                let meaning = format!("current position of the probe {}{relative}", self.name);
                columns(&self.name, quantity.components(), "length", &meaning)
            }
            ProbeQuantity::Field(field) => {
                let relative = if field.is_of_motion() { relative.as_str() } else { "" };
                let meaning = format!("{field} at the probe {}{relative}", self.name);
                columns(&format!("{}_{field}", self.name), field.components(), field.dimension(), &meaning)
            }
        };
        self.quantities.iter().flat_map(of).collect()
    }
}

impl Quantities {
    /// All columns, in their order.
    pub fn columns(&self) -> Vec<ColumnInfo> {
        let probes = self.probes.iter().flat_map(|probe| probe.columns(self.relative_to.as_deref()));
        let reactions = self.reactions.iter().flat_map(|(group, _)| reaction_columns(group));
        let mechanism = self.mechanism.owned().into_iter().map(|(_, column)| column);
        let extremes = self.extremes.iter().map(|field| extreme_column(*field, self.relative_to.as_deref()));
        let values = self.values.iter().flat_map(value_columns);
        probes.chain(reactions).chain(mechanism).chain(extremes).chain(values).collect()
    }

    /// Motion of the frame of reference; `None`: at rest.
    pub fn reference(&self) -> Option<&ReferenceMotion> {
        self.reference_of(self.relative_to.as_deref()?)
    }

    /// Motion of the frame of reference of a probe; `None`: at rest.
    pub(crate) fn reference_of_probe(&self, probe: &Probe) -> Option<&ReferenceMotion> {
        self.reference_of(probe.relative_to.as_deref().or(self.relative_to.as_deref())?)
    }

    fn reference_of(&self, name: &str) -> Option<&ReferenceMotion> {
        self.references.iter().find(|(own, _)| own == name).map(|(_, motion)| motion)
    }

    /// Names of the columns that the input names: all but joints, rigid bodies, and reactions that it does not list.
    pub(crate) fn named_columns(&self) -> Vec<String> {
        let reactions = if self.names_reactions { self.reactions.clone() } else { Vec::new() };
        let named = Quantities { reactions, mechanism: MechanismColumns::default(), ..self.clone() };
        named.columns().into_iter().map(|column| column.name).collect()
    }
}

fn reaction_columns(group: &str) -> Vec<ColumnInfo> {
    let force = format!("reaction of {group}: its mean force on the body over the step");
    let moment = format!("moment of the reaction of {group} about the origin");
    let mut all = columns(&format!("{group}_force"), &AXES, "force", &force);
    all.extend(columns(&format!("{group}_moment"), &AXES, "force·length", &moment));
    all
}

fn extreme_column(field: FieldName, relative_to: Option<&str>) -> ColumnInfo {
    let relative = if field.is_of_motion() { relation(relative_to) } else { String::new() };
    let meaning = format!("largest value of {field} in the body{relative}");
    ColumnInfo { name: format!("max_{field}"), dimension: field.dimension().to_string(), meaning }
}

/// Words for a frame of reference after the name of a quantity.
pub(crate) fn relation(relative_to: Option<&str>) -> String {
    let other = relative_to.filter(|name| *name != GROUND);
    other.map_or_else(String::new, |name| format!(", relative to {name}"))
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
