//! Everything a run needs, built from an input.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use emmy::body::{Body, InitialVelocity, Load, PointTerms, Region, Support};
use emmy::mesh::Mesh;
use emmy::motion::Solver;
use emmy::motion::{NewtonSettings, StepPlan};
use emmy::time::Scheme;

use super::description::{Described, Kind, Section};
use super::fault::{Fault, Faults, InputError};
use super::formulation::Formulations;
use super::groups::Members;
use super::history::Context;
use super::quantities::{Quantities, Requested};
use super::region::Placed;
use super::settings::{Limits, Output};
use super::shape::Shape;
use super::table::{Item, Table};
use super::tree::{self, Node};
use super::{
    Start, adaptive, complete, derived, equilibrium, groups, history, initial, load, nodal, plausible,
    quantities, region, set, settings, shape, start, support, time, units, write,
};
use crate::mesh::MeshFile;
use crate::message::shown;
use crate::units::Units;

/// The whole input.
pub(super) static ROOT: Described = Described::new(|| {
    Section::new("the input", "Motion of an elastic body; units are any consistent set")
        .may("title", Kind::Text, "", "Any text; it goes into the summary")
        .may("units", Kind::Table(&units::UNITS), "", "System of units, for results with units")
        .must("mesh", Kind::Table(&shape::MESH), "", "Source of the cells")
        .must("region", Kind::Tables(&region::REGION), "", "Material of the cells; one or more")
        .may("mass", Kind::Tables(&nodal::MASS), "", "Point masses at nodes; none, one or more")
        .may("load", Kind::Tables(&load::LOAD), "", "Loads on the body; none, one or more")
        .may(
            "support",
            Kind::Tables(&support::SUPPORT),
            "",
            "Nodes that are held or driven; none, one or more",
        )
        .may("initial", Kind::Tables(&initial::INITIAL), "", "Velocities at the start; none, one or more")
        .absent("at rest")
        .may(
            "equilibrium",
            Kind::Table(&equilibrium::EQUILIBRIUM),
            "",
            "Start from the static equilibrium under the loads at t = 0; without `time` a static analysis",
        )
        .absent("starts undeformed")
        .may("time", Kind::Table(&time::TIME), "", "Scheme, degree and steps")
        .absent("a static analysis, which needs `equilibrium`")
        .may("newton", Kind::Table(&settings::NEWTON), "", "End of the iteration of a step")
        .default("{}")
        .may("solver", Kind::Table(&settings::SOLVER), "", "Solver of the linear systems")
        .may("output", Kind::Table(&settings::OUTPUT), "", "Files of the results, and their place")
        .default("{}")
        .may("limits", Kind::Table(&settings::LIMITS), "", "Limits that end a run early")
        .at_least_one(&["time", "equilibrium"])
});

/// Options of the command line for an input.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Overrides {
    /// `--set KEY=VALUE`, in order.
    pub set: Vec<String>,
    /// `--until T`: end of the run; the plan is cut, or its last phase is extended.
    pub until: Option<f64>,
    /// `--output DIR`.
    pub output: Option<PathBuf>,
    /// `--step H` of a resumed run: a time, and the size of the later steps.
    pub step: Option<(f64, f64)>,
}

