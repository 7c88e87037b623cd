//! The runs of a sweep, side by side.

use std::collections::HashMap;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use emmy::modes::{Mode, modes, modes_about};
use emmy::motion::{MarchError, Motion, Observer, View};
use serde_json::Value;

use super::{COLUMNS, Sweep};
use crate::accuracy::{self, Accuracy};
use crate::directory;
use crate::history::{Extreme, HistoryColumns, HistoryFile, Number, Peaks, keep_largest};
use crate::input::Problem;
use crate::limits;
use crate::message::with_causes;
use crate::results::{input, write_units};
use crate::side_by_side::{on_one_thread, side_by_side};
use crate::summary::{self, Status, SummaryHeader, add_accuracy, add_notes, add_peaks};
use crate::whole_file::replace;

/// A finished run.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRow {
    /// Index of the run, from 0.
    pub run: usize,
    /// Why the run failed, in a line.
    pub failure: Option<String>,
    /// The numbers of [`Sweep::columns`] at the end of the run; if it failed, after its last completed step.
    pub numbers: Vec<Number>,
}

impl SweepRow {
    /// The status of the run, as in its summary.
    pub fn status(&self) -> Status {
        status(self.failure.as_deref())
    }
}

fn status(failure: Option<&str>) -> Status {
    if failure.is_some() { Status::Failed } else { Status::Done }
}

/// Runs some of the combinations, each on one thread, on as many threads as the pool of the caller has, and returns
/// their rows in the given order. A row is reported as soon as its run has ended.
///
/// `watch` sees the index of a run and the part of its time that is done, from 0 to 1, before the run and after each
/// step. Once it returns true, the running ones end after their step without a row, and no others start.
///
/// The numbers do not depend on the number of threads, except `wall_seconds`.
///
/// # Errors
/// The first error of `report` or of a kept file; the sweep stops then.
pub fn sweep(
    sweep: &Sweep,
    runs: &[usize],
    watch: impl Fn(usize, f64) -> bool + Sync,
    report: impl FnMut(&SweepRow) -> io::Result<()> + Send,
) -> io::Result<Vec<SweepRow>> {
    let is_broken = AtomicBool::new(false);
    let watch = |run: usize, part: f64| watch(run, part) || is_broken.load(Ordering::Relaxed);
    let report = Mutex::new(report);
    let rows = side_by_side(runs.len(), |place| {
        let reported = row(sweep, runs[place], &watch).and_then(|row| {
            let mut report = report.lock().unwrap_or_else(PoisonError::into_inner);
            row.as_ref().map_or(Ok(()), &mut *report).map(|()| row)
        });
        reported.inspect_err(|_| is_broken.store(true, Ordering::Relaxed)).transpose()
    });
    rows.into_iter().flatten().collect()
}

/// Whether to stop, asked with a run and its part that is done.
type Watch<'a> = dyn Fn(usize, f64) -> bool + Sync + 'a;

/// The row of a run; `None` if it was stopped.
fn row(sweep: &Sweep, run: usize, watch: &Watch<'_>) -> io::Result<Option<SweepRow>> {
    if watch(run, 0.0) {
        return Ok(None);
    }
    let ended = match on_one_thread(|| ended(sweep, run, watch)) {
        Ok(ended) => ended?,
        Err(message) => Some((sweep.nothing(), Some(message))),
    };
    let row = |(numbers, failure): Ended| {
        let failure = failure.map(|failure| failure.lines().collect::<Vec<_>>().join("; "));
        SweepRow { run, failure, numbers }
    };
    Ok(ended.map(row))
}

/// The numbers of a run, and why it failed.
type Ended = (Vec<Number>, Option<String>);

/// Computes a run; `None` if it was stopped.
fn ended(sweep: &Sweep, run: usize, watch: &Watch<'_>) -> io::Result<Option<Ended>> {
    let started = Instant::now();
    let failed = |message: String| Ok(Some((sweep.nothing(), Some(message))));
    let problem = match sweep.problem(run) {
        Ok(problem) => problem,
        Err(error) => return failed(error.to_string()),
    };
    if let Some(count) = sweep.n_modes() {
        return Ok(Some(match modes_of(&problem, count) {
            Ok(modes) => (numbers_of_modes(&modes, started), None),
            Err(message) => (sweep.nothing(), Some(message)),
        }));
    }
    let mut motion = match problem.motion(&mut []) {
        Ok(motion) => motion,
        Err(error) => return failed(with_causes(&error)),
    };
    let columns = HistoryColumns::of(&problem);
    let kept = if sweep.is_kept() { Some(Kept::create(&problem, &columns)?) } else { None };
    let is_stopped = |part| watch(run, part);
    let peaks = Peaks::of(&columns);
    let mut recorder = Recorder {
        problem: &problem,
        columns,
        peaks,
        extremes: Vec::new(),
        kept,
        started,
        is_stopped: &is_stopped,
    };
    let failure = match motion.march(&problem.plan, &mut [&mut recorder]) {
        Ok(()) => None,
        Err(MarchError::Step(error)) => Some(with_causes(&error)),
        Err(MarchError::Observer(error)) => match error.downcast::<io::Error>() {
            Ok(error) => return Err(*error),
            Err(error) if error.is::<Stopped>() => return Ok(None),
            Err(error) => Some(error.to_string()),
        },
    };
    recorder.end(sweep.columns(), &motion, failure).map(Some)
}

