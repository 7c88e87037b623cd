//! `emmy converge FILE --sizes A,B,C`: the error over the step size.

mod runs;
mod study;
mod table;

use std::path::PathBuf;

use clap::Args;
use emmy_io::convergence::{self, MemberRun};
use emmy_io::directory::{self, MARK};
use emmy_io::input::{self, Overrides, Problem};

use super::with_threads;
use crate::failure::Failure;
use crate::host::{Host, message};
use crate::print;
use runs::Runs;

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Input file (TOML)
    file: PathBuf,
    /// Step sizes, such as 0.04,0.02,0.01
    #[arg(long, value_name = "A,B,C", value_delimiter = ',', required = true, allow_hyphen_values = true)]
    sizes: Vec<f64>,
    /// Step size of the reference [default: a tenth of the smallest size]
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    reference: Option<f64>,
    /// Scheme of the reference [default: the input's scheme]
    #[arg(long, value_name = "SCHEME")]
    reference_scheme: Option<String>,
    /// Degree of the reference [default: the input's degree]
    #[arg(long, value_name = "K")]
    reference_degree: Option<usize>,
    /// Time from which on each run has its own step size [default: the start]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    from: Option<f64>,
    /// Time at which the runs end [default: the end of the plan]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    to: Option<f64>,
    /// Times between which the error is measured [default: the whole run]
    #[arg(long, value_name = "TA,TB", value_delimiter = ',', allow_hyphen_values = true)]
    window: Option<Vec<f64>>,
    /// Change a value of the input, such as time.scheme=DGM or region.0.density=2.5 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Output directory [default: the directory of the input, with `-convergence` added]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Number of threads, and of members side by side; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// No progress on standard error
    #[arg(long)]
    quiet: bool,
    /// One JSON object on standard output instead of the table
    #[arg(long)]
    json: bool,
}

const KIND: &str = "convergence study";
/// The file by which the directory of a study is recognized.
const WITNESS: &str = "study.toml";

/// Runs the study.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    with_threads(arguments.threads, host, || converge(arguments, host))?
}

/// Runs the study in the calling thread.
fn converge(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let problem = arguments.problem()?;
    problem.notes.iter().for_each(|note| message!(host, "note: {note}"));
    let study = study::read(arguments, &problem)?;
    let times = study.sample_times()?;
    let directory = arguments.directory(&problem);
    directory::check_kind(&directory, KIND, WITNESS)?;
    let runs = Runs { study: &study, host, is_quiet: arguments.quiet };
    let state = runs.start(&problem)?;
    // Nothing is written before the runs are ready to start.
    directory::prepare_kind(&directory, KIND, WITNESS)?;
    write(&directory.join(WITNESS), &input(&problem))?;
    let reference = runs.reference(&problem, &state, &times, &directory)?;
    let narrow = convergence::on_one_thread(|| arguments.problem()).map_err(Failure::Other)??;
    let rows = runs.members(&narrow, &state, &reference.samples);
    convergence::write(&directory, &study, &rows).map_err(|error| not_written(&directory, &error))?;
    print::result(
        host,
        &match arguments.json {
            true => format!("{}\n", table::json(&study, &reference, &rows)),
            false => table::text(&rows),
        },
    )?;
    if !arguments.quiet {
        let stem = directory.join("convergence");
        message!(host, "written: {0}.csv, {0}.svg, {0}.png", stem.display());
    }
    ending(&rows)
}

impl Arguments {
    fn problem(&self) -> Result<Problem, Failure> {
        let overrides = Overrides { set: self.set.clone(), ..Default::default() };
        Ok(input::read(&self.file, &overrides)?)
    }

    fn directory(&self, problem: &Problem) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let mut name = problem.output.directory.clone().into_os_string();
            name.push("-convergence");
            name.into()
        })
    }
}

/// The resolved input with its mark.
fn input(problem: &Problem) -> String {
    let version = env!("CARGO_PKG_VERSION");
    format!("{MARK} {version}: the input of this convergence study.\n\n{}", problem.resolved)
}

fn write(path: &std::path::Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text).map_err(|error| not_written(path, &error))
}

fn not_written(path: &std::path::Path, error: &std::io::Error) -> Failure {
    Failure::Other(format!("cannot write to {}: {error}", path.display()))
}

/// After everything is written, members that did not converge end the program with exit code 3.
fn ending(rows: &[MemberRun]) -> Result<(), Failure> {
    let why = |row: &MemberRun| {
        row.outcome.as_ref().err().map(|why| format!("h = {}: {why}", print::number(row.step_size)))
    };
    let failed: Vec<String> = rows.iter().filter_map(why).collect();
    if failed.is_empty() {
        return Ok(());
    }
    let message =
        format!("{} of {} members did not converge\n{}", failed.len(), rows.len(), failed.join("\n"));
    Err(Failure::Study { message, help: "the other members are written".to_string() })
}
