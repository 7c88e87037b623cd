//! `emmy sweep FILE --set KEY=A,B,C`: a run for every combination of values.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use clap::Args;
use emmy_io::accuracy;
use emmy_io::directory;
use emmy_io::history::Number;
use emmy_io::message::counted;
use emmy_io::sweep::{KEPT, SWEEP_KIND, SWEEP_WITNESS, Sweep, SweepError, SweepFile, SweepRow};
use serde_json::{Map, Value};

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
    /// Values of a key, such as region.density=1,2,3 or time.scheme=AS(2),DGM (repeatable; the last one changes
    /// fastest). Brackets and quotes hold a value together: load.traction=[0,0,1],[0,0,2]. One value is a constant
    #[arg(long, value_name = "KEY=A,B,C", required = true)]
    set: Vec<String>,
    /// End of the runs: later steps are dropped, or the last phase is extended
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    until: Option<f64>,
    /// Compute N natural modes of each run, rigid ones included, in place of its motion
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), conflicts_with_all = ["until", "keep"])]
    modes: Option<u32>,
    /// Output directory [default: the directory of the input, with `-sweep` added]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Continue an interrupted sweep of the same input: only runs without a row
    #[arg(long)]
    resume: bool,
    /// Number of threads, and of runs side by side; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Keep input, history and summary of each run, as a run in the folder `runs/N` of the directory
    #[arg(long)]
    keep: bool,
    /// No progress on standard error
    #[arg(long)]
    quiet: bool,
    /// One JSON object a run on standard output in place of the table
    #[arg(long)]
    json: bool,
}

/// Rows of the table on standard output at most.
const MAX_SHOWN: usize = 20;

/// Columns of that table after the values, by their names in `sweep.csv` and in the head.
const SHOWN: [(&str, &str); 6] = [
    ("end_time", "end time"),
    ("steps", "steps"),
    ("newton_iterations_per_step", "corrections/step"),
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
    let Arguments { file, set, until, modes, .. } = arguments;
    let mut sweep = match modes {
        Some(count) => Sweep::read_for_modes(file, set, *count as usize)?,
        None => Sweep::read(file, set, *until)?,
    };
    sweep.notes().iter().for_each(|note| message!(host, "note: {note}"));
    let directory = arguments.output.clone().unwrap_or_else(|| sweep.directory());
    directory::check_kind(&directory, SWEEP_KIND, SWEEP_WITNESS)?;
    if arguments.keep {
        sweep.keep_in(&directory);
    }
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
    if arguments.keep {
        note_runs_without_history(&directory, &rows, host);
    }
    host.prepare()?;
    let progress = Mutex::new(RunsProgress::new(host, missing.len(), arguments.quiet));
    let locked = || progress.lock().unwrap_or_else(PoisonError::into_inner);
    let outcome = emmy_io::sweep(
        &sweep,
        &missing,
        |run, part| {
            // A thread does not wait to show its progress.
            if let Ok(mut progress) = progress.try_lock() {
                progress.within(run, part);
            }
            host.is_interrupted()
        },
        |row| {
            file.write(row)?;
            let failure = row.failure.as_ref().map(|failure| format!("{}: {failure}", sweep.name(row.run)));
            locked().add(row.run, failure);
            Ok(())
        },
    );
    locked().end();
    rows.extend(outcome.map_err(not_written)?);
    rows.sort_by_key(|row| row.run);
    let path = file.path().to_path_buf();
    file.finish(&rows).map_err(not_written)?;
    let text = if arguments.json { lines(&sweep, &rows) } else { table(&sweep, &rows) };
    print::result(host, &text)?;
    if !arguments.quiet {
        message!(host, "written: {}", path.display());
    }
    warn_of_loads(&sweep, &rows, host);
    note_long_steps(&sweep, &rows, host);
    ending(&sweep, &rows)
}

/// Says which rows of a resumed sweep have no kept history.
fn note_runs_without_history(directory: &Path, rows: &[SweepRow], host: &dyn Host) {
    let history = |row: &SweepRow| directory.join(KEPT).join((row.run + 1).to_string()).join("history.csv");
    let without = rows.iter().filter(|row| row.failure.is_none() && !history(row).is_file()).count();
    if without > 0 {
        message!(host, "note: {without} of the earlier runs have no history: they were not kept");
    }
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
            SweepError::Unreadable { .. } => None,
            SweepError::System(_) => return Failure::Other(error.to_string()),
        };
        Failure::Files { message: error.to_string(), help: help.map(String::from) }
    }
}

