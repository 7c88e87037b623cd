//! The sections of an input, read and put together.

use std::path::Path;
use std::sync::Arc;

use emmy::body::{InitialVelocity, Load, Region, Support};
use emmy::mesh::Mesh;
use emmy::motion::{NewtonSettings, Solver};
use emmy::time::Scheme;

use super::catalogue::ROOT;
use super::fault::{Fault, Faults, InputError};
use super::formulation::Formulations;
use super::history::Context;
use super::placed::{Members, Placed};
use super::problem::{Overrides, Problem};
use super::quantities::{self, Requested};
use super::settings::{self, Limits, Output};
use super::shape::{self, Shape};
use super::source::{CheckedMesh, Source};
use super::table::{Item, Table};
use super::tree::Node;
use super::{
    Start, derived, equilibrium, groups, histories, initial, load, nodal, plausible, region, start, support,
    time, units,
};
use crate::accuracy;
use crate::mesh::MeshFile;
use crate::message::shown;
use crate::units::Units;

/// Data read from the tree before the mesh is made.
pub(super) struct Parts {
    title: Option<String>,
    units: Units,
    pub(super) shape: Shape,
    regions: Vec<Placed<Region>>,
    loads: Vec<Placed<(Load, Members)>>,
    supports: Vec<Placed<Support>>,
    nodal: nodal::PlacedNodal,
    initial: Vec<Placed<InitialVelocity>>,
    pub(super) start: Start,
    pub(super) time: time::Time,
    newton: NewtonSettings,
    pub(super) output: Output,
    requested: Requested,
    limits: Limits,
    faults: Faults,
}

impl Parts {
    pub(super) fn read(tree: &Node, directory: &Path, overrides: &Overrides) -> Result<Parts, InputError> {
        let mut faults = Faults::default();
        let root = match faults.keep(Table::root(tree, &ROOT)) {
            Some(root) => root,
            None => return Err(faults.finish().err().unwrap_or_else(|| Fault::new("no input").into())),
        };
        let title = root.get("title").map(|item| item.string().map(str::to_string)).transpose();
        let title = faults.keep(title).flatten();
        let units =
            faults.keep(root.get("units").map_or(Ok(Units::default()), units::read)).unwrap_or_default();
        let shape = faults.keep(root.require("mesh").and_then(|item| shape::read(item, directory)));
        let regions = faults.keep(root.require("region").and_then(at_least_one));
        let regions = regions.map(|item| each(item, region::read, &mut faults)).unwrap_or_default();
        let start = faults.keep(read_start(&root, directory)).unwrap_or(Start::Undeformed);
        let time = read_time(&root, &start, overrides);
        let end = time.as_ref().map_or(1.0, |time| time.plan.end());
        let context = Context { directory, end };
        let load::Sorted { loads, attractions, drags } =
            optional(&root, "load", |item| load::read(item, context), &mut faults).into_iter().collect();
        let is_support = |item: &Item<'_>| !nodal::is_spring_alone(item);
        let supports =
            optional_where(&root, "support", is_support, |item| support::read(item, context), &mut faults);
        let nodal = nodal::read(&root, attractions, drags, &mut faults);
        faults.keep(root.get("mass").map_or(Ok(()), |item| item.one_or_more().map(|_| ())));
        let is_velocity = |item: &Item<'_>| item.has_key("state").is_none();
        let initial = optional_where(&root, "initial", is_velocity, initial::read, &mut faults);
        if start == Start::Undeformed {
            faults.keep(support::check_starts(&root, context));
        }
        let time = faults.keep(time);
        let start = if root.get("time").is_some() { start } else { Start::Undeformed };
        let newton = faults.keep(root.require("newton").and_then(settings::newton));
        let output = root.require("output").and_then(|item| {
            Ok((settings::output(item)?, quantities::read(&item.table(&settings::OUTPUT)?)?))
        });
        let output = faults.keep(output);
        let limits = root.get("limits").map_or(Ok(Limits::default()), settings::limits);
        let limits = faults.keep(limits).unwrap_or_default();
        let solver = faults.keep(root.get("solver").map_or(Ok(Solver::Auto), settings::solver));
        if let Some(time) = &time {
            histories::check_finite(tree, &time.plan, &mut faults);
        }
        let Some(shape) = shape else { return Err(finished(faults)) };
        let (Some(time), Some(newton), Some(solver), Some((output, requested))) =
            (time, newton, solver, output)
        else {
            return Err(with_groups(&shape, &regions, &loads, &supports, &nodal, &initial, faults));
        };
        let plan = match time.scheme {
            // The load fraction is no time.
            Scheme::Static => time.plan.clone(),
            _ => support::plan_with_releases(&time.plan, &supports),
        };
        let plan = root.require("output").and_then(|item| settings::plan_with_frames(plan, &output, &item));
        let Some(plan) = faults.keep(plan) else { return Err(finished(faults)) };
        let time = time::Time { plan, ..time };
        Ok(Parts {
            title,
            units,
            shape,
            regions,
            loads,
            supports,
            nodal,
            initial,
            start,
            time,
            newton: NewtonSettings { solver, ..newton },
            output,
            requested,
            limits,
            faults,
        })
    }

