//! `summary.json`: the results of a run in one JSON object.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use emmy::body::FieldName;
use emmy::motion::RunStatistics;
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::accuracy::Accuracy;
use crate::history::{Extreme, HIDDEN, Peaks, RESIDUAL};
use crate::input::Problem;
use crate::units::Units;
use crate::whole_file::{self, replace};

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// It has not ended; a killed run leaves this status.
    Running,
    /// It reached the end of the plan.
    Done,
    /// A step did not converge.
    NoConvergence,
    /// A limit of `[limits]` was exceeded.
    LimitExceeded,
    /// It was stopped by a signal, with a checkpoint.
    Interrupted,
    /// Another error ended it.
    Failed,
}

impl Status {
    /// The word in the file.
    pub const fn name(self) -> &'static str {
        match self {
            Status::Running => "running",
            Status::Done => "done",
            Status::NoConvergence => "no-convergence",
            Status::LimitExceeded => "limit-exceeded",
            Status::Interrupted => "interrupted",
            Status::Failed => "failed",
        }
    }
}

/// Fewer correct digits than these cause a warning.
pub const FEW_DIGITS: f64 = 6.0;

/// Warnings about the results of a run.
///
/// ```
/// use emmy::motion::RunStatistics;
/// use emmy_io::summary::warnings;
/// let sound = RunStatistics { steps: 10, ..Default::default() };
/// assert!(warnings(&sound).is_empty());
/// let missed = warnings(&RunStatistics { unresolved_loads: 2, ..sound });
/// assert!(missed[0].starts_with("2 of 10 steps did not resolve a load or a given motion"));
/// ```
pub fn warnings(statistics: &RunStatistics) -> Vec<String> {
    let mut warnings = Vec::new();
    let digits = statistics.digits_left();
    if digits < FEW_DIGITS {
        warnings.push(format!(
            "rounding leaves {digits:.1} correct digits of energy and momenta: the body is very stiff for steps of this size"
        ));
    }
    if statistics.unresolved_loads > 0 {
        let (missed, steps) = (statistics.unresolved_loads, statistics.steps);
        warnings.push(format!(
            "{missed} of {steps} steps did not resolve a load or a given motion; the first one is in the events"
        ));
    }
    if statistics.unresolved_turns > 0 {
        let (missed, steps) = (statistics.unresolved_turns, statistics.steps);
        warnings.push(format!(
            "a rigid body turned further in {missed} of {steps} steps than they can follow: take smaller ones, or a \
             higher degree"
        ));
    }
    warnings
}

/// The part of a summary that is known before the run starts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SummaryHeader {
    version: &'static str,
    title: Option<String>,
    scheme: String,
    degree: usize,
    dofs: usize,
    nodes: usize,
    cells: usize,
    /// Number of the constraints of all joints; `None` without joints.
    #[serde(skip_serializing_if = "Option::is_none")]
    constraints: Option<usize>,
    /// `None` with adaptive steps.
    planned_steps: Option<usize>,
    /// Notes on the input.
    notes: Vec<String>,
    #[serde(skip)]
    units: Units,
}

impl SummaryHeader {
    /// The header of a problem.
    pub fn new(problem: &Problem) -> Self {
        let [nodes, cells] = problem.mesh_size();
        SummaryHeader {
            version: env!("CARGO_PKG_VERSION"),
            title: problem.title.clone(),
            scheme: problem.scheme.name(),
            degree: problem.scheme.degree(),
            dofs: problem.body.n_dofs_of_ranks(),
            nodes,
            cells,
            constraints: (!problem.joints.is_empty()).then(|| problem.body.n_constraints()),
            planned_steps: problem.plan.adaptivity().is_none().then(|| problem.plan.n_steps()),
            notes: problem.notes.clone(),
            units: problem.units,
        }
    }

    /// The summary as JSON: this header, the fields of the statistics by their names, the largest values of fields, and
    /// the end of the run. Numbers
    /// that are not finite become `null`.
    pub fn summary(
        &self,
        statistics: &RunStatistics,
        extremes: &[Extreme],
        status: Status,
        message: Option<&str>,
        wall_seconds: f64,
    ) -> Value {
        let mut summary = Map::new();
        insert_fields(&mut summary, "", &json!(self));
        let mut of_steps = json!(statistics);
        of_steps["solver"] = statistics.solver.map(|solver| solver.to_string()).into();
        let limits = statistics.step_limits.counts();
        of_steps["step_limits"] = limits.map(|(limit, count)| (limit.name().to_string(), count)).collect();
        insert_fields(&mut summary, "", &of_steps);
        if statistics.largest_contact_energy.is_some() && statistics.smallest_gap.is_none() {
            summary.insert("smallest_gap".to_string(), Value::Null);
        }
        let of_body = |own: &&Extreme| own.field != DISPLACEMENT && own.region.is_none();
        for extreme in extremes.iter().filter(of_body) {
            insert_fields(&mut summary, &format!("largest_{}", extreme.field), &place_of(extreme));
        }
        let of_regions: Vec<Value> = extremes.iter().filter_map(row_of).collect();
        if !of_regions.is_empty() {
            summary.insert("largest_in_regions".to_string(), of_regions.into());
        }
        let end = json!({
            "energy_drift": statistics.energy_drift(),
            "angular_momentum_drift": statistics.angular_momentum_drift(),
            "digits_left": (10.0 * statistics.digits_left()).floor() / 10.0,
            "estimated_error": null,
            "accuracy_in_time": null,
            "accuracy_in_time_text": null,
            "steps_per_lowest_period": null,
            "wall_seconds": wall_seconds,
            "status": status.name(),
            "message": message,
        });
        insert_fields(&mut summary, "", &end);
        summary.extend(self.units.json().map(|units| ("units".to_string(), units)));
        Value::Object(summary)
    }
}

