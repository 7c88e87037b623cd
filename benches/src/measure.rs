//! One run in this process, measured step by step.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{StepDamping, StepInput};
use emmy::internals::sparse::inverse;
use emmy::motion::{Observer, Record, State, View};
use emmy::time::Scheme;
use emmy_io::accuracy::{Accuracy, lowest_period};
use emmy_io::input::{self, Overrides, Problem};

use crate::outcome::{Outcome, mean, median};
use crate::process::{cpu_time, peak_megabytes};

/// Arguments of `emmy-bench case`.
#[derive(Debug, Clone, Args)]
pub(crate) struct Arguments {
    /// Input file
    pub input: PathBuf,
    /// A value in place of the file's, as in `emmy run`
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Number of threads
    #[arg(long, default_value_t = 1)]
    pub threads: usize,
    /// Assemblies of residual and tangent to measure after the run, on one thread
    #[arg(long, default_value_t = 0)]
    pub assemblies: usize,
    /// File for all bits of the last state and of every step's energies and momenta
    #[arg(long, value_name = "FILE")]
    pub state: Option<PathBuf>,
    /// The statement on the accuracy of the run in time, as at the end of `emmy run`
    #[arg(long)]
    pub accuracy: bool,
    /// CPU seconds after which the run gives up, at the end of a step
    #[arg(long, value_name = "SECONDS")]
    pub longest: Option<f64>,
    /// Only the report of `emmy check`
    #[arg(long)]
    pub check: bool,
}

/// Beginning of the message of a run that cannot solve a step, or gives up.
pub(crate) const UNSOLVED: &str = "the run failed";
/// Words of the message of one that gives up.
pub(crate) const GAVE_UP: &str = "gave up after";

/// Runs the case and returns its figures.
///
/// # Errors
/// The message of any failure.
pub(crate) fn measure(arguments: &Arguments) -> Result<Outcome, String> {
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build_global();
    pool.map_err(|error| text(&error))?;
    // Inside the pool, like `emmy run`.
    rayon::scope(|_| measure_here(arguments))
}

fn measure_here(arguments: &Arguments) -> Result<Outcome, String> {
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let overrides = Overrides { set: arguments.set.clone(), ..Default::default() };
    let problem = input::read(&arguments.input, &overrides);
    let problem = problem.map_err(|error| format!("{}: {error}", arguments.input.display()))?;
    if arguments.check {
        emmy_cli::report_on(&problem).map_err(|error| format!("{error:?}"))?;
        return Ok(Outcome {
            cells: problem.body.mesh().n_cells(),
            dofs: problem.body.n_dofs(),
            threads: arguments.threads,
            peak_megabytes: peak_megabytes(),
            cpu_seconds_with_start: Some(cpu_time().as_secs_f64()),
            ..Outcome::default()
        });
    }
    let mut motion = problem.motion(&mut []).map_err(|error| text(&error))?;
    let mut steps = Steps { longest: arguments.longest, ..Steps::default() };
    motion.march(&problem.plan, &mut [&mut steps]).map_err(|error| format!("{UNSOLVED}: {error}"))?;
    // Before any other work.
    let (peak_megabytes, cpu_seconds_with_start) = (peak_megabytes(), Some(cpu_time().as_secs_f64()));
    if let Some(path) = &arguments.state {
        save(path, motion.state(), &steps.records).map_err(|error| text(&error))?;
    }
    let accuracy = arguments.accuracy.then(|| {
        Accuracy::of(&problem, &problem.plan, motion.statistics(), None, || lowest_period(&problem))
    });
    Ok(Outcome {
        threads: arguments.threads,
        steps_per_lowest_period: accuracy.flatten().and_then(|accuracy| accuracy.steps_per_period),
        peak_megabytes,
        cpu_seconds_with_start,
        assembled_cells_per_second: assembly_rate(&problem, motion.state(), arguments.assemblies)?,
        ..steps.outcome(&problem)
    })
}

/// The clocks at the start and after every step.
#[derive(Debug, Default)]
struct Steps {
    longest: Option<f64>,
    clocks: Vec<(Duration, Instant)>,
    records: Vec<Record>,
}