    /// Checks that the mesh has the groups and cells that the input names.
    fn check_mesh(&mut self, mesh: &Mesh) -> Result<Formulations, InputError> {
        groups::check(mesh, &self.regions, &self.loads, &self.supports, &self.initial, &mut self.faults);
        groups::check_nodes(mesh, self.nodal.groups(), &mut self.faults);
        self.faults.finish()?;
        groups::check_regions(mesh, &self.regions)?;
        let formulations = Formulations::new(mesh, &self.regions, &self.time)?;
        support::check_together(mesh, &self.supports, &self.time)?;
        Ok(formulations)
    }

    /// The mesh with every group found.
    fn checked_mesh(&mut self) -> Result<CheckedMesh, InputError> {
        let Some(mut file) = self.faults.keep(self.shape.mesh(&link_groups(&self.regions))) else {
            return Err(finished(std::mem::take(&mut self.faults)));
        };
        let formulations = self.check_mesh(&file.mesh).map_err(|error| error.with_notes(&file.notes))?;
        let mesh = &file.mesh;
        let regions: Vec<&Region> = self.regions.iter().map(|region| &region.value).collect();
        let loads = self.loads.iter().map(|load| &load.value.0);
        file.notes.extend(plausible::note_on_size(mesh, self.units));
        file.notes.extend(plausible::notes_on_loads(mesh, loads, &regions, self.units));
        file.notes.extend(groups::notes(mesh, &self.loads, &self.supports, &self.initial, &self.nodal));
        Ok(CheckedMesh { file, formulations })
    }

    /// The mesh alone, with remarks on it.
    pub(super) fn mesh(mut self) -> Result<MeshFile, InputError> {
        Ok(self.checked_mesh()?.file)
    }

