//! Everything a run needs, built from an input.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use emmy::body::{Body, InitialVelocity, Load, PointTerms, Support};
use emmy::mesh::Mesh;
use emmy::motion::{NewtonSettings, StepPlan};
use emmy::team::Team;
use emmy::time::Scheme;

use super::description::{Described, Kind, Section};
use super::fault::InputError;
use super::formulation::Formulations;
use super::parts::Parts;
use super::quantities::Quantities;
use super::settings::{Limits, Output};
use super::source::{self, Source};
use super::tree::{self, Node};
use super::{
    Start, complete, equilibrium, initial, load, nodal, region, set, settings, shape, support, time, units,
    write,
};
use crate::checkpoint::identity::digest_of_tables;
use crate::mesh::MeshFile;
use crate::shares::MeshSource;
use crate::units::Units;

/// The whole input.
pub(super) static ROOT: Described = Described::new(|| {
    Section::new("the input", "Motion of an elastic body; units are any consistent set")
        .may("title", Kind::Text, "", "Any text; it goes into the summary")
        .may("units", Kind::Table(&units::UNITS), "", "System of units, for results with units")
        .must("mesh", Kind::Table(&shape::MESH), "", "Source of the cells")
        .must("region", Kind::Tables(&region::REGION), "", "Material of the cells; one or more")
        .may("mass", Kind::Tables(&nodal::MASS), "", "Masses besides those of the cells; none, one or more")
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
    /// `--parts DIR` of a team: the folder of [`crate::shares`] from which each rank reads its part of the mesh.
    pub parts: Option<PathBuf>,
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
    /// Masses besides those of the cells, springs to the ground, attraction to points.
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
    /// On a team, the digest of the whole mesh.
    pub(crate) digest: Option<String>,
}

/// Reads an input file. Nothing is written.
///
/// # Errors
/// [`InputError`] with every fault and its place.
pub fn read(path: &Path, overrides: &Overrides) -> Result<Problem, InputError> {
    let mut problem = of_tree(tree::read(path), path, overrides, Source::Alone(None))?;
    problem.files.insert(0, path.to_path_buf());
    Ok(problem)
}

/// Reads the mesh of an input, and what it was made from. No body is built.
///
/// # Errors
/// [`InputError`] with every fault and its place.
pub fn read_mesh(path: &Path, overrides: &Overrides) -> Result<(MeshFile, MeshSource), InputError> {
    let Prepared { parts, resolved, .. } = Prepared::new(tree::read(path)?, path, overrides)?;
    Ok((parts.mesh()?, source::mesh_source(&resolved)?))
}

/// Reads an input file on all ranks of a team: each has its part of the body. Nothing is written.
///
/// # Errors
/// [`InputError`] on all ranks. Rank 0 has every fault and its place, if it has found them.
pub fn read_on_team(path: &Path, overrides: &Overrides, team: &Arc<dyn Team>) -> Result<Problem, InputError> {
    let source = overrides.parts.as_deref().map_or(Source::Team(team), |folder| Source::Parts(team, folder));
    let mut problem = of_tree(tree::read(path), path, overrides, source)?;
    problem.files.insert(0, path.to_path_buf());
    Ok(problem)
}

/// The problem of a tree. `path`: its file, or the file that it would have.
pub(super) fn of_tree(
    tree: Result<Node, InputError>,
    path: &Path,
    overrides: &Overrides,
    source: Source<'_>,
) -> Result<Problem, InputError> {
    let advised = |error| set::of_one_run(error, &overrides.set);
    let prepared = tree.and_then(|tree| Prepared::new(tree, path, overrides)).map_err(advised);
    let prepared = source.agree(prepared)?;
    source.check_input(&prepared.resolved)?;
    let problem = prepared.parts.problem(prepared.resolved, source).map_err(advised);
    let mut problem = source.agree(problem)?;
    source.check_digest("tables", "other files of histories", &digest_of_tables(&problem))?;
    problem.files.extend(prepared.histories);
    problem.notes.extend(prepared.notes);
    Ok(problem)
}

/// An input before its mesh is read.
struct Prepared {
    parts: Parts,
    /// The text with all defaults.
    resolved: String,
    /// Files of histories.
    histories: Vec<PathBuf>,
    notes: Vec<String>,
}

impl Prepared {
    fn new(mut tree: Node, path: &Path, overrides: &Overrides) -> Result<Self, InputError> {
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
        let lost = is_lost.then(|| LOST_MESH.to_string());
        let notes = lost.into_iter().chain(note).collect();
        Ok(Prepared { parts, resolved: write::toml(&tree), histories, notes })
    }
}

/// A path of the mesh that no TOML file can hold.
const LOST_MESH: &str = "the mesh path is not UTF-8, so `input.toml` cannot record it; to resume, give \
                         `--set mesh.file=PATH` with a UTF-8 path";
