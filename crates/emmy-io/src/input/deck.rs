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
use crate::mesh::{DeckEntry, MeshFile};

/// Reads the mesh file of an input and inserts what it has besides the mesh, but for what is left out. `None` without a
/// file, and with one that is not right, whose faults are found later.
pub(super) fn insert(tree: &mut Node, directory: &Path) -> Option<MeshFile> {
    let (shape, file) = read(tree, directory)?;
    let scale = shape.scale().unwrap_or(1.0);
    let left_out: Vec<String> = shape.left_out().iter().map(|(name, _)| name.clone()).collect();
    let from = shape.absolute_file()?;
    let from = from.file_name().unwrap_or_default().to_string_lossy().into_owned();
    for entry in file.entries.iter().filter(|entry| !left_out.contains(&entry.name)) {
        let (_, section) = catalogue::kind_of(entry.section)?;
        let place = Place::of_path(&format!("{from}: {}", entry.card));
        let mut node = node(&toml::Value::Table(entry.table.clone()), &place);
        scale_lengths(&mut node, section, scale);
        complete::fill(&mut node, section).ok()?;
        append(tree, entry.section, node);
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

/// Checks that what is left out is in the file.
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
    let message = format!("several ranks do not compute {} of the mesh file", entry.card);
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

/// Multiplies lengths by a factor, and moments of inertia by its square.
fn scale_lengths(table: &mut Node, section: &'static Section, factor: f64) {
    if factor == 1.0 {
        return;
    }
    for key in &section.keys {
        let Some(node) = table.get_mut(key.name) else { continue };
        match (key.kind.section(), key.unit) {
            (Some(inner), _) => scale_lengths(node, inner, factor),
            (None, "length") => scale(node, factor),
            (None, "mass·length²") => scale(node, factor * factor),
            (None, _) => {}
        }
    }
}

fn scale(node: &mut Node, factor: f64) {
    match &mut node.value {
        Value::Float(value) => *value *= factor,
        Value::Integer(value) => node.value = Value::Float(*value as f64 * factor),
        Value::Array(items) => items.iter_mut().for_each(|item| scale(item, factor)),
        _ => {}
    }
}