/// Adds the statement on the accuracy in time.
pub(crate) fn add_accuracy(summary: &mut Value, accuracy: &Accuracy) {
    let Accuracy { kind, text, note, steps_per_period } = accuracy;
    summary["accuracy_in_time"] = kind.name().into();
    summary["accuracy_in_time_text"] = text.as_str().into();
    summary["steps_per_lowest_period"] = (*steps_per_period).into();
    if let (Some(note), Some(notes)) = (note, summary["notes"].as_array_mut()) {
        notes.push(note.as_str().into());
    }
}

/// Adds how well the constraints of joints and rigid bodies were kept, if there are any.
fn add_constraints(summary: &mut Value, peaks: &Peaks) {
    let columns = [(RESIDUAL, "worst_constraint_residual"), (HIDDEN, "largest_hidden_constraint")];
    for (column, name) in columns {
        if let Some(peak) = peaks.of_column(column) {
            summary[name] = peak.largest.into();
            summary[format!("{name}_time")] = peak.largest_time.into();
        }
    }
}

/// Adds the numbers of the columns after those of the whole body: `X`, `X_min`, `X_min_time`, `X_max`, `X_max_time`. A
/// field that is there already stays.
pub(crate) fn add_peaks(summary: &mut Value, peaks: &Peaks) {
    add_constraints(summary, peaks);
    if let Value::Object(fields) = summary {
        for (name, number) in peaks.numbers() {
            fields.entry(name).or_insert(number.into());
        }
    }
}

/// The field whose largest value is among the statistics.
const DISPLACEMENT: &str = FieldName::Displacement.name();

/// The largest value of a field with its place.
fn place_of(extreme: &Extreme) -> Value {
    let Extreme { value, step, time, member, is_cell, point, .. } = extreme;
    let kind = if *is_cell { "cell" } else { "node" };
    json!({ "value": value, "step": step, "time": time, kind: member, "point": point })
}

/// The largest value of a field in a region, which it names first.
fn row_of(extreme: &Extreme) -> Option<Value> {
    let mut row = Map::from_iter([
        ("region".to_string(), extreme.region.clone()?.into()),
        ("field".to_string(), extreme.field.clone().into()),
    ]);
    insert_fields(&mut row, "", &place_of(extreme));
    Some(Value::Object(row))
}

/// Inserts the fields of an object. Fields of an object inside it become `NAME_FIELD`, and its `value` becomes `NAME`.
fn insert_fields(summary: &mut Map<String, Value>, prefix: &str, fields: &Value) {
    for (name, value) in fields.as_object().into_iter().flatten() {
        let name = match (prefix, name.as_str()) {
            ("", name) => name.to_string(),
            (prefix, "value") => prefix.to_string(),
            (prefix, name) => format!("{prefix}_{name}"),
        };
        match value {
            Value::Object(_) => insert_fields(summary, &name, value),
            value => drop(summary.insert(name, value.clone())),
        }
    }
}

/// Replaces a summary. On a full disk it is overwritten in place, so that its status is true.
///
/// # Errors
/// Errors of the system.
pub fn write(path: &Path, summary: &Value) -> io::Result<()> {
    let mut running = running();
    put(path, &format!("{summary:#}\n"))?;
    running.retain(|own| own != path);
    if summary["status"] == Status::Running.name() {
        running.push(path.to_path_buf());
    }
    Ok(())
}

/// The summary in the directory of a run; null if none can be read there.
pub fn of_run(directory: &Path) -> Value {
    let text = whole_file::read_text(&directory.join("summary.json")).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

fn put(path: &Path, text: &str) -> io::Result<()> {
    replace(path, text.as_bytes()).or_else(|error| overwrite(path, text.as_bytes()).map_err(|_| error))
}

/// Overwrites a file without freeing its space.
fn overwrite(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).open(path)?;
    file.write_all(bytes)?;
    file.set_len(bytes.len() as u64)
}

/// Summaries of this process with the status `running`.
static RUNNING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn running() -> MutexGuard<'static, Vec<PathBuf>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sets the status of all running summaries before the process ends. Nothing is written to them afterwards.
pub fn abandon(status: Status, message: &str) {
    // A thread that is writing a summary may finish, but a thread that panicked while writing never will.
    for _ in 0..100 {
        if let Ok(mut running) = RUNNING.try_lock() {
            running.drain(..).for_each(|path| end(&path, status, message));
            // Other threads may still be running.
            return std::mem::forget(running);
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
}

/// Sets the status of one summary, if it is running.
pub(crate) fn abandon_one(path: &Path, status: Status, message: &str) {
    let mut running = running();
    let is_there = running.iter().any(|own| own == path);
    running.retain(|own| own != path);
    if is_there {
        end(path, status, message);
    }
}

/// Sets the status in a file, if it can still be written.
fn end(path: &Path, status: Status, message: &str) {
    let text = whole_file::read_text(path).unwrap_or_default();
    if let Ok(Value::Object(mut summary)) = serde_json::from_str(&text) {
        summary.insert("status".into(), status.name().into());
        summary.insert("message".into(), message.into());
        let _ = put(path, &format!("{:#}\n", Value::Object(summary)));
    }
}
