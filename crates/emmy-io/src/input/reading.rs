//! From an input to its problem.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use emmy::team::Team;

use super::catalogue::ROOT_KIND;
use super::fault::{Faults, InputError};
use super::large_output::{self, LeftOut};
use super::problem::{Overrides, Problem};
use super::sections::Sections;
use super::shape::MeshPath;
use super::source::{self, Source};
use super::tree::{self, Node};
use super::{canonical, complete, deck, parameters, set, write};
use crate::checkpoint::identity::digest_of_tables;
use crate::mesh::MeshFile;
use crate::shares::MeshSource;

/// Reads an input file. Nothing is written.
///
/// # Errors
/// [`InputError`] with every fault and its place.
pub fn read(path: &Path, overrides: &Overrides) -> Result<Problem, InputError> {
    of_file(path, overrides, Source::Alone(None))
}

/// Reads the mesh of an input, and what it was made from. No body is built.
///
/// # Errors
/// [`InputError`] with every fault and its place.
pub fn read_mesh(path: &Path, overrides: &Overrides) -> Result<(MeshFile, MeshSource), InputError> {
    let Prepared { sections, resolved, .. } = Prepared::new(tree::read(path)?, path, overrides, true)?;
    Ok((sections.mesh()?, source::mesh_source(&resolved)?))
}

/// Reads an input file on all ranks of a team: each has its part of the body. Nothing is written.
///
/// # Errors
/// [`InputError`] on all ranks. Rank 0 has every fault and its place, if it has found them.
pub fn read_on_team(path: &Path, overrides: &Overrides, team: &Arc<dyn Team>) -> Result<Problem, InputError> {
    let source = overrides.parts.as_deref().map_or(Source::Team(team), |folder| Source::Parts(team, folder));
    of_file(path, overrides, source)
}

/// The problem of a file, whose frames may have smaller defaults.
fn of_file(path: &Path, overrides: &Overrides, source: Source<'_>) -> Result<Problem, InputError> {
    let (mut problem, mut tree, left_out) = read_tree(tree::read(path), path, overrides, source)?;
    if !overrides.is_of_body && large_output::reduce(&mut problem, &mut tree, left_out) {
        problem.resolved = write::toml(&tree);
    }
    problem.files.insert(0, path.to_path_buf());
    Ok(problem)
}

/// The problem of a tree in memory. `path`: the file that it would have.
pub(super) fn of_tree(
    tree: Node,
    path: &Path,
    overrides: &Overrides,
    known: Option<&Problem>,
) -> Result<Problem, InputError> {
    read_tree(Ok(tree), path, overrides, Source::Alone(known)).map(|(problem, ..)| problem)
}

/// The problem of a tree, the tree with all defaults, and which keys of the output it left out.
fn read_tree(
    tree: Result<Node, InputError>,
    path: &Path,
    overrides: &Overrides,
    source: Source<'_>,
) -> Result<(Problem, Node, LeftOut), InputError> {
    let advised = |error| set::of_one_run(error, &overrides.set);
    let is_alone = matches!(source, Source::Alone(_));
    let prepared = tree.and_then(|tree| Prepared::new(tree, path, overrides, is_alone)).map_err(advised);
    let prepared = source.agree(prepared)?;
    source.check_input(&prepared.resolved)?;
    let problem = prepared.sections.problem(prepared.resolved, source).map_err(advised);
    let mut problem = source.agree(problem)?;
    source.check_digest("tables", "other files of histories", &digest_of_tables(&problem))?;
    problem.files.extend(prepared.histories);
    problem.notes.extend(prepared.notes);
    Ok((problem, prepared.tree, prepared.left_out))
}

/// An input before its mesh is read.
struct Prepared {
    sections: Sections,
    /// The input with all defaults, and its text.
    tree: Node,
    resolved: String,
    left_out: LeftOut,
    /// Files of histories.
    histories: Vec<PathBuf>,
    notes: Vec<String>,
}

impl Prepared {
    /// `reads_mesh`: whether the mesh file is read here, and its entries act.
    fn new(mut tree: Node, path: &Path, overrides: &Overrides, reads_mesh: bool) -> Result<Self, InputError> {
        for flag in &overrides.set {
            set::apply(&mut tree, flag)?;
        }
        set::apply_to_time(&mut tree, overrides.step_size, overrides.degree)?;
        canonical::spell(&mut tree, &ROOT_KIND);
        let mut faults = Faults::default();
        let unused = parameters::evaluate(&mut tree, &ROOT_KIND, &mut faults);
        let note = complete::clean_title(&mut tree);
        let left_out = LeftOut::of(&mut tree);
        complete::fill_defaults(&mut tree)?;
        let output = complete::fill_directory(&mut tree, path, overrides.output.as_deref());
        let directory = path.parent().unwrap_or(Path::new(""));
        let file = if reads_mesh { deck::insert(&mut tree, directory) } else { None };
        let mut sections = Sections::read(&tree, directory, overrides, faults)?;
        // The text may have lost characters that are not UTF-8.
        sections.output.directory = output.unwrap_or(sections.output.directory);
        let spellable = |own: MeshPath| MeshPath {
            file: complete::spellable(own.file, &sections.output.directory),
            ..own
        };
        let mesh_files: Vec<MeshPath> = sections.shape.files().into_iter().map(spellable).collect();
        let histories = complete::resolve_histories(&mut tree, directory, &sections.output.directory);
        let lost = mesh_files.iter().find(|own| own.file.to_str().is_none()).map(lost_mesh);
        complete::resolve(&mut tree, &mesh_files, &sections.start, &sections.time.plan)?;
        complete::spell(&mut tree);
        file.iter().for_each(|file| deck::leave_out_all(&mut tree, file));
        sections.mesh_file.set(file);
        let of_histories = std::mem::take(&mut sections.notes);
        let notes = lost.into_iter().chain(note).chain(unused).chain(of_histories).collect();
        let resolved = write::toml(&tree);
        Ok(Prepared { sections, tree, resolved, left_out, histories, notes })
    }
}

/// The remark on a path of the mesh that no TOML file can hold.
fn lost_mesh(path: &MeshPath) -> String {
    let key = path.part.map_or("mesh.file".to_string(), |part| format!("mesh.parts.{part}.file"));
    format!(
        "the mesh path is not UTF-8, so `input.toml` cannot record it; to resume, give `--set {key}=PATH` with a UTF-8 \
         path"
    )
}
