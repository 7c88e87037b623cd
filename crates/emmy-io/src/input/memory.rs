//! Inputs that a program builds: the words of the input file in a tree, with a mesh and functions in memory.

use std::cell::RefCell;
use std::path::Path;
use std::sync::Arc;

use emmy::body::{Field, Region, TimeFunction};
use emmy::mesh::Mesh;

use super::context::Context;
use super::fault::{Fault, Faults, InputError, Place};
use super::table::{Item, Table};
use super::tree::{self, Entry, Node, Value};
use super::{
    Overrides, Problem, adaptive, canonical, catalogue, complete, contact, coupling, joint, load, material,
    measured, nodal, parameters, reading, region, rigid, support, tie, walk,
};
use crate::units::Units;

/// A value of an input. Tables have the keys of the input file; where a file names a mesh or describes a function, a
/// program may give the object itself.
#[derive(Debug, Clone)]
pub enum Tree {
    /// True or false.
    Boolean(bool),
    /// A whole number.
    Whole(i64),
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
    /// A list.
    List(Vec<Tree>),
    /// A table.
    Table(Vec<(String, Tree)>),
    /// The mesh, in place of the table `mesh`.
    Mesh(Arc<Mesh>),
    /// A factor over time, in place of a history.
    TimeFunction(TimeFunction),
    /// A function of reference position and time, in place of a vector of a load.
    Field(Field),
}

impl Tree {
    /// The tree with paths such as `load[1].group` as places.
    fn node(&self, path: &str) -> Node {
        let value = match self {
            Tree::Boolean(value) => Value::Boolean(*value),
            Tree::Whole(value) => Value::Integer(*value),
            Tree::Number(value) => Value::Float(*value),
            Tree::Text(text) => Value::String(text.clone()),
            Tree::List(items) => {
                let item = |(i, item): (usize, &Tree)| item.node(&format!("{path}[{i}]"));
                Value::Array(items.iter().enumerate().map(item).collect())
            }
            Tree::Table(entries) => {
                Value::Table(entries.iter().map(|(key, own)| entry(path, key, own)).collect())
            }
            Tree::Mesh(mesh) => Value::Mesh(mesh.clone()),
            Tree::TimeFunction(function) => Value::TimeFunction(function.clone()),
            Tree::Field(field) => Value::Field(field.clone()),
        };
        Node { value, place: Place::of_path(path) }
    }
}

fn entry(path: &str, key: &str, tree: &Tree) -> Entry {
    let path = if path.is_empty() { key.to_string() } else { format!("{path}.{key}") };
    Entry { key: key.to_string(), place: Place::of_path(&path), node: tree.node(&path) }
}

/// The problem of a tree, checked as [`super::read`] checks a file. Relative paths in it start from the working
/// directory. The body of a `known` problem is shared if this one has the same.
///
/// ```
/// use emmy_io::input::{self, Overrides, Tree};
/// use std::sync::Arc;
/// let table = |entries: Vec<(&str, Tree)>| {
///     Tree::Table(entries.into_iter().map(|(key, value)| (key.to_string(), value)).collect())
/// };
/// let rubber = table(vec![("lambda", Tree::Number(1000.0)), ("mu", Tree::Number(500.0))]);
/// let region = table(vec![("density", Tree::Number(2.0)), ("material", table(vec![("neo-hooke", rubber)]))]);
/// let steps = table(vec![("until", Tree::Number(1.0)), ("size", Tree::Number(0.1))]);
/// let time = |scheme: &str| {
///     table(vec![("scheme", Tree::Text(scheme.into())), ("steps", Tree::List(vec![steps.clone()]))])
/// };
/// let mesh = Arc::new(emmy::mesh::block([1.0; 3], [2; 3])?);
/// let tree = |scheme: &str| {
///     table(vec![("mesh", Tree::Mesh(mesh.clone())), ("region", region.clone()), ("time", time(scheme))])
/// };
/// let problem = input::build(&tree("DGM"), &Overrides::default(), None)?;
/// assert_eq!((problem.body.n_dofs(), problem.plan.n_steps()), (81, 10));
/// let error = input::build(&tree("DG"), &Overrides::default(), Some(&problem)).unwrap_err();
/// assert!(error.to_string().starts_with("time.scheme: "));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`InputError`] with every fault; its places are paths ([`Place::path`]).
pub fn build(tree: &Tree, overrides: &Overrides, known: Option<&Problem>) -> Result<Problem, InputError> {
    reading::of_tree(tree.node(""), Path::new(NAME), overrides, known)
}

