//! `emmy run FILE`: the motion, with its results on disk.

mod closing;
mod json_lines;

use std::time::{Duration, Instant};

use clap::Args;
use emmy::motion::{GlobalError, MarchError, Motion, Observer, State, StepPlan};
use emmy::time::MAX_DEGREE;
use emmy_io::directory;
use emmy_io::input::{Problem, Start};
use emmy_io::limits::LimitExceeded;
use emmy_io::message::shown;
use emmy_io::results::Results;
use emmy_io::summary::Status;

use super::{Input, agreed, unresolved_steps, with_threads};
use crate::failure::Failure;
use crate::host::{Host, message};
use crate::print;
use crate::progress::Progress;
use crate::signals::{Interrupted, Stop};
use closing::Closing;
use json_lines::JsonLines;

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    options: RunOptions,
}

/// Options of runs and resumed runs.
#[derive(Debug, Args)]
pub(super) struct RunOptions {
    /// Number of threads; results do not depend on it [default: all cores; on ranks of `mpirun`, one each]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// No progress and no closing report on standard error
    #[arg(long)]
    pub quiet: bool,
    /// One JSON object a step on standard output, and the summary at the end
    #[arg(long)]
    pub json: bool,
    /// Stop after the step in which the program has run for this many seconds, with a checkpoint, as after a signal
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..))]
    wall_limit: Option<u32>,
    #[arg(skip = Instant::now())]
    started: Instant,
    /// Estimate the error of the positions at the end by a second motion of the next degree; takes two to three times
    /// as long
    #[arg(long)]
    pub estimate_error: bool,
}

impl Arguments {
    /// The flags in which the ranks of a team must agree.
    pub(super) fn compared(&self) -> String {
        format!("{} {}", self.input.compared(), self.options.compared())
    }
}

impl RunOptions {
    /// As [`Arguments::compared`].
    pub(super) fn compared(&self) -> String {
        let RunOptions { threads: _, quiet, json, wall_limit, started: _, estimate_error } = self;
        format!("{quiet} {json} {wall_limit:?} {estimate_error}")
    }

    /// When the time of the run is over.
    fn end(&self) -> Option<Instant> {
        self.wall_limit.map(|seconds| self.started + Duration::from_secs(seconds.into()))
    }
}

/// Runs the problem.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    with_threads(arguments.options.threads, host, || run_here(arguments, host))?
}

/// Runs the problem in the calling thread.
fn run_here(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let problem = arguments.input.problem(host)?;
    check(&problem, &arguments.options)?;
    agreed(host, check_directory(&problem))?;
    problem.critical_step(problem.check_start()?.as_ref())?;
    let mut motion = start(&problem, &arguments.options, host)?;
    if let Some(warning) = unresolved_steps(&problem) {
        message!(host, "{warning}");
    }
    // Nothing is written before everything is read and built.
    let results = Results::create(&problem)?;
    march((&problem, &arguments.options, host), &mut motion, results, Motion::march)
}

/// Checks that the run may write into its directory.
fn check_directory(problem: &Problem) -> Result<(), Failure> {
    if problem.rank() == 0 { Ok(directory::check_run(problem)?) } else { Ok(()) }
}

/// The start of the motion, with the progress of its equilibrium.
fn start<'a>(problem: &'a Problem, options: &RunOptions, host: &dyn Host) -> Result<Motion<'a>, Failure> {
    let Start::Equilibrium { load_steps } = problem.start else { return Ok(problem.motion(&mut [])?) };
    let mut progress = Progress::of(
        host,
        "equilibrium",
        &emmy::equilibrium::increments(load_steps)?,
        problem.units,
        options.quiet,
    );
    let motion = problem.motion(&mut [&mut progress]);
    progress.end();
    Ok(motion?)
}

/// Motion::march, or Motion::march_on.
type March<'a> = fn(&mut Motion<'a>, &StepPlan, &mut [&mut dyn Observer]) -> Result<(), MarchError>;

