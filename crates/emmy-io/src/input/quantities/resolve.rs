//! The quantities of a body: groups, nodes and columns that they name.

use emmy::body::{Body, FieldName, Fields, Place as Members};
use emmy::internals::number::{short, short_vector};
use emmy::mesh::Mesh;

use super::{
    GroupValue, Measure, Probe, ProbeQuantity, Quantities, Requested, reaction_columns, value_columns,
};
use crate::history::{ColumnInfo, fixed_names};
use crate::input::fault::{Fault, Place};
use crate::input::suggest::{did_you_mean, listed};

impl Requested {
    /// The quantities of a body, with notes on probes whose node is not at the requested point.
    pub(in crate::input) fn quantities(
        mut self,
        body: &Body,
        notes: &mut Vec<String>,
    ) -> Result<Quantities, Fault> {
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
    // A mean over a cell would hide the largest value.
    if has_cells && value.measure != Measure::Max {
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
    if distance > FAR * mesh.diagonal() {
        notes.push(format!(
            "probe `{}`: the nearest node, {}, is {} away, at {}",
            probe.name,
            probe.node,
            short(distance),
            short_vector(at)
        ));
    }
}
