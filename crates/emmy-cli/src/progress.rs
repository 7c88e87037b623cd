//! Progress: a bar on a terminal, otherwise a line for every tenth of the run.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use emmy::motion::{Event, EventKind, Observer, Record, State, StepPlan, View};
use emmy::time::Scheme;
use emmy_io::message::{counted, shown};
use emmy_io::units::Units;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::host::{Host, ProgressUpdate, message};
use crate::print::number;

/// Shows the progress of a run.
#[derive(Debug)]
pub(crate) struct Progress<'h> {
    host: &'h dyn Host,
    form: Form,
    what: &'static str,
    /// Number of the step at the start.
    first: Option<usize>,
    n_steps: usize,
    is_adaptive: bool,
    /// Start and end of the plan.
    span: [f64; 2],
    /// Whether steps were cut, so that there are more than planned ones.
    is_cut: bool,
    /// Whether the steps are increments of an equilibrium.
    is_static: bool,
    units: Units,
}

#[derive(Debug)]
enum Form {
    Nothing,
    Lines { shown: usize },
    Bar(ProgressBar),
}

/// Length of the bar of a run with an unknown number of steps.
const PARTS: f64 = 1000.0;

/// Rounding of a part of the time.
const SAME_PART: f64 = 1e-9;

const ADAPTIVE_STYLE: &str = "{bar:24} {percent:>3} %  {msg}  {eta} left";

const STYLE: &str = "{bar:24} {pos}/{len} steps  {msg}  {eta} left";

impl<'h> Progress<'h> {
    /// Progress through a plan.
    pub(crate) fn new(host: &'h dyn Host, plan: &StepPlan, units: Units, quiet: bool) -> Self {
        Progress::of(host, "", plan, units, quiet)
    }

    /// Progress of one of several runs; `what` is the beginning of each line.
    pub(crate) fn of(
        host: &'h dyn Host,
        what: &'static str,
        plan: &StepPlan,
        units: Units,
        quiet: bool,
    ) -> Self {
        let n_steps = plan.n_steps();
        let form = match (quiet, host.draws_bars()) {
            (true, _) => Form::Nothing,
            (false, false) => Form::Lines { shown: 0 },
            (false, true) if plan.adaptivity().is_some() => Form::Bar(bar(PARTS as usize, ADAPTIVE_STYLE)),
            (false, true) => Form::Bar(bar(n_steps, STYLE)),
        };
        let is_adaptive = plan.adaptivity().is_some();
        let span = [plan.start(), plan.end()];
        Progress {
            host,
            form,
            what,
            first: None,
            n_steps,
            is_adaptive,
            span,
            is_cut: false,
            is_static: false,
            units,
        }
    }

    /// Counts the steps of a resumed run from its state on.
    pub(crate) fn start_at(&mut self, state: &State, plan: &StepPlan) {
        if state.step > 0 {
            self.first = Some(0);
            let n_left = if self.is_adaptive { 0 } else { plan.steps_from(state.time).count() };
            self.is_cut = state.step + n_left > self.n_steps;
        }
    }

    /// Beginning of each line.
    fn prefix(&self) -> String {
        if self.what.is_empty() { String::new() } else { format!("{}: ", self.what) }
    }

    /// Removes the bar.
    pub(crate) fn end(&self) {
        if let Form::Bar(bar) = &self.form {
            bar.finish_and_clear();
        }
    }

    /// Time, balance of the step relative to a scale of the energy, and work; load fraction of an equilibrium.
    fn message(&self, record: &Record, energy: f64, is_static: bool) -> String {
        let balance = if energy > 0.0 { record.energy_residual.abs() / energy } else { 0.0 };
        if is_static {
            let fraction = number(record.time);
            return format!("load fraction {fraction}  {}", work(record));
        }
        let time = self.units.number(record.time, "time");
        format!("t = {time}  energy balance {balance:.0e}  {}", work(record))
    }
}

/// The work of a step.
fn work(record: &Record) -> String {
    let corrections = counted(record.newton_iterations, "correction", "corrections");
    match record.refactorizations {
        0 => corrections,
        n => format!("{corrections}, {}", counted(n, "factorisation", "factorisations")),
    }
}

/// Shows how many of several runs are finished.
#[derive(Debug)]
pub(crate) struct RunsProgress<'h> {
    host: &'h dyn Host,
    form: Form,
    n_runs: usize,
    n_done: usize,
    n_failed: usize,
    /// Runs that have begun, with the part of their time that is done.
    begun: BTreeMap<usize, f64>,
    /// When something was shown.
    shown: Instant,
}

/// Time between two messages on runs that have not ended.
const BETWEEN_PARTS: Duration = Duration::from_secs(5);

const RUNS_STYLE: &str = "{bar:24} {pos}/{len} runs  {msg}  {eta} left";

impl<'h> RunsProgress<'h> {
    /// Progress through some runs.
    pub(crate) fn new(host: &'h dyn Host, n_runs: usize, quiet: bool) -> Self {
        let form = match (quiet, host.draws_bars()) {
            (true, _) => Form::Nothing,
            (false, false) => Form::Lines { shown: 0 },
            (false, true) => Form::Bar(bar(n_runs, RUNS_STYLE)),
        };
        let begun = BTreeMap::new();
        RunsProgress { host, form, n_runs, n_done: 0, n_failed: 0, begun, shown: Instant::now() }
    }