    /// The problem, once the mesh is made.
    pub(super) fn problem(mut self, resolved: String, source: Source<'_>) -> Result<Problem, InputError> {
        let (mesh, digest) = source.mesh(&resolved, || self.checked_mesh())?;
        // Of the ranks that have not read the mesh.
        source.agree(self.faults.finish())?;
        let (mesh, mut notes, files, formulations) = match mesh {
            Some(CheckedMesh { file, formulations }) => {
                (Some(file.mesh), file.notes, file.files, formulations)
            }
            None => Default::default(),
        };
        self.nodal.check_damping(&self.regions, &self.time)?;
        let places = derived::Places::new(&self.regions, &self.loads, &self.initial, &self.nodal);
        let is_moved = derived::is_moved(&self.regions, &self.loads, &self.supports, &self.initial);
        notes.extend(self.regions.iter().filter_map(|region| plausible::note(&region.value, self.units)));
        let pulls = derived::pulls(&self.regions);
        let held = support::places(&self.supports);
        let pressed = load::places(&self.loads);
        let supports = values(self.supports);
        let loads: Vec<Load> = values(self.loads).into_iter().map(|(load, _)| load).collect();
        let drag = self.nodal.drag();
        let spread = self.nodal.spread_groups();
        let nodal = self.nodal.values();
        let is_static = self.time.scheme == Scheme::Static;
        let mesh_in_memory = self.shape.given().cloned();
        let is_same = |known: &&Problem| {
            let mesh = known.mesh_in_memory.as_ref().zip(mesh_in_memory.as_ref());
            mesh.is_some_and(|(known, own)| Arc::ptr_eq(known, own))
                && !is_static
                && !known.is_static()
                && (&known.supports, &known.loads, &known.nodal) == (&supports, &loads, &nodal)
                && known.body.drag() == drag
                && body_of(&resolved).is_some_and(|own| body_of(&known.resolved) == Some(own))
        };
        let body = match source.known().filter(is_same) {
            Some(known) => known.body.clone(),
            None => {
                let body = source
                    .builder(mesh)?
                    .regions(values(self.regions))
                    .point_terms(nodal.clone())
                    .supports(&supports)
                    .loads(&loads)
                    .drag(drag)
                    .build();
                let fault = |error| {
                    let own = support::fault(&error, &held).or_else(|| nodal::fault(&error, &spread));
                    let own = own.or_else(|| load::fault(&error, &pressed));
                    own.unwrap_or_else(|| self.shape.fault(&error))
                };
                body.map_err(fault)?
            }
        };
        time::check_scale(&body, &self.time)?;
        if self.output.has_frames() {
            self.output.format.check(&body).map_err(|error| Fault::new(error.to_string()))?;
        }
        let quantities = self.requested.quantities(&body, &mut notes)?;
        let initial = values(self.initial);
        source.agree(places.check(&body, &loads, &initial, &self.time.plan).map_err(InputError::from))?;
        if !is_moved && nodal.attractions.is_empty() && !matches!(self.start, Start::Run(_)) {
            notes.push(derived::NOTHING_MOVES.to_string());
        }
        let is_equilibrium = is_static || matches!(self.start, Start::Equilibrium { .. });
        if is_equilibrium && !pulls && nodal.attractions.is_empty() && !body.is_loaded_at(0.0) {
            notes.push(derived::UNLOADED.to_string());
        }
        if !is_static {
            notes.extend(derived::of_tables(&loads, &supports, &self.time.plan));
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

/// The state from which the motion starts.
fn read_start(root: &Table<'_>, directory: &Path) -> Result<Start, Fault> {
    if let Some(state) = start::read(root, directory)? {
        return Ok(Start::Run(state));
    }
    let Some(item) = root.get("equilibrium") else { return Ok(Start::Undeformed) };
    Ok(Start::Equilibrium { load_steps: equilibrium::read(item)? })
}

/// Scheme and plan; an equilibrium without `[time]` is a static analysis.
fn read_time(root: &Table<'_>, start: &Start, overrides: &Overrides) -> Result<time::Time, Fault> {
    let Start::Equilibrium { load_steps } = *start else {
        return time::read(root.require("time")?, overrides.until, overrides.step);
    };
    if let Some(time) = root.get("time") {
        return time::read(time, overrides.until, overrides.step);
    }
    if let Some(initial) = root.get("initial") {
        let message = "a static analysis has no velocities: without `[time]` the body does not move";
        return Err(
            Fault::at(initial.key_place, message, "velocities").help("give `[time]`, or remove `[initial]`")
        );
    }
    match (overrides.until, overrides.step) {
        (Some(_), _) => Err(equilibrium::no_time("--until")),
        (None, Some(_)) => Err(equilibrium::no_time("--step")),
        (None, None) => equilibrium::analysis(load_steps),
    }
}

/// Further faults: the groups, if the mesh can be made despite faults elsewhere.
fn with_groups(
    shape: &Shape,
    regions: &[Placed<Region>],
    loads: &[Placed<(Load, Members)>],
    supports: &[Placed<Support>],
    nodal: &nodal::PlacedNodal,
    initial: &[Placed<InitialVelocity>],
    mut faults: Faults,
) -> InputError {
    if let Some(MeshFile { mesh, .. }) = faults.keep(shape.mesh(&link_groups(regions))) {
        groups::check(&mesh, regions, loads, supports, initial, &mut faults);
        groups::check_nodes(&mesh, nodal.groups(), &mut faults);
    }
    finished(faults)
}

/// Groups of the regions of links: lines of a mesh file that are cells.
fn link_groups(regions: &[Placed<Region>]) -> Vec<String> {
    let links = regions.iter().filter(|region| region.value.link().is_some());
    let names = links.map(|region| region.value.group.clone().unwrap_or_else(|| LINKS.to_string()));
    // `cells:NAME` means the cells of a group, unless a group itself has such a name.
    let with_own = |name: String| {
        let own = name.strip_prefix("cells:").map(str::to_string);
        std::iter::once(name).chain(own)
    };
    names.flat_map(with_own).collect()
}

/// Group of all links of a mesh in memory.
const LINKS: &str = "links";

fn finished(mut faults: Faults) -> InputError {
    faults.finish().err().unwrap_or_else(|| Fault::new("the input could not be read").into())
}

/// The sections of a resolved input that describe the body, but for its mesh. Functions of a program have their names there:
/// loads and supports themselves tell them apart.
fn body_of(resolved: &str) -> Option<[Option<toml::Value>; 4]> {
    let mut table = resolved.parse::<toml::Table>().ok()?;
    Some(["region", "mass", "load", "support"].map(|section| table.remove(section)))
}

fn values<T>(placed: Vec<Placed<T>>) -> Vec<T> {
    placed.into_iter().map(|placed| placed.value).collect()
}

fn at_least_one(item: Item<'_>) -> Result<Item<'_>, Fault> {
    if item.one_or_more()?.is_empty() {
        return Err(item.fault("`region` is empty: a body needs at least one region", "empty"));
    }
    Ok(item)
}

/// Reads one table or a list of them; each failure stores its fault.
fn each<'a, T>(item: Item<'a>, read: impl Fn(Item<'a>) -> Result<T, Fault>, faults: &mut Faults) -> Vec<T> {
    let items = faults.keep(item.one_or_more()).unwrap_or_default();
    items.into_iter().filter_map(|item| faults.keep(read(item))).collect()
}

/// Reads only the tables of a kind.
fn optional_where<'a, T>(
    root: &Table<'a>,
    key: &str,
    is_wanted: impl Fn(&Item<'_>) -> bool,
    read: impl Fn(Item<'a>) -> Result<T, Fault>,
    faults: &mut Faults,
) -> Vec<T> {
    let Some(item) = root.get(key) else { return Vec::new() };
    let items = faults.keep(item.one_or_more()).unwrap_or_default();
    items.into_iter().filter(is_wanted).filter_map(|item| faults.keep(read(item))).collect()
}

fn optional<'a, T>(
    root: &Table<'a>,
    key: &str,
    read: impl Fn(Item<'a>) -> Result<T, Fault>,
    faults: &mut Faults,
) -> Vec<T> {
    root.get(key).map(|item| each(item, read, faults)).unwrap_or_default()
}