/// Marches with all observers, and ends the run.
pub(super) fn march<'a>(
    (problem, options, host): (&Problem, &RunOptions, &dyn Host),
    motion: &mut Motion<'a>,
    mut results: Results,
    march: March<'a>,
) -> Result<(), Failure> {
    agreed(host, host.prepare())?;
    results.notes().iter().for_each(|note| message!(host, "note: {note}"));
    let mut progress = Progress::new(host, &problem.plan, problem.units, options.quiet);
    progress.start_at(motion.state(), &problem.plan);
    let mut json = JsonLines::new(host, options.json, problem);
    let mut error = if options.estimate_error { Some(global_error(problem, motion.state())?) } else { None };
    let mut stop = Stop::new(host, results.directory(), options.end());
    let mut observers: Vec<&mut dyn Observer> = vec![&mut json, &mut progress, &mut results];
    observers.extend(error.as_mut().map(|error| error as &mut dyn Observer));
    observers.push(&mut stop);
    let outcome = march(motion, &problem.plan, &mut observers);
    progress.end();
    let error = error.map(|error| problem.body.mass_weighted_rms(error.displacement()));
    error.into_iter().for_each(|error| results.set_error(error));
    let (status, failure) = ending(outcome, &results, host);
    let message = failure.as_ref().map(Failure::message);
    let ended = results.finish(problem, motion, status, message.as_deref());
    let unwritten = ended.error.map(|error| format!("the results cannot be written: {error}"));
    let failure = match (failure, unwritten) {
        // The first failure says more.
        (Some(failure), Some(unwritten)) if failure.message() != unwritten => {
            message!(host, "note: {unwritten}");
            Some(failure)
        }
        (failure, unwritten) => failure.or(unwritten.map(Failure::Other)),
    };
    // The numbers are written: a report that cannot be written does not make the run fail.
    let report = results
        .report()
        .inspect_err(|error| message!(host, "note: no report was written: {}", shown(&error.to_string())))
        .ok()
        .flatten();
    let printed = if options.json { print::result(host, &format!("{}\n", ended.summary)) } else { Ok(()) };
    let seconds = ended.summary["wall_seconds"].as_f64().unwrap_or_default();
    let closing = Closing { host, problem, results: &results, seconds, accuracy: ended.accuracy.as_ref() };
    closing.warnings();
    if !options.quiet {
        closing.report(ended.status, report.as_deref());
    }
    failure.map_or(printed, Err)
}

/// Checks the options before anything is written.
pub(super) fn check(problem: &Problem, options: &RunOptions) -> Result<(), Failure> {
    let scheme = problem.scheme;
    if !options.estimate_error || scheme.is_time_element() && scheme.degree() < MAX_DEGREE {
        return Ok(());
    }
    let message =
        format!("--estimate-error: there is no next degree of {}, degree {}", scheme.name(), scheme.degree());
    let help = format!("it works with time elements up to degree {}", MAX_DEGREE - 1);
    Err(Failure::Usage { message, help: Some(help) })
}

/// The estimator of the error that accumulates from a state on.
fn global_error<'a>(problem: &'a Problem, state: &State) -> Result<GlobalError<'a>, Failure> {
    // One degree above the highest that the motion may have.
    let degrees = problem.plan.adaptivity().and_then(|adaptivity| adaptivity.degrees);
    let degree = degrees.map_or(problem.scheme.degree(), |[_, highest]| highest);
    let scheme = problem.scheme.at_degree(degree)?;
    Ok(GlobalError::new(&problem.body, scheme, problem.newton, state)?)
}

/// How the march ended: status of the summary, and failure of the program.
fn ending(outcome: Result<(), MarchError>, results: &Results, host: &dyn Host) -> (Status, Option<Failure>) {
    match outcome {
        Ok(()) => (Status::Done, None),
        // An observer of another rank.
        Err(MarchError::Step(error @ emmy::Error::Observer { .. })) => {
            (Status::Failed, Some(Failure::Other(error.to_string())))
        }
        Err(MarchError::Step(error)) => {
            (Status::NoConvergence, Some(Failure::NoConvergence(Box::new(error))))
        }
        Err(MarchError::Observer(error)) => match error.downcast::<LimitExceeded>() {
            Ok(limit) => (Status::LimitExceeded, Some(Failure::Limit(limit.to_string()))),
            Err(error) => match error.downcast::<Interrupted>() {
                Ok(interrupted) => (Status::Interrupted, Some(stopped(&interrupted, results, host))),
                Err(error) => {
                    (Status::Failed, Some(Failure::Other(format!("the results cannot be written: {error}"))))
                }
            },
        },
    }
}

fn stopped(interrupted: &Interrupted, results: &Results, host: &dyn Host) -> Failure {
    let directory = results.directory().display();
    let program =
        host.team().map_or("emmy".to_string(), |team| format!("mpirun -n {} emmy-mpi", team.size()));
    let help = match results.has_checkpoints() {
        true => format!("`{program} resume {directory}` resumes from here"),
        false => "`checkpoint_every` is 0: there is no checkpoint to resume from".to_string(),
    };
    Failure::Interrupted { message: interrupted.to_string(), help }
}