    /// Shows the parts of the runs that have begun, by their indices, if nothing was shown for some seconds.
    pub(crate) fn within(&mut self, run: usize, part: f64) {
        self.begun.insert(run, part);
        if self.shown.elapsed() < BETWEEN_PARTS {
            return;
        }
        self.shown = Instant::now();
        let part = |(run, part): (&usize, &f64)| format!("run {}: {:.0} %", run + 1, 100.0 * part);
        let text = self.begun.iter().map(part).collect::<Vec<_>>().join(", ");
        let done = self.n_done as f64 + self.begun.values().sum::<f64>();
        let host = self.host;
        host.progress(&ProgressUpdate { what: "runs", done, total: self.n_runs as f64, text: &text });
        match &self.form {
            Form::Nothing => {}
            Form::Bar(bar) => bar.set_message(text),
            Form::Lines { .. } => message!(host, "{text}"),
        }
    }

    /// Counts a finished run, and shows why it failed.
    pub(crate) fn add(&mut self, run: usize, failure: Option<String>) {
        self.begun.remove(&run);
        self.shown = Instant::now();
        self.n_done += 1;
        self.n_failed += usize::from(failure.is_some());
        let count = if self.n_failed > 0 { format!("{} failed", self.n_failed) } else { String::new() };
        let (done, total) = (self.n_done as f64, self.n_runs as f64);
        self.host.progress(&ProgressUpdate { what: "runs", done, total, text: &count });
        let tenths = 10 * self.n_done / self.n_runs.max(1);
        let host = self.host;
        match &mut self.form {
            Form::Nothing => {}
            Form::Bar(bar) => {
                bar.set_message(count);
                bar.set_position(self.n_done as u64);
                failure.into_iter().for_each(|failure| bar.println(shown(&failure)));
            }
            Form::Lines { shown: before } => {
                failure.into_iter().for_each(|failure| message!(host, "{}", shown(&failure)));
                if tenths > *before {
                    let count = if count.is_empty() { count } else { format!(", {count}") };
                    message!(host, "run {} of {}{count}", self.n_done, self.n_runs);
                    *before = tenths;
                }
            }
        }
    }

    /// Removes the bar.
    pub(crate) fn end(&self) {
        if let Form::Bar(bar) = &self.form {
            bar.finish_and_clear();
        }
    }
}

fn bar(n_steps: usize, style: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(n_steps as u64), ProgressDrawTarget::stderr());
    match ProgressStyle::with_template(style) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

impl Observer for Progress<'_> {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let record = view.record;
        let is_static = view.motion.scheme() == Scheme::Static;
        self.is_static = is_static;
        let done = record.step - *self.first.get_or_insert(record.step);
        self.is_cut |= record.cuts > 0;
        // The number of adaptive steps is unknown, and so is that of cut ones: the bar shows the time.
        let [start, end] = self.span;
        let part = (record.time - start) / (end - start);
        let (position, whole) = match (self.is_adaptive, self.is_cut) {
            (true, _) => ((PARTS * part) as usize, PARTS as usize),
            (false, true) => ((self.n_steps as f64 * part) as usize, self.n_steps),
            (false, false) => (done, self.n_steps),
        };
        let tenths = match self.is_cut {
            true => (10.0 * part * (1.0 + SAME_PART)) as usize,
            false => 10 * position / whole.max(1),
        };
        let (energy, _) = view.motion.statistics().energy_size();
        let message = self.message(record, energy, is_static);
        let (done_part, total) = match (self.is_adaptive, self.is_cut) {
            (true, _) => (record.time - start, end - start),
            (false, true) => (self.n_steps as f64 * part, self.n_steps as f64),
            (false, false) => (done as f64, self.n_steps as f64),
        };
        let update = ProgressUpdate { what: self.what, done: done_part, total, text: &message };
        self.host.progress(&update);
        let prefix = self.prefix();
        let host = self.host;
        match &mut self.form {
            Form::Nothing => {}
            Form::Lines { shown } if tenths <= *shown => {}
            Form::Bar(bar) => {
                bar.set_message(format!("{prefix}{message}"));
                bar.set_position(position as u64);
            }
            Form::Lines { .. } => {
                let end = self.units.number(self.span[1], "time");
                let end = if is_static { String::new() } else { format!(" (end: t = {end})") };
                let step = if is_static { "increment" } else { "step" };
                let of = if self.is_adaptive || self.is_cut {
                    String::new()
                } else {
                    format!(" of {}", self.n_steps)
                };
                message!(host, "{prefix}{step} {done}{of}, {message}{end}");
                self.form = Form::Lines { shown: tenths };
            }
        }
        Ok(())
    }

    fn notice(&mut self, event: &Event) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let is_seldom = event.kind != EventKind::Grown;
        let step = if self.is_static { "increment" } else { "step" };
        let text = format!("{}{step} {}: {}", self.prefix(), event.step, event.message);
        let host = self.host;
        match &self.form {
            Form::Bar(bar) if is_seldom => bar.println(text),
            Form::Lines { .. } if is_seldom => message!(host, "{text}"),
            _ => {}
        }
        Ok(())
    }
}
