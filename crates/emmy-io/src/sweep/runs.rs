//! The runs of a sweep, side by side.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use emmy::motion::{MarchError, Motion, Observer, View};
use serde_json::Value;

use super::Sweep;
use crate::history::{HistoryColumns, Number};
use crate::input::{Limits, Problem};
use crate::limits;
use crate::message::with_causes;
use crate::side_by_side::{on_one_thread, side_by_side};
use crate::summary::{Status, SummaryHeader};

/// A finished run.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRow {
    /// Index of the run, from 0.
    pub run: usize,
    /// Why the run failed, in a line.
    pub failure: Option<String>,
    /// The numbers of [`Sweep::columns`] at its end; of a failed run after its last completed step.
    pub numbers: Vec<Number>,
}

/// Runs some of the combinations, each on one thread, on as many threads as the pool of the caller has, and returns
/// their rows in the given order. A row is reported as soon as its run has ended. Once `is_stopped`, running ones end
/// after their step without a row, and no others start.
///
/// The numbers do not depend on the number of threads, except `wall_seconds`.
///
/// # Errors
/// The first error of `report`; the sweep stops then.
pub fn sweep(
    sweep: &Sweep,
    runs: &[usize],
    is_stopped: impl Fn() -> bool + Sync,
    report: impl FnMut(&SweepRow) -> io::Result<()> + Send,
) -> io::Result<Vec<SweepRow>> {
    let is_broken = AtomicBool::new(false);
    let is_stopped = || is_broken.load(Ordering::Relaxed) || is_stopped();
    let report = Mutex::new(report);
    let rows = side_by_side(runs.len(), |place| {
        let row = row(sweep, runs[place], &is_stopped)?;
        let mut report = report.lock().unwrap_or_else(PoisonError::into_inner);
        let reported = report(&row).inspect_err(|_| is_broken.store(true, Ordering::Relaxed));
        Some(reported.map(|()| row))
    });
    rows.into_iter().flatten().collect()
}

/// The row of a run; `None` if it was stopped.
fn row(sweep: &Sweep, run: usize, is_stopped: &(dyn Fn() -> bool + Sync)) -> Option<SweepRow> {
    if is_stopped() {
        return None;
    }
    let ended = on_one_thread(|| {
        let started = Instant::now();
        let problem = sweep.problem(run).map_err(|error| error.to_string())?;
        let mut motion = problem.motion(&mut []).map_err(|error| with_causes(&error))?;
        let mut watch = Watch { limits: &problem.limits, is_stopped };
        let failure = match motion.march(&problem.plan, &mut [&mut watch]) {
            Ok(()) => None,
            Err(MarchError::Observer(error)) if error.is::<Stopped>() => return Ok(None),
            Err(MarchError::Observer(error)) => Some(error.to_string()),
            Err(MarchError::Step(error)) => Some(with_causes(&error)),
        };
        let seconds = started.elapsed().as_secs_f64();
        Ok(Some((numbers(sweep.columns(), &problem, &motion, seconds), failure)))
    });
    let nothing = || vec![Number::Missing; sweep.columns().len()];
    let (numbers, failure) = match ended.and_then(|ended| ended) {
        Ok(ended) => ended?,
        Err(failure) => (nothing(), Some(failure)),
    };
    let failure = failure.map(|failure| failure.lines().collect::<Vec<_>>().join("; "));
    Some(SweepRow { run, failure, numbers })
}

/// The numbers of the columns, from the summary and from the last row of the history.
fn numbers(columns: &[String], problem: &Problem, motion: &Motion<'_>, seconds: f64) -> Vec<Number> {
    let statistics = motion.statistics();
    let summary = SummaryHeader::new(problem).summary(statistics, &[], Status::Done, None, seconds);
    let history = HistoryColumns::of(problem);
    let last = history.row(motion.view(), seconds);
    let last: Vec<(String, Number)> = history.names().into_iter().zip(last.numbers).collect();
    let in_summary = |name: &str| match &summary[name] {
        Value::Number(number) => match number.as_u64() {
            Some(whole) => Number::Whole(whole as usize),
            None => number.as_f64().map_or(Number::Missing, Number::Real),
        },
        _ => Number::Missing,
    };
    let number = |name: &String| match name.as_str() {
        "end_time" => in_summary("time"),
        "newton_iterations_per_step" if statistics.steps == 0 => Number::Missing,
        "newton_iterations_per_step" => {
            Number::Real(statistics.newton_iterations as f64 / statistics.steps as f64)
        }
        name => {
            last.iter().find(|(own, _)| own == name).map_or_else(|| in_summary(name), |(_, number)| *number)
        }
    };
    columns.iter().map(number).collect()
}

/// Checks the limits, and ends a run that is stopped.
struct Watch<'a> {
    limits: &'a Limits,
    is_stopped: &'a (dyn Fn() -> bool + Sync),
}

#[derive(Debug, thiserror::Error)]
#[error("stopped")]
struct Stopped;

impl Observer for Watch<'_> {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        if (self.is_stopped)() {
            return Err(Box::new(Stopped));
        }
        Ok(limits::check(self.limits, view.motion.statistics())?)
    }
}
