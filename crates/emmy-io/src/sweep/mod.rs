//! Sweeps: one file with every combination of values of some keys, and a row of numbers for each run.
//!
//! [`Sweep::read`] reads and checks every combination, so a mistake is found before the first run. [`fn@sweep`] runs
//! them side by side, each on one thread, and [`SweepFile`] keeps their rows as `sweep.csv`. [`SweepTable`] reads such
//! a file.

mod file;
mod runs;
pub mod table;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use emmy::modes::n_modes;
use emmy::time::Scheme;

pub use file::{KEPT, SWEEP_KIND, SWEEP_WITNESS, SweepError, SweepFile};
pub use runs::{SweepRow, sweep};
pub use table::{SweepTable, TableRow};

use crate::checkpoint::identity::Identity;
use crate::convergence::kept::{checksum, state_sum};
use crate::history::{Number, Peak};
use crate::input::{self, Fault, InputError, Overrides, Problem, Quantities};
use crate::message::with_causes;
use crate::side_by_side::{on_one_thread, side_by_side};

/// Runs of a sweep at most; more are probably a typing error.
const MAX_RUNS: usize = 1_000_000;

/// Columns of the whole body after the status, by their names in histories and summaries.
const COLUMNS: [&str; 21] = [
    "end_time",
    "steps",
    "newton_iterations_per_step",
    "kinetic_energy",
    "strain_energy",
    "total_energy",
    "external_work",
    "dissipated_energy",
    "worst_energy_residual",
    "energy_drift",
    "angular_momentum_drift",
    "digits_left",
    "unresolved_loads",
    "steps_per_lowest_period",
    "linear_momentum_x",
    "linear_momentum_y",
    "linear_momentum_z",
    "angular_momentum_x",
    "angular_momentum_y",
    "angular_momentum_z",
    "wall_seconds",
];

/// An input file with several values for some keys; every combination of them has been read and checked.
///
/// ```
/// use emmy_io::sweep::Sweep;
/// # let directory = std::env::temp_dir().join(format!("emmy-doc-sweep-{}", std::process::id()));
/// # std::fs::create_dir_all(&directory)?;
/// # let path = directory.join("flight.toml");
/// # std::fs::write(&path, "mesh.box = { size = [1, 1, 1], cells = [1, 1, 1] }\n\
/// #     time = { scheme = 'DGM', steps = [{ until = 1, size = 0.5 }] }\n\
/// #     initial = [{ velocity = [1, 0, 0] }]\n\
/// #     region = [{ density = 2, material.neo-hooke = { lambda = 1, mu = 1 } }]\n")?;
/// let flags = ["initial.velocity=[1,0,0],[3,0,0]", "region.density=2,4", "time.degree=2"];
/// let sweep = Sweep::read(&path, &flags.map(String::from), None)?;
/// assert_eq!((sweep.n_runs(), sweep.keys().len()), (4, 2));
/// assert_eq!(sweep.values(2), ["[3,0,0]", "2"]); // the last key changes fastest
/// let rows = emmy_io::sweep(&sweep, &sweep.all(), |_, _| false, |_| Ok(()))?;
/// let energy = sweep.columns().iter().position(|name| name == "total_energy").unwrap();
/// let energies = rows.iter().map(|row| row.numbers[energy].value()); // 1/2 m v^2
/// assert!(energies.zip([1.0, 2.0, 9.0, 18.0]).all(|(e, exact)| (e - exact).abs() < 1e-13));
/// # std::fs::remove_dir_all(&directory)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    file: PathBuf,
    until: Option<f64>,
    /// Number of natural modes of each run, in place of its motion.
    modes: Option<usize>,
    /// Of each `--set`, a flag for each value.
    flags: Vec<Vec<String>>,
    /// Names of the numbers in a row.
    columns: Vec<String>,
    /// Columns of the histories that the input names.
    named: Vec<String>,
    /// Directory of the kept files of the runs.
    kept: Option<PathBuf>,
    /// Output directory of the input.
    directory: PathBuf,
    /// Files that the runs read.
    files: Vec<PathBuf>,
    notes: Vec<String>,
    /// Resolved input of the first run.
    first: String,
    /// Checksum of the data of all runs.
    checksum: u64,
    /// Scheme of each run.
    schemes: Vec<Scheme>,
}

