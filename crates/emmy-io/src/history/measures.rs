//! Numbers of a state that `[output]` asks for: reactions, probes, extremes, values of groups.

use emmy::body::{Body, FieldName, FieldValues, Fields, Place, Selection};
use emmy::mesh::Mesh;
use emmy::motion::{State, View};
use serde::{Deserialize, Serialize};

use super::ColumnInfo;
use super::Number::{self, Missing, Real};
use crate::input::{GroupValue, Measure, ProbeQuantity, Quantities};

/// The largest value of a field so far, and where it was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Extreme {
    /// Name of the field.
    pub field: String,
    /// The value, of a vector its norm.
    pub value: f64,
    /// Number of the step.
    pub step: usize,
    /// Time \[time\].
    pub time: f64,
    /// Index of the node, or of the cell of a field in cells.
    pub member: usize,
    /// Whether the member is a cell.
    pub is_cell: bool,
    /// Position of the node, or of the centre of the nodes of the cell, in the reference configuration \[length\].
    pub point: [f64; 3],
}

impl Extreme {
    /// The largest value of a field at a state; undefined values are left out.
    pub(crate) fn of(mesh: &Mesh, state: &State, field: FieldName, numbers: &[f64]) -> Option<Self> {
        let sizes = numbers.chunks_exact(field.components().len()).map(size).enumerate();
        let (member, value) = sizes.filter(|(_, size)| !size.is_nan()).max_by(|a, b| a.1.total_cmp(&b.1))?;
        let is_cell = field.place() == Place::Cells;
        let point = if is_cell { centre(mesh, member) } else { mesh.points()[member] };
        let field = field.name().to_string();
        Some(Extreme { field, value, step: state.step, time: state.time, member, is_cell, point })
    }
}

/// A number itself, or the norm of a vector.
fn size(components: &[f64]) -> f64 {
    match components {
        [number] => *number,
        vector => vector.iter().map(|x| x * x).sum::<f64>().sqrt(),
    }
}

/// Mean of the nodes of a cell.
fn centre(mesh: &Mesh, cell: usize) -> [f64; 3] {
    let nodes = mesh.cell(cell).nodes;
    let sum = |d: usize| nodes.iter().map(|&node| mesh.points()[node as usize][d]).sum::<f64>();
    [0, 1, 2].map(|d| sum(d) / nodes.len() as f64)
}

/// What the quantities of an input need: fields at the members that they name, and nothing else.
#[derive(Debug, Default)]
pub(super) struct Measures {
    quantities: Quantities,
    /// `None` if no quantity needs them.
    fields: Option<Fields>,
    /// The node of each probe.
    probes: Vec<Selection>,
    /// The members of each value, with the weights of a total: reference volumes of cells.
    values: Vec<(Selection, Vec<f64>)>,
}

impl Measures {
    /// The measures of a body.
    pub(super) fn new(body: &Body, quantities: &Quantities) -> Self {
        let quantities = quantities.clone();
        if !needs_fields(&quantities) {
            return Measures { quantities, ..Measures::default() };
        }
        let fields = Fields::new(body);
        let probe = |node: usize| fields.select_nodes(&[node as u32]);
        Measures {
            probes: quantities.probes.iter().map(|own| probe(own.node)).collect(),
            values: quantities.values.iter().map(|value| members(body.mesh(), &fields, value)).collect(),
            fields: Some(fields),
            quantities,
        }
    }

    /// The columns.
    pub(super) fn columns(&self) -> Vec<ColumnInfo> {
        self.quantities.columns()
    }

    pub(super) fn has_extreme(&self, field: &str) -> bool {
        self.quantities.extremes.iter().any(|name| name.name() == field)
    }

    /// Appends the numbers of a state, and returns its extremes.
    pub(super) fn add_to(&self, view: View<'_>, numbers: &mut Vec<Number>) -> Vec<Extreme> {
        self.add_probes(view, numbers);
        for &(_, index) in &self.quantities.reactions {
            match view.motion.reactions().get(index) {
                Some(reaction) => numbers.extend(reaction.force.into_iter().chain(reaction.moment).map(Real)),
                None => numbers.extend([Missing; 6]),
            }
        }
        let extremes = self.extremes(view);
        let of = |name: &FieldName| extremes.iter().find(|own| own.field == name.name());
        numbers.extend(
            self.quantities
                .extremes
                .iter()
                .map(|name| of(name).map_or(Real(f64::NAN), |own| Real(own.value))),
        );
        if let Some(fields) = &self.fields {
            self.add_values(fields, view.state, numbers);
        }
        extremes
    }

    fn add_values(&self, fields: &Fields, state: &State, numbers: &mut Vec<Number>) {
        for (value, (selection, weights)) in self.quantities.values.iter().zip(&self.values) {
            let all = fields.on(selection, &state.displacement, &state.velocity, value.quantity);
            let n = value.quantity.components().len();
            numbers.extend(measured(&all, n, weights, value.measure).into_iter().map(Real));
        }
    }

