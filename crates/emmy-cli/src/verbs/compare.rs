//! `emmy compare DIR...`: several runs side by side, in a page, charts and a table.

use std::path::PathBuf;

use clap::Args;
use emmy_io::comparison::{self, Run, RunError};
use emmy_io::directory;
use emmy_io::report;
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::host::{Host, message};
use crate::print;

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Output directories of runs
    #[arg(required = true, value_name = "DIR")]
    directories: Vec<PathBuf>,
    /// Directory of the charts
    #[arg(long, value_name = "DIR", default_value = "compare")]
    output: PathBuf,
    /// No message on standard error
    #[arg(long)]
    quiet: bool,
    /// One JSON object a run on standard output in place of the table
    #[arg(long)]
    json: bool,
}

/// Reads the runs, writes the charts, prints the table.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let runs = arguments.directories.iter().map(|directory| Run::read(directory));
    let mut runs = runs.collect::<Result<Vec<_>, _>>()?;
    name_apart(&mut runs, &arguments.directories);
    directory::prepare_kind(&arguments.output, "comparison", "compare.svg")?;
    comparison::write(&arguments.output, &runs).map_err(|error| {
        Failure::Other(format!("cannot write the charts to {}: {error}", arguments.output.display()))
    })?;
    let named = runs.iter().map(|run| run.name.clone()).zip(arguments.directories.iter().cloned());
    let page = report::write_comparison(&arguments.output, &named.collect::<Vec<_>>())?;
    print::result(host, &if arguments.json { lines(&runs) } else { table(&runs) })?;
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
    ("newton_iterations", "Newton"),
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

fn cell(key: &str, value: &Value) -> String {
    match (value, value.as_f64()) {
        (Value::String(text), _) => text.clone(),
        (_, Some(number)) if key.starts_with("worst") => format!("{number:.2e}"),
        (_, Some(number)) if key == "wall_seconds" => format!("{number:.2}"),
        (Value::Number(number), _) => number.to_string(),
        _ => "-".to_string(),
    }
}

fn lines(runs: &[Run]) -> String {
    runs.iter().map(|run| format!("{}\n", json!({ "run": run.name, "summary": run.summary }))).collect()
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        Failure::Files { message: error.to_string(), help: None }
    }
}
