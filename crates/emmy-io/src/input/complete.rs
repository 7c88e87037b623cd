//! Completes the tree: defaults of missing keys, and results of the reading.

use std::path::{Path, PathBuf};

use emmy::internals::material::IfAbsent;
use emmy::motion::{Phase, StepPlan};

use super::Start;
use super::catalogue::ROOT_KIND;
use super::description::{Kind, Section, for_each_value};
use super::fault::{InputError, Place};
use super::measured::MEASURED;
use super::shape::MeshPath;
use super::tree::{self, Node, Value};
use crate::{link, message};

/// Inserts the defaults of missing keys.
pub(super) fn fill_defaults(tree: &mut Node) -> Result<(), InputError> {
    // Frames by time replace frames by steps.
    let by_time = tree
        .get_mut("output")
        .is_some_and(|own| own.get_mut("interval").is_some() && own.get_mut("every").is_none());
    fill(tree, &ROOT_KIND)?;
    let output = tree.get_mut("output").filter(|_| by_time);
    output
        .and_then(Node::entries_mut)
        .into_iter()
        .for_each(|entries| entries.retain(|entry| entry.key != "every"));
    Ok(())
}

/// Inserts the defaults of the missing keys of a table and of the tables in it; their place is that of their table.
pub(super) fn fill(own: &mut Node, kind: &'static Kind) -> Result<(), InputError> {
    let mut result = Ok(());
    for_each_table(own, kind, &mut |table, section| {
        for key in &section.keys {
            let (None, IfAbsent::Value(value)) = (table.get_mut(key.name), key.if_absent) else { continue };
            match tree::parse("defaults", &format!("{} = {value}", key.name)) {
                Ok(mut default) => {
                    let place = table.place.clone();
                    let default = default.get_mut(key.name).map(|node| Node { place, ..node.clone() });
                    default.into_iter().for_each(|node| table.put(key.name, node));
                }
                Err(error) => result = Err(error),
            }
        }
    });
    result
}

/// Visits a table and the tables in it with their descriptions, each before those in it.
fn for_each_table(node: &mut Node, kind: &'static Kind, visit: &mut impl FnMut(&mut Node, &'static Section)) {
    for_each_value(node, kind, &mut |node, kind| {
        if let (Kind::Table(section) | Kind::TimeFunction(section), Value::Table(_)) = (kind, &node.value) {
            visit(node, section);
        }
    });
}

/// Replaces characters of the title that a file cannot hold, with a remark.
pub(super) fn clean_title(tree: &mut Node) -> Option<String> {
    let Value::String(title) = &mut tree.get_mut("title")?.value else { return None };
    let note = message::note_on_name(title).map(|note| note.replacen("the name", "the title", 1));
    *title = message::name(title).into_owned();
    note
}

/// Inserts the directory of the command line, else of the file, else the name of the file; returns it if it differs
/// from the directory of the file.
pub(super) fn fill_directory(tree: &mut Node, path: &Path, asked: Option<&Path>) -> Option<PathBuf> {
    let place = tree.place.clone();
    let output = tree.get_mut("output")?;
    let stem = path.file_stem().map(PathBuf::from);
    let missing = output.get_mut("directory").is_none();
    let directory = asked.map(PathBuf::from).or(stem.filter(|_| missing));
    if let Some(directory) = &directory {
        output.put("directory", string(&directory.to_string_lossy(), &place));
    }
    directory
}

/// Makes the files of histories absolute, or else relative to the output directory, and returns their paths.
pub(super) fn resolve_histories(tree: &mut Node, directory: &Path, output: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for_each_table(tree, &ROOT_KIND, &mut |table, section| {
        let Some(Node { value: Value::String(name), .. }) =
            table.get_mut("file").filter(|_| std::ptr::eq(section, &*MEASURED))
        else {
            return;
        };
        let file = directory.join(&*name);
        let absolute = std::path::absolute(&file).unwrap_or_else(|_| file.clone());
        *name = spellable(absolute, output).to_string_lossy().into_owned();
        files.push(file);
    });
    files
}