impl Sweep {
    /// Reads a file with every combination of the values of `--set KEY=A,B,C` flags.
    ///
    /// # Errors
    /// [`InputError`] with the faults of all combinations; a fault of only some of them names the first one.
    pub fn read(file: &Path, set: &[String], until: Option<f64>) -> Result<Self, InputError> {
        Sweep::read_for(file, set, until, None)
    }

    /// As [`Sweep::read`], for the lowest natural modes in place of the motions.
    ///
    /// # Errors
    /// As [`Sweep::read`]; also if a body has fewer modes.
    pub fn read_for_modes(file: &Path, set: &[String], count: usize) -> Result<Self, InputError> {
        Sweep::read_for(file, set, None, Some(count))
    }

    fn read_for(
        file: &Path,
        set: &[String],
        until: Option<f64>,
        modes: Option<usize>,
    ) -> Result<Self, InputError> {
        let mut flags = Vec::new();
        for flag in set {
            flags.push(input::alternatives(flag)?);
        }
        let mut sweep = Sweep {
            file: file.to_path_buf(),
            until,
            modes,
            flags,
            columns: modes.map_or_else(|| COLUMNS.map(String::from).to_vec(), columns_of_modes),
            named: modes.map_or_else(Vec::new, |count| names_of_modes("frequency", count)),
            kept: None,
            directory: PathBuf::new(),
            files: Vec::new(),
            notes: Vec::new(),
            first: String::new(),
            checksum: 0,
            schemes: Vec::new(),
        };
        sweep.check_keys()?;
        let checked = side_by_side(sweep.n_runs(), |run| sweep.check(run));
        sweep.add(checked)?;
        Ok(sweep)
    }

    /// Rejects a swept key that is given twice, and too many runs.
    fn check_keys(&self) -> Result<(), InputError> {
        let all: Vec<&str> = self.flags.iter().map(|flags| key_of(&flags[0])).collect();
        let is_twice = |key: &&str| all.iter().filter(|other| *other == key).count() > 1;
        if let Some(key) = self.keys().into_iter().find(is_twice) {
            let fault = Fault::new(format!("--set {key}: a swept key is given twice"));
            return Err(fault.help("put all its values behind one `=`").into());
        }
        let n_runs = self.flags.iter().try_fold(1_usize, |n, flags| n.checked_mul(flags.len()));
        if n_runs.is_none_or(|n| n > MAX_RUNS) {
            let counts: Vec<String> = self.flags.iter().map(|flags| flags.len().to_string()).collect();
            let message = format!("--set: {} combinations are too many runs", counts.join(" x "));
            return Err(Fault::new(message).help(format!("at most {MAX_RUNS} in one sweep")).into());
        }
        Ok(())
    }

    /// Reads and checks one combination, as `emmy run` does before its first step.
    fn check(&self, run: usize) -> Result<Checked, InputError> {
        let checked = on_one_thread(|| {
            let problem = self.problem(run)?;
            let start = problem.check_start().map_err(|error| Fault::new(with_causes(&error)))?;
            match self.modes {
                Some(count) => check_modes(&problem, count)?,
                None => drop(problem.critical_step(start.as_ref())?),
            }
            let Identity { input, mesh, tables } = Identity::new(&problem);
            let state = start.as_ref().map_or(0, state_sum);
            let none = Quantities::default();
            let quantities = if self.modes.is_some() { &none } else { &problem.quantities };
            Ok(Checked {
                checksum: checksum(format!("{input}{mesh}{tables}{state}").as_bytes()),
                columns: quantities.columns().into_iter().map(|column| column.name).collect(),
                named: quantities.named_columns(),
                scheme: problem.scheme,
                first: if run == 0 { input } else { String::new() },
                directory: problem.output.directory,
                files: problem.files,
                notes: problem.notes,
            })
        });
        checked.unwrap_or_else(|message| Err(Fault::new(message).into()))
    }

