//! The verbs, each in a file.

mod check;
mod compare;
mod completions;
mod converge;
mod list;
mod modes;
mod new;
mod period;
mod report;
mod response;
mod resume;
mod run;
mod schema;
mod sizes;
mod spectrum;
mod split;
mod sweep;

use std::num::NonZero;
use std::path::{Path, PathBuf};

pub use check::{report_on, report_on_body};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand};
use emmy::internals::motion::Resolution;
use emmy::team;
use emmy_io::input::{Overrides, Problem};

use crate::failure::Failure;
use crate::host::{Host, message};

/// The verb.
#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Write a commented example input into the working directory
    New(new::Arguments),
    /// Read an input and its mesh and report on them; run nothing
    Check(check::Arguments),
    /// Compute the motion and write the results
    ///
    /// The output directory may be new, empty, or hold an earlier run of Emmy, which is replaced. Files that are not
    /// Emmy's are never overwritten or removed; a directory that holds only such files is rejected. Bad input leaves
    /// everything as it is.
    Run(run::Arguments),
    /// Compute natural modes: frequencies, effective masses, mode shapes
    ///
    /// These are modes of the supported body about the start of the motion (the reference configuration,
    /// `[equilibrium]`, or `initial.state`), without viscosity and drag. Rigid modes are counted among them, with the
    /// frequency 0.
    Modes(modes::Arguments),
    /// Compute the response to harmonic excitation, by the modes
    ///
    /// The loads of the input, or the shaking supports, excite the body about the start of the motion. `response.csv`
    /// has amplitudes and phases at the probes, `response.svg` their plot.
    Response(response::Arguments),
    /// Write report.html of a run again
    ///
    /// A run writes its report at the end, and updates it before. The report opens from disk in a browser: the motion
    /// in three dimensions, energies, momenta, balances, and the verdict. Pictures (PNG) are for documents; they need
    /// neither a browser nor a graphics card.
    Report(report::Arguments),
    /// Resume a run that was stopped or has failed, or extend it
    ///
    /// The run resumes from the newest complete checkpoint in its directory. Later rows and frames are removed, so that
    /// the history is the same as without the interruption. Step size, scheme, degree, end, output and limits may
    /// change; body, loads and supports may not.
    Resume(resume::Arguments),
    /// Show several runs side by side: a page, charts and a table; or the rows of sweeps
    Compare(compare::Arguments),
    /// Measure the error over the step size
    ///
    /// From --from on, each run has one of the given step sizes instead of the sizes of the plan; before, all runs
    /// share the plan and the state of the input. The error is the L2 norm, over nodes and time, of the distance from a
    /// reference, which is kept in the output directory for the next study.
    Converge(converge::Arguments),
    /// Run a file with every combination of values of some keys
    ///
    /// Runs go side by side, each on one thread; `sweep.csv` has a row for each. A run that fails is a row with its
    /// message. Rows are written when their runs end, and --resume continues an interrupted sweep.
    Sweep(sweep::Arguments),
    /// Compute spectra of columns of a run: power spectral density, frequency response, shock response
    ///
    /// Averages over segments are those of SciPy's `signal.welch` and `csd`, shock response spectra those of ISO
    /// 18431-4. `spectrum.csv` has the numbers, `spectrum.svg` their plot.
    Spectrum(spectrum::Arguments),
    /// Split the mesh of an input into parts for `emmy-mpi run --parts`
    ///
    /// Each rank then reads only its part, so no rank needs memory for the whole mesh.
    Split(split::Arguments),
    /// List schemes, materials, elements, meshes, ...
    List(list::Arguments),
    /// Print the JSON schema of the input, for completion and checks in an editor
    ///
    /// `emmy schema > emmy.schema.json`, and as first line of an input `#:schema ./emmy.schema.json`: editors with a
    /// TOML language server (Even Better TOML in VS Code, taplo elsewhere) then complete keys and mark errors.
    Schema,
    /// Print completions for a shell
    Completions(completions::Arguments),
}

