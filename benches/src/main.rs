//! Times and memory of Emmy, beside other programs, with a verdict on each goal.
//!
//!     cargo run --release -p emmy-bench -- [ITEM]... [--peers] [--rounds N] [--quick]
//!     cargo run --release -p emmy-bench -- case INPUT [--set KEY=VALUE]...
//!     cargo run --release -p emmy-bench -- precision [CASE]... [--output DIR]
//!
//! Compared runs take turns, each in a process of its own, and medians over the rounds are taken: machines are shared,
//! and times of different hours are not comparable. Prints Markdown. Ends with exit code 2 if something cannot be run,
//! or if an energy differs from the other programs; a missed goal is a result, not a failure.

mod items;
mod job;
mod machine;
mod measure;
mod mesh_file;
mod outcome;
mod peers;
mod precision;
mod process;
mod report;
mod roofline;
mod scratch;
mod session;
mod work;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::items::{Item, Settings};
use crate::peers::Interpreters;
use crate::session::Session;

/// Measures times and memory of Emmy.
#[derive(Debug, Parser)]
#[command(args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    verb: Option<Verb>,
    /// step (the default), schemes, degrees, stiff, real, solvers, locking, large, assembly, ensembles, threads, shake,
    /// check, contact; or all
    items: Vec<String>,
    /// Runs the other installed programs in turns with Emmy, instead of showing their recorded figures (`step`,
    /// `stiff`, `real`)
    #[arg(long)]
    peers: bool,
    /// Interpreter of another program, such as ngsolve=venv/bin/python [default: benches/peers/environments, the
    /// system's]
    #[arg(long, value_name = "NAME=PATH")]
    python: Vec<String>,
    /// How often everything runs
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// Core for the runs with one thread (with taskset); without it the system chooses
    #[arg(long, value_name = "N")]
    core: Option<usize>,
    /// Cells a unit length for `step` [default: 1,2,4,6], `stiff` [default: 4,6,8] and `large` [default:
    /// 4,6,8,12]
    #[arg(long, value_name = "R,...", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=64))]
    cells: Vec<u32>,
    /// `large` takes the one mesh of 1.5 million degrees of freedom
    #[arg(long)]
    million: bool,
    /// Small meshes, few steps, no verdicts about time: for continuous integration
    #[arg(long)]
    quick: bool,
}

/// Other modes of the program.
#[derive(Debug, Subcommand)]
enum Verb {
    /// Runs one input in this process and prints its figures as one line of JSON
    Case(measure::Arguments),
    /// Measures errors over time and over steps, steps chosen by the error beside equal ones
    Precision(precision::Arguments),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let done = match &arguments.verb {
        Some(Verb::Case(case)) => print_case(case),
        Some(Verb::Precision(arguments)) => precision::print(arguments),
        None => print_items(&arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

fn print_case(case: &measure::Arguments) -> Result<(), String> {
    let outcome = measure::measure(case)?;
    println!("{}", serde_json::to_string(&outcome).map_err(|error| error.to_string())?);
    Ok(())
}

fn print_items(arguments: &Arguments) -> Result<(), String> {
    let items = arguments.items()?;
    let settings = arguments.settings()?;
    println!("{}\n", machine::heading());
    println!("Medians over {} rounds of runs in turns.", settings.session.rounds);
    for item in items {
        let reports = (item.measure)(&settings).map_err(|message| format!("{}: {message}", item.name))?;
        reports.iter().for_each(|report| print!("\n{}", report.markdown(!arguments.quick)));
    }
    Ok(())
}

impl Arguments {
    /// The requested items; the first one if none is named.
    fn items(&self) -> Result<Vec<Item>, String> {
        if self.items.is_empty() {
            return Ok(vec![items::ALL[0]]);
        }
        if self.items.iter().any(|name| name == "all") {
            return Ok(items::ALL.to_vec());
        }
        let item = |name: &String| items::ALL.into_iter().find(|item| item.name == name);
        let unknown = |name: &String| {
            let names: Vec<&str> = items::ALL.iter().map(|item| item.name).collect();
            format!("there is no item {name}; there are {}", names.join(", "))
        };
        self.items.iter().map(|name| item(name).ok_or_else(|| unknown(name))).collect()
    }

    fn settings(&self) -> Result<Settings, String> {
        let pythons = Interpreters::new(&self.python)?;
        let mut cells = self.cells.clone();
        cells.sort_unstable();
        cells.dedup();
        let rounds = if self.quick { 1 } else { usize::from(self.rounds) };
        Ok(Settings {
            session: Session { quick: self.quick, rounds, core: self.core },
            peers: self.peers.then_some(pythons),
            cells: (!cells.is_empty()).then_some(cells),
            million: self.million,
        })
    }
}
