//! Inputs of the items, and runs of them.

use std::path::{Path, PathBuf};

use emmy::motion::{MarchError, Motion, Observer, Record, State, View};
use emmy_io::input::{self, Overrides, Problem};

/// One of the input files, with values changed as by `--set`.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    file: String,
    set: Vec<String>,
}

impl Case {
    /// An unchanged input.
    pub(crate) fn new(file: impl Into<String>) -> Self {
        Case { file: file.into(), set: Vec::new() }
    }

    /// The case with another value.
    pub(crate) fn with(mut self, key: &str, value: impl std::fmt::Display) -> Self {
        self.set.push(format!("{key}={value}"));
        self
    }

    /// The case with another scheme.
    pub(crate) fn scheme(self, scheme: &str) -> Self {
        self.with("time.scheme", scheme)
    }

    /// The equivalent command.
    pub(crate) fn command(&self) -> String {
        let set: String = self.set.iter().map(|set| format!(" --set \"{set}\"")).collect();
        format!("emmy run validation/inputs/{}.toml{set}", self.file)
    }

    /// Path of the input.
    fn path(&self) -> PathBuf {
        let name = format!("{}.toml", self.file);
        Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs").join(name)
    }

    /// The problem.
    ///
    /// # Errors
    /// The message of an input that cannot be used.
    pub(crate) fn problem(&self) -> Result<Problem, String> {
        let overrides = Overrides { set: self.set.clone(), ..Default::default() };
        input::read(&self.path(), &overrides).map_err(|error| format!("{}: {error}", self.file))
    }

    /// The motion, to its end or to the first step that fails.
    ///
    /// # Errors
    /// The message of an input that cannot be used.
    pub(crate) fn run(&self) -> Result<Run, String> {
        Run::of(&self.problem()?)
    }
}

/// Result of a run.
#[derive(Debug, Default)]
pub(crate) struct Run {
    /// The start and every step.
    pub records: Vec<Record>,
    /// Positions at the same times, `[n_nodes][3]`.
    pub positions: Vec<Vec<[f64; 3]>>,
    /// The message of a step that failed.
    pub failure: Option<String>,
}

impl Run {
    /// Runs a problem; a step that fails ends the run.
    ///
    /// # Errors
    /// The message of an invalid initial state.
    pub(crate) fn of(problem: &Problem) -> Result<Run, String> {
        let text = |error: emmy::Error| error.to_string();
        let body = &problem.body;
        let state = State::initial(body, problem.plan.start(), &problem.initial).map_err(text)?;
        let motion = Motion::starting(body, problem.scheme, problem.newton, state);
        let mut run = Run::default();
        match motion.map_err(text)?.march(&problem.plan, &mut [&mut run]) {
            Ok(()) => Ok(run),
            Err(MarchError::Step(error)) => Ok(Run { failure: Some(error.to_string()), ..run }),
            Err(error) => Err(error.to_string()),
        }
    }

    /// Records from a time on.
    pub(crate) fn after(&self, time: f64) -> &[Record] {
        &self.records[self.records.partition_point(|record| record.time < time - 1e-9)..]
    }

    /// A quantity over time, from a time on.
    pub(crate) fn history(&self, from: f64, value: impl Fn(&Record) -> f64) -> Vec<(f64, f64)> {
        self.after(from).iter().map(|record| (record.time, value(record))).collect()
    }
}

impl Observer for Run {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        self.records.push(view.record.clone());
        let nodes = 0..view.body.mesh().n_nodes();
        self.positions.push(nodes.map(|node| view.state.position(view.body, node)).collect());
        Ok(())
    }
}
