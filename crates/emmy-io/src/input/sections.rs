//! The sections of an input, read and put together.

use std::cell::{Cell, RefCell};
use std::path::Path;
use std::sync::Arc;

use emmy::body::{BodyBuilder, Contact, InitialVelocity, Load, Region, Support};
use emmy::mesh::Mesh;
use emmy::motion::{NewtonSettings, Solver, StepPlan};
use emmy::time::Scheme;

use super::catalogue::ROOT_KIND;
use super::contact::{self, PlacedContact};
use super::context::Context;
use super::expect::{self, Expected};
use super::fault::{Fault, Faults, InputError};
use super::formulation::Formulations;
use super::mechanism::Mechanism;
use super::names::Naming;
use super::nodal::PlacedNodal;
use super::placed::NamedGroup;
use super::placed::{Members, Placed};
use super::problem::{Overrides, Problem};
use super::quantities::Requested;
use super::root::Root;
use super::settings::{Limits, Output};
use super::shape::Shape;
use super::source::{CheckedMesh, Source};
use super::start::Start;
use super::table::Item;
use super::tie::PlacedTie;
use super::time::Time;
use super::tree::{Node, Value};
use super::{
    coupling, deck, derived, equilibrium, groups, initial, joint, load, nodal, placed, plane_strain,
    plausible, quantities, region, rigid, settings, shape, start, support, tie, time, units, walk,
};
use crate::accuracy;
use crate::mesh::MeshFile;
use crate::message::shown;
use crate::units::Units;

/// Data read from the tree before the mesh is made.
pub(super) struct Sections {
    title: Option<String>,
    units: Units,
    pub(super) shape: Shape,
    regions: Vec<Placed<Region>>,
    loads: Vec<Placed<(Load, Members)>>,
    supports: Vec<Placed<Support>>,
    ties: Vec<PlacedTie>,
    contacts: Vec<PlacedContact>,
    mechanism: Mechanism,
    nodal: PlacedNodal,
    initial: Vec<Placed<InitialVelocity>>,
    pub(super) start: Start,
    pub(super) time: Time,
    newton: NewtonSettings,
    pub(super) output: Output,
    requested: Requested,
    limits: Limits,
    expected: Option<Expected>,
    /// Notes on histories.
    pub(super) notes: Vec<String>,
    /// Groups of the regions of links: lines of a mesh file that are cells.
    link_groups: Vec<String>,
    /// The mesh of a file, if it was read before.
    pub(super) mesh_file: Cell<Option<MeshFile>>,
}

