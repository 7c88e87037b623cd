//! `emmy check FILE`: reports on an input. Runs nothing and writes nothing.

mod mechanism;
mod ranks;
mod report;

use clap::Args;
use emmy_io::input::Problem;

use super::{Input, agreed, is_first, period, unresolved_steps, with_threads};
use crate::failure::Failure;
use crate::host::{Host, message};
use crate::print;
pub(super) use report::Report;

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    /// Number of threads; the report does not depend on it [default: all cores; on ranks of `mpirun`, one each]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
}

impl Arguments {
    /// The flags in which the ranks of a team must agree.
    pub(super) fn compared(&self) -> String {
        self.input.compared()
    }
}

/// Prints the report.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    with_threads(arguments.threads, host, || run_here(arguments, host))?
}

fn run_here(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    // First, since a body cannot be divided among any number of ranks.
    let of_ranks = host.team().map(|team| {
        let problem =
            emmy_io::input::read_on_team(&arguments.input.file, &arguments.input.overrides(), team)?;
        Ok::<_, Failure>(ranks::report(&problem))
    });
    let of_ranks = of_ranks.transpose()?;
    let whole = if is_first(host) { run_alone(arguments, host) } else { Ok(()) };
    agreed(host, whole)?;
    of_ranks.map_or(Ok(()), |text| print::result(host, &text))
}

/// Prints the report on the whole body.
fn run_alone(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let problem = arguments.input.read_alone(host)?;
    emmy_io::directory::check_run(&problem)?;
    let Report { text, notes, .. } = whole_report(&problem)?;
    if let Some(warning) = unresolved_steps(&problem) {
        message!(host, "{warning}");
    }
    notes.iter().for_each(|note| message!(host, "note: {note}"));
    let mut file = Report::default();
    file.line("input", &arguments.input.file.display().to_string());
    print::result(host, &(file.text + &text))
}

/// The output of `emmy check` on the body of a problem: mesh, groups, masses, resultants of the loads, supports.
pub fn report_on_body(problem: &Problem) -> String {
    let mut report = Report { units: problem.units, ..Report::default() };
    of_body(&mut report, problem);
    report.text
}

fn of_body(report: &mut Report, problem: &Problem) {
    report.mesh(&problem.body);
    report.groups(&problem.body);
    report.body(problem);
}

/// The output of `emmy check` on a problem, without the name of its file: mesh, groups, masses, resultants of the
/// loads, supports, start, plan and output.
///
/// # Errors
/// [`Failure::Usage`] if the start does not fit the body, [`Failure::Study`] if its equilibrium is not found.
pub fn report_on(problem: &Problem) -> Result<String, Failure> {
    Ok(whole_report(problem)?.text)
}

fn whole_report(problem: &Problem) -> Result<Report, Failure> {
    let mut report = Report { units: problem.units, ..Report::default() };
    report.line("title", problem.title.as_deref().unwrap_or("(none)"));
    if let Some(units) = problem.units.description() {
        report.line("units", &units);
    }
    of_body(&mut report, problem);
    let state = problem.check_start()?;
    report.start(problem, state.as_ref());
    report.time(problem);
    if let Some(step) = problem.critical_step(state.as_ref())? {
        let step = problem.units.number(step, "time");
        report.line("stability", &format!("critical step {step} at the start"));
        report.stability_in_contact(problem, state.as_ref());
    }
    period::report(&mut report, problem, state.as_ref());
    report.output(problem);
    problem.formulations.advice.iter().for_each(|advice| report.line("advice", advice));
    Ok(report)
}
