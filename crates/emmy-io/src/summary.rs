//! `summary.json`: the results of a run in one JSON object.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use emmy::body::{Body, ContactSummary, FieldName, LayerLaw};
use emmy::motion::{ContactStatistics, Extreme, RunStatistics};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::accuracy::Accuracy;
use crate::history::{Extreme as FieldExtreme, HIDDEN, Peaks, RESIDUAL};
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

/// A gap below this part of its layer causes a warning.
pub const SMALL_GAP: f64 = 0.05;

/// A smallest gap above this part of its layer causes a note: an impact has used next to nothing of the layer.
const LARGE_GAP: f64 = 0.98;

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
    if let Some(gap) = statistics.smallest_gap.filter(|gap| gap.value < SMALL_GAP) {
        warnings.push(format!(
            "the layer is too soft for this impact: a gap is down to {:.3} of its thickness; take a larger `stiffness` \
             or `distance`",
            gap.value
        ));
    }
    warnings
}

/// Notes on the results of a motion with contact.
///
/// ```
/// use emmy::body::{Contact, Obstacle};
/// use emmy::prelude::*;
/// use emmy_io::summary::notes;
/// let floor = Obstacle::Plane { point: [0.0, 0.0, -0.06], normal: [0.0, 0.0, 1.0] };
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?)
///     .region(Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0))
///     .contact(Contact::with_obstacle("z-min", floor).with_distance(0.05))
///     .build()?;
/// let mut numbers = Vec::new();
/// for v in [1e-3, 1.0] {
///     let falls = InitialVelocity { velocity: [0.0, 0.0, -v], ..InitialVelocity::default() };
///     let start = State::initial(&body, 0.0, &[falls])?;
///     let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.from(start)?;
///     motion.march(&StepPlan::new(0.0, vec![Phase { until: 0.02 / v, size: 5e-4 / v }])?, &mut [])?;
///     assert!(motion.statistics().contacts[0].largest_force.is_some());
///     numbers.push(notes(motion.statistics(), &body).len());
/// }
/// assert_eq!(numbers, [1, 0]); // the layer is thick for the slow impact
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn notes(statistics: &RunStatistics, body: &Body) -> Vec<String> {
    let has_touched = |(own, contact): (&ContactStatistics, &ContactSummary)| {
        own.largest_force.is_some() && contact.law == LayerLaw::Smooth
    };
    let may_be_thick = statistics.contacts.iter().zip(body.contacts()).any(has_touched);
    // A gap that is not inside the layer at any end of a step says nothing about what was between them.
    let gap = statistics.smallest_gap.filter(|gap| may_be_thick && (LARGE_GAP..1.0).contains(&gap.value));
    let note = |gap: Extreme| {
        format!(
            "the layer is thick for so slow an impact: `law = \"linear\"`, or a smaller `distance` (the smallest gap \
             is {:.4} of its thickness)",
            gap.value
        )
    };
    gap.map(note).into_iter().collect()
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
        extremes: &[FieldExtreme],
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
        let of_body = |own: &&FieldExtreme| own.field != DISPLACEMENT && own.region.is_none();
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

/// Adds the notes on the results of a problem.
pub(crate) fn add_notes(summary: &mut Value, statistics: &RunStatistics, problem: &Problem) {
    if let Some(all) = summary["notes"].as_array_mut().filter(|_| !problem.is_static()) {
        all.extend(notes(statistics, &problem.body).into_iter().map(Value::from));
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
fn place_of(extreme: &FieldExtreme) -> Value {
    let FieldExtreme { value, step, time, member, is_cell, point, .. } = extreme;
    let kind = if *is_cell { "cell" } else { "node" };
    json!({ "value": value, "step": step, "time": time, kind: member, "point": point })
}

/// The largest value of a field in a region, which it names first.
fn row_of(extreme: &FieldExtreme) -> Option<Value> {
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