impl Observer for Steps {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let now = cpu_time();
        self.clocks.push((now, Instant::now()));
        self.records.push(view.record.clone());
        match self.longest {
            Some(longest) if now.as_secs_f64() > longest => Err(format!("{GAVE_UP} {longest:.1} s").into()),
            _ => Ok(()),
        }
    }
}

impl Steps {
    fn outcome(&self, problem: &Problem) -> Outcome {
        let cpu: Vec<f64> = self.clocks.windows(2).map(|w| (w[1].0 - w[0].0).as_secs_f64()).collect();
        let wall: Vec<f64> = self.clocks.windows(2).map(|w| (w[1].1 - w[0].1).as_secs_f64()).collect();
        let (later, steps) = (if cpu.len() > 2 { 2 } else { 0 }, &self.records[1..]);
        let average = |count: fn(&Record) -> usize| {
            steps.iter().map(count).sum::<usize>() as f64 / steps.len().max(1) as f64
        };
        let last = &self.records[self.records.len() - 1];
        Outcome {
            program: format!("Emmy {}", env!("CARGO_PKG_VERSION")),
            solver: problem.scheme.name(),
            cells: problem.body.mesh().n_cells(),
            dofs: problem.body.n_dofs(),
            cpu_seconds_per_step: median(&cpu[later..]),
            cpu_seconds_per_step_mean: mean(&cpu[later..]),
            wall_seconds_per_step_mean: mean(&wall[later..]),
            cpu_seconds: cpu.iter().sum(),
            newton_per_step: average(|record| record.newton_iterations),
            linear_per_step: average(|record| record.linear_iterations),
            kinetic_energy: last.kinetic_energy,
            strain_energy: last.strain_energy,
            ..Outcome::default()
        }
    }
}

/// Cells per second in the assembly of residual and tangent, median of some; for time elements, at the state reached.
fn assembly_rate(problem: &Problem, state: &State, count: usize) -> Result<Option<f64>, String> {
    if count == 0 {
        return Ok(None);
    }
    let Scheme::TimeElement(element) = problem.scheme else {
        return Err(format!("{} is not a time element", problem.scheme));
    };
    let rule = Rule::new(element.rule, element.degree);
    let inverse = inverse(rule.coefficients());
    let (body, k) = (&problem.body, element.degree);
    let step_size = problem.plan.phases()[0].size;
    let rates: Vec<f64> = state.velocity.iter().map(|v| step_size * v).collect::<Vec<_>>().repeat(k);
    let step = StepInput {
        coordinates: &[],
        damping: StepDamping::default(),
        local: None,
        rule: &rule,
        tangent_factor: step_size * step_size,
        displacement: &state.displacement,
        rates: &rates,
    };
    let mut assembly = body.assembly(&rule);
    let seconds = timed(count, || body.assemble(&step, Request::Tangent, &inverse, &mut assembly))?;
    Ok(Some(body.mesh().n_cells() as f64 / seconds))
}

/// CPU time of a piece of work, median of some, after one that is not counted.
fn timed(count: usize, mut work: impl FnMut() -> emmy::Result<()>) -> Result<f64, String> {
    let mut seconds = Vec::with_capacity(count);
    for _ in 0..=count {
        let start = cpu_time();
        work().map_err(|error| error.to_string())?;
        seconds.push((cpu_time() - start).as_secs_f64());
    }
    Ok(median(&seconds[1..]))
}

/// Writes displacement, momentum, velocity and the records' energies and momenta, 8 bytes per number.
fn save(path: &Path, state: &State, records: &[Record]) -> std::io::Result<()> {
    let numbers = [&state.displacement, &state.momentum, &state.velocity].into_iter().flatten().copied();
    let of_record = |record: &Record| {
        let energies = [record.kinetic_energy, record.strain_energy];
        energies.into_iter().chain(record.linear_momentum).chain(record.angular_momentum)
    };
    let bytes: Vec<u8> =
        numbers.chain(records.iter().flat_map(of_record)).flat_map(f64::to_le_bytes).collect();
    std::fs::write(path, bytes)
}
