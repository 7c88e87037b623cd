//! The quantities of a body: groups, nodes and columns that they name.

use emmy::body::{Body, FieldName, Fields, Place as Members};
use emmy::internals::number::{short, short_vector};
use emmy::motion::ReferenceMotion;

use super::{
    GROUND, GroupValue, Measure, Probe, Quantities, Requested, reaction_columns, relation, value_columns,
};
use crate::history::{ColumnInfo, MechanismColumns, column_of_peak, fixed_names, nodes_of};
use crate::input::fault::{Fault, Faults, InputError, Place};
use crate::input::groups;
use crate::input::placed::Members as MemberKind;
use crate::input::suggest::{did_you_mean, listed};

impl Requested {
    /// The quantities of a body, with notes on probes whose node is not at the requested point; `place` finds the name
    /// of a joint or a rigid body. On a team a call of all ranks, with the same outcome.
    pub(in crate::input) fn quantities(
        mut self,
        body: &Body,
        place: impl Fn(&str) -> Option<Place>,
        notes: &mut Vec<String>,
    ) -> Result<Quantities, InputError> {
        let mut faults = Faults::default();
        for (probe, place) in &mut self.probes {
            if faults.keep(check_group(body, probe, place)).is_some() {
                find(body, probe, notes);
                notes.extend(sides(body, probe));
            }
        }
        for (value, place) in &mut self.values {
            faults.keep(resolve(body, value, place));
        }
        self.check_fields(body, &mut faults);
        let references = self.references(body, &mut faults);
        let supported: Vec<String> = body.supported_groups().map(str::to_string).collect();
        faults.finish()?;
        let reactions = self.reactions(supported);
        let joints =
            self.joints.as_ref().map(|all| all.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>());
        let mechanism = MechanismColumns::of(body, joints.as_deref(), &relation(self.relative_to.as_deref()));
        self.check_columns(&reactions, &mechanism, place)?;
        Ok(Quantities {
            reactions,
            names_reactions: self.reactions.is_some(),
            mechanism,
            probes: values(self.probes),
            extremes: values(self.extremes),
            values: values(self.values),
            relative_to: self.relative_to,
            references,
        })
    }

    /// The motions of all frames of reference but that at rest.
    fn references(&self, body: &Body, faults: &mut Faults) -> Vec<(String, ReferenceMotion)> {
        let mut all: Vec<(String, ReferenceMotion)> = Vec::new();
        for (name, place) in &self.references {
            let motion = match name.as_str() {
                group if has_nodes(body, group) => ReferenceMotion::of_group(body, group),
                GROUND => continue,
                BASE => ReferenceMotion::of_base(body),
                RIGID_MOTION => Ok(ReferenceMotion::of_body()),
                unknown => {
                    let words = [GROUND, BASE, RIGID_MOTION];
                    let known: Vec<&str> = words.into_iter().chain(body.mesh().groups().names()).collect();
                    let label = did_you_mean(unknown, known.iter().copied()).unwrap_or("not there".into());
                    let fault =
                        Fault::at(place, format!("`relative_to`: there is no group `{unknown}`"), label);
                    faults.push(fault.help(format!("there are {}", listed(known.iter().copied()))));
                    continue;
                }
            };
            match motion {
                Ok(motion) if all.iter().all(|(own, _)| own != name) => all.push((name.clone(), motion)),
                Ok(_) => {}
                Err(error) => {
                    faults.push(Fault::at(place, format!("`relative_to`: {error}"), "not of this body"))
                }
            }
        }
        all
    }

    /// Groups whose reactions are asked for, with their places among those with supports.
    fn reactions(&self, supported: Vec<String>) -> Vec<(String, usize)> {
        let place = |group: &String| supported.iter().position(|name| name == group);
        match &self.reactions {
            None => supported.into_iter().enumerate().map(|(index, group)| (group, index)).collect(),
            Some(asked) => {
                asked.iter().filter_map(|(group, _)| Some((group.clone(), place(group)?))).collect()
            }
        }
    }

