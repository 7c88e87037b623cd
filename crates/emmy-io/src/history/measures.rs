//! Numbers of a state besides those of the whole body: those that `[output]` asks for, reactions, joints, rigid bodies.

use emmy::body::{Body, FieldName, Fields, Place, Selection};
use emmy::mesh::Mesh;
use emmy::motion::{Motion, State, View};
use emmy::team::Subdomain;
use serde::{Deserialize, Serialize};

use super::ColumnInfo;
use super::Number::{self, Missing, Real};
use super::output_motion::OutputMotion;
use super::regions::{RegionMembers, by_region, nodes_of};
use crate::input::{GroupValue, Measure, Probe, ProbeQuantity, Quantities};

/// The largest value of a field so far in the body or in a region, and where it was.
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
    /// Index of the node, or of the cell of a field in cells, in the whole mesh.
    pub member: usize,
    /// Whether the member is a cell.
    pub is_cell: bool,
    /// Position of the node, or of the centre of the nodes of the cell, in the reference configuration \[length\].
    pub point: [f64; 3],
    /// Group of the region from whose cells the value comes; `None`: the whole body.
    #[serde(default)]
    pub region: Option<String>,
}

/// Keeps the largest value of each field, in the body and in each region.
pub(crate) fn keep_largest(kept: &mut Vec<Extreme>, new: impl IntoIterator<Item = Extreme>) {
    for new in new {
        match kept.iter_mut().find(|own| own.field == new.field && own.region == new.region) {
            Some(own) if own.value >= new.value => {}
            Some(own) => *own = new,
            None => kept.push(new),
        }
    }
}

impl Extreme {
    /// The largest value of a field at a state among some members with these numbers, the last of several; undefined
    /// values are left out. On a team a call of all ranks with the members of their shares.
    pub(crate) fn of(
        (mesh, ranks): (&Mesh, &Subdomain),
        state: &State,
        field: FieldName,
        members: impl Iterator<Item = usize>,
        numbers: &[f64],
    ) -> Option<Self> {
        let is_cell = field.place() == Place::Cells;
        let whole = |member: usize| number_of_ranks(ranks, is_cell, member);
        let sizes = members.zip(numbers.chunks_exact(field.components().len()).map(size));
        let sizes = sizes.filter(|(member, size)| !size.is_nan() && counts(ranks, is_cell, *member));
        let own = sizes.max_by(|a, b| a.1.total_cmp(&b.1).then_with(|| whole(a.0).cmp(&whole(b.0))));
        let own = own.map(|(member, value)| {
            let point = if is_cell { centre(mesh, member) } else { mesh.points()[member] };
            (whole(member), value, point)
        });
        let (member, value, point) = largest_of_ranks(ranks, own)?;
        let field = field.name().to_string();
        Some(Extreme {
            field,
            value,
            step: state.step,
            time: state.time,
            member,
            is_cell,
            point,
            region: None,
        })
    }
}

/// Number in the whole mesh of a node or a cell.
fn number_of_ranks(subdomain: &Subdomain, is_cell: bool, member: usize) -> usize {
    let numbers = if is_cell { subdomain.cells() } else { subdomain.nodes() };
    numbers[member] as usize
}

/// Whether a node or a cell counts on this rank.
pub(super) fn counts(ranks: &Subdomain, is_cell: bool, member: usize) -> bool {
    if is_cell { ranks.counts()[member] } else { member < ranks.n_own() }
}

