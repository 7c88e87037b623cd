//! Gathers a run for a page: a manifest in JSON, numbers in packed arrays.

use std::path::Path;

use emmy::body::FieldName;
use serde_json::{Value, json};

use super::collection::FrameSource;
use super::history::Thinned;
use super::loads::{is_driven, loads};
use super::pack::Pack;
use super::{ReportError, Room, events, frames};
use crate::comparison::{self, RunError};
use crate::directory::FILES;
use crate::units::{UnitSystem, Units};
use crate::whole_file;

/// Name of a run in a page, and the link to its directory.
#[derive(Debug, Clone, Default)]
pub(super) struct RunLink {
    /// Name; `None`: the name of the directory.
    pub(super) name: Option<String>,
    /// Link to the directory with a final slash; empty for the directory of the page.
    pub(super) href: String,
}

/// A run, gathered from its directory.
#[derive(Debug)]
pub(super) struct RunData {
    /// Name in the page.
    pub(super) name: String,
    /// Everything but the arrays.
    pub(super) manifest: Value,
    /// The packed arrays.
    pub(super) arrays: String,
}

impl RunData {
    /// Gathers a run. Only history and summary are required.
    pub(super) fn gather(directory: &Path, link: RunLink, room: Room) -> Result<Self, ReportError> {
        comparison::check(directory)?;
        let mut frames = FrameSource::find(directory);
        let times = frames.as_ref().map_or(&[][..], |(_, frames)| frames.times());
        let history =
            Thinned::read(&directory.join("history.csv"), room.rows, times).map_err(RunError::from)?;
        frames.iter_mut().for_each(|(_, frames)| frames.set_steps(&history.steps));
        let summary = comparison::summary(directory)?;
        let name = link.name.unwrap_or_else(|| name_of(directory));
        let input = whole_file::read_text(&directory.join("input.toml")).unwrap_or_default();
        let tree: toml::Table = input.parse().unwrap_or_default();
        let mut pack = Pack::default();
        let columns = history.pack(&mut pack);
        history.pack_newton(&directory.join("newton.csv"), &mut pack);
        let (collection, frames) = frames.unzip();
        let frames = frames
            .map(|frames| frames::gather(&frames, &tree, room.frame_bytes, &mut pack))
            .transpose()?
            .flatten();
        let (places, arrays) = pack.finish();
        let (events, more_events) = events::read(&directory.join("events.csv"));
        let files = FILES.iter().chain(&["input.toml"]).map(|file| file.to_string()).chain(collection);
        let is_there = |file: &String| {
            directory.join(file).is_file() && (file != "report.html" || !link.href.is_empty())
        };
        let units = units(directory, &tree);
        let manifest = json!({
            "name": name,
            "units": units,
            "href": link.href,
            "summary": summary,
            "input": shortened(input),
            "loads": loads(&tree),
            "is_driven": is_driven(&tree),
            "relative_to": frames_of_reference(&tree),
            "events": events,
            "more_events": more_events,
            "probes": names(&tree, "probes"),
            "values": names(&tree, "values"),
            "joints": joints(&tree),
            "rigid": rigid_bodies(&tree).into_iter().map(|(name, _)| name).collect::<Vec<_>>(),
            "files": files.filter(is_there).collect::<Vec<_>>(),
            "history": columns,
            "frames": frames,
            "arrays": places,
        });
        Ok(RunData { name, manifest, arrays })
    }
}

/// Units of a run that has a system: `system` with the units of all quantities, `columns` and `fields` with the unit of
/// each by its name; `null` without a system.
pub(super) fn units(directory: &Path, input: &toml::Table) -> Value {
    let system = input.get("units").and_then(|units| units.get("system")?.as_str());
    let Some(system) = system.and_then(UnitSystem::named) else { return Value::Null };
    let columns = whole_file::read_text(&directory.join("columns.json")).unwrap_or_default();
    let columns: Vec<Value> = serde_json::from_str(&columns).unwrap_or_default();
    let columns =
        columns.iter().filter_map(|own| Some((own["column"].as_str()?.to_string(), own["unit"].clone())));
    let fields =
        FieldName::ALL.map(|field| (field.name().to_string(), system.unit(field.dimension()).into()));
    json!({
        "system": Units::from(system).json(),
        "columns": Value::Object(columns.collect()),
        "fields": Value::Object(fields.into_iter().collect()),
    })
}