/// A complete, checked problem: everything that the library needs to compute a motion, and the output to write.
///
/// ```
/// use emmy_io::input::{self, Overrides};
/// # let directory = std::env::temp_dir().join(format!("emmy-doc-{}", std::process::id()));
/// # std::fs::create_dir_all(&directory)?;
/// # let path = directory.join("block.toml");
/// # std::fs::write(&path, "mesh.box = { size = [1, 1, 1], cells = [1, 1, 1] }\n\
/// #     time = { scheme = 'DGM', steps = [{ until = 1, size = 0.1 }] }\n\
/// #     region = [{ density = 2, material.neo-hooke = { lambda = 1, mu = 1 } }]\n")?;
/// let problem = input::read(&path, &Overrides { until: Some(2.0), ..Default::default() })?;
/// assert_eq!((problem.body.n_dofs(), problem.plan.n_steps()), (24, 20));
/// # std::fs::remove_dir_all(&directory)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Problem {
    /// Title.
    pub title: Option<String>,
    /// Units of all numbers, if they are given.
    pub units: Units,
    /// The body: mesh, regions, supports and loads.
    pub body: Body,
    /// The mesh, if it was given in memory: a run writes it beside its results.
    pub mesh_in_memory: Option<Arc<Mesh>>,
    /// Supports.
    pub supports: Vec<Support>,
    /// Point masses, springs to the ground, attraction to points.
    pub nodal: PointTerms,
    /// Loads.
    pub loads: Vec<Load>,
    /// Initial velocities.
    pub initial: Vec<InitialVelocity>,
    /// The state to which the initial velocities belong.
    pub start: Start,
    /// Scheme; [`Scheme::Static`] for a static analysis.
    pub scheme: Scheme,
    /// Step plan; of a static analysis over the load fraction.
    pub plan: StepPlan,
    /// Smallest size of a cut step; `None`: 1/1024 of the planned one.
    pub smallest_step: Option<f64>,
    /// Settings of Newton's iteration.
    pub newton: NewtonSettings,
    /// Output files and directory.
    pub output: Output,
    /// Quantities in the history besides those of the whole body.
    pub quantities: Quantities,
    /// Limits that end a run early.
    pub limits: Limits,
    /// Formulations of the cells, for `emmy check`.
    pub formulations: Formulations,
    /// Remarks from the mesh reader, and on keys without effect.
    pub notes: Vec<String>,
    /// The source files: the input, the files of the mesh, the files of histories.
    pub files: Vec<PathBuf>,
    /// The input with all values in effect, as TOML that gives the same run.
    pub resolved: String,
}

/// Reads an input file. Nothing is written.
///
/// # Errors
/// [`InputError`] with every fault and its place.
pub fn read(path: &Path, overrides: &Overrides) -> Result<Problem, InputError> {
    let mut problem = of_tree(tree::read(path)?, path, overrides, None)?;
    problem.files.insert(0, path.to_path_buf());
    Ok(problem)
}

/// The problem of a tree. `path`: its file, or the file that it would have; `known`: a problem whose body is taken if it
/// is the same.
pub(super) fn of_tree(
    mut tree: Node,
    path: &Path,
    overrides: &Overrides,
    known: Option<&Problem>,
) -> Result<Problem, InputError> {
    for flag in &overrides.set {
        set::apply(&mut tree, flag)?;
    }
    let note = complete::clean_title(&mut tree);
    complete::fill_defaults(&mut tree)?;
    let output = complete::fill_directory(&mut tree, path, overrides.output.as_deref());
    let directory = path.parent().unwrap_or(Path::new(""));
    let mut parts = Parts::read(&tree, directory, overrides)?;
    // The text may have lost characters that are not UTF-8.
    parts.output.directory = output.unwrap_or(parts.output.directory);
    let mesh_file =
        parts.shape.absolute_file().map(|file| complete::spellable(file, &parts.output.directory));
    let histories = complete::resolve_histories(&mut tree, directory, &parts.output.directory);
    let is_lost = mesh_file.as_ref().is_some_and(|file| file.to_str().is_none());
    complete::resolve(&mut tree, mesh_file, &parts.start, &parts.time.plan)?;
    complete::spell(&mut tree);
    let mut problem = parts.problem(write::toml(&tree), known)?;
    if is_lost {
        problem.notes.push(LOST_MESH.to_string());
    }
    problem.files.extend(histories);
    problem.notes.extend(note);
    Ok(problem)
}

/// A path of the mesh that no TOML file can hold.
const LOST_MESH: &str = "the path of the mesh is not UTF-8, which the input of the output directory cannot hold: `emmy resume` \
                         needs `--set mesh.file=PATH` with another name of it";

