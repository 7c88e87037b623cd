//! `emmy-bench precision`: error over time and over steps, adaptive steps compared with equal ones.

mod cases;
mod compare;
mod fork;
mod output;
mod run;

use std::path::PathBuf;

use clap::Args;

use crate::machine;
use crate::report::Report;
use cases::Case;
use run::Sweep;

/// Arguments of `emmy-bench precision`.
#[derive(Debug, Clone, Args)]
pub(crate) struct Arguments {
    /// orbit, block, pulse, damped, fork; all of them without a name
    cases: Vec<String>,
    /// Folder for NAME.csv and NAME.svg
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// How often everything runs, in turns
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// One round of few runs, without verdicts about time: for continuous integration
    #[arg(long)]
    quick: bool,
}

/// Measures the cases and prints a table of each.
///
/// # Errors
/// The message of any failure.
pub(crate) fn print(arguments: &Arguments) -> Result<(), String> {
    let names = named(&arguments.cases)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build_global();
    pool.map_err(|error| error.to_string())?;
    let rounds = if arguments.quick { 1 } else { usize::from(arguments.rounds) };
    println!("{}\n", machine::heading());
    println!("Fastest of {rounds} rounds of runs in turns, one thread.");
    let mut summary = output::summary();
    for name in names {
        // Inside the pool, like `emmy run`.
        let (report, rows) = rayon::scope(|_| measure(name, arguments, rounds))?;
        print!("\n{}", report.markdown(!arguments.quick));
        rows.into_iter().for_each(|row| summary.tables[0].push(row));
    }
    print!("\n{}", summary.markdown(!arguments.quick));
    Ok(())
}

/// The report of a case, and its rows in the summary.
fn measure(name: &str, arguments: &Arguments, rounds: usize) -> Result<(Report, Vec<Vec<String>>), String> {
    let case = Case::named(name)?;
    let case = if arguments.quick { case.quick() } else { case };
    let sweep = Sweep::measure(&case, rounds).map_err(|message| format!("{name}: {message}"))?;
    if let Some(folder) = &arguments.output {
        output::write(&case, &sweep, folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    Ok((output::report(&case, &sweep), output::summary_rows(&case, &sweep)))
}

/// The names of the requested cases.
fn named(names: &[String]) -> Result<Vec<&'static str>, String> {
    if names.is_empty() {
        return Ok(cases::NAMES.to_vec());
    }
    let known = |name: &String| cases::NAMES.into_iter().find(|known| known == name);
    let unknown = |name: &String| format!("there is no case {name}; there are {}", cases::NAMES.join(", "));
    names.iter().map(|name| known(name).ok_or_else(|| unknown(name))).collect()
}