impl Sections {
    /// `faults`: those of values that were computed before.
    pub(super) fn read(
        tree: &Node,
        directory: &Path,
        overrides: &Overrides,
        mut faults: Faults,
    ) -> Result<Sections, InputError> {
        let Some(table) = walk::root(Item::of("input", tree, &ROOT_KIND), &mut faults) else {
            return Err(faults.error());
        };
        let mut root = Root { table, faults };
        let title = table.item("title").filter(|item| walk::is_right(*item, &mut root.faults));
        let title = title.map(|title| title.text().unwrap_or_default().to_string());
        let units = root.one("units", |table, _| Some(units::read(table))).unwrap_or_default();
        let shape = match table.item("mesh").map(|item| (item.value(), item.place())) {
            Some((Value::Mesh(mesh), place)) => Some(shape::given(mesh, place)),
            None if table.item("rigid").is_some() && table.item("region").is_none() => {
                root.raw("rigid").next().map(|rigid| shape::without_cells(rigid.place))
            }
            _ => root.one("mesh", |table, faults| faults.keep(shape::read(table, directory))),
        };
        let regions = root.each("region", region::read);
        let link_groups = root.link_groups();
        let (start, initial) = read_start(&mut root, directory);
        let time = read_time(&mut root, start.as_ref(), overrides);
        let run = time.as_ref().map(|time| [time.plan.start(), time.plan.end()]);
        let notes = RefCell::default();
        let is_undeformed = start == Some(Start::Undeformed);
        let context = Context { directory, units, run, is_undeformed, notes: &notes };
        let load::Sorted { loads, attractions, drags } =
            root.each("load", |table, faults| load::read(table, context, faults)).into_iter().collect();
        let motion = table.item("time").filter(|_| !overrides.is_of_body);
        load::check_observers(&loads, motion.map(|time| time.key_place), &mut root.faults);
        let held = root.each("support", |table, faults| Some(support::read(table, context, faults)));
        let (supports, springs): (Vec<_>, Vec<_>) =
            held.into_iter().map(|held| (held.support, held.spring)).unzip();
        let supports: Vec<Placed<Support>> = supports.into_iter().flatten().collect();
        let springs = springs.into_iter().flatten().collect();
        let ties = root.each("tie", |table, faults| faults.keep(tie::read(table)));
        let contacts = root.each("contact", |table, faults| {
            let own = contact::read(table, context, faults);
            faults.keep(own)
        });
        let rigid = root.each("rigid", |table, faults| faults.keep(rigid::read(table)));
        let joints = root.tables("joint").into_iter().zip(1..);
        let joints =
            joints.filter_map(|(table, number)| joint::read(&table, number, context, &mut root.faults));
        let joints = joints.collect();
        let mut mechanism = Mechanism { rigid, couplings: Vec::new(), joints };
        for own in root.each("coupling", |table, faults| faults.keep(coupling::read(table))) {
            match own {
                coupling::Read::Rigid(own) => mechanism.rigid.push(own),
                coupling::Read::Distributing(own) => mechanism.couplings.push(own),
            }
        }
        let masses = read_masses(&mut root, &mut mechanism);
        let nodal = PlacedNodal { masses, springs, attractions, drags };
        let start = start.map(|start| if table.item("time").is_some() { start } else { Start::Undeformed });
        let newton = root.one("newton", |table, _| Some(settings::newton(table))).unwrap_or_default();
        let solver = root.one("solver", |table, _| Some(settings::solver(table))).unwrap_or(Solver::Auto);
        let limits = root.one("limits", |table, _| Some(settings::limits(table))).unwrap_or_default();
        let expected = root.one("expect", |table, _| Some(expect::read(table)));
        let plan = time.as_ref().map(|time| match time.scheme {
            // The load fraction is no time.
            Scheme::Static => time.plan.clone(),
            // Steps end where supports and joints are released.
            _ => {
                let joints = mechanism.joints.iter().filter_map(|joint| joint.until);
                support::releases(&supports).chain(joints).fold(time.plan.clone(), StepPlan::with_end_at)
            }
        });
        let supported = root.supported_groups();
        let output = root.one("output", |table, faults| {
            let (output, requested) = (faults.keep(settings::output(table)), quantities::read(table, faults));
            supported.iter().for_each(|groups| requested.check_reactions(groups, faults));
            requested.check_joints(&mechanism.names_of_joints(), faults);
            let place = table.item("interval").map_or(table.place, |item| item.place());
            let plan = plan.clone().zip(output.as_ref());
            let plan = plan.map(|(plan, output)| settings::plan_with_frames(plan, output, place));
            Some((output, requested, plan.and_then(|plan| faults.keep(plan))))
        });
        let requested = output.as_ref().map(|(_, requested, _)| requested);
        let naming = Naming {
            regions: &regions,
            loads: &loads,
            supports: &supports,
            ties: &ties,
            contacts: &contacts,
            mechanism: &mechanism,
            initial: &initial,
            nodal: &nodal,
            requested,
        };
        let named = naming.groups();
        mechanism.check_names(requested.into_iter().flat_map(Requested::names), &mut root.faults);
        let bodies = root.rigid_bodies();
        let Root { mut faults, .. } = root;
        match (shape, start, time, output) {
            (Some(shape), Some(start), Some(time), Some((Some(output), requested, Some(plan))))
                if faults.len() == 0 =>
            {
                Ok(Sections {
                    title,
                    units,
                    shape,
                    time: Time { plan, ..time },
                    newton: NewtonSettings { solver, ..newton },
                    output,
                    requested,
                    limits,
                    expected,
                    notes: notes.take(),
                    start,
                    regions,
                    loads,
                    supports,
                    ties,
                    contacts,
                    mechanism,
                    nodal,
                    initial,
                    link_groups,
                    mesh_file: Cell::default(),
                })
            }
            (shape, ..) => {
                // Further faults: the groups, if the mesh can be made despite faults elsewhere.
                let mesh = shape.and_then(|shape| faults.keep(shape.mesh(&link_groups)));
                if let (Some(file), Some(bodies)) = (mesh, bodies) {
                    let bodies: Vec<&str> = bodies.iter().map(String::as_str).collect();
                    groups::check(&file.mesh, &named, &bodies, &mut faults);
                }
                Err(faults.error())
            }
        }
    }

