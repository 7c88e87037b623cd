//! `[newton]`, `[solver]`, `[output]`, `[limits]`.

use std::path::PathBuf;

use emmy::body::fields::FieldName;
use emmy::motion::{NewtonSettings, StepPlan};
use emmy::sparse::{SOLVERS, Solver};

use super::fault::{Fault, Place};
use super::keys;
use super::table::{Item, Table, spelled};
use crate::vtk::{Format, Precision};

/// What is written, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Directory of the results, relative to the working directory.
    pub directory: PathBuf,
    /// Steps between frames, beside the first and the last; 0: none of these.
    pub every: usize,
    /// Time between frames, in place of steps.
    pub interval: Option<f64>,
    /// Which files the frames are.
    pub format: Format,
    /// Precision of their fields.
    pub precision: Precision,
    /// Fields in the frames; those that the body does not have are left out.
    pub fields: Vec<FieldName>,
    /// Steps between checkpoints; 0: no checkpoints.
    pub checkpoint_every: usize,
    /// Steps between rows of `newton.csv` and between steps in `run.log`; 0: none of these.
    pub log_every: usize,
    /// Points whose path is written into the history.
    pub probes: Vec<Probe>,
}

/// A point that is followed: the nearest node.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Name in the columns of the history.
    pub name: String,
    /// The point that was asked for, in the reference configuration \[length\].
    pub point: [f64; 3],
    /// Index of the nearest node.
    pub node: usize,
}

/// What makes a run end early (exit code 4).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Largest accumulated energy residual over the largest T + |V|.
    pub energy: Option<f64>,
    /// Largest accumulated angular momentum residual over the largest |L|.
    pub angular_momentum: Option<f64>,
}

/// Values of keys that are left out.
pub(super) const DEFAULTS: &str = "\
    [time]\ndegree = 1\n\
    [newton]\ntolerance = 1e-10\nmax_iterations = 20\n\
    [output]\nevery = 1\nformat = \"vtu\"\nprecision = \"double\"\n\
    fields = [\"displacement\", \"velocity\", \"momentum_density\", \"cauchy_stress\", \
    \"second_piola_kirchhoff_stress\", \"von_mises_stress\", \"principal_stretches\", \
    \"strain_energy_density\", \"axial_force\"]\n\
    checkpoint_every = 50\nlog_every = 1\nprobes = []\n";

pub(super) fn newton(item: Item<'_>) -> Result<NewtonSettings, Fault> {
    let table = item.table(keys::NEWTON)?;
    let tolerance = table.require("tolerance")?;
    let value = tolerance.positive()?;
    if value >= 1.0 {
        return Err(tolerance
            .fault(format!("`tolerance` must be less than 1, not {}", spelled(value)), "it is relative"));
    }
    Ok(NewtonSettings {
        tolerance: value,
        max_iterations: table.require("max_iterations")?.whole(1)?,
        ..Default::default()
    })
}

pub(super) fn solver(item: Item<'_>) -> Result<Solver, Fault> {
    let table = item.table(keys::SOLVER)?;
    let word = table.require("kind")?.word("a solver", &SOLVERS.map(|(name, ..)| name))?;
    Ok(SOLVERS.into_iter().find(|(name, ..)| *name == word).map_or(Solver::Auto, |(_, solver, _)| solver))
}

pub(super) fn output(item: Item<'_>) -> Result<Output, Fault> {
    let table = item.table(keys::OUTPUT)?;
    let mut probes: Vec<(Probe, Place)> = Vec::new();
    for item in table.require("probes")?.list()? {
        let found = probe(item)?;
        if let Some((_, place)) = probes.iter().find(|(other, _)| other.name == found.0.name) {
            let fault = Fault::at(&found.1, format!("two probes are named `{}`", found.0.name), "second");
            return Err(fault.label(place, "first"));
        }
        probes.push(found);
    }
    Ok(Output {
        directory: table.require("directory")?.string()?.into(),
        every: table.get("every").map_or(Ok(0), |item| item.whole(0))?,
        interval: interval(&table)?,
        format: format(table.require("format")?)?,
        precision: precision(table.require("precision")?)?,
        fields: fields(table.require("fields")?)?,
        checkpoint_every: table.require("checkpoint_every")?.whole(0)?,
        log_every: table.require("log_every")?.whole(0)?,
        probes: probes.into_iter().map(|(probe, _)| probe).collect(),
    })
}