/// Name of a directory, also of `.`.
pub(super) fn name_of(directory: &Path) -> String {
    let whole = directory.canonicalize().unwrap_or_else(|_| directory.to_path_buf());
    whole.file_name().map_or_else(|| whole.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Largest number of bytes of the input in a page.
const MAX_INPUT: usize = 100_000;

/// Cuts an input that is too long for a page.
pub(super) fn shortened(mut input: String) -> String {
    let length = input.len();
    if length > MAX_INPUT {
        let end = (0..=MAX_INPUT).rev().find(|&end| input.is_char_boundary(end));
        input.truncate(end.unwrap_or(0));
        input += &format!("\n...\n# This is the beginning; all {length} bytes are in input.toml.\n");
    }
    input
}

/// Names, kinds and places of the joints.
fn joints(input: &toml::Table) -> Vec<Value> {
    let own = |(number, table): (usize, &toml::Table)| {
        let name = table.get("name").and_then(toml::Value::as_str);
        let name = name.map_or_else(|| format!("joint-{number}"), str::to_string);
        let kind = table.iter().find(|(_, value)| value.get("between").is_some());
        let places = kind.map(|(_, keys)| places(input, keys)).unwrap_or_default();
        json!({ "name": name, "kind": kind.map(|(key, _)| key), "places": places })
    };
    (1..).zip(tables(input, "joint")).map(own).collect()
}

/// The places of a joint, each with what it moves with: the centre of a rigid body, the ground, or a node.
fn places(input: &toml::Table, joint: &toml::Value) -> Vec<Value> {
    let bodies = joint.get("between").and_then(toml::Value::as_array).map_or(&[][..], Vec::as_slice);
    let place = |body: &toml::Value, at: &toml::Value| {
        let rigid = rigid_bodies(input).into_iter().find(|(name, _)| body.as_str() == Some(name));
        let is_ground = body.as_str() == Some("ground");
        json!({ "at": at, "centre": rigid.and_then(|(_, centre)| centre), "ground": is_ground })
    };
    match (joint.get("at"), joint.get("points").and_then(toml::Value::as_array)) {
        (Some(at), _) => {
            let moved = bodies.iter().find(|body| body.as_str() != Some("ground"));
            moved.map(|body| place(body, at)).into_iter().collect()
        }
        (None, Some(points)) => bodies.iter().zip(points).map(|(body, at)| place(body, at)).collect(),
        _ => Vec::new(),
    }
}

/// Names of the rigid bodies, with their centres where the input has them: those of couplings and masses, too.
fn rigid_bodies(input: &toml::Table) -> Vec<(String, Option<&toml::Value>)> {
    let text = |table: &toml::Table, key: &str| Some(table.get(key)?.as_str()?.to_string());
    let rigid = tables(input, "rigid").into_iter();
    let rigid = rigid.filter_map(|table| Some((text(table, "name")?, table.get("centre"))));
    let couplings =
        tables(input, "coupling").into_iter().filter(|table| text(table, "kind").as_deref() == Some("rigid"));
    let couplings = couplings.filter_map(|table| Some((text(table, "name")?, table.get("point"))));
    let masses = (1..).zip(tables(input, "mass")).filter_map(|(number, table)| {
        let at = table.get("at").filter(|_| text(table, "coupling").as_deref() != Some("distributing"))?;
        Some((text(table, "name").unwrap_or_else(|| format!("mass-{number}")), Some(at)))
    });
    rigid.chain(couplings).chain(masses).collect()
}

/// The tables of a section: a list, or one alone.
pub(super) fn tables<'a>(input: &'a toml::Table, section: &str) -> Vec<&'a toml::Table> {
    match input.get(section) {
        Some(toml::Value::Array(all)) => all.iter().filter_map(toml::Value::as_table).collect(),
        Some(toml::Value::Table(table)) => vec![table],
        _ => Vec::new(),
    }
}

/// Frames of reference: of all quantities, and of probes with one of their own by their names.
fn frames_of_reference(input: &toml::Table) -> Value {
    let frame =
        |table: &toml::Table| table.get("relative_to").and_then(toml::Value::as_str).map(str::to_string);
    let output = input.get("output").and_then(toml::Value::as_table);
    let probes = output.and_then(|output| output.get("probes")?.as_array());
    let probes = probes.into_iter().flatten().filter_map(toml::Value::as_table);
    let own =
        probes.filter_map(|probe| Some((probe.get("name")?.as_str()?.to_string(), frame(probe)?.into())));
    json!({ "all": output.and_then(frame), "probes": Value::Object(own.collect()) })
}

/// Names of the entries of a list in `[output]`.
fn names<'a>(input: &'a toml::Table, key: &str) -> Vec<&'a str> {
    let list = input.get("output").and_then(|output| output.get(key)?.as_array());
    list.into_iter().flatten().filter_map(|entry| entry.get("name")?.as_str()).collect()
}
