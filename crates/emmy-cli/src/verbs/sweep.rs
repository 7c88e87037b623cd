//! `emmy sweep FILE --set KEY=A,B,C`: a run for every combination of values.

use std::collections::HashSet;
use std::path::PathBuf;

use clap::Args;
use emmy_io::directory;
use emmy_io::sweep::{SWEEP_KIND, SWEEP_WITNESS, Sweep, SweepError, SweepFile, SweepRow};

use super::with_threads;
use crate::failure::Failure;
use crate::host::{Host, message};
use crate::print::{self, columns, number};
use crate::progress::RunsProgress;

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Input file (TOML)
    file: PathBuf,
    /// Values of a key, such as region.density=1,2,3 or time.scheme=AS(2),DGM (repeatable; the last one changes fastest).
    /// Brackets and quotes hold a value together: load.traction=[0,0,1],[0,0,2]. One value is a constant
    #[arg(long, value_name = "KEY=A,B,C", required = true)]
    set: Vec<String>,
    /// End of the runs: later steps are dropped, or the last phase is extended
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    until: Option<f64>,
    /// Output directory [default: the directory of the input, with `-sweep` added]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Continue an interrupted sweep of the same input: only runs without a row
    #[arg(long)]
    resume: bool,
    /// Number of threads, and of runs side by side; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// No progress on standard error
    #[arg(long)]
    quiet: bool,
}

/// Rows of the table on standard output at most.
const MAX_SHOWN: usize = 20;

/// Columns of that table after the values, by their names in `sweep.csv` and in the head.
const SHOWN: [(&str, &str); 6] = [
    ("end_time", "end time"),
    ("steps", "steps"),
    ("newton_iterations_per_step", "Newton/step"),
    ("total_energy", "total energy"),
    ("energy_drift", "energy drift"),
    ("wall_seconds", "seconds"),
];

/// Failed runs whose messages are shown at most.
const MAX_FAILURES: usize = 5;

/// Runs the sweep.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    with_threads(arguments.threads, host, || sweep(arguments, host))?
}

/// Runs the sweep in the calling thread.
fn sweep(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let sweep = Sweep::read(&arguments.file, &arguments.set, arguments.until)?;
    sweep.notes().iter().for_each(|note| message!(host, "note: {note}"));
    let directory = arguments.output.clone().unwrap_or_else(|| sweep.directory());
    directory::check_kind(&directory, SWEEP_KIND, SWEEP_WITNESS)?;
    let (mut file, mut rows) = match arguments.resume {
        true => SweepFile::resume(&sweep, &directory)?,
        false => (SweepFile::create(&sweep, &directory)?, Vec::new()),
    };
    let mut missing = sweep.all();
    let known: HashSet<usize> = rows.iter().map(|row| row.run).collect();
    missing.retain(|run| !known.contains(run));
    if arguments.resume && !arguments.quiet {
        message!(host, "resuming: {} of {} runs have a row", rows.len(), sweep.n_runs());
    }
    host.prepare()?;
    let mut progress = RunsProgress::new(host, missing.len(), arguments.quiet);
    let outcome = emmy_io::sweep(
        &sweep,
        &missing,
        || host.is_interrupted(),
        |row| {
            file.write(row)?;
            progress.add(row.failure.as_ref().map(|failure| format!("{}: {failure}", sweep.name(row.run))));
            Ok(())
        },
    );
    progress.end();
    rows.extend(outcome.map_err(not_written)?);
    rows.sort_by_key(|row| row.run);
    let path = file.path().to_path_buf();
    file.finish(&rows).map_err(not_written)?;
    print::result(host, &table(&sweep, &rows))?;
    if !arguments.quiet {
        message!(host, "written: {}", path.display());
    }
    warn_of_loads(&sweep, &rows, host);
    ending(&sweep, &rows)
}

fn not_written(error: std::io::Error) -> Failure {
    Failure::Other(format!("cannot write the sweep: {error}"))
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        let help = match &error {
            SweepError::Directory(_) => None,
            SweepError::Nothing { .. } => Some("leave --resume out to start a sweep"),
            SweepError::Changed { .. } => {
                Some("restore the input, or leave --resume out to replace that sweep")
            }
            SweepError::Damaged { .. } => {
                Some("remove this line, or leave --resume out to replace the sweep")
            }
            SweepError::System(_) => return Failure::Other(error.to_string()),
        };
        Failure::Files { message: error.to_string(), help: help.map(String::from) }
    }
}

/// The first rows.
fn table(sweep: &Sweep, rows: &[SweepRow]) -> String {
    let text = |words: &[&str]| words.iter().map(|word| word.to_string()).collect::<Vec<_>>();
    let names = SHOWN.map(|(_, name)| name);
    let head = [&text(&["run"])[..], &text(&sweep.keys()), &text(&["status"]), &text(&names)].concat();
    let line = |row: &SweepRow| {
        let status = if row.failure.is_some() { "failed" } else { "completed" };
        let numbers = SHOWN.map(|(column, _)| shown(sweep, row, column));
        [&[(row.run + 1).to_string()][..], &text(&sweep.values(row.run)), &text(&[status]), &numbers].concat()
    };
    // If more do not fit, the last line says so.
    let n_shown = if rows.len() > MAX_SHOWN { MAX_SHOWN - 1 } else { rows.len() };
    let lines = std::iter::once(head).chain(rows[..n_shown].iter().map(line)).collect();
    match rows.len() - n_shown {
        0 => columns(lines),
        more => format!("{}... and {more} more runs in sweep.csv\n", columns(lines)),
    }
}

/// The number of a column, for reading.
fn shown(sweep: &Sweep, row: &SweepRow, column: &str) -> String {
    let value = of(sweep, row, column);
    match column {
        _ if value.is_nan() => String::new(),
        "wall_seconds" => format!("{value:.2}"),
        "energy_drift" => format!("{value:.0e}"),
        _ => number(value),
    }
}

/// The number of a column; NaN if it is missing.
fn of(sweep: &Sweep, row: &SweepRow, column: &str) -> f64 {
    let place = sweep.columns().iter().position(|name| name == column);
    place.map_or(f64::NAN, |place| row.numbers[place].value())
}

/// A warning of runs whose steps did not resolve a load.
fn warn_of_loads(sweep: &Sweep, rows: &[SweepRow], host: &dyn Host) {
    let missed = rows.iter().filter(|row| of(sweep, row, "unresolved_loads") > 0.0).count();
    if missed > 0 {
        message!(
            host,
            "warning: in {missed} runs, steps did not resolve a load or a moving support (column unresolved_loads)"
        );
    }
}

/// After everything is written, a signal or failed runs are the end of the program.
fn ending(sweep: &Sweep, rows: &[SweepRow]) -> Result<(), Failure> {
    if rows.len() < sweep.n_runs() {
        let message = format!("stopped with the rows of {} of {} runs", rows.len(), sweep.n_runs());
        let help = "the same command with --resume runs the others".to_string();
        return Err(Failure::Interrupted { message, help });
    }
    let why = |row: &SweepRow| Some(format!("{}: {}", sweep.name(row.run), row.failure.as_ref()?));
    let failed: Vec<String> = rows.iter().filter_map(why).collect();
    if failed.is_empty() {
        return Ok(());
    }
    let first = failed[..failed.len().min(MAX_FAILURES)].join("\n");
    let message = format!("{} of {} runs failed\n{first}", failed.len(), rows.len());
    let help = "the rows of the other runs are complete; the column `message` has the reason of each failure";
    Err(Failure::Study { message, help: help.to_string() })
}
