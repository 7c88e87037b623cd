//! `emmy resume DIR`: resumes a run from its newest checkpoint.

use std::path::PathBuf;

use clap::Args;
use emmy::motion::Motion;
use emmy::team::{Alone, Team};
use emmy_io::checkpoint::{self, Checkpoint, CheckpointError, Identity};
use emmy_io::directory::Lock;
use emmy_io::input::{Overrides, Problem};
use emmy_io::results::Results;
use emmy_io::summary::{self, Status};

use super::run::{self, RunOptions, march};
use super::{agreed, is_first, read, with_threads};
use crate::failure::Failure;
use crate::host::{Host, message};
use crate::print::{self, number};

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Output directory of the run
    directory: PathBuf,
    /// End of the run: later steps are dropped, or the last phase is extended
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    until: Option<f64>,
    /// Size of the steps from here on
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    step: Option<f64>,
    /// Change a value of the input, such as time.scheme=DGM or newton.max_iterations=40 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    options: RunOptions,
}

impl Arguments {
    /// The flags in which the ranks of a team must agree.
    pub(super) fn compared(&self) -> String {
        let Arguments { directory, until, step, set, options } = self;
        format!("{directory:?} {until:?} {step:?} {set:?} {}", options.compared())
    }
}

/// Resumes the run.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    with_threads(arguments.options.threads, host, || run_here(arguments, host))?
}

/// Resumes the run in the calling thread.
fn run_here(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let lock = agreed(host, lock(arguments, host))?;
    let team = host.team().map_or(&Alone as &dyn Team, |team| &**team);
    let (mut checkpoint, note) = checkpoint::newest(&arguments.directory, team).map_err(unreadable)?;
    note.into_iter().for_each(|note| message!(host, "note: {note}; the other checkpoint is used"));
    let problem = problem(arguments, &checkpoint, host)?;
    run::check(&problem, &arguments.options)?;
    if is_done(arguments, &problem, &checkpoint, host) {
        return print_done(arguments, &problem, &checkpoint, host);
    }
    agreed(host, fit(&problem, &mut checkpoint))?;
    let snapshot = checkpoint.snapshot(&problem.body).map_err(unreadable)?;
    let motion = Motion::resumed(&problem.body, problem.scheme, problem.newton, snapshot)?;
    let mut motion = problem.settled(motion);
    let results = Results::resume(&problem, lock, &checkpoint);
    let results = results.map_err(|error| unusable(error.to_string(), "nothing was changed"))?;
    if !arguments.options.quiet {
        let state = motion.state();
        message!(host, "resuming after step {}, t = {}", state.step, number(state.time));
    }
    march((&problem, &arguments.options, host), &mut motion, results, Motion::march_on)
}

/// The lock of the directory of a run, on rank 0.
fn lock(arguments: &Arguments, host: &dyn Host) -> Result<Option<Lock>, Failure> {
    if !is_first(host) {
        return Ok(None);
    }
    if !arguments.directory.join("input.toml").is_file() {
        return Err(unusable(
            format!("{} holds no run of Emmy: there is no input.toml", arguments.directory.display()),
            "name the output directory of a run",
        ));
    }
    Ok(Some(Lock::take(&arguments.directory)?))
}

/// Checks that a checkpoint is one of the problem, and fits it to its plan.
fn fit(problem: &Problem, checkpoint: &mut Checkpoint) -> Result<(), Failure> {
    let identity = Identity::new(problem);
    let same = checkpoint.identity.check(&identity);
    same.map_err(|mismatch| Failure::Files { message: mismatch.to_string(), help: None })?;
    check_end(problem, checkpoint)?;
    settle(problem, checkpoint, &identity);
    Ok(())
}

fn unreadable(error: CheckpointError) -> Failure {
    unusable(error.to_string(), "`emmy run` with its input.toml starts it again")
}

fn unusable(message: String, help: &str) -> Failure {
    Failure::Files { message, help: Some(help.to_string()) }
}