    /// The groups that the input names.
    fn named_groups(&self) -> Vec<NamedGroup> {
        let Sections { regions, loads, supports, ties, contacts, mechanism, initial, nodal, .. } = self;
        let requested = Some(&self.requested);
        Naming { regions, loads, supports, ties, contacts, mechanism, initial, nodal, requested }.groups()
    }

    /// Checks that the mesh has the groups and cells that the input names.
    fn check_mesh(&self, mesh: &Mesh) -> Result<Formulations, InputError> {
        let mut faults = Faults::default();
        groups::check(mesh, &self.named_groups(), &self.mechanism.bodies(), &mut faults);
        self.mechanism.check(mesh, &mut faults);
        self.mechanism.check_moments(&self.loads, mesh, &mut faults);
        faults.finish()?;
        let cells = groups::check_regions(mesh, &self.regions);
        let formulations = cells.and_then(|()| Formulations::new(mesh, &self.regions, &self.time));
        let formulations = faults.keep(formulations);
        faults.keep(support::check_together(mesh, &self.supports, &self.time));
        faults.keep(contact::check_scheme(&self.contacts, &self.time));
        faults.finish()?;
        Ok(formulations.unwrap_or_default())
    }

    /// The mesh with every group found.
    fn checked_mesh(&self) -> Result<CheckedMesh, InputError> {
        let mut faults = Faults::default();
        let mut file = match self.mesh_file.take() {
            Some(file) => file,
            None => {
                let file = self.shape.mesh(&self.link_groups)?;
                deck::check_unused(&self.shape, &file)?;
                file
            }
        };
        deck::check_left_out(&self.shape, &file, &mut faults);
        faults.finish()?;
        let formulations = self.check_mesh(&file.mesh).map_err(|error| error.with_notes(&file.notes))?;
        if !(self.ties.is_empty() && self.mechanism.joints.is_empty()) {
            let (is_tied, joined) = (tie::joins(&file.mesh, &self.ties), self.mechanism.joined(&file.mesh));
            file.leave_out_joined(|[a, b]| is_tied([a, b]) || joined.contains(&[a.min(b), a.max(b)]));
        }
        let mesh = &file.mesh;
        let regions: Vec<&Region> = self.regions.iter().map(|region| &region.value).collect();
        let loads = || self.loads.iter().map(|load| &load.value.0);
        file.notes.extend(plausible::note_on_size(mesh, self.units));
        file.notes.extend(plausible::notes_on_loads(mesh, loads(), &regions, self.units));
        let initial = self.initial.iter().map(|own| &own.value);
        file.notes.extend(plane_strain::notes(mesh, loads(), initial));
        let Sections { loads, supports, ties, initial, nodal, .. } = self;
        file.notes.extend(groups::notes(mesh, loads, supports, ties, &self.mechanism, initial, nodal));
        Ok(CheckedMesh { file, formulations })
    }

    /// The mesh alone for several ranks, with remarks on it.
    pub(super) fn mesh(&self) -> Result<MeshFile, InputError> {
        self.mechanism.check_alone()?;
        let of_contacts = self.contacts.first().map(PlacedContact::not_on_ranks);
        match self.ties.first().map(PlacedTie::not_on_ranks).or(of_contacts) {
            Some(fault) => Err(fault.into()),
            None => Ok(self.checked_mesh()?.file),
        }
    }