/// The first rows.
fn table(sweep: &Sweep, rows: &[SweepRow]) -> String {
    let text = |words: &[&str]| words.iter().map(|word| word.to_string()).collect::<Vec<_>>();
    // If more do not fit, the last line says so.
    let n_shown = if rows.len() > MAX_SHOWN { MAX_SHOWN - 1 } else { rows.len() };
    let shown = &rows[..n_shown];
    let numbers = |column: &str| shown.iter().map(|row| of(sweep, row, column)).collect();
    let (names, heads): (Vec<String>, Vec<String>) =
        shown_columns(sweep.named_columns(), numbers).into_iter().unzip();
    let head = [&text(&["run"])[..], &text(&sweep.keys()), &text(&["status"]), &heads].concat();
    let line = |row: &SweepRow| {
        let numbers: Vec<String> =
            names.iter().map(|column| shown_number(column, of(sweep, row, column))).collect();
        let status = text(&[row.status().name()]);
        [&[(row.run + 1).to_string()][..], &text(&sweep.values(row.run)), &status, &numbers].concat()
    };
    let lines = std::iter::once(head).chain(shown.iter().map(line)).collect();
    match rows.len() - n_shown {
        0 => columns(lines),
        more => format!("{}... and {more} more runs in sweep.csv\n", columns(lines)),
    }
}

/// The columns of the printed table with their heads: those of every sweep of motions, then `X`, `X_min` and `X_max`
/// for each named column X that is not 0 in all rows; empty columns are left out. `numbers`: of a column in all rows.
pub(super) fn shown_columns(named: &[String], numbers: impl Fn(&str) -> Vec<f64>) -> Vec<(String, String)> {
    let peaks = named.iter().map(|name| ["", "_min", "_max"].map(|ending| format!("{name}{ending}")));
    let is_zero = |number: &f64| *number == 0.0 || number.is_nan();
    let peaks = peaks.filter(|own| !own.iter().all(|name| numbers(name).iter().all(is_zero)));
    let always = SHOWN.map(|(name, head)| (name.to_string(), head.to_string()));
    let all = always.into_iter().chain(peaks.flatten().map(|name| (name.clone(), name)));
    all.filter(|(name, _)| !numbers(name).iter().all(|number| number.is_nan())).collect()
}

/// The number of a column, for reading.
pub(super) fn shown_number(column: &str, value: f64) -> String {
    match column {
        _ if value.is_nan() => String::new(),
        "wall_seconds" => format!("{value:.2}"),
        "energy_drift" => format!("{value:.0e}"),
        _ => number(value),
    }
}

/// An object for each row.
fn lines(sweep: &Sweep, rows: &[SweepRow]) -> String {
    let line = |row: &SweepRow| {
        let keys = sweep.keys().into_iter().zip(sweep.values(row.run));
        let mut object = Map::new();
        object.insert("run".into(), (row.run + 1).into());
        object.extend(keys.map(|(key, value)| (key.to_string(), value.into())));
        object.insert("status".into(), row.status().name().into());
        let numbers = row.numbers.iter().map(|number| match *number {
            Number::Whole(value) => Value::from(value),
            number => Value::from(number.value()),
        });
        object.extend(sweep.columns().iter().cloned().zip(numbers));
        object.insert("message".into(), row.failure.clone().into());
        format!("{}\n", Value::Object(object))
    };
    rows.iter().map(line).collect()
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
            "warning: in {missed} runs, steps did not resolve a load or a given motion (column unresolved_loads)"
        );
    }
}

/// Says in how many runs the steps are too long for the lowest elastic period.
fn note_long_steps(sweep: &Sweep, rows: &[SweepRow], host: &dyn Host) {
    let is_coarse = |row: &&SweepRow| {
        let steps = of(sweep, row, "steps_per_lowest_period");
        accuracy::is_coarse(1.0, steps, sweep.scheme(row.run))
    };
    let coarse: Vec<&SweepRow> = rows.iter().filter(is_coarse).collect();
    let Some(first) = coarse.first() else { return };
    let [many, name] = [counted(coarse.len(), "run", "runs"), sweep.name(first.run)];
    host.statement(&format!(
        "note: in {many}, vibrations are not resolved: the steps are too long for the lowest elastic period \
         (column steps_per_lowest_period), first in {name}"
    ));
}

/// Once everything is written, a signal or failed runs set the exit code.
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