    fn add_probes(&self, view: View<'_>, numbers: &mut Vec<Number>) {
        let State { displacement, velocity, .. } = view.state;
        for (index, probe) in self.quantities.probes.iter().enumerate() {
            let of_node = |vectors: &[f64]| vectors[3 * probe.node..3 * probe.node + 3].to_vec();
            for quantity in &probe.quantities {
                let own = match (quantity, &self.fields) {
                    (ProbeQuantity::Position, _) => view.state.position(view.body, probe.node).to_vec(),
                    (ProbeQuantity::Field(FieldName::Displacement), _) => of_node(displacement),
                    (ProbeQuantity::Field(FieldName::Velocity), _) => of_node(velocity),
                    (ProbeQuantity::Field(name), Some(fields)) => {
                        fields.on(&self.probes[index], displacement, velocity, *name)
                    }
                    (ProbeQuantity::Field(name), None) => vec![f64::NAN; name.components().len()],
                };
                numbers.extend(own.into_iter().map(Real));
            }
        }
    }

    /// The largest values at a state.
    fn extremes(&self, view: View<'_>) -> Vec<Extreme> {
        let State { displacement, velocity, .. } = view.state;
        let names = &self.quantities.extremes;
        let of = |name: FieldName, numbers: &[f64]| Extreme::of(view.body.mesh(), view.state, name, numbers);
        match &self.fields {
            Some(fields) => {
                let all = fields.at(displacement, velocity, names);
                all.iter().filter_map(|FieldValues { name, numbers }| of(*name, numbers)).collect()
            }
            None => names.iter().filter_map(|&name| of(name, motion_of(name, view.state))).collect(),
        }
    }
}

/// Displacement or velocity, which need no fields.
fn motion_of(name: FieldName, state: &State) -> &[f64] {
    if name == FieldName::Velocity { &state.velocity } else { &state.displacement }
}

/// Whether a quantity needs more than displacement and velocity.
fn needs_fields(quantities: &Quantities) -> bool {
    let is_motion = |name: &FieldName| matches!(name, FieldName::Displacement | FieldName::Velocity);
    let of_probes = quantities.probes.iter().flat_map(|probe| &probe.quantities);
    let of_probes = of_probes.filter_map(|quantity| match quantity {
        ProbeQuantity::Position => None,
        ProbeQuantity::Field(name) => Some(name),
    });
    !quantities.values.is_empty() || of_probes.chain(&quantities.extremes).any(|name| !is_motion(name))
}

/// The members of a value with their weights.
fn members(mesh: &Mesh, fields: &Fields, value: &GroupValue) -> (Selection, Vec<f64>) {
    match value.quantity.place() {
        Place::Cells => {
            let all: Vec<u32> = (0..mesh.n_cells() as u32).collect();
            let group = value.group.as_ref().and_then(|group| mesh.groups().cells(group).ok());
            let cells = group.unwrap_or(&all);
            let volumes = cells.iter().map(|&cell| fields.cell_volume(cell as usize));
            (fields.select_cells(cells), volumes.collect())
        }
        Place::Nodes => {
            let all = || (0..mesh.n_nodes() as u32).collect();
            let nodes =
                value.group.as_ref().and_then(|group| mesh.group_nodes(group).ok()).unwrap_or_else(all);
            (fields.select_nodes(&nodes), vec![1.0; nodes.len()])
        }
    }
}

/// The numbers of a value; `all: [n_members][n]`.
fn measured(all: &[f64], n: usize, weights: &[f64], measure: Measure) -> Vec<f64> {
    let members = || all.chunks_exact(n);
    let sum = |weight: &dyn Fn(usize) -> f64| {
        let of =
            |component: usize| members().enumerate().map(|(i, own)| weight(i) * own[component]).sum::<f64>();
        (0..n).map(of).collect::<Vec<f64>>()
    };
    let whole: f64 = weights.iter().sum();
    match measure {
        Measure::Total => sum(&|member| weights[member]),
        Measure::Mean if whole > 0.0 => sum(&|member| weights[member] / whole),
        // Springs have no volume.
        Measure::Mean => sum(&|_| 1.0 / weights.len() as f64),
        Measure::Max => vec![members().map(size).filter(|size| !size.is_nan()).fold(f64::NAN, f64::max)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn totals_means_and_largest_values() {
        // Two members of two components, volumes 1 and 3.
        let all = [2.0, 0.0, 6.0, 8.0];
        assert_eq!(measured(&all, 2, &[1.0, 3.0], Measure::Total), [20.0, 24.0]);
        assert_eq!(measured(&all, 2, &[1.0, 3.0], Measure::Mean), [5.0, 6.0]);
        assert_eq!(measured(&all, 2, &[0.0, 0.0], Measure::Mean), [4.0, 4.0]);
        assert_eq!(measured(&all, 2, &[1.0, 3.0], Measure::Max), [10.0]);
        assert_eq!(measured(&[f64::NAN, -3.0, -5.0], 1, &[1.0; 3], Measure::Max), [-3.0]);
    }
}