    /// The problem, once the mesh is made.
    pub(super) fn problem(self, resolved: String, source: Source<'_>) -> Result<Problem, InputError> {
        if !matches!(source, Source::Alone(_)) {
            self.mechanism.check_alone()?;
        }
        self.mechanism.check_scheme(&self.time)?;
        let (mesh, digest) = source.mesh(&resolved, || self.checked_mesh())?;
        let (mesh, mut notes, files, formulations) = match mesh {
            Some(CheckedMesh { file, formulations }) => {
                (Some(file.mesh), file.notes, file.files, formulations)
            }
            None => Default::default(),
        };
        self.nodal.check_damping(&self.regions, &self.time)?;
        let mechanism = &self.mechanism;
        let places = derived::Places::new(&self.regions, &self.loads, &self.initial, &self.nodal, mechanism);
        let is_moved =
            derived::is_moved(&self.regions, &self.loads, &self.supports, &self.initial, mechanism)
                || self.contacts.iter().any(|own| own.contact.moves());
        let (rigid, couplings) = (mechanism.rigid_bodies(), mechanism.couplings());
        let joints = mesh.as_ref().map(|mesh| mechanism.joints(mesh)).transpose()?.unwrap_or_default();
        notes.extend(self.regions.iter().filter_map(|region| plausible::note(&region.value, self.units)));
        let pulls = derived::pulls(&self.regions);
        let held = placed::groups(self.supports.iter().map(|support| &support.group));
        let pressed = placed::groups(self.loads.iter().map(|load| &load.group));
        let supports = values(self.supports);
        let (ties, tied): (Vec<_>, Vec<_>) = self.ties.into_iter().map(PlacedTie::into_parts).unzip();
        let contact_places = contact::places(&self.contacts);
        let contacts: Vec<Contact> = self.contacts.into_iter().map(|own| own.contact).collect();
        let loads: Vec<Load> =
            values(self.loads).into_iter().map(|(load, _)| mechanism.at_centre(load)).collect();
        let drag = self.nodal.drag();
        let spread = placed::groups(self.nodal.spread());
        let nodal = self.nodal.values();
        let is_static = self.time.scheme == Scheme::Static;
        let mesh_in_memory = self.shape.given().cloned();
        let is_same = |known: &&Problem| {
            let mesh = known.mesh_in_memory.as_ref().zip(mesh_in_memory.as_ref());
            mesh.is_some_and(|(known, own)| Arc::ptr_eq(known, own))
                && !is_static
                && !known.is_static()
                // A function of time has no text that tells it from others.
                && !contacts.iter().any(Contact::moves)
                && (&known.supports, &known.loads, &known.nodal) == (&supports, &loads, &nodal)
                && (&known.rigid, &known.couplings, &known.joints) == (&rigid, &couplings, &joints)
                && known.body.drag() == drag
                && body_of(&resolved).is_some_and(|own| body_of(&known.resolved) == Some(own))
        };
        let body = match source.known().filter(is_same) {
            Some(known) => known.body.clone(),
            None => {
                let builder = rigid.iter().cloned().fold(source.builder(mesh)?, BodyBuilder::rigid);
                let builder = couplings.iter().cloned().fold(builder, BodyBuilder::coupling);
                let builder = joints.iter().cloned().fold(builder, BodyBuilder::joint);
                let body = builder
                    .regions(values(self.regions))
                    .point_terms(nodal.clone())
                    .supports(&supports)
                    .ties(ties)
                    .contacts(&contacts)
                    .loads(&loads)
                    .drag(drag)
                    .build();
                let fault = |error| {
                    let own = support::fault(&error, &held).or_else(|| nodal::fault(&error, &spread));
                    let own = own.or_else(|| load::fault(&error, &pressed));
                    let own = own.or_else(|| tie::fault(&error, &tied));
                    let own = own.or_else(|| contact::fault(&error, &contact_places));
                    let own = own.or_else(|| mechanism.fault(&error));
                    own.unwrap_or_else(|| self.shape.fault(&error))
                };
                body.map_err(fault)?
            }
        };
        if let Some(expected) = &self.expected {
            let mut faults = Faults::default();
            expected.check(&body, self.units, &mut faults);
            faults.finish()?;
        }
        notes.extend(tie::notes(&body, self.units));
        let is_equilibrium = is_static || matches!(self.start, Start::Equilibrium { .. });
        let starts_as_drawn = !is_equilibrium && !matches!(self.start, Start::Run(_));
        notes.extend(contact::notes(&body, starts_as_drawn, self.units));
        time::check_scale(&body, &self.time)?;
        if self.output.has_frames() {
            self.output.format.check(&body).map_err(|error| Fault::new(error.to_string()))?;
        }
        mechanism.check_drives(&body)?;
        notes.extend(super::mechanism::note_on_forces(&body));
        let quantities = self.requested.quantities(&body, |name| mechanism.place(name), &mut notes)?;
        let initial = values(self.initial);
        notes.extend(tie::notes_on_start(&body, &initial));
        // The velocities of another run obey its joints.
        if !matches!(self.start, Start::Run(_)) {
            notes.extend(super::mechanism::note_on_start(
                &body,
                &initial,
                self.time.plan.start(),
                self.units,
            ));
        }
        source.agree(places.check(&body, &loads, &initial, &self.time.plan).map_err(InputError::from))?;
        let pushes = body.contacts().any(|contact| contact.energy > 0.0);
        let is_moved = is_moved || pushes || !nodal.attractions.is_empty();
        if !is_moved && !matches!(self.start, Start::Run(_)) {
            notes.push(derived::NOTHING_MOVES.to_string());
        }
        let pulls = pulls || pushes;
        if is_equilibrium && !pulls && nodal.attractions.is_empty() && !body.is_loaded_at(0.0) {
            notes.push(derived::UNLOADED.to_string());
        }
        if !is_static {
            notes.extend(derived::of_tables(&loads, &supports, &joints, &self.time.plan));
            notes.extend(accuracy::long_step(&self.time.plan, self.units));
        }
        let body = if is_static { body.in_proportion(0.0) } else { body };
        Ok(Problem {
            title: self.title,
            units: self.units,
            body,
            mesh_in_memory,
            supports,
            nodal,
            rigid,
            couplings,
            joints,
            loads,
            initial,
            start: self.start,
            scheme: self.time.scheme,
            plan: self.time.plan,
            smallest_step: self.time.smallest_step,
            newton: self.newton,
            output: self.output,
            quantities,
            limits: self.limits,
            formulations,
            notes: notes.iter().map(|note| shown(note).into_owned()).collect(),
            files,
            resolved,
            digest,
        })
    }
}

