//! `emmy modes FILE`: natural modes, as a table and as files.

use std::path::PathBuf;

use clap::Args;
use emmy::body::{Body, RegionSummary};
use emmy::equilibrium::unbalanced_force;
use emmy::modes::{Mode, modes, modes_about, n_modes};
use emmy::motion::State;
use emmy_io::input::{self, NOTHING_MOVES, Overrides, Problem, Start};

use super::{with_ending, with_threads};
use crate::failure::Failure;
use crate::host::{Host, message};
use crate::print::{self, columns, number};

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Input file (TOML)
    file: PathBuf,
    /// Number of modes, rigid ones included [default: 10, or all of a smaller body]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    count: Option<u32>,
    /// Output directory [default: the directory of the input, with `-modes` added]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Change a value of the input, such as region.0.density=2.5 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Number of threads; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// No messages on standard error
    #[arg(long)]
    quiet: bool,
}

/// Number of modes without `--count`.
const DEFAULT_COUNT: usize = 10;

/// Number of modes with `--count` or without.
pub(super) fn n_wanted(body: &Body, count: Option<u32>) -> usize {
    count.map_or_else(|| DEFAULT_COUNT.min(n_modes(body).max(1)), |count| count as usize)
}

/// Computes, prints and writes the modes.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    with_threads(arguments.threads, host, || run_here(arguments, host))?
}

fn run_here(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let overrides = Overrides { set: arguments.set.clone(), ..Overrides::default() };
    let problem = input::read(&arguments.file, &overrides)?;
    if !arguments.quiet {
        let notes = problem.notes.iter().filter(|note| *note != NOTHING_MOVES);
        notes.for_each(|note| message!(host, "note: {note}"));
    }
    let directory = arguments.directory(&problem);
    emmy_io::modes::check(&directory, &problem)?;
    let state = problem.state_of_vibration()?;
    let modes = computed(&problem, state.as_ref(), arguments.count)?;
    let displacement =
        state.as_ref().map_or_else(|| vec![0.0; problem.body.n_dofs()], |state| state.displacement.clone());
    emmy_io::modes::write(&directory, &problem, &displacement, &modes)?;
    print::result(host, &table(&problem, &modes))?;
    let page = emmy_io::report::write(&directory)?;
    if !arguments.quiet {
        about(&problem, state.as_ref(), host)?;
        remarks(&modes, host);
        seen(&problem, &modes, host);
        message!(host, "written: {}", directory.join(emmy_io::modes::TABLE).display());
        message!(host, "to look at: {}", page.display());
    }
    Ok(())
}

impl Arguments {
    fn directory(&self, problem: &Problem) -> PathBuf {
        self.output.clone().unwrap_or_else(|| with_ending(&problem.output.directory, "-modes"))
    }
}

/// The modes about a state, or about the undeformed body.
fn computed(problem: &Problem, state: Option<&State>, count: Option<u32>) -> Result<Vec<Mode>, Failure> {
    let body = &problem.body;
    let n = n_wanted(body, count);
    let found = match state {
        Some(state) => modes_about(body, state, n),
        None => modes(body, n),
    };
    found.map_err(|error| failure(error, count.is_some()))
}

/// An iteration that does not converge is not a fault of the input.
pub(super) fn failure(error: emmy::Error, is_count_given: bool) -> Failure {
    match error {
        emmy::Error::TooManyModes { free, .. } => {
            let help = match free {
                0 => "supports and joints hold all of it".to_string(),
                free => format!("take at most {free}"),
            };
            let flag = if is_count_given { "--count: " } else { "" };
            Failure::Usage { message: format!("{flag}{error}"), help: Some(help) }
        }
        emmy::Error::Modes { .. } => {
            let help = "nothing was written; thin cells and stiff springs leave the lowest modes few digits";
            Failure::Study { message: error.to_string(), help: help.to_string() }
        }
        emmy::Error::Linear { .. } | emmy::Error::Rotation { .. } => {
            Failure::Study { message: error.to_string(), help: "nothing was written".to_string() }
        }
        error => error.into(),
    }
}