/// A verb of a team.
#[derive(Debug, Subcommand)]
pub(crate) enum TeamVerb {
    /// Compute the motion on all ranks and write the results, as `emmy run` does
    Run {
        #[command(flatten)]
        arguments: run::Arguments,
        #[command(flatten)]
        parts: Parts,
    },
    /// Resume a run of any number of ranks from its newest checkpoint
    Resume {
        #[command(flatten)]
        arguments: resume::Arguments,
        #[command(flatten)]
        parts: Parts,
    },
    /// Report on an input and on its division among the ranks; run nothing
    Check(check::Arguments),
}

/// The folder of a mesh in parts.
#[derive(Debug, Args)]
pub(crate) struct Parts {
    /// Directory of `emmy split` with as many parts as there are ranks: each rank reads its own, and none the whole
    /// mesh
    #[arg(long, value_name = "DIR")]
    parts: Option<PathBuf>,
}

impl TeamVerb {
    /// The verb with its flags as text, on which the ranks must agree. The paths of their input files may differ.
    pub(crate) fn compared(&self) -> String {
        match self {
            TeamVerb::Run { arguments, parts } => {
                format!("run {} {}", arguments.compared(), parts.compared())
            }
            TeamVerb::Resume { arguments, parts } => {
                format!("resume {} {}", arguments.compared(), parts.compared())
            }
            TeamVerb::Check(arguments) => format!("check {}", arguments.compared()),
        }
    }

    /// The verb that the ranks run together, and the folder of their parts of the mesh.
    pub(crate) fn verb(self) -> (Verb, Option<PathBuf>) {
        match self {
            TeamVerb::Run { arguments, parts } => (Verb::Run(arguments), parts.parts),
            TeamVerb::Resume { arguments, parts } => (Verb::Resume(arguments), parts.parts),
            TeamVerb::Check(arguments) => (Verb::Check(arguments), None),
        }
    }
}

impl Verb {
    /// Runs the verb.
    pub(crate) fn run(self, host: &dyn Host) -> Result<(), Failure> {
        match self {
            Verb::New(arguments) => new::run(&arguments, host),
            Verb::Check(arguments) => check::run(&arguments, host),
            Verb::Run(arguments) => run::run(&arguments, host),
            Verb::Modes(arguments) => modes::run(&arguments, host),
            Verb::Response(arguments) => response::run(&arguments, host),
            Verb::Report(arguments) => report::run(&arguments, host),
            Verb::Resume(arguments) => resume::run(&arguments, host),
            Verb::Compare(arguments) => compare::run(&arguments, host),
            Verb::Converge(arguments) => converge::run(&arguments, host),
            Verb::Sweep(arguments) => sweep::run(&arguments, host),
            Verb::Spectrum(arguments) => spectrum::run(&arguments, host),
            Verb::Split(arguments) => split::run(&arguments, host),
            Verb::List(arguments) => list::run(&arguments, host),
            Verb::Schema => schema::run(host),
            Verb::Completions(arguments) => completions::run(&arguments, host),
        }
    }
}

/// An input file, and the changes of the command line.
#[derive(Debug, Args)]
struct Input {
    /// Input file (TOML)
    file: PathBuf,
    /// Output directory, instead of the one in the input
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Change a value of the input, such as time.scheme=DGM or region.0.density=2.5 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// End of the run: later steps are dropped, or the last phase is extended
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    until: Option<f64>,
    /// Size of the steps, where the input has one phase of them: time.steps.size
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    dt: Option<f64>,
    /// Degree of the time elements: time.degree
    #[arg(long, value_name = "K")]
    degree: Option<usize>,
}

impl Parts {
    /// Each rank may have its parts in a folder of its own.
    fn compared(&self) -> &'static str {
        if self.parts.is_some() { "with parts" } else { "" }
    }
}

impl Input {
    /// As [`TeamVerb::compared`].
    fn compared(&self) -> String {
        let Input { file: _, output, set, until, dt, degree } = self;
        format!("{output:?} {set:?} {until:?} {dt:?} {degree:?}")
    }

    fn overrides(&self) -> Overrides {
        Overrides {
            set: self.set.clone(),
            until: self.until,
            step_size: self.dt,
            degree: self.degree,
            output: self.output.clone(),
            ..Overrides::default()
        }
    }