/// The largest value of all ranks with its member and its point; of equal values, the last member.
fn largest_of_ranks(
    subdomain: &Subdomain,
    own: Option<(usize, f64, [f64; 3])>,
) -> Option<(usize, f64, [f64; 3])> {
    let mut value = [own.map_or(f64::NEG_INFINITY, |(_, value, _)| value)];
    subdomain.largest("largest value of a field", &mut value);
    let own = own.filter(|own| own.1 == value[0]);
    let mut last = [own.map_or(-1.0, |(member, ..)| member as f64)];
    subdomain.largest("member of the largest value", &mut last);
    let member = (last[0] >= 0.0).then_some(last[0] as usize)?;
    let mut point = own.filter(|own| own.0 == member).map_or([0.0; 3], |(.., point)| point);
    subdomain.sum("point of the largest value", &mut point);
    Some((member, value[0], point))
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

/// Fields that the quantities of an input need, at the members that they name.
#[derive(Debug, Default)]
pub(super) struct Measures {
    quantities: Quantities,
    /// `None` if no quantity needs them.
    fields: Option<Fields>,
    /// The node of each probe; `None`: another rank owns it.
    probes: Vec<Option<usize>>,
    /// The nodes of the probes for fields, one by one.
    selections: Vec<Option<Selection>>,
    /// The members of each value that count on this rank, with the weights of a total: reference volumes of cells.
    values: Vec<(Vec<Selection>, Vec<f64>)>,
    /// For extremes of fields; `None` if the input asks only for extremes of the motion.
    regions: Option<RegionMembers>,
}

impl Measures {
    /// The measures of a body.
    pub(super) fn new(body: &Body, quantities: &Quantities) -> Self {
        let quantities = quantities.clone();
        let own = |node: usize| body.ranks().own_node(node);
        let probes: Vec<Option<usize>> = quantities.probes.iter().map(|probe| own(probe.node)).collect();
        if !needs_fields(&quantities) {
            return Measures { quantities, probes, ..Measures::default() };
        }
        let fields = Fields::new(body);
        let selection =
            |(probe, node): (&Probe, &Option<usize>)| Some(probe.selection(body, &fields, (*node)?));
        let needs_regions = quantities.extremes.iter().any(|name| !name.is_of_motion());
        Measures {
            selections: quantities.probes.iter().zip(&probes).map(selection).collect(),
            values: quantities.values.iter().map(|value| members(body, &fields, value)).collect(),
            regions: needs_regions.then(|| RegionMembers::new(body, &fields, &quantities.extremes)),
            probes,
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

    /// Appends the numbers of a state, and returns its extremes; on a team, a collective call.
    pub(super) fn add_to(&self, view: View<'_>, numbers: &mut Vec<Number>) -> Vec<Extreme> {
        let motion = self.output_motion(view.motion);
        self.add_probes(view, &motion, numbers);
        for &(_, index) in &self.quantities.reactions {
            match view.motion.reactions().get(index) {
                Some(reaction) => numbers.extend(reaction.force.into_iter().chain(reaction.moment).map(Real)),
                None => numbers.extend([Missing; 6]),
            }
        }
        let displacement = motion.vectors(FieldName::Displacement);
        let seen = |node: usize| {
            let rest = view.body.mesh().points()[node];
            [0, 1, 2].map(|d| rest[d] + displacement[3 * node + d])
        };
        let seen: Option<&dyn Fn(usize) -> [f64; 3]> =
            if self.quantities.reference().is_some() { Some(&seen) } else { None };
        self.quantities.mechanism.add_to(view.record, seen, numbers);
        let extremes = self.extremes(view, &motion);
        let of =
            |name: &FieldName| extremes.iter().find(|own| own.field == name.name() && own.region.is_none());
        numbers.extend(
            self.quantities
                .extremes
                .iter()
                .map(|name| of(name).map_or(Real(f64::NAN), |own| Real(own.value))),
        );
        if let Some(fields) = &self.fields {
            self.add_values((fields, view.body), &motion, numbers);
        }
        extremes
    }

    /// The motion for all quantities but those of probes with a frame of reference of their own.
    fn output_motion<'a>(&self, motion: &'a Motion<'_>) -> OutputMotion<'a> {
        let Quantities { probes, extremes, values, .. } = &self.quantities;
        let of_probes = probes.iter().flat_map(Probe::fields);
        let fields = of_probes.chain(extremes.iter().copied()).chain(values.iter().map(|own| own.quantity));
        OutputMotion::new(motion, self.quantities.reference(), fields)
    }

    fn add_values(
        &self,
        (fields, body): (&Fields, &Body),
        motion: &OutputMotion<'_>,
        numbers: &mut Vec<Number>,
    ) {
        let ranks = body.ranks();
        for (value, (selections, weights)) in self.quantities.values.iter().zip(&self.values) {
            let on = |selection| fields.on(selection, motion.of(value.quantity), value.quantity);
            let all: Vec<f64> = selections.iter().flat_map(on).collect();
            let mut whole = [weights.iter().sum(), weights.len() as f64];
            ranks.sum("size of a group", &mut whole);
            let n = value.quantity.components().len();
            let mut own = measured(&all, n, (weights, whole), value.measure);
            match value.measure {
                Measure::Max => largest_number(ranks, &mut own),
                _ => ranks.sum("value of a group", &mut own),
            }
            numbers.extend(own.into_iter().map(Real));
        }
    }

    /// The numbers of all probes; those of other ranks are added as zeros.
    fn add_probes(&self, view: View<'_>, motion: &OutputMotion<'_>, numbers: &mut Vec<Number>) {
        let mut all = Vec::new();
        for (index, probe) in self.quantities.probes.iter().enumerate() {
            let reference = || self.quantities.reference_of_probe(probe);
            let own = probe.relative_to.as_ref();
            let own = own.map(|_| OutputMotion::new(view.motion, reference(), probe.fields()));
            let motion = own.as_ref().unwrap_or(motion);
            for quantity in &probe.quantities {
                match self.probes[index] {
                    Some(node) => all.extend(self.at_probe((index, node), *quantity, view.body, motion)),
                    None => all.extend(vec![0.0; quantity.components().len()]),
                }
            }
        }
        if !all.is_empty() {
            view.body.ranks().sum("probes", &mut all);
        }
        numbers.extend(all.into_iter().map(Real));
    }

    fn at_probe(
        &self,
        (index, node): (usize, usize),
        quantity: ProbeQuantity,
        body: &Body,
        motion: &OutputMotion<'_>,
    ) -> Vec<f64> {
        let of_node = |name: FieldName| motion.vectors(name)[3 * node..3 * node + 3].to_vec();
        match quantity {
            ProbeQuantity::Position => {
                let moved = of_node(FieldName::Displacement);
                body.mesh().points()[node].iter().zip(moved).map(|(at, u)| at + u).collect()
            }
            ProbeQuantity::Field(name) if name.is_of_motion() => of_node(name),
            ProbeQuantity::Field(name) => match (&self.fields, self.selections.get(index)) {
                (Some(fields), Some(Some(selection))) => fields.on(selection, motion.of(name), name),
                _ => vec![f64::NAN; name.components().len()],
            },
        }
    }

    /// The largest values at a state.
    fn extremes(&self, View { body, state, .. }: View<'_>, motion: &OutputMotion<'_>) -> Vec<Extreme> {
        let (of_motion, others): (Vec<FieldName>, Vec<FieldName>) =
            self.quantities.extremes.iter().partition(|name| name.is_of_motion());
        let whole = (body.mesh(), &**body.ranks());
        let of = |&name: &FieldName| {
            Extreme::of(whole, state, name, 0..body.mesh().n_nodes(), &motion.vectors(name))
        };
        let mut all: Vec<Extreme> = of_motion.iter().filter_map(of).collect();
        if let (Some(fields), Some(regions)) = (&self.fields, &self.regions) {
            all.extend(regions.extremes(body, fields, state, &others));
        }
        all
    }
}

/// Whether a quantity needs more than the motion.
fn needs_fields(quantities: &Quantities) -> bool {
    let of_probes = quantities.probes.iter().flat_map(Probe::fields);
    let mut all = of_probes.chain(quantities.extremes.iter().copied());
    !quantities.values.is_empty() || all.any(|name| !name.is_of_motion())
}

/// The members of a value that count on this rank, with their weights. Fields at the nodes of a group of cells come
/// from these cells alone; for a largest value each region has its own members, so that no value is a mean of two
/// materials.
fn members(body: &Body, fields: &Fields, value: &GroupValue) -> (Vec<Selection>, Vec<f64>) {
    let mesh = body.mesh();
    let ranks = body.ranks();
    let all_cells = || (0..mesh.n_cells() as u32).collect();
    let of_group = value.group.as_deref().and_then(|group| mesh.groups().cells(group).ok());
    if value.quantity.place() == Place::Cells {
        let mut cells = of_group.map_or_else(all_cells, <[u32]>::to_vec);
        cells.retain(|&cell| counts(ranks, true, cell as usize));
        let volumes = cells.iter().map(|&cell| fields.volume_for(value.quantity, cell as usize)).collect();
        return (vec![fields.select_cells(&cells)], volumes);
    }
    let all_nodes = || (0..mesh.n_nodes() as u32).collect();
    let nodes = value.group.as_ref().and_then(|group| mesh.volume_nodes(group).ok());
    let mut nodes: Vec<u32> = nodes.unwrap_or_else(all_nodes);
    nodes.retain(|&node| counts(ranks, false, node as usize));
    let is_max = value.measure == Measure::Max;
    if value.quantity.is_of_motion() || of_group.is_none() && !is_max {
        return (vec![fields.select_nodes(&nodes)], vec![1.0; nodes.len()]);
    }
    let cells: Vec<u32> = of_group.map_or_else(all_cells, <[u32]>::to_vec);
    let parts = if is_max { by_region(body, &cells) } else { vec![cells] };
    let part = |cells: Vec<u32>| {
        let mut own = nodes_of(mesh, &cells);
        own.retain(|node| nodes.binary_search(node).is_ok());
        fields.select_nodes_in(&own, cells)
    };
    let selections: Vec<Selection> = parts.into_iter().map(part).collect();
    let n_members = selections.iter().map(|selection| selection.members().len()).sum();
    (selections, vec![1.0; n_members])
}

/// The numbers of a value; `all: [n_members][n]`, `whole`: sum of the weights and number of members, over all ranks. A
/// total or a mean of all ranks is the sum of theirs.
fn measured(all: &[f64], n: usize, (weights, whole): (&[f64], [f64; 2]), measure: Measure) -> Vec<f64> {
    let members = || all.chunks_exact(n);
    let sum = |weight: &dyn Fn(usize) -> f64| {
        let of =
            |component: usize| members().enumerate().map(|(i, own)| weight(i) * own[component]).sum::<f64>();
        (0..n).map(of).collect::<Vec<f64>>()
    };
    let [weight, n_members] = whole;
    match measure {
        Measure::Total => sum(&|member| weights[member]),
        Measure::Mean if weight > 0.0 => sum(&|member| weights[member] / weight),
        // Springs have no volume.
        Measure::Mean => sum(&|_| 1.0 / n_members),
        Measure::Max => vec![members().map(size).filter(|size| !size.is_nan()).fold(f64::NAN, f64::max)],
    }
}

/// Replaces numbers by the largest of all ranks; NaN is left out, unless every rank has it.
fn largest_number(subdomain: &Subdomain, numbers: &mut [f64]) {
    numbers.iter_mut().filter(|number| number.is_nan()).for_each(|number| *number = f64::NEG_INFINITY);
    subdomain.largest("largest value of a group", numbers);
    numbers.iter_mut().filter(|number| **number == f64::NEG_INFINITY).for_each(|number| *number = f64::NAN);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn totals_means_and_largest_values() {
        // Two members of two components, volumes 1 and 3.
        let all = [2.0, 0.0, 6.0, 8.0];
        assert_eq!(measured(&all, 2, (&[1.0, 3.0], [4.0, 2.0]), Measure::Total), [20.0, 24.0]);
        assert_eq!(measured(&all, 2, (&[1.0, 3.0], [4.0, 2.0]), Measure::Mean), [5.0, 6.0]);
        assert_eq!(measured(&all, 2, (&[0.0, 0.0], [0.0, 2.0]), Measure::Mean), [4.0, 4.0]);
        assert_eq!(measured(&all, 2, (&[1.0, 3.0], [4.0, 2.0]), Measure::Max), [10.0]);
        assert_eq!(measured(&[f64::NAN, -3.0, -5.0], 1, (&[1.0; 3], [3.0, 3.0]), Measure::Max), [-3.0]);
    }
}
