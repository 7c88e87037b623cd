//! `emmy compare DIR...`: several runs side by side, in a page, charts and a table; or the rows of sweeps.

use std::path::PathBuf;

use clap::Args;
use emmy_io::comparison::{self, Run, RunError};
use emmy_io::differences::Differences;
use emmy_io::directory;
use emmy_io::report;
use emmy_io::sweep::table::{self, is_sweep};
use emmy_io::sweep::{SweepTable, TableRow};
use serde_json::{Map, Value, json};

use super::sweep::{shown_columns, shown_number};
use crate::failure::Failure;
use crate::host::{Host, message};
use crate::print;

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Output directories of runs, or of sweeps over the same keys
    #[arg(required = true, value_name = "DIR")]
    directories: Vec<PathBuf>,
    /// Directory of the charts
    #[arg(long, value_name = "DIR", default_value = "compare")]
    output: PathBuf,
    /// No message on standard error
    #[arg(long)]
    quiet: bool,
    /// One JSON object a run, or a row, on standard output in place of the table
    #[arg(long)]
    json: bool,
}

/// Reads the runs, writes the charts, prints the table.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let directories = &arguments.directories;
    match directories.iter().filter(|directory| is_sweep(directory)).count() {
        0 => runs(arguments, host),
        n if n == directories.len() => sweeps(arguments, host),
        _ => {
            let of = |is: bool| directories.iter().find(|directory| is_sweep(directory) == is);
            let [sweep, run] =
                [of(true), of(false)].map(|own| own.map_or("".into(), |own| own.display().to_string()));
            let message = format!("{sweep} holds a sweep, and {run} does not");
            let help =
                "compare sweeps with sweeps; `emmy sweep --keep` keeps its runs in `runs/1`, `runs/2`, ...";
            Err(Failure::Files { message, help: Some(help.to_string()) })
        }
    }
}

/// The rows of sweeps side by side.
fn sweeps(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let sweeps = arguments.directories.iter().map(|directory| SweepTable::read(directory));
    let mut sweeps = sweeps.collect::<Result<Vec<_>, _>>()?;
    table::name_apart(&mut sweeps, &arguments.directories);
    if let [first, others @ ..] = &sweeps[..]
        && let Some(other) = others.iter().find(|other| other.keys != first.keys)
    {
        let [a, b] = [first, other].map(|own| format!("{} ({})", own.name, own.keys.join(", ")));
        let message = format!("the sweeps have other keys: {a} and {b}");
        return Err(Failure::Files { message, help: None });
    }
    directory::prepare_kind(&arguments.output, "comparison", "compare.svg")?;
    table::write(&arguments.output, &sweeps).map_err(|error| {
        Failure::Other(format!("cannot write to {}: {error}", arguments.output.display()))
    })?;
    let text = if arguments.json { sweep_lines(&sweeps) } else { sweep_table(&sweeps) };
    print::result(host, &text)?;
    if !arguments.quiet {
        message!(host, "written: {0}.csv, {0}.svg, {0}.png", arguments.output.join("compare").display());
    }
    Ok(())
}

/// For each combination of values the row of each sweep; then the largest differences from the first sweep.
fn sweep_table(sweeps: &[SweepTable]) -> String {
    let named = table::named_columns(sweeps);
    let columns = shown_columns(&named, |column| {
        sweeps.iter().flat_map(|own| own.rows.iter().map(|row| own.number(row, column))).collect()
    });
    let keys = sweeps.first().map_or(&[][..], |sweep| &sweep.keys);
    let words = |words: &[&str]| words.iter().map(|word| word.to_string()).collect::<Vec<_>>();
    let heads = columns.iter().map(|(_, head)| head.clone()).collect::<Vec<_>>();
    let mut lines = vec![[keys, &words(&["sweep", "run", "status"]), &heads].concat()];
    let rows = table::rows_side_by_side(sweeps);
    for own in &rows {
        for (sweep, row) in sweeps.iter().zip(own).filter_map(|(sweep, row)| Some((sweep, (*row)?))) {
            let numbers: Vec<String> =
                columns.iter().map(|(column, _)| shown_number(column, sweep.number(row, column))).collect();
            let middle = [sweep.name.clone(), row.run.to_string(), row.status.clone()];
            lines.push([&row.values[..], &middle, &numbers].concat());
        }
    }
    let mut text = print::columns(lines);
    let [first, others @ ..] = sweeps else { return text };
    if others.is_empty() {
        return text;
    }
    let head = words(&["largest difference"]).into_iter().chain(others.iter().map(|own| own.name.clone()));
    let mut lines = vec![head.collect::<Vec<_>>()];
    for (column, head) in columns.iter().filter(|(column, _)| column != "wall_seconds") {
        let of = |place: usize| {
            let pairs = rows.iter().filter_map(|own| Some((own[0]?, own[place]?)));
            let pairs = pairs.map(|(a, b)| [first.number(a, column), sweeps[place].number(b, column)]);
            pairs
                .map(|[a, b]| if a == b { 0.0 } else { (b - a).abs() / a.abs().max(b.abs()) })
                .fold(f64::NAN, f64::max)
        };
        let cells = (1..sweeps.len()).map(|place| match of(place) {
            part if part.is_nan() => "-".to_string(),
            part => format!("{:.2} %", 100.0 * part),
        });
        lines.push(std::iter::once(head.clone()).chain(cells).collect());
    }
    text += &format!("\n{}", print::columns(lines));
    text
}

