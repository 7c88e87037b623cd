//! `emmy run FILE`: the motion, with its results on disk.

mod closing;
mod json_lines;

use clap::Args;
use emmy::motion::{MarchError, Motion, State};
use emmy_io::directory;
use emmy_io::limits::LimitExceeded;
use emmy_io::results::Results;
use emmy_io::summary::Status;

use super::{Input, with_threads};
use crate::failure::{Failure, with_causes};
use crate::print;
use crate::progress::Progress;
use json_lines::JsonLines;

/// Arguments of the verb.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    input: Input,
    /// Number of threads; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// No progress and no closing report on standard error
    #[arg(long)]
    quiet: bool,
    /// One JSON object a step on standard output, and the summary at the end
    #[arg(long)]
    json: bool,
}

/// Runs the problem.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    with_threads(arguments.threads, || run_here(arguments))?
}

/// Runs the problem in the thread that it is called in.
fn run_here(arguments: &Arguments) -> Result<(), Failure> {
    let problem = arguments.input.problem()?;
    directory::check(&problem.output.directory)?;
    let state = State::initial(&problem.body, problem.plan.start(), &problem.initial)?;
    let mut motion = Motion::new(&problem.body, problem.scheme, problem.degree, problem.newton, state)?;
    // Only now, with everything read and built, is anything written.
    let mut results = Results::create(&problem)?;
    let mut progress = Progress::new(&problem.plan, arguments.quiet);
    let mut json = JsonLines::new(arguments.json, &problem.output.probes);
    let outcome = motion.march(&problem.plan, &mut [&mut json, &mut progress, &mut results]);
    progress.end();
    let (status, failure) = ending(outcome);
    let message = failure.as_ref().map(Failure::message);
    let summary = results.finish(motion.state(), status, message.as_deref());
    let summary = summary.map_err(|error| Failure::Other(format!("cannot write the summary: {error}")))?;
    if arguments.json {
        print::result(&format!("{summary}\n"))?;
    }
    // The numbers are safe: a page that cannot be written does not make a run fail.
    let report = results.report().inspect_err(|error| eprintln!("note: no report was written: {error}")).ok();
    if !arguments.quiet {
        closing::report(&results, status, report.as_deref());
    }
    failure.map_or(Ok(()), Err)
}

/// How the march ended, as it stands in the summary and as the program ends.
fn ending(outcome: Result<(), MarchError>) -> (Status, Option<Failure>) {
    match outcome {
        Ok(()) => (Status::Done, None),
        Err(MarchError::Step(error)) => {
            (Status::NoConvergence, Some(Failure::NoConvergence(with_causes(&error))))
        }
        Err(MarchError::Observer(error)) => match error.downcast::<LimitExceeded>() {
            Ok(limit) => (Status::LimitExceeded, Some(Failure::Limit(limit.to_string()))),
            Err(error) => {
                (Status::Failed, Some(Failure::Other(format!("the results cannot be written: {error}"))))
            }
        },
    }
}
