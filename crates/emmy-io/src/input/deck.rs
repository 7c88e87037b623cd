//! Rigid elements, ties, masses, springs and joints of a mesh file, as tables of the input.

use std::path::Path;

use emmy::mesh::{Mesh, Placement};

use super::catalogue::{self, ROOT_KIND};
use super::complete;
use super::description::{Kind, Section};
use super::fault::{Fault, Faults, Place};
use super::rigid::GROUND;
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
    let from = match &shape.files()[..] {
        [one] => one.file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        _ => "mesh.parts".to_string(),
    };
    let (acting, notes) = acting_entries(&file.entries, &file.mesh, &left_out);
    file.notes.extend(notes);
    for entry in acting {
        let kind = catalogue::kind_of(&entry.section)?;
        let place = Place::of_path(&format!("{from}: {}", entry.card()));
        let mut node = node(&toml::Value::Table(entry.table.clone()), &place);
        complete::fill(&mut node, kind).ok()?;
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
    if shape.files().is_empty() {
        return None;
    }
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
        if let Some(section) = catalogue::kind_of(&self.section).and_then(Kind::section) {
            scale_lengths(&mut self.table, section, factor);
        }
        self
    }

    /// The same at another place: points are moved, directions and inertias are turned.
    ///
    /// ```
    /// use emmy::mesh::Placement;
    /// use emmy_io::mesh::DeckEntry;
    /// let [name, section, kind, label] = ["m", "rigid", "CONM2", "1"].map(String::from);
    /// let words = ["mass acts", "masses act"].map(String::from);
    /// let table = "name = 'm'\nmass = 2.0\ncentre = [10, 0, 0.5]\ninertia = [1, 2, 3]".parse().unwrap();
    /// let own = DeckEntry { name, section, kind, label, words, table };
    /// let turn = Placement::default().turned([0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2, [0.0; 3])?;
    /// let table = own.placed(&turn.shifted([1.0, 0.0, 0.0])).table;
    /// assert_eq!(table["centre"].to_string(), "[1.0, 10.0, 0.5]");
    /// assert_eq!(table["inertia"][0].to_string(), "[2.0, 0.0, 0.0]");
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn placed(mut self, placement: &Placement) -> Self {
        if let Some(section) = catalogue::kind_of(&self.section).and_then(Kind::section) {
            place_vectors(&mut self.table, section, placement);
        }
        self
    }

    /// The same in a mesh that has its own mesh as a part: its names and groups have the name of the part before them.
    pub(crate) fn in_part(mut self, part: &str, mesh: &Mesh) -> Self {
        let renamed = |name: &str| match name {
            GROUND => name.to_string(),
            _ => mesh.groups().name_in_part(part, mesh.n_cells(), name),
        };
        let name_of = |text: &str| {
            // `cells:NAME` means the cells of a group, unless a group itself has such a name.
            let chosen = text.split_once(':').filter(|(kind, _)| ["cells", "facets", "nodes"].contains(kind));
            match chosen.filter(|_| !mesh.groups().names().contains(&text)) {
                Some((kind, name)) => format!("{kind}:{}", renamed(name)),
                None => renamed(text),
            }
        };
        rename(&mut self.table, &name_of);
        self.name = format!("{part}-{}", self.name);
        self.label = format!("{} of part {part}", self.label);
        self
    }
}

/// Keys whose values are names of groups, bodies or entries.
const NAMES: [&str; 5] = ["name", "group", "follower", "leader", "between"];

fn rename(table: &mut toml::Table, name_of: &dyn Fn(&str) -> String) {
    for (key, value) in table.iter_mut() {
        match value {
            toml::Value::Table(inner) => rename(inner, name_of),
            toml::Value::String(text) if NAMES.contains(&key.as_str()) => *text = name_of(text),
            toml::Value::Array(items) if NAMES.contains(&key.as_str()) => {
                for item in items {
                    if let toml::Value::String(text) = item {
                        *text = name_of(text);
                    }
                }
            }
            _ => {}
        }
    }
}

fn place_vectors(table: &mut toml::Table, section: &'static Section, placement: &Placement) {
    for key in &section.keys {
        match (table.get_mut(key.name), key.kind.section()) {
            (Some(toml::Value::Table(inner)), Some(section)) => place_vectors(inner, section, placement),
            (Some(value), _) if key.unit == "length" => {
                for_each_vector(value, &|own| placement.point(own));
            }
            (Some(value), _) if ["axis", "axes"].contains(&key.name) => {
                for_each_vector(value, &|own| placement.direction(own));
            }
            (Some(value), _) if key.unit == "mass·length²" => {
                if let Some(inertia) = tensor(value) {
                    let turned = placement.tensor(inertia);
                    // Rounding must not make it unsymmetric.
                    let of_row = |i: usize| [0, 1, 2].map(|j| turned[i.min(j)][i.max(j)]);
                    *value = toml::Value::Array([0, 1, 2].map(|i| vector(of_row(i))).to_vec());
                }
            }
            _ => {}
        }
    }
}

/// Changes a vector, or each vector of a list.
fn for_each_vector(value: &mut toml::Value, change: &dyn Fn([f64; 3]) -> [f64; 3]) {
    if let Some(own) = numbers(value) {
        *value = vector(change(own));
    } else if let toml::Value::Array(items) = value {
        items.iter_mut().for_each(|item| for_each_vector(item, change));
    }
}

/// An inertia given by its principal moments along the axes, or by its rows.
fn tensor(value: &toml::Value) -> Option<[[f64; 3]; 3]> {
    if let Some([x, y, z]) = numbers(value) {
        return Some([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]);
    }
    value.as_array()?.iter().map(numbers).collect::<Option<Vec<_>>>()?.try_into().ok()
}

/// Three numbers.
fn numbers(value: &toml::Value) -> Option<[f64; 3]> {
    let number = |value: &toml::Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
    value.as_array()?.iter().map(number).collect::<Option<Vec<f64>>>()?.try_into().ok()
}

fn vector(numbers: [f64; 3]) -> toml::Value {
    toml::Value::Array(numbers.map(toml::Value::Float).to_vec())
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