    /// Adds what the checks of all combinations found.
    fn add(&mut self, checked: Vec<Result<Checked, InputError>>) -> Result<(), InputError> {
        InputError::unless_empty(self.faults(&checked))?;
        let mut same = HashMap::new();
        let mut sums = String::new();
        for (run, own) in checked.into_iter().flatten().enumerate() {
            if let Some(other) = same.insert(own.checksum, run) {
                let message = format!("{} and {} have the same input", self.name(other), self.name(run));
                let help = "two equal values, or a key without effect, which another --set replaces";
                return Err(Fault::new(message).help(help).into());
            }
            sums.push_str(&format!("{:016x}", own.checksum));
            self.schemes.push(own.scheme);
            match run {
                0 => (self.first, self.directory) = (own.first, own.directory),
                _ if self.directory != own.directory => {
                    return Err(Fault::new(
                        "`output.directory` cannot be swept: there is one table of all runs",
                    )
                    .into());
                }
                _ => {}
            }
            // Of a value with the name of a column of the whole body there are the peaks alone.
            add_new(&mut self.columns, own.columns.iter().flat_map(|name| Peak::names(name)));
            add_new(&mut self.named, own.named);
            add_new(&mut self.files, own.files);
            add_new(&mut self.notes, own.notes);
        }
        self.checksum = checksum(sums.as_bytes());
        Ok(())
    }

    /// The faults of all combinations, each once; those that not every combination has name the first one.
    fn faults(&self, checked: &[Result<Checked, InputError>]) -> Vec<Fault> {
        let mut found: Vec<(usize, usize, Fault)> = Vec::new();
        let mut known = HashMap::new();
        for (run, error) in
            checked.iter().enumerate().filter_map(|(run, own)| Some((run, own.as_ref().err()?)))
        {
            for fault in error.faults() {
                // Flags of one key have different values.
                let place = fault.place().map(|place| (key_of(place.text()).to_string(), place.span().start));
                let at = *known.entry((fault.to_string(), place)).or_insert(found.len());
                match found.get_mut(at) {
                    Some((_, count, _)) => *count += 1,
                    None => found.push((run, 1, fault.clone())),
                }
            }
        }
        let named = |(run, count, fault): (usize, usize, Fault)| match count < self.n_runs() {
            true => fault.before(&format!("{}: ", self.name(run))),
            false => fault,
        };
        found.into_iter().map(named).collect()
    }

    /// Number of runs.
    pub fn n_runs(&self) -> usize {
        self.flags.iter().map(Vec::len).product()
    }

    /// Indices of all runs.
    pub fn all(&self) -> Vec<usize> {
        (0..self.n_runs()).collect()
    }

    /// The flags with several values.
    fn swept(&self) -> impl Iterator<Item = &Vec<String>> {
        self.flags.iter().filter(|flags| flags.len() > 1)
    }

    /// The keys with several values.
    pub fn keys(&self) -> Vec<&str> {
        self.swept().map(|flags| key_of(&flags[0])).collect()
    }

    /// The value of each of these keys in a run, counted from 0.
    pub fn values(&self, run: usize) -> Vec<&str> {
        let values = self.flags_of(run).zip(&self.flags).filter(|(_, flags)| flags.len() > 1);
        values.map(|(flag, _)| value_of(flag)).collect()
    }

    /// A run in words, such as `run 3 (region.density=2, time.degree=1)`.
    pub fn name(&self, run: usize) -> String {
        let flags: Vec<&str> = self
            .flags_of(run)
            .zip(&self.flags)
            .filter(|(_, all)| all.len() > 1)
            .map(|(flag, _)| flag)
            .collect();
        match flags.is_empty() {
            true => format!("run {}", run + 1),
            false => format!("run {} ({})", run + 1, flags.join(", ")),
        }
    }