/// The lowest natural modes of a problem; an error is its message.
fn modes_of(problem: &Problem, count: usize) -> Result<Vec<Mode>, String> {
    let state = problem.state_of_vibration().map_err(|error| with_causes(&error))?;
    let found = match state {
        Some(state) => modes_about(&problem.body, &state, count),
        None => modes(&problem.body, count),
    };
    found.map_err(|error| with_causes(&error))
}

/// Frequencies, effective masses in x, y and z, residuals, and the duration in seconds.
fn numbers_of_modes(modes: &[Mode], started: Instant) -> Vec<Number> {
    let frequencies = modes.iter().map(Mode::frequency);
    let masses = (0..3).flat_map(|axis| modes.iter().map(move |mode| mode.effective_mass[axis]));
    let residuals = modes.iter().map(|mode| mode.residual);
    frequencies
        .chain(masses)
        .chain(residuals)
        .chain([started.elapsed().as_secs_f64()])
        .map(Number::Real)
        .collect()
}

/// The files of a run that are kept.
struct Kept {
    history: HistoryFile,
    summary: PathBuf,
}

impl Kept {
    fn create(problem: &Problem, columns: &HistoryColumns) -> io::Result<Self> {
        let directory = problem.output.directory.as_path();
        directory::prepare(directory).map_err(io::Error::other)?;
        replace(&directory.join("input.toml"), input(problem).as_bytes())?;
        write_units(&directory.join("columns.json"), problem)?;
        let history = HistoryFile::create(&directory.join("history.csv"), columns)?;
        Ok(Kept { history, summary: directory.join("summary.json") })
    }
}

/// Sees the steps of a run: peaks, the kept history, the limits, and whether to stop.
struct Recorder<'a> {
    problem: &'a Problem,
    columns: HistoryColumns,
    peaks: Peaks,
    extremes: Vec<Extreme>,
    kept: Option<Kept>,
    started: Instant,
    is_stopped: &'a dyn Fn(f64) -> bool,
}

#[derive(Debug, thiserror::Error)]
#[error("stopped")]
struct Stopped;

impl Observer for Recorder<'_> {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let [start, end] = [self.problem.plan.start(), self.problem.plan.end()];
        if (self.is_stopped)((view.record.time - start) / (end - start)) {
            return Err(Box::new(Stopped));
        }
        if self.kept.is_some() || !self.peaks.is_empty() {
            let row = self.columns.row(view, self.started.elapsed().as_secs_f64());
            self.peaks.add(&row.numbers);
            keep_largest(&mut self.extremes, row.extremes);
            if let Some(kept) = &mut self.kept {
                kept.history.write(&row.numbers)?;
            }
        }
        Ok(limits::check(&self.problem.limits, view.motion.statistics())?)
    }
}

impl Recorder<'_> {
    /// Writes the kept summary, and returns the numbers of some columns: of the whole body from the summary or the last
    /// step, others from the peaks.
    fn end(self, columns: &[String], motion: &Motion<'_>, failure: Option<String>) -> io::Result<Ended> {
        let seconds = self.started.elapsed().as_secs_f64();
        let statistics = motion.statistics();
        let header = SummaryHeader::new(self.problem);
        let mut summary = header.summary(
            statistics,
            &self.extremes,
            status(failure.as_deref()),
            failure.as_deref(),
            seconds,
        );
        let period = || accuracy::lowest_period(self.problem);
        if let Some(accuracy) = Accuracy::of(self.problem, &self.problem.plan, statistics, None, period) {
            add_accuracy(&mut summary, &accuracy);
        }
        add_notes(&mut summary, statistics, self.problem);
        let last = self.columns.numbers(motion.view().record, seconds);
        let last: HashMap<String, Number> = self.columns.names().into_iter().zip(last).collect();
        let in_summary = |name: &str| match &summary[name] {
            Value::Number(number) => match number.as_u64() {
                Some(whole) => Number::Whole(whole as usize),
                None => number.as_f64().map_or(Number::Missing, Number::Real),
            },
            _ => Number::Missing,
        };
        let peaks: HashMap<String, f64> = self.peaks.numbers().collect();
        let peak = |name: &str| peaks.get(name).copied().filter(|number| !number.is_nan());
        let number = |name: &String| match name.as_str() {
            "end_time" => in_summary("time"),
            "newton_iterations_per_step" if statistics.steps == 0 => Number::Missing,
            "newton_iterations_per_step" => {
                Number::Real(statistics.newton_iterations as f64 / statistics.steps as f64)
            }
            name if !COLUMNS.contains(&name) => peak(name).map_or(Number::Missing, Number::Real),
            name => last.get(name).map_or_else(|| in_summary(name), |number| *number),
        };
        let numbers = columns.iter().map(number).collect();
        if let Some(kept) = &self.kept {
            kept.history.verify()?;
            add_peaks(&mut summary, &self.peaks);
            summary::write(&kept.summary, &summary)?;
        }
        Ok((numbers, failure))
    }
}
