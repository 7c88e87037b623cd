//! Rigid elements, ties, masses, springs and joints of a mesh file, as tables of the input.

use std::path::Path;

use super::catalogue::{self, ROOT_KIND};
use super::complete;
use super::description::Section;
use super::fault::{Fault, Faults, Place};
use super::root::Root;
use super::shape::{self, Shape};
use super::suggest::{did_you_mean, listed};
use super::table::{Item, Table};
use super::tree::{Entry, Node, Value};
use super::walk;
use crate::mesh::{DeckEntry, MeshFile, acting_entries};

/// Reads the mesh file of an input, inserts the entries that act, and adds notes on them. `None` without a file, and
/// with a wrong one, whose faults are found later.
pub(super) fn insert(tree: &mut Node, directory: &Path) -> Option<MeshFile> {
    let (shape, mut file) = read(tree, directory)?;
    let left_out: Vec<String> = shape.left_out().iter().map(|(name, _)| name.clone()).collect();
    let from = shape.absolute_file()?;
    let from = from.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let (acting, notes) = acting_entries(&file.entries, &file.mesh, &left_out);
    file.notes.extend(notes);
    for entry in acting {
        let (_, section) = catalogue::kind_of(&entry.section)?;
        let place = Place::of_path(&format!("{from}: {}", entry.card()));
        let mut node = node(&toml::Value::Table(entry.table.clone()), &place);
        complete::fill(&mut node, section).ok()?;
        append(tree, &entry.section, node);
    }
    Some(file)
}

/// Records in a resolved input that the entries of its mesh file stand in the input itself.
pub(super) fn leave_out_all(tree: &mut Node, file: &MeshFile) {
    let Some(mesh) = tree.get_mut("mesh").filter(|_| !file.entries.is_empty()) else { return };
    let place = mesh.place.clone();
    let name = |entry: &DeckEntry| Node { value: Value::String(entry.name.clone()), place: place.clone() };
    let names = file.entries.iter().map(name).collect();
    mesh.put("leave_out", Node { value: Value::Array(names), place: place.clone() });
}

/// Checks that the file has the entries that `mesh.leave_out` names.
pub(super) fn check_left_out(shape: &Shape, file: &MeshFile, faults: &mut Faults) {
    let names = || file.entries.iter().map(|entry| entry.name.as_str());
    for (name, place) in shape.left_out() {
        if names().any(|own| own == name) {
            continue;
        }
        let message = format!("`leave_out`: the mesh has nothing that is named `{name}`");
        let label = did_you_mean(name, names()).unwrap_or("not there".into());
        let known = match file.entries.is_empty() {
            true => "it has a mesh alone".to_string(),
            false => format!("there is {}", listed(names())),
        };
        faults.push(Fault::at(place, message, label).help(known));
    }
}

/// Checks that nothing acts that was not inserted, as on several ranks.
pub(super) fn check_unused(shape: &Shape, file: &MeshFile) -> Result<(), Fault> {
    let is_left_out = |entry: &DeckEntry| shape.left_out().iter().any(|(name, _)| *name == entry.name);
    let Some(entry) = file.entries.iter().find(|entry| !is_left_out(entry)) else { return Ok(()) };
    let message = format!("several ranks do not compute {} of the mesh file", entry.card());
    let help = format!("take threads: `--threads`; or leave it out: `mesh.leave_out = [\"{}\"]`", entry.name);
    Err(Fault::at(shape.place(), message, "from here").help(help))
}

fn read(tree: &Node, directory: &Path) -> Option<(Shape, MeshFile)> {
    let mut faults = Faults::default();
    let table = walk::root(Item::of("input", tree, &ROOT_KIND), &mut faults)?;
    let mesh = table.item("mesh").filter(|mesh| matches!(mesh.value(), Value::Table(_)))?;
    let mesh: Table<'_> = walk::table(mesh, &mut faults)?;
    let shape = shape::read(&mesh, directory).ok()?;
    shape.absolute_file()?;
    let links = Root { table, faults }.link_groups();
    let file = shape.mesh(&links).ok()?;
    Some((shape, file))
}

fn append(tree: &mut Node, key: &str, node: Node) {
    if tree.get_mut(key).is_none() {
        let place = node.place.clone();
        tree.put(key, Node { value: Value::Array(Vec::new()), place });
    }
    let Some(section) = tree.get_mut(key) else { return };
    match &mut section.value {
        Value::Array(items) => items.push(node),
        // A single table in the place of a list.
        Value::Table(_) => {
            let first = section.clone();
            section.value = Value::Array(vec![first, node]);
        }
        _ => {}
    }
}

fn node(value: &toml::Value, place: &Place) -> Node {
    let entry = |(key, value): (&String, &toml::Value)| Entry {
        key: key.clone(),
        place: place.clone(),
        node: node(value, place),
    };
    let value = match value {
        toml::Value::String(text) => Value::String(text.clone()),
        toml::Value::Integer(value) => Value::Integer(*value),
        toml::Value::Float(value) => Value::Float(*value),
        toml::Value::Boolean(value) => Value::Boolean(*value),
        toml::Value::Datetime(date) => Value::Datetime(date.to_string()),
        toml::Value::Array(items) => Value::Array(items.iter().map(|item| node(item, place)).collect()),
        toml::Value::Table(table) => Value::Table(table.iter().map(entry).collect()),
    };
    Node { value, place: place.clone() }
}

impl DeckEntry {
    /// The same with all lengths multiplied by a factor, and moments of inertia by its square; masses, times and so
    /// forces over lengths stay.
    ///
    /// ```
    /// use emmy_io::mesh::DeckEntry;
    /// let [name, section, kind, label] = ["m", "rigid", "CONM2", "1"].map(String::from);
    /// let words = ["mass acts", "masses act"].map(String::from);
    /// let table = "name = 'm'\nmass = 2.0\ncentre = [10, 0, 0.5]".parse().unwrap();
    /// let scaled = DeckEntry { name, section, kind, label, words, table }.scaled(0.001).table;
    /// assert_eq!((scaled["mass"].as_float(), scaled["centre"][0].as_float()), (Some(2.0), Some(0.01)));
    /// ```
    pub fn scaled(mut self, factor: f64) -> Self {
        if let Some((_, section)) = catalogue::kind_of(&self.section) {
            scale_lengths(&mut self.table, section, factor);
        }
        self
    }
}

fn scale_lengths(table: &mut toml::Table, section: &'static Section, factor: f64) {
    for key in &section.keys {
        match (table.get_mut(key.name), key.kind.section(), key.unit) {
            (Some(toml::Value::Table(inner)), Some(section), _) => scale_lengths(inner, section, factor),
            (Some(value), _, "length") => scale(value, factor),
            (Some(value), _, "mass·length²") => scale(value, factor * factor),
            _ => {}
        }
    }
}

fn scale(value: &mut toml::Value, factor: f64) {
    match value {
        toml::Value::Float(value) => *value *= factor,
        toml::Value::Integer(whole) => *value = toml::Value::Float(*whole as f64 * factor),
        toml::Value::Array(items) => items.iter_mut().for_each(|item| scale(item, factor)),
        _ => {}
    }
}