/// An object for each row.
fn sweep_lines(sweeps: &[SweepTable]) -> String {
    let line = |(sweep, row): (&SweepTable, &TableRow)| {
        let mut object = Map::new();
        object.insert("sweep".into(), sweep.name.clone().into());
        object.insert("run".into(), row.run.into());
        object.extend(
            sweep.keys.iter().cloned().zip(row.values.iter().map(|value| Value::from(value.clone()))),
        );
        object.insert("status".into(), row.status.clone().into());
        object
            .extend(sweep.columns.iter().cloned().zip(row.numbers.iter().map(|number| Value::from(*number))));
        object.insert("message".into(), row.message.clone().into());
        format!("{}\n", Value::Object(object))
    };
    sweeps.iter().flat_map(|sweep| sweep.rows.iter().map(move |row| (sweep, row))).map(line).collect()
}

/// The runs side by side.
fn runs(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let runs = arguments.directories.iter().map(|directory| Run::read(directory));
    let mut runs = runs.collect::<Result<Vec<_>, _>>()?;
    name_apart(&mut runs, &arguments.directories);
    directory::prepare_kind(&arguments.output, "comparison", "compare.svg")?;
    comparison::write(&arguments.output, &runs).map_err(|error| {
        Failure::Other(format!("cannot write the charts to {}: {error}", arguments.output.display()))
    })?;
    let differences = Differences::between(&runs);
    let page = report::write_comparison(&arguments.output, &runs, &arguments.directories, &differences)?;
    let text = if arguments.json { lines(&runs, &differences) } else { tables(&runs, &differences) };
    print::result(host, &text)?;
    if !arguments.quiet {
        let stem = arguments.output.join("compare");
        message!(host, "written: {0}.svg, {0}.png, and single charts in {0}-*", stem.display());
        message!(host, "to look at: {}", page.display());
    }
    Ok(())
}

/// Names runs in directories of the same name by their full paths.
fn name_apart(runs: &mut [Run], directories: &[PathBuf]) {
    let names: Vec<String> = runs.iter().map(|run| run.name.clone()).collect();
    for (run, directory) in runs.iter_mut().zip(directories) {
        if names.iter().filter(|name| **name == run.name).count() > 1 {
            run.name = directory.display().to_string();
        }
    }
}

/// Fields of the summary in the table.
const COLUMNS: [(&str, &str); 8] = [
    ("scheme", "scheme"),
    ("degree", "degree"),
    ("steps", "steps"),
    ("newton_iterations", "corrections"),
    ("worst_energy_residual", "worst energy residual"),
    ("worst_angular_momentum_residual", "angular momentum"),
    ("wall_seconds", "seconds"),
    ("status", "status"),
];

fn table(runs: &[Run]) -> String {
    let head = ["run"].into_iter().chain(COLUMNS.map(|(_, title)| title)).map(String::from).collect();
    let row = |run: &Run| {
        let cells = COLUMNS.map(|(key, _)| cell(key, &run.summary[key]));
        std::iter::once(run.name.clone()).chain(cells).collect()
    };
    print::columns(std::iter::once(head).chain(runs.iter().map(row)).collect())
}

/// The runs, the keys in which their inputs differ, and the peaks of their columns.
fn tables(runs: &[Run], Differences { inputs, peaks }: &Differences) -> String {
    let mut text = table(runs);
    if runs.len() < 2 {
        return text;
    }
    let names = || runs.iter().map(|run| run.name.clone());
    let head = |title: &str| std::iter::once(title.to_string()).chain(names()).collect::<Vec<_>>();
    let missing = || "-".to_string();
    let keys = inputs.iter().map(|own| {
        let values = own.values.iter().map(|value| value.clone().unwrap_or_else(missing));
        std::iter::once(own.key.clone()).chain(values).collect()
    });
    if !inputs.is_empty() {
        let rows = std::iter::once(head("input")).chain(keys).collect();
        text += &format!("\n{}", print::columns(rows));
    }
    if !peaks.is_empty() {
        let others = names().skip(1).map(|name| format!("{name}, %"));
        let head = head("peak").into_iter().chain(others).collect::<Vec<_>>();
        let rows = peaks.iter().map(|own| {
            let values = own.values.iter().map(|value| print::number(*value));
            let parts = own.differences.iter().map(|part| match part.is_finite() {
                true => format!("{:+.2}", 100.0 * part),
                false => missing(),
            });
            std::iter::once(own.column.clone()).chain(values).chain(parts).collect()
        });
        text += &format!("\n{}", print::columns(std::iter::once(head).chain(rows).collect()));
    }
    text
}

fn cell(key: &str, value: &Value) -> String {
    match (value, value.as_f64()) {
        (Value::String(text), _) => text.clone(),
        (_, Some(number)) if key.starts_with("worst") => format!("{number:.2e}"),
        (_, Some(number)) if key == "wall_seconds" => format!("{number:.2}"),
        (Value::Number(number), _) => number.to_string(),
        _ => "-".to_string(),
    }
}

fn lines(runs: &[Run], differences: &Differences) -> String {
    let input = |place: usize| -> Map<String, Value> {
        differences.inputs.iter().map(|own| (own.key.clone(), own.values[place].clone().into())).collect()
    };
    let line = |(place, run): (usize, &Run)| {
        let object = json!({ "run": run.name, "summary": run.summary, "input": input(place) });
        format!("{object}\n")
    };
    runs.iter().enumerate().map(line).collect()
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        Failure::Files { message: error.to_string(), help: None }
    }
}