    /// Every field must be one of the body.
    fn check_fields(&self, body: &Body, faults: &mut Faults) {
        let of_probe = |(probe, place): &(Probe, Place)| {
            probe.fields().map(|field| (field, place.clone())).collect::<Vec<_>>()
        };
        let mut all: Vec<(FieldName, Place)> = self.probes.iter().flat_map(of_probe).collect();
        all.extend(self.extremes.iter().cloned());
        all.extend(self.values.iter().map(|(value, place)| (value.quantity, place.clone())));
        if all.is_empty() {
            return;
        }
        let fields = Fields::new(body);
        for (field, place) in all.into_iter().filter(|(field, _)| !fields.has(*field)) {
            let why = match field {
                FieldName::ContactPressure | FieldName::ContactGap => "it has no contact",
                _ => "none of its cells has such a quantity",
            };
            let message = format!("the body has no field `{field}`: {why}");
            faults.push(Fault::at(&place, message, "not of this body"));
        }
    }

    /// No two columns may have the same name, and none that of a peak of another one.
    fn check_columns(
        &self,
        reactions: &[(String, usize)],
        mechanism: &MechanismColumns,
        place: impl Fn(&str) -> Option<Place>,
    ) -> Result<(), Fault> {
        let mut taken: Vec<String> = fixed_names().map(str::to_string).collect();
        let names =
            |columns: Vec<ColumnInfo>| columns.into_iter().map(|column| column.name).collect::<Vec<_>>();
        taken.extend(reactions.iter().flat_map(|(group, _)| names(reaction_columns(group))));
        for (owner, ColumnInfo { name, .. }) in mechanism.owned() {
            if let (Some(owner), true) = (owner, taken.contains(&name)) {
                let message = format!("`{owner}` would have a column `{name}`, which is there already");
                let fault = match place(owner) {
                    Some(place) => Fault::at(&place, message, "taken"),
                    None => Fault::new(message),
                };
                return Err(fault.help("give this joint or rigid body another name"));
            }
            taken.push(name);
        }
        taken.extend(self.extremes.iter().map(|(field, _)| format!("max_{field}")));
        let probes = self.probes.iter().map(|(probe, place)| (names(probe.columns(None)), place));
        let values = self.values.iter().map(|(value, place)| (names(value_columns(value)), place));
        let named: Vec<(Vec<String>, &Place)> = probes.chain(values).collect();
        for (columns, place) in &named {
            if let Some(column) = columns.iter().find(|column| taken.contains(column)) {
                return Err(Fault::at(place, format!("there is a column `{column}` already"), "taken"));
            }
            taken.extend(columns.iter().cloned());
        }
        let is_asked = |name: &str| taken[fixed_names().count()..].iter().any(|own| own == name);
        for (columns, place) in &named {
            let peak = |own: &String| {
                Some((own.clone(), column_of_peak(own).filter(|of| is_asked(of))?.to_string()))
            };
            if let Some((column, of)) = columns.iter().find_map(peak) {
                let message = format!("`{column}` is also the name of a peak of `{of}` over the run");
                let help =
                    "summaries and sweeps have X_min, X_min_time, X_max and X_max_time of each column X";
                return Err(Fault::at(place, message, "give it another name").help(help));
            }
        }
        Ok(())
    }
}

fn values<T>(placed: Vec<(T, Place)>) -> Vec<T> {
    placed.into_iter().map(|(value, _)| value).collect()
}