/// File of a mesh in memory, in the output directory.
pub(crate) const MESH_FILE: &str = "mesh.vtu";

/// Replaces what no text can hold: a mesh by the name of its file, functions by their names.
pub(super) fn spell(node: &mut Node) {
    let place = node.place.clone();
    match &mut node.value {
        Value::Array(items) => items.iter_mut().for_each(spell),
        Value::Table(entries) => entries.iter_mut().for_each(|entry| spell(&mut entry.node)),
        Value::Mesh(_) => {
            node.value = Value::Table(Vec::new());
            node.put("file", string(MESH_FILE, &place));
        }
        Value::TimeFunction(function) => match function.text() {
            Some(text) => *node = string(name(text), &place),
            None => {
                let of = |value: Value| Node { value, place: place.clone() };
                let number = |value: f64| of(Value::Float(value));
                let pair = |&(time, value): &(f64, f64)| of(Value::Array(vec![number(time), number(value)]));
                node.value = Value::Array(function.entries().iter().map(pair).collect());
            }
        },
        Value::Field(field) => *node = string(name(field.text()), &place),
        Value::String(_) | Value::Integer(_) | Value::Float(_) | Value::Boolean(_) | Value::Datetime(_) => {}
    }
}

/// The name of a function: its text up to the last bracket, behind which a program may tell functions of one name
/// apart.
fn name(text: &str) -> &str {
    text.rfind('>').map_or(text, |end| &text[..=end])
}

/// The path of a mesh file as text: absolute, or else relative to the output directory, which holds the text.
pub(super) fn spellable(file: PathBuf, output: &Path) -> PathBuf {
    if file.to_str().is_some() {
        return file;
    }
    let way = link::relative(output, &file);
    let way = way.trim_end_matches('/');
    let is_whole = !way.contains(char::REPLACEMENT_CHARACTER) && !way.starts_with("file:");
    if is_whole { PathBuf::from(way) } else { file }
}

/// A text at a place.
pub(super) fn string(text: &str, place: &Place) -> Node {
    Node { value: Value::String(text.to_string()), place: place.clone() }
}

/// Puts the results of the reading back into the tree: the paths of meshes and of another run, the plan.
pub(super) fn resolve(
    tree: &mut Node,
    mesh_files: &[MeshPath],
    start: &Start,
    plan: &StepPlan,
) -> Result<(), InputError> {
    let place = tree.place.clone();
    if let (Start::Run(directory), Some(initial)) = (start, tree.get_mut("initial")) {
        let absolute = std::path::absolute(directory).unwrap_or_else(|_| directory.clone());
        initial.put_in_first("state", string(&absolute.to_string_lossy(), &place));
    }
    for MeshPath { part, file } in mesh_files {
        let Some(mesh) = tree.get_mut("mesh") else { continue };
        let text = string(&file.to_string_lossy(), &place);
        match part {
            None => mesh.put("file", text),
            Some(part) => {
                let Some(Node { value: Value::Array(parts), .. }) = mesh.get_mut("parts") else { continue };
                parts.iter_mut().skip(*part).take(1).for_each(|own| own.put("file", text.clone()));
            }
        }
    }
    if plan.adaptivity().is_some() {
        let end = tree::parse("until", &format!("until = {:?}", plan.end()))?;
        if let (Value::Table(entries), Some(time)) = (end.value, tree.get_mut("time")) {
            entries.into_iter().for_each(|entry| time.put(&entry.key, entry.node));
        }
        return Ok(());
    }
    let phase = |phase: &Phase| format!("{{ until = {:?}, size = {:?} }}", phase.until, phase.size);
    let phases: Vec<String> = plan.phases().iter().map(phase).collect();
    let mut steps = tree::parse("steps", &format!("steps = [{}]", phases.join(", ")))?;
    if let (Some(steps), Some(time)) = (steps.get_mut("steps"), tree.get_mut("time")) {
        time.put("steps", steps.clone());
    }
    Ok(())
}