fn interval(table: &Table<'_>) -> Result<Option<f64>, Fault> {
    let Some(interval) = table.get("interval") else { return Ok(None) };
    if let Some(every) = table.get("every") {
        let message = "frames are counted by steps or by time: give `every` or `interval`";
        let fault = Fault::at(every.key_place, message, "this one").label(interval.key_place, "and this one");
        return Err(fault.help("`interval` is a time, `every` a number of steps"));
    }
    interval.positive().map(Some)
}

/// The plan that meets the times of the frames.
pub(super) fn plan_with_frames(plan: StepPlan, output: &Output, item: &Item<'_>) -> Result<StepPlan, Fault> {
    let Some(interval) = output.interval else { return Ok(plan) };
    let item = item.table(keys::OUTPUT)?.require("interval")?;
    plan.with_interval(interval).map_err(|error| {
        let fault = item.fault(format!("`interval`: {}", reason(&error)), "not met by the steps");
        fault.help("give steps of which it is a multiple, or adaptive ones: those meet every such time")
    })
}

fn reason(error: &emmy::Error) -> String {
    match error {
        emmy::Error::Plan { reason, .. } => reason.clone(),
        other => other.to_string(),
    }
}

impl Output {
    /// Whether frames are written.
    pub fn has_frames(&self) -> bool {
        self.every > 0 || self.interval.is_some()
    }

    /// Number of the frames of a plan; not known where every so many adaptive steps are one.
    pub fn n_frames(&self, plan: &StepPlan) -> Option<usize> {
        let duration = plan.end() - plan.start();
        match (self.interval, self.every) {
            // The last one may lie on the end, or differ from it by rounding.
            (Some(interval), _) => Some((duration / interval * (1.0 - 1e-12)).ceil() as usize + 1),
            (None, 0) => Some(0),
            (None, _) if plan.adaptivity().is_some() => None,
            (None, every) => Some(plan.n_steps().div_ceil(every) + 1),
        }
    }

    /// Whether a state is one for a frame, by its step or by its time in a plan.
    pub fn is_frame(&self, plan: &StepPlan, step: usize, time: f64) -> bool {
        match self.interval {
            Some(_) => step == 0 || plan.is_output(time),
            None => step.is_multiple_of(self.every),
        }
    }
}

fn format(item: Item<'_>) -> Result<Format, Fault> {
    let word = item.word("a format of frames", &Format::ALL.map(Format::name))?;
    Ok(Format::ALL.into_iter().find(|format| format.name() == word).unwrap_or(Format::Vtu))
}

fn precision(item: Item<'_>) -> Result<Precision, Fault> {
    let word = item.word("a precision of frames", &Precision::ALL.map(Precision::name))?;
    let named = Precision::ALL.into_iter().find(|precision| precision.name() == word);
    Ok(named.unwrap_or(Precision::Double))
}

fn fields(item: Item<'_>) -> Result<Vec<FieldName>, Fault> {
    let mut fields: Vec<FieldName> = Vec::new();
    for item in item.list_or("a list of fields, such as [\"displacement\", \"cauchy_stress\"]")? {
        let word = item.word("a field", &FieldName::ALL.map(FieldName::name))?;
        let field = FieldName::from_name(word).filter(|field| !fields.contains(field));
        fields.push(field.ok_or_else(|| item.fault(format!("the field `{word}` is there twice"), "again"))?);
    }
    Ok(fields)
}

/// Names that would make columns which are there already.
const TAKEN: [&str; 2] = ["linear_momentum", "angular_momentum"];

fn probe(item: Item<'_>) -> Result<(Probe, Place), Fault> {
    let table = item.table(keys::PROBE)?;
    let name_item = table.require("name")?;
    let name = name_item.string()?;
    if !name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-') {
        let message =
            format!("a probe's name becomes a column: `{name}` may have letters, digits, `_` and `-` only");
        return Err(name_item.fault(message, "not a name"));
    }
    if TAKEN.contains(&name) {
        return Err(name_item.fault(format!("there is a column `{name}_x` already"), "taken"));
    }
    let point = table.require("point")?.numbers()?;
    Ok((Probe { name: name.to_string(), point, node: 0 }, name_item.place().clone()))
}

pub(super) fn limits(item: Item<'_>) -> Result<Limits, Fault> {
    let table = item.table(keys::LIMITS)?;
    let limit = |key: &str| table.get(key).map(|item| item.positive()).transpose();
    Ok(Limits { energy: limit("energy")?, angular_momentum: limit("angular_momentum")? })
}
