//! `emmy modes FILE`: natural modes, as a table and as files.

use std::path::PathBuf;

use clap::Args;
use emmy::body::RegionSummary;
use emmy::modes::{Mode, modes, modes_about, n_modes};
use emmy_io::input::{self, Overrides, Problem, Start, StartError};

use super::with_threads;
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

/// Computes, prints and writes the modes.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    with_threads(arguments.threads, host, || run_here(arguments, host))?
}

fn run_here(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let overrides = Overrides { set: arguments.set.clone(), ..Overrides::default() };
    let problem = input::read(&arguments.file, &overrides)?;
    if !arguments.quiet {
        problem.notes.iter().for_each(|note| message!(host, "note: {note}"));
    }
    let directory = arguments.directory(&problem);
    emmy_io::modes::check(&directory, &problem)?;
    let (displacement, modes) = computed(&problem, arguments.count)?;
    emmy_io::modes::write(&directory, &problem, &displacement, &modes)?;
    print::result(host, &table(&problem, &modes))?;
    let page = emmy_io::report::write(&directory)?;
    if !arguments.quiet {
        about(&problem, &displacement, host);
        remarks(&modes, host);
        message!(host, "written: {}", directory.join(emmy_io::modes::TABLE).display());
        message!(host, "to look at: {}", page.display());
    }
    Ok(())
}

impl Arguments {
    fn directory(&self, problem: &Problem) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let mut name = problem.output.directory.clone().into_os_string();
            name.push("-modes");
            name.into()
        })
    }
}

/// The displacement about which the body vibrates, and its modes.
fn computed(problem: &Problem, count: Option<u32>) -> Result<(Vec<f64>, Vec<Mode>), Failure> {
    let body = &problem.body;
    let count = count.map_or(DEFAULT_COUNT.min(n_modes(body).max(1)), |count| count as usize);
    let Some(equilibrium) = problem.equilibrium()? else {
        let modes = modes(body, count).map_err(failure)?;
        return Ok((vec![0.0; body.n_dofs()], modes));
    };
    let state = equilibrium.start(problem.newton, &[], &mut []).map_err(StartError::from)?;
    let modes = modes_about(body, &state, count).map_err(failure)?;
    Ok((state.displacement, modes))
}

/// An iteration that does not converge is no fault of the input.
fn failure(error: emmy::Error) -> Failure {
    match error {
        emmy::Error::TooManyModes { free, .. } => {
            let help = match free {
                0 => "all nodes are held".to_string(),
                free => format!("take at most {free}"),
            };
            Failure::Usage { message: format!("--count: {error}"), help: Some(help) }
        }
        emmy::Error::Linear { .. } => {
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

/// Says about which state the body vibrates, unless it is the reference configuration of the input.
fn about(problem: &Problem, displacement: &[f64], host: &dyn Host) {
    match problem.start {
        Start::Run(_) => {
            message!(
                host,
                "note: the modes are about the reference configuration; `initial.state` has no effect"
            )
        }
        _ if displacement.iter().all(|u| *u == 0.0) => {}
        _ => {
            let lengths =
                displacement.as_chunks::<3>().0.iter().map(|[x, y, z]| (x * x + y * y + z * z).sqrt());
            let largest = problem.units.number(lengths.fold(0.0, f64::max), "length");
            message!(host, "about the equilibrium under the loads at t = 0; largest displacement {largest}");
        }
    }
}

/// Largest relative residual without a warning.
const MAX_RESIDUAL: f64 = 1e-4;

/// Remarks on rigid, unstable and inaccurate modes.
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
    let residual = modes.iter().map(|mode| mode.residual).fold(0.0, f64::max);
    if residual > MAX_RESIDUAL {
        message!(
            host,
            "warning: relative residuals of up to {residual:.0e}: the lowest modes have few correct digits"
        );
    }
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "mode" } else { "modes" }
}
