//! `summary.json`: a run in one object.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};

use crate::directory::replace;
use crate::input::Problem;
use crate::tally::Tally;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// It has not ended; a run that is killed leaves this.
    Running,
    /// The plan was done.
    Done,
    /// A step did not converge.
    NoConvergence,
    /// A limit of `[limits]` was exceeded.
    LimitExceeded,
    /// It was stopped from outside, with a checkpoint.
    Interrupted,
    /// Something else failed.
    Failed,
}

impl Status {
    /// Key word of the status.
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

/// What a run is, before it starts.
#[derive(Debug, Clone, PartialEq)]
pub struct Heading {
    title: Option<String>,
    scheme: String,
    degree: usize,
    dofs: usize,
    nodes: usize,
    cells: usize,
    /// `None`: sizes are chosen by the error.
    planned_steps: Option<usize>,
}

impl Heading {
    /// The heading of a problem.
    pub fn new(problem: &Problem) -> Self {
        Heading {
            title: problem.title.clone(),
            scheme: problem.scheme.name(),
            degree: problem.scheme.degree(),
            dofs: problem.body.n_dofs(),
            nodes: problem.body.mesh().n_nodes(),
            cells: problem.body.mesh().n_cells(),
            planned_steps: problem.plan.adaptivity().is_none().then(|| problem.plan.n_steps()),
        }
    }

    /// The summary as JSON. Numbers that are not finite become `null`, which is all that JSON has for them.
    pub fn summary(&self, tally: &Tally, status: Status, message: Option<&str>, wall_seconds: f64) -> Value {
        let mut summary = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "title": self.title,
            "scheme": self.scheme,
            "degree": self.degree,
            "dofs": self.dofs,
            "nodes": self.nodes,
            "cells": self.cells,
            "steps": tally.steps,
            "planned_steps": self.planned_steps,
            "time": tally.time,
            "newton_iterations": tally.newton_iterations,
            "linear_iterations": tally.linear_iterations,
            "solver": tally.solver.map(|solver| solver.to_string()),
            "stiffness_renewals": tally.renewals,
            "steps_with_exact_tangent": tally.steps_with_exact_tangent,
            "steps_at_rounding_floor": tally.steps_at_rounding_floor,
            "cuts": tally.cuts,
            "refusals": tally.refusals,
            "degree_changes": tally.degree_changes,
            "releases": tally.releases,
            "wall_seconds": wall_seconds,
            "worst_energy_residual": tally.energy.value,
            "worst_energy_residual_step": tally.energy.step,
            "worst_linear_momentum_residual": tally.linear_momentum.value,
            "worst_linear_momentum_residual_step": tally.linear_momentum.step,
            "worst_angular_momentum_residual": tally.angular_momentum.value,
            "worst_angular_momentum_residual_step": tally.angular_momentum.step,
            "energy_drift": tally.energy_drift(),
            "angular_momentum_drift": tally.angular_momentum_drift(),
            "largest_energy": tally.largest_energy,
            "largest_linear_momentum": tally.largest_linear_momentum,
            "largest_angular_momentum": tally.largest_angular_momentum,
            "linear_momentum_scale": tally.linear_momentum_scale,
            "angular_momentum_scale": tally.angular_momentum_scale,
            "total_energy": tally.total_energy,
            "external_work": tally.external_work,
            "dissipated_energy": tally.dissipated_energy,
            "estimated_error": null,
            "status": status.name(),
            "message": message,
        });
        // One object of all would be too much for the macro.
        let (most, name) = (&tally.displacement, "largest_displacement");
        summary[name] = most.value.into();
        summary[format!("{name}_step")] = most.step.into();
        summary[format!("{name}_time")] = most.time.into();
        summary[format!("{name}_node")] = most.node.into();
        summary[format!("{name}_point")] = json!(most.point);
        summary["digits_left"] = ((10.0 * tally.digits_left()).floor() / 10.0).into();
        summary["unresolved_loads"] = tally.unresolved_loads.into();
        summary
    }
}

/// Writes a summary; the file is whole at every moment. On a disk without room for a second file the first one is overwritten in its
/// place, so that the status is true.
///
/// # Errors
/// What the system refuses.
pub fn write(path: &Path, summary: &Value) -> io::Result<()> {
    let mut running = running();
    put(path, &format!("{summary:#}\n"))?;
    running.retain(|own| own != path);
    if summary["status"] == Status::Running.name() {
        running.push(path.to_path_buf());
    }
    Ok(())
}

fn put(path: &Path, text: &str) -> io::Result<()> {
    replace(path, text.as_bytes()).or_else(|error| overwrite(path, text.as_bytes()).map_err(|_| error))
}

/// Overwrites a file without giving back the room that it has.
fn overwrite(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).open(path)?;
    file.write_all(bytes)?;
    file.set_len(bytes.len() as u64)
}

/// Summaries of this process that say `running`.
static RUNNING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn running() -> MutexGuard<'static, Vec<PathBuf>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends the summaries that say `running`, for a process that ends here and now: nothing is written to them afterwards.
pub fn abandon(status: Status, message: &str) {
    // Whoever writes one at this moment is let finish. One that panicked while it wrote does not: that is not waited for.
    for _ in 0..100 {
        if let Ok(mut running) = RUNNING.try_lock() {
            running.drain(..).for_each(|path| end(&path, status, message));
            // Other threads may go on for a moment.
            return std::mem::forget(running);
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
}

/// Ends one summary, if it still says `running`.
pub(crate) fn abandon_one(path: &Path, status: Status, message: &str) {
    let mut running = running();
    let is_there = running.iter().any(|own| own == path);
    running.retain(|own| own != path);
    if is_there {
        end(path, status, message);
    }
}

/// What cannot be written any more stays as it is.
fn end(path: &Path, status: Status, message: &str) {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    if let Ok(Value::Object(mut summary)) = serde_json::from_str(&text) {
        summary.insert("status".into(), status.name().into());
        summary.insert("message".into(), message.into());
        let _ = put(path, &format!("{:#}\n", Value::Object(summary)));
    }
}
