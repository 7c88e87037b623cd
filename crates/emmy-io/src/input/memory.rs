//! Inputs that a program builds: the words of the input file in a tree, with a mesh and functions in memory.

use std::path::Path;
use std::sync::Arc;

use emmy::body::{Field, Region, TimeFunction};
use emmy::mesh::Mesh;

use super::description::Section;
use super::fault::{Fault, InputError, Place};
use super::history::Context;
use super::source::Source;
use super::table::Item;
use super::tree::{Entry, Node, Value};
use super::{Overrides, Problem, adaptive, complete, initial, load, material, nodal, read, region, support};

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
/// let error = input::build(&tree("dgm"), &Overrides::default(), Some(&problem)).unwrap_err();
/// assert!(error.to_string().starts_with("time.scheme: "));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`InputError`] with every fault; its places are paths ([`Place::path`]).
pub fn build(tree: &Tree, overrides: &Overrides, known: Option<&Problem>) -> Result<Problem, InputError> {
    read::of_tree(Ok(tree.node("")), Path::new(NAME), overrides, Source::Alone(known))
}

/// The file that an input in memory would have: it gives the default of `output.directory`.
const NAME: &str = "emmy-run.toml";

/// The region of a material alone, with density 1: its energy, stress and moduli.
///
/// # Errors
/// [`InputError`] with the first fault, whose place is a path in the table.
pub fn material_region(tree: &Tree) -> Result<Region, InputError> {
    let mut node = tree.node("");
    complete::fill(&mut node, &material::MATERIAL)?;
    Ok(material::region(Item::of("material", &node), 1.0)?)
}

/// Checks a table of a section alone: its keys, kinds and ranges. Groups and the mesh are not looked for. Sections:
/// `region`, `material`, `viscosity`, `load`, `support`, `mass`, `initial`, `adaptive`.
///
/// ```
/// use emmy_io::input::{Tree, check};
/// let density = Tree::Table(vec![("density".into(), Tree::Number(-1.0))]);
/// let error = check("region", &density).unwrap_err().to_string();
/// assert!(error.contains("`material` is missing"), "{error}");
/// ```
///
/// # Errors
/// [`InputError`] with the first fault, whose place is a path in the table.
pub fn check(section: &str, tree: &Tree) -> Result<(), InputError> {
    type Read = fn(Item<'_>, Context<'_>) -> Result<(), Fault>;
    let (described, read): (&'static Section, Read) = match section {
        "region" => (&region::REGION, |item, _| region::read(item).map(drop)),
        "material" => (&material::MATERIAL, |item, _| material::region(item, 1.0).map(drop)),
        "viscosity" => (&region::VISCOSITY, |item, _| region::viscosity(item, None).map(drop)),
        "load" => (&load::LOAD, |item, context| load::read(item, context).map(drop)),
        "support" => (&support::SUPPORT, |item, context| match nodal::is_spring_alone(&item) {
            true => nodal::check_spring(item),
            false => support::read(item, context).map(drop),
        }),
        "mass" => (&nodal::MASS, |item, _| nodal::check_mass(item)),
        "initial" => (&initial::INITIAL, |item, _| initial::read(item).map(drop)),
        "adaptive" => (&adaptive::ADAPTIVE, |item, _| adaptive::check(&item)),
        other => return Err(Fault::new(format!("`{other}` is not a section of the input")).into()),
    };
    let mut node = tree.node("");
    complete::fill(&mut node, described)?;
    Ok(read(Item::of(section, &node), Context { directory: Path::new(""), end: 1.0 })?)
}