/// The modes with their effective masses relative to the mass of the body.
fn table(problem: &Problem, modes: &[Mode]) -> String {
    let mass = RegionSummary::combined(problem.body.regions()).mass;
    let share = |effective: f64| format!("{:.1} %", 100.0 * effective / mass);
    let labels = [problem.units.label("frequency", "frequency"), problem.units.label("period", "time")];
    let masses = ["mass x", "mass y", "mass z"].map(String::from);
    let head = ["mode".to_string()].into_iter().chain(labels).chain(masses).collect();
    let row = |(index, mode): (usize, &Mode)| {
        let period = match mode.angular_frequency {
            0.0 => "rigid".to_string(),
            _ if mode.is_elastic() => number(mode.period()),
            _ => "unstable".to_string(),
        };
        let own = [(index + 1).to_string(), number(mode.frequency()), period];
        own.into_iter().chain(mode.effective_mass.map(share)).collect()
    };
    let sum = |axis: usize| share(modes.iter().map(|mode| mode.effective_mass[axis]).sum());
    let sums = ["sum".to_string(), String::new(), String::new()].into_iter().chain([0, 1, 2].map(sum));
    let rows = std::iter::once(head).chain(modes.iter().enumerate().map(row));
    columns(rows.chain([sums.collect()]).collect())
}

/// Prints the state about which the body vibrates, and which parts of the start have no effect.
fn about(problem: &Problem, state: Option<&State>, host: &dyn Host) -> Result<(), Failure> {
    let body = &problem.body;
    if problem.initial.iter().any(|field| field.angular_velocity != [0.0; 3]) {
        message!(host, "note: the modes are those of the body at rest; its initial rotation has no effect");
    }
    let Some(state) = state else { return Ok(()) };
    let largest = |vectors: &[f64], dimension| problem.units.number(largest_length(vectors), dimension);
    let displaced = format!("largest displacement {}", largest(&state.displacement, "length"));
    let Start::Run(directory) = &problem.start else {
        if state.displacement.iter().any(|u| *u != 0.0) {
            message!(host, "about the equilibrium under the loads at t = 0; {displaced}");
        }
        return Ok(());
    };
    message!(host, "about the last state of the run in {}; {displaced}", directory.display());
    let mut faults = Vec::new();
    if state.velocity.iter().any(|v| *v != 0.0) {
        faults
            .push(format!("it moves, with velocities of up to {}", largest(&state.velocity, "length/time")));
    }
    let mut forces = unbalanced_force(body, &state.displacement, state.time)?;
    let all = largest_length(&forces);
    forces.iter_mut().zip(body.fixed()).filter(|(_, fixed)| **fixed).for_each(|(force, _)| *force = 0.0);
    if largest_length(&forces) > UNBALANCED * all {
        let size = largest(&forces, "force");
        faults.push(format!("nodal forces of up to {size} are not balanced under the loads at t = 0"));
    }
    if !faults.is_empty() {
        let faults = faults.join(", and ");
        message!(
            host,
            "note: this state is no equilibrium ({faults}); the modes are about its positions alone"
        );
    }
    Ok(())
}

/// Unbalanced force, relative to the largest reaction, that may come from rounding and from the end of an iteration.
const UNBALANCED: f64 = 1e-6;

/// Largest length of a vector, `[n_nodes][3]`.
fn largest_length(vectors: &[f64]) -> f64 {
    let length = |[x, y, z]: &[f64; 3]| (x * x + y * y + z * z).sqrt();
    vectors.as_chunks().0.iter().map(length).fold(0.0, f64::max)
}

/// Remarks on rigid and unstable modes.
fn remarks(modes: &[Mode], host: &dyn Host) {
    let rigid = modes.iter().filter(|mode| mode.angular_frequency == 0.0).count();
    let unstable = modes.iter().filter(|mode| mode.angular_frequency < 0.0).count();
    if rigid > 0 {
        message!(host, "note: {rigid} rigid {}, in which nothing holds the body", plural(rigid));
    }
    if unstable > 0 {
        let modes = plural(unstable);
        message!(
            host,
            "note: {unstable} unstable {modes}, shown with a negative frequency: this equilibrium is unstable"
        );
    }
}

/// Residual of a vibration for an observer that turns, above which there is a remark.
const LARGE_RESIDUAL: f64 = 1e-3;

/// Remarks on frequencies that an observer sees who turns.
fn seen(problem: &Problem, modes: &[Mode], host: &dyn Host) {
    let Some(spin) = problem.body.observer_spin() else { return };
    let speed = spin.iter().map(|x| x * x).sum::<f64>().sqrt();
    let largest = modes.iter().map(|mode| mode.residual).fold(0.0, f64::max);
    message!(
        host,
        "note: frequencies are those that the observer sees, who turns with {}; a shape is one moment of a vibration in which \
         points run through ellipses",
        problem.units.number(speed, "1/time")
    );
    if largest > LARGE_RESIDUAL {
        message!(
            host,
            "note: residuals are up to {largest:.1e}, because twice as many real modes as are wanted span the vibrations: a larger \
             `--count` takes more"
        );
    }
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "mode" } else { "modes" }
}