    /// The problem, on the team of the host if it has one; notes of its reader go to the host.
    fn problem(&self, host: &dyn Host) -> Result<Problem, Failure> {
        let problem = read(&self.file, &self.overrides(), host)?;
        problem.notes.iter().for_each(|note| message!(host, "note: {note}"));
        Ok(problem)
    }

    /// The problem with its whole body.
    fn read_alone(&self, host: &dyn Host) -> Result<Problem, Failure> {
        let problem = emmy_io::input::read(&self.file, &self.overrides())?;
        problem.notes.iter().for_each(|note| message!(host, "note: {note}"));
        Ok(problem)
    }
}

/// The problem of an input, on the team of the host if it has one.
fn read(file: &Path, overrides: &Overrides, host: &dyn Host) -> Result<Problem, Failure> {
    Ok(match host.team() {
        Some(team) => {
            let overrides = Overrides { parts: host.parts().map(Path::to_path_buf), ..overrides.clone() };
            emmy_io::input::read_on_team(file, &overrides, team)?
        }
        None => emmy_io::input::read(file, overrides)?,
    })
}

/// A parser of the values of some names.
fn named<T>(all: &'static [(&'static str, T)]) -> impl TypedValueParser<Value = T>
where
    T: Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(all.iter().map(|(name, _)| *name)).try_map(|name| {
        let found = all.iter().find(|(own, _)| *own == name);
        found.map(|(_, value)| value.clone()).ok_or(format!("unknown name {name}"))
    })
}

/// A directory beside another one, with an ending added to its name.
fn with_ending(directory: &Path, ending: &str) -> PathBuf {
    // Components leave out a slash at the end, behind which the ending would be a directory in it.
    let mut name = directory.components().as_path().as_os_str().to_os_string();
    name.push(ending);
    name.into()
}

/// The same outcome on all ranks of the host's team.
fn agreed<T>(host: &dyn Host, own: Result<T, Failure>) -> Result<T, Failure> {
    match host.team() {
        Some(team) => team::agree(&**team, own, Failure::Other),
        None => own,
    }
}

/// Whether this process shows text and writes the files of the whole run.
fn is_first(host: &dyn Host) -> bool {
    host.team().is_none_or(|team| team.rank() == 0)
}

/// Runs a function in a thread pool, because a thread outside of it would wait for every small task. With a number of
/// threads, the pool is new; otherwise it is that of the caller. On a team, the function runs in the calling thread,
/// which alone may call the other ranks; without a number, its pool has one thread.
fn with_threads<T: Send>(
    threads: Option<u16>,
    host: &dyn Host,
    work: impl FnOnce() -> T + Send,
) -> Result<T, Failure> {
    let is_team = host.team().is_some();
    let threads = threads.map(|threads| at_most_all_cores(threads, host)).or(is_team.then_some(1));
    let Some(threads) = threads else { return Ok(rayon::scope(|_| work())) };
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
    let pool = if is_team { builder.use_current_thread().build() } else { builder.build() };
    let pool = pool.map_err(|error| Failure::Other(format!("cannot start {threads} threads: {error}")));
    let pool = agreed(host, pool)?;
    Ok(pool.install(work))
}

/// The number of threads, at most one a core: more would only wait for each other.
fn at_most_all_cores(threads: u16, host: &dyn Host) -> u16 {
    let cores = std::thread::available_parallelism().map_or(1, NonZero::get);
    match u16::try_from(cores) {
        Ok(cores) if cores < threads => {
            let has = if cores == 1 { "1 core".to_string() } else { format!("{cores} cores") };
            message!(host, "note: --threads {threads}: this machine has {has}; one thread a core is used");
            cores
        }
        _ => threads,
    }
}

/// A warning of planned steps that do not resolve a load or a given motion.
fn unresolved_steps(problem: &Problem) -> Option<String> {
    let Problem { body, scheme, plan, .. } = problem;
    let (count, first) = Resolution::new(body, *scheme, plan)?.unresolved_steps(plan);
    let advice = "take smaller steps there, adaptive ones, or a table, which is integrated exactly";
    first.map(|first| {
        format!(
            "warning: {count} planned steps do not resolve the loads and supports, first {first}; {advice}"
        )
    })
}