    /// The `KEY=VALUE` flags of a run, in their order.
    fn flags_of(&self, run: usize) -> impl Iterator<Item = &str> {
        let mut period = self.n_runs();
        self.flags.iter().map(move |flags| {
            period /= flags.len();
            flags[run / period % flags.len()].as_str()
        })
    }

    /// The problem of a run.
    ///
    /// # Errors
    /// [`InputError`].
    pub fn problem(&self, run: usize) -> Result<Problem, InputError> {
        let set = self.flags_of(run).map(String::from).collect();
        let output = self.kept.as_ref().map(|kept| kept.join((run + 1).to_string()));
        input::read(&self.file, &Overrides { set, until: self.until, output, ..Default::default() })
    }

    /// The scheme of a run.
    pub fn scheme(&self, run: usize) -> Scheme {
        self.schemes[run]
    }

    /// Names of the numbers in a row: of the whole body, and for each column X of a history that `[output]` asks for
    /// `X`, `X_min`, `X_min_time`, `X_max` and `X_max_time`.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The columns X that the input names; without reactions if it lists none.
    pub fn named_columns(&self) -> &[String] {
        &self.named
    }

    /// Keeps input, history and summary of each run from now on; those of run N, counted from 1, are in `runs/N` of a
    /// directory.
    pub fn keep_in(&mut self, directory: &Path) {
        self.kept = Some(directory.join(KEPT));
    }

    /// Whether the files of runs are kept.
    pub(crate) fn is_kept(&self) -> bool {
        self.kept.is_some()
    }

    /// Number of natural modes of each run, in place of its motion.
    pub(crate) fn n_modes(&self) -> Option<usize> {
        self.modes
    }

    /// The numbers of a run without any.
    fn nothing(&self) -> Vec<Number> {
        vec![Number::Missing; self.columns.len()]
    }

    /// Remarks of the reader, each once.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Default output directory: the one of the input, with `-sweep` added.
    pub fn directory(&self) -> PathBuf {
        let mut name = self.directory.clone().into_os_string();
        name.push("-sweep");
        name.into()
    }
}

/// Columns of the natural modes of a run.
fn columns_of_modes(count: usize) -> Vec<String> {
    let masses = ["x", "y", "z"].map(|axis| format!("effective_mass_{axis}"));
    let names = ["frequency"].into_iter().chain(masses.iter().map(String::as_str));
    let names = names.chain(["residual"]).flat_map(|name| names_of_modes(name, count));
    names.chain(["wall_seconds".to_string()]).collect()
}

/// Names of a number of each mode, counted from 1.
fn names_of_modes(name: &str, count: usize) -> Vec<String> {
    (1..=count).map(|mode| format!("{name}_{mode}")).collect()
}

/// Checks that a body has so many modes.
fn check_modes(problem: &Problem, count: usize) -> Result<(), Fault> {
    let most = n_modes(&problem.body);
    if count <= most {
        return Ok(());
    }
    let fault =
        Fault::new(format!("--modes {count}: these are more natural modes than the body has, {most}"));
    Err(if most > 0 { fault.help(format!("take at most {most}")) } else { fault.help("all nodes are held") })
}

/// The checked result of a combination.
struct Checked {
    checksum: u64,
    columns: Vec<String>,
    named: Vec<String>,
    scheme: Scheme,
    first: String,
    directory: PathBuf,
    files: Vec<PathBuf>,
    notes: Vec<String>,
}

/// The key of a flag `KEY=VALUE`.
fn key_of(flag: &str) -> &str {
    flag.split_once('=').map_or(flag, |(key, _)| key).trim()
}

/// The value of a flag `KEY=VALUE`.
fn value_of(flag: &str) -> &str {
    flag.split_once('=').map_or("", |(_, value)| value)
}

/// Adds the items that a list does not have.
fn add_new<T: PartialEq>(list: &mut Vec<T>, items: impl IntoIterator<Item = T>) {
    for item in items {
        if !list.contains(&item) {
            list.push(item);
        }
    }
}