/// The file that an input in memory would have: it gives the default of `output.directory`.
const NAME: &str = "emmy-run.toml";

/// The region of a material alone, with density 1: its energy, stress and moduli.
///
/// # Errors
/// [`InputError`] with every fault, whose places are paths in the table.
pub fn material_region(tree: &Tree) -> Result<Region, InputError> {
    read_alone("material", tree.node(""), |table, faults| faults.keep(material::region(table, 1.0)))
}

/// Checks a table of a section alone: its keys, kinds and ranges. Groups and the mesh are not looked for. Sections:
/// `region`, `material`, `viscosity`, `load`, `support`, `tie`, `contact`, `obstacle`, `obstacle.plane`,
/// `obstacle.sphere`, `obstacle.cylinder`, `rigid`, `coupling`, `joint`, `mass`, `initial`, `adaptive`.
///
/// ```
/// use emmy_io::input::{Tree, check};
/// let density = Tree::Table(vec![("density".into(), Tree::Number(-1.0))]);
/// let error = check("region", &density).unwrap_err().to_string();
/// assert!(error.contains("`material` is missing"), "{error}");
/// ```
///
/// # Errors
/// [`InputError`] with every fault, whose places are paths in the table.
pub fn check(section: &str, tree: &Tree) -> Result<(), InputError> {
    let units = Units::default();
    // The input of a run has the notes.
    let notes = RefCell::default();
    let context = Context { directory: Path::new(""), units, run: None, is_undeformed: false, notes: &notes };
    let read = |table: &Table<'_>, faults: &mut Faults| match section {
        "region" => region::read(table, faults).map(drop),
        "material" => faults.keep(material::region(table, 1.0).map(drop)),
        "viscosity" => faults.keep(region::viscosity(table, None).map(drop)),
        "load" => load::read(table, context, faults).map(drop),
        "support" => {
            support::read(table, context, faults);
            Some(())
        }
        "tie" => faults.keep(tie::read(table)).map(drop),
        "obstacle" => {
            contact::motion(table, context, faults);
            Some(())
        }
        "rigid" => faults.keep(rigid::read(table)).map(drop),
        "coupling" => faults.keep(coupling::read(table)).map(drop),
        "mass" => faults.keep(nodal::read(table, 1)).map(drop),
        "joint" => joint::read(table, 1, context, faults).map(drop),
        "adaptive" => faults.keep(adaptive::check(table)),
        _ => Some(()),
    };
    read_alone(section, tree.node(""), read)
}

/// The table of a resolved input, whose path is absolute; `None` if the file cannot be read any more.
pub(crate) fn resolved(history: &toml::Table) -> Option<TimeFunction> {
    let node = tree::parse("history", &toml::to_string(history).ok()?).ok()?;
    let (units, notes) = (Units::default(), RefCell::default());
    let context = Context { directory: Path::new(""), units, run: None, is_undeformed: false, notes: &notes };
    read_alone("history", node, |table, faults| faults.keep(measured::read(table, context))).ok()
}

/// Fills, checks and reads a table that stands in no input; its section is named by its key.
pub(super) fn read_alone<T>(
    key: &str,
    mut node: Node,
    read: impl FnOnce(&Table<'_>, &mut Faults) -> Option<T>,
) -> Result<T, InputError> {
    let no_section = || Fault::new(format!("`{key}` is not a section of the input"));
    let kind = catalogue::kind_of(key).ok_or_else(no_section)?;
    let mut faults = Faults::default();
    canonical::spell(&mut node, kind);
    parameters::evaluate_alone(&mut node, kind, &mut faults);
    complete::fill(&mut node, kind)?;
    let table = walk::table(Item::of(key, &node, kind), &mut faults);
    let read = table.and_then(|table| read(&table, &mut faults));
    read.filter(|_| faults.len() == 0).ok_or_else(|| faults.error())
}