/// The state from which the motion starts, unless it has a fault, and the velocities there.
fn read_start(root: &mut Root<'_>, directory: &Path) -> (Option<Start>, Vec<Placed<InitialVelocity>>) {
    let equilibrium = root.table.item("equilibrium").map(|item| item.key_place);
    let names_state = root.raw("initial").any(|table| table.item("state").is_some());
    let tables = root.tables("initial");
    let state = root.faults.keep(start::read(&tables, equilibrium, directory)).flatten();
    let load_steps = root.one("equilibrium", |table, _| Some(table.must("load_steps")));
    let is_meant = !root.faults.are_many()
        && walk::meant(&root.table).any(|key| ["equilibrium", "initial"].contains(&key));
    let start = match equilibrium {
        _ if is_meant => None,
        _ if names_state => state.map(Start::Run),
        Some(_) => load_steps.map(|load_steps| Start::Equilibrium { load_steps }),
        None => Some(Start::Undeformed),
    };
    (start, tables.iter().filter(|_| !names_state).map(initial::read).collect())
}

/// The masses at nodes; those that are coupled go to the mechanism.
fn read_masses(root: &mut Root<'_>, mechanism: &mut Mechanism) -> Vec<Placed<nodal::Mass>> {
    let mut masses = Vec::new();
    for (table, number) in root.tables("mass").into_iter().zip(1..) {
        match root.faults.keep(nodal::read(&table, number)) {
            Some(nodal::Read::AtNodes(mass)) => masses.push(mass),
            Some(nodal::Read::Rigid(own)) => mechanism.rigid.push(own),
            Some(nodal::Read::Distributing(own, mass)) => {
                mechanism.couplings.push(own);
                masses.push(mass);
            }
            Some(nodal::Read::OfBody { name, mass, inertia, place }) => {
                root.faults.keep(mechanism.add_mass(&name, (mass, inertia), &place));
            }
            None => {}
        }
    }
    masses
}

/// Scheme and plan; an equilibrium without `[time]` is a static analysis.
fn read_time(root: &mut Root<'_>, start: Option<&Start>, overrides: &Overrides) -> Option<Time> {
    if root.table.item("time").is_some() {
        return root
            .one("time", |table, faults| faults.keep(time::read(table, overrides.until, overrides.step)));
    }
    let Some(&Start::Equilibrium { load_steps }) = start else { return None };
    let time = match (root.table.item("initial"), overrides.until, overrides.step) {
        (Some(initial), ..) => {
            let message = "a static analysis has no velocities: without `[time]` the body does not move";
            let fault = Fault::at(initial.key_place, message, "velocities");
            Err(fault.help("give `[time]`, or remove `[initial]`"))
        }
        (None, Some(_), _) => Err(equilibrium::no_time("--until")),
        (None, None, Some(_)) => Err(equilibrium::no_time("--step")),
        (None, None, None) => equilibrium::analysis(load_steps),
    };
    root.faults.keep(time)
}

/// The sections of a resolved input that describe the body, but for its mesh. Functions of a program have their names
/// there: loads and supports themselves tell them apart.
fn body_of(resolved: &str) -> Option<[Option<toml::Value>; 9]> {
    let mut table = resolved.parse::<toml::Table>().ok()?;
    let sections = ["region", "mass", "load", "support", "tie", "contact", "rigid", "coupling", "joint"];
    Some(sections.map(|section| table.remove(section)))
}

fn values<T>(placed: Vec<Placed<T>>) -> Vec<T> {
    placed.into_iter().map(|placed| placed.value).collect()
}