/// Takes the field in cells in a group of cells, and checks that the group has members for the field.
fn resolve(body: &Body, value: &mut GroupValue, place: &Place) -> Result<(), Fault> {
    let groups = body.mesh().groups();
    let has_cells = match &value.group {
        None => true,
        Some(group) => match has_nodes(body, group) {
            true => groups.cells(group).is_ok(),
            false => {
                let known = groups.names();
                let near = groups::near(body.mesh(), group, MemberKind::Nodes);
                let label = near.unwrap_or("not there".into());
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

/// Names of references that are no groups.
const BASE: &str = "base";
const RIGID_MOTION: &str = "rigid-motion";

/// Distance between a probe's point and its node, relative to the size of the mesh, above which there is a remark.
const FAR: f64 = 1e-6;

/// Whether any rank has a node of a group.
fn has_nodes(body: &Body, group: &str) -> bool {
    let mut n_nodes = [body.mesh().group_nodes(group).map_or(0, |nodes| nodes.len()) as f64];
    body.ranks().largest("nodes of a group", &mut n_nodes);
    n_nodes[0] > 0.0
}

/// The group of a probe must have cells.
fn check_group(body: &Body, probe: &Probe, place: &Place) -> Result<(), Fault> {
    let Some(group) = &probe.group else { return Ok(()) };
    let mut n_cells = [body.mesh().groups().cells(group).map_or(0, |cells| cells.len()) as f64];
    body.ranks().largest("cells of a group", &mut n_cells);
    if n_cells[0] > 0.0 {
        return Ok(());
    }
    let known: Vec<&str> = body.mesh().groups().cells.keys().map(String::as_str).collect();
    let label = groups::near(body.mesh(), group, MemberKind::Cells).unwrap_or("not there".into());
    let message = format!("the mesh has no group of cells `{group}` for the probe `{}`", probe.name);
    Err(Fault::at(place, message, label).help(format!("groups of cells: {}", listed(known.iter().copied()))))
}

/// A note on a probe whose fields are means of several regions.
fn sides(body: &Body, probe: &Probe) -> Option<String> {
    let of_contact = [FieldName::ContactPressure, FieldName::ContactGap];
    let jumps = |field: FieldName| !field.is_of_motion() && !of_contact.contains(&field);
    let mut fields = probe.fields().filter(|field| jumps(*field));
    let field = fields.next().filter(|_| probe.group.is_none())?;
    let regions = body.regions();
    let mut touches = vec![0.0; regions.len()];
    if let Some(node) = body.ranks().own_node(probe.node) {
        let cells = body.mesh().cells().zip(body.region_of_cell());
        let around = cells.filter(|(cell, _)| cell.nodes.contains(&(node as u32)));
        let solid = around.filter(|(cell, _)| cell.kind.dimension() > 1);
        solid.for_each(|(_, &region)| touches[region as usize] = 1.0);
    }
    body.ranks().sum("regions at a probe", &mut touches);
    let sides = regions.iter().zip(&touches).filter(|(_, touches)| **touches > 0.0);
    let sides: Vec<&str> = sides.filter_map(|(region, _)| region.group.as_deref()).collect();
    (sides.len() > 1).then(|| {
        format!(
            "probe `{}`: {} meet at node {}, so `{field}` is a mean by volume; `group` chooses one side",
            probe.name,
            listed(sides.iter().copied()),
            probe.node
        )
    })
}

/// Finds the node of a probe, with a note if it is not at the requested point.
fn find(body: &Body, probe: &mut Probe, notes: &mut Vec<String>) {
    let (node, at) = nearest_node(body, probe.point, probe.group.as_deref());
    probe.node = node;
    let distance = square(at, probe.point).sqrt();
    if distance > FAR * body.mesh().diagonal() {
        notes.push(format!(
            "probe `{}`: the nearest node, {}, is {} away, at {}",
            probe.name,
            probe.node,
            short(distance),
            short_vector(at)
        ));
    }
}

/// The nearest node of the whole mesh or of a group of cells, the first of several, and its position.
fn nearest_node(body: &Body, point: [f64; 3], group: Option<&str>) -> (usize, [f64; 3]) {
    let points = body.mesh().points();
    let ranks = body.ranks();
    let nodes: Vec<u32> = match group.map(|group| body.mesh().groups().cells(group)) {
        None => (0..points.len() as u32).collect(),
        Some(cells) => nodes_of(body.mesh(), cells.unwrap_or_default()),
    };
    let nodes = nodes.into_iter().map(|node| node as usize).filter(|&node| node < ranks.n_own());
    let own = nodes.map(|node| (node, square(points[node], point)));
    let own = own.min_by(|a, b| a.1.total_cmp(&b.1));
    let mut nearest = [own.map_or(f64::NEG_INFINITY, |(_, square)| -square)];
    ranks.largest("distance of the nearest node", &mut nearest);
    let own = own.filter(|(_, square)| -square == nearest[0]);
    let whole = own.map(|(node, _)| ranks.nodes()[node] as usize);
    let node = ranks.lowest("nearest node", whole).unwrap_or(0);
    let mut at = ranks.own_node(node).map_or([0.0; 3], |node| points[node]);
    ranks.sum("position of the nearest node", &mut at);
    (node, at)
}

/// Square of the distance of two points.
fn square(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use emmy::body::{Region, Support};
    use emmy::material::NeoHooke;
    use emmy::mesh::{Share, block, owners};
    use emmy::team::{Team, Threads};

    use super::super::ProbeQuantity;
    use super::*;

    /// A probe at a node, one amid eight nodes, and values of a group.
    fn requested(group: &str) -> Requested {
        let place = || Place::start_of("a test", "");
        let probe = |name: &str, point| {
            (
                Probe {
                    name: name.to_string(),
                    point,
                    group: None,
                    node: 0,
                    quantities: vec![ProbeQuantity::Position],
                    relative_to: None,
                },
                place(),
            )
        };
        let value = |name: &str, group: &str, measure| {
            let (name, group) = (name.to_string(), Some(group.to_string()));
            (GroupValue { name, group, quantity: FieldName::StrainEnergyDensity, measure }, place())
        };
        Requested {
            reactions: None,
            joints: None,
            probes: vec![probe("corner", [1.0, 2.0, 1.0]), probe("middle", [0.75, 1.25, 0.25])],
            extremes: vec![(FieldName::Velocity, place())],
            values: vec![value("energy", "body", Measure::Total), value("mean", group, Measure::Mean)],
            groups: Vec::new(),
            relative_to: None,
            references: Vec::new(),
        }
    }

    fn found(requested: Requested, body: &Body) -> Result<(Quantities, Vec<String>), String> {
        let mut notes = Vec::new();
        let quantities =
            requested.quantities(body, |_| None, &mut notes).map_err(|fault| format!("{fault:?}"))?;
        Ok((quantities, notes))
    }

    #[test]
    fn quantities_of_a_team_are_those_of_the_whole_body() {
        let mesh = block([1.0, 2.0, 1.0], [2, 4, 2]).unwrap();
        let rubber = || Region::new(NeoHooke::new(10.0, 5.0).unwrap(), 2.0);
        let support = Support::fixed("y-min");
        let whole = Body::builder(mesh.clone()).region(rubber()).support(support.clone()).build().unwrap();
        let (quantities, notes) = found(requested("x-max"), &whole).unwrap();
        assert_eq!(quantities.probes[0].node, mesh.n_nodes() - 1);
        assert_eq!(notes.len(), 1); // the nodes around the second probe lie elsewhere
        let is_in_cells = |index: usize| quantities.values[index].quantity.place() == Members::Cells;
        assert!(is_in_cells(0) && !is_in_cells(1));
        let owners = owners(&mesh, 3).unwrap();
        let of_ranks = |group: &str| {
            let rank = |team: Arc<dyn Team>| {
                let share = Share::new(&mesh, &owners, team.rank());
                let body = Body::shared(share, team).region(rubber()).support(support.clone());
                found(requested(group), &body.build().unwrap())
            };
            Threads::run(3, rank).unwrap()
        };
        // Only the ranks at x = 1 have nodes of this group.
        for own in of_ranks("x-max") {
            assert_eq!(own, Ok((quantities.clone(), notes.clone())));
        }
        let unknown = found(requested("x-mox"), &whole);
        assert!(unknown.as_ref().is_err_and(|fault| fault.contains("has no group `x-mox`")), "{unknown:?}");
        assert!(of_ranks("x-mox").iter().all(|own| *own == unknown));
    }
}