/// The problem of the input in the directory, with the changes of the command line.
fn problem(arguments: &Arguments, checkpoint: &Checkpoint, host: &dyn Host) -> Result<Problem, Failure> {
    let overrides = Overrides {
        set: arguments.set.clone(),
        until: arguments.until,
        output: Some(arguments.directory.clone()),
        step: arguments.step.map(|size| (checkpoint.snapshot.state.time, size)),
        ..Overrides::default()
    };
    let problem = read(&arguments.directory.join("input.toml"), &overrides, host)?;
    problem.notes.iter().for_each(|note| message!(host, "note: {note}"));
    Ok(problem)
}

/// Whether there is nothing to do: the run is complete, and no flag changes it. A call of all ranks of a team.
fn is_done(arguments: &Arguments, problem: &Problem, checkpoint: &Checkpoint, host: &dyn Host) -> bool {
    let is_plain = arguments.until.is_none() && arguments.step.is_none() && arguments.set.is_empty();
    let has_status =
        |status: Status| summary::of_run(&problem.output.directory)["status"].as_str() == Some(status.name());
    let has_no_step = is_plain && check_end(problem, checkpoint).is_err();
    let mut is_done = [f64::from(u8::from(is_first(host) && has_no_step && has_status(Status::Done)))];
    if let Some(team) = host.team() {
        team.largest("whether a run is complete", &mut is_done);
    }
    is_done == [1.0]
}

/// Says that the run is complete.
fn print_done(
    arguments: &Arguments,
    problem: &Problem,
    checkpoint: &Checkpoint,
    host: &dyn Host,
) -> Result<(), Failure> {
    let state = &checkpoint.snapshot.state;
    let longer = if problem.is_static() { "" } else { "; --until T extends it" };
    let (step, time) = (state.step, number(state.time));
    message!(host, "note: nothing to do: the run is complete, after step {step}, t = {time}{longer}");
    if arguments.options.json {
        return print::result(host, &format!("{}\n", summary::of_run(&problem.output.directory)));
    }
    Ok(())
}

/// Rejects a run that is complete, unless it ended before all its files were written.
fn check_end(problem: &Problem, checkpoint: &Checkpoint) -> Result<(), Failure> {
    let state = &checkpoint.snapshot.state;
    let directory = &problem.output.directory;
    if problem.plan.steps_from(state.time).next().is_some() || is_unfinished(problem, state.time) {
        return Ok(());
    }
    let time = number(state.time);
    let end = number(problem.plan.end());
    let message =
        format!("the run has already reached t = {time} (step {}); its plan ends at t = {end}", state.step);
    let longer = if problem.is_static() { "" } else { "give a later end with --until T; " };
    let help = format!("{longer}`emmy report {}` writes the report again", directory.display());
    Err(Failure::Usage { message, help: Some(help) })
}

/// Whether the run up to a time ended before all its files were written.
fn is_unfinished(problem: &Problem, time: f64) -> bool {
    let summary = summary::of_run(&problem.output.directory);
    let is_at_end = problem.plan.end() >= time;
    let has_page = problem.output.directory.join("report.html").is_file();
    match summary["status"].as_str() {
        Some(status) if status == Status::Done.name() => is_at_end && !has_page,
        // The state exceeds the limit, wherever the plan ends.
        Some(status) => is_at_end && status != Status::LimitExceeded.name(),
        None => is_at_end,
    }
}

/// Moves the time to the grid of the plan, and drops the memory of the stepper where it is no longer valid.
fn settle(problem: &Problem, checkpoint: &mut Checkpoint, identity: &Identity) {
    let keeps_stepper = checkpoint.identity.has_same_stepper(identity);
    let snapshot = &mut checkpoint.snapshot;
    snapshot.state.time = problem.plan.on_grid(snapshot.state.time);
    snapshot.record.time = snapshot.state.time;
    let step = snapshot.state.step;
    let time = snapshot.state.time;
    checkpoint.frames.iter_mut().filter(|frame| frame.step == step).for_each(|frame| frame.time = time);
    if !keeps_stepper {
        (snapshot.memory, snapshot.control) = (None, None);
    }
}