/// Data read from the tree before the mesh is made.
struct Parts {
    title: Option<String>,
    units: Units,
    shape: Shape,
    regions: Vec<Placed<Region>>,
    loads: Vec<Placed<(Load, Members)>>,
    supports: Vec<Placed<Support>>,
    nodal: nodal::PlacedNodal,
    initial: Vec<Placed<InitialVelocity>>,
    start: Start,
    time: time::Time,
    newton: NewtonSettings,
    output: Output,
    requested: Requested,
    limits: Limits,
    faults: Faults,
}

impl Parts {
    fn read(tree: &Node, directory: &Path, overrides: &Overrides) -> Result<Parts, InputError> {
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
            history::check_finite(tree, &time.plan, &mut faults);
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

    /// The problem, once the mesh is made and every group found.
    fn problem(mut self, resolved: String, known: Option<&Problem>) -> Result<Problem, InputError> {
        let Some(MeshFile { mesh, mut notes, files }) =
            self.faults.keep(self.shape.mesh(&link_groups(&self.regions)))
        else {
            return Err(finished(self.faults));
        };
        groups::check(&mesh, &self.regions, &self.loads, &self.supports, &self.initial, &mut self.faults);
        groups::check_nodes(&mesh, self.nodal.groups(), &mut self.faults);
        self.faults.finish()?;
        groups::check_regions(&mesh, &self.regions)?;
        let formulations = Formulations::new(&mesh, &self.regions, &self.time)?;
        support::check_together(&mesh, &self.supports, &self.time)?;
        self.nodal.check_damping(&self.regions, &self.time)?;
        let places = derived::Places::new(&self.regions, &self.loads, &self.initial, &self.nodal);
        let is_moved = derived::is_moved(&self.regions, &self.loads, &self.supports, &self.initial);
        notes.extend(self.regions.iter().filter_map(|region| plausible::note(&region.value, self.units)));
        let pulls = derived::pulls(&self.regions);
        let held = support::places(&self.supports);
        let supports = values(self.supports);
        let loads: Vec<Load> = values(self.loads).into_iter().map(|(load, _)| load).collect();
        let drag = self.nodal.drag();
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
                && regions(&known.resolved) == regions(&resolved)
        };
        let body = match known.filter(is_same) {
            Some(known) => known.body.clone(),
            None => {
                let body = Body::builder(mesh)
                    .regions(values(self.regions))
                    .point_terms(nodal.clone())
                    .supports(&supports)
                    .loads(&loads)
                    .drag(drag)
                    .build();
                let fault = |error| support::fault(&error, &held).unwrap_or_else(|| self.shape.fault(&error));
                body.map_err(fault)?
            }
        };
        adaptive::check_scale(&body, &self.time)?;
        let quantities = self.requested.quantities(&body, &mut notes)?;
        let initial = values(self.initial);
        places.check(&body, &loads, &initial, &self.time.plan)?;
        if !is_moved && nodal.attractions.is_empty() && !matches!(self.start, Start::Run(_)) {
            notes.push(derived::NOTHING_MOVES.to_string());
        }
        let is_equilibrium = is_static || matches!(self.start, Start::Equilibrium { .. });
        if is_equilibrium && !pulls && nodal.attractions.is_empty() && !body.is_loaded_at(0.0) {
            notes.push(derived::UNLOADED.to_string());
        }
        if !is_static {
            notes.extend(derived::of_records(&loads, &supports, &self.time.plan));
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
    links.map(|region| region.value.group.clone().unwrap_or_else(|| LINKS.to_string())).collect()
}

/// Group of all links of a mesh in memory.
const LINKS: &str = "links";

fn finished(mut faults: Faults) -> InputError {
    faults.finish().err().unwrap_or_else(|| Fault::new("the input could not be read").into())
}

/// The regions in a resolved input.
fn regions(resolved: &str) -> Option<toml::Value> {
    resolved.parse::<toml::Table>().ok()?.remove("region")
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
