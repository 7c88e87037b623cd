//! A job in a process of its own: a case of Emmy, or another program.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::measure::Arguments;
use crate::outcome::Outcome;

/// A process that prints the figures of one run.
#[derive(Debug, Clone)]
pub(crate) struct Job {
    program: PathBuf,
    arguments: Vec<String>,
    threads: usize,
    check: Option<Check>,
}

/// How the energies of the spinning block are checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Check {
    /// Cells per unit length.
    pub r: u32,
    /// Whether material and scheme agree with the other programs; if not, only the total energy is compared, roughly.
    pub same_equations: bool,
}

/// Environment variables that set the number of threads for the libraries of other programs.
const THREADS: [&str; 4] =
    ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"];

/// Relative tolerance for the energies of two programs.
const AGREEMENT: f64 = 1e-8;
/// The same for the total energy with another material or scheme.
const ROUGH_AGREEMENT: f64 = 1e-3;

impl Job {
    /// A script of another program; the energies are checked if it computes the spinning block.
    pub(crate) fn script(python: &Path, script: &Path, arguments: Vec<String>, check: Option<Check>) -> Self {
        let arguments = std::iter::once(script.display().to_string()).chain(arguments).collect();
        Job { program: python.to_path_buf(), arguments, threads: 1, check }
    }

    /// A case of Emmy, in a process of this program with its own memory and CPU time.
    ///
    /// # Errors
    /// A message if the program cannot find itself.
    pub(crate) fn case(case: &Case) -> Result<Self, String> {
        let program = std::env::current_exe().map_err(|error| error.to_string())?;
        let check = case.known_block().map(|r| Check { r, same_equations: true });
        Ok(Job { program, arguments: case.words(), threads: case.0.threads, check })
    }

    /// Runs the job and returns its figures; on one core if it has one thread and a core is named.
    ///
    /// # Errors
    /// The message of the process if it fails, or if its energies differ from the other programs.
    pub(crate) fn run(&self, core: Option<usize>) -> Result<Outcome, String> {
        let mut command = match core.filter(|_| self.threads == 1) {
            Some(core) => {
                let mut pinned = Command::new("taskset");
                pinned.arg("-c").arg(core.to_string()).arg(&self.program);
                pinned
            }
            None => Command::new(&self.program),
        };
        command.args(&self.arguments);
        command.envs(THREADS.map(|name| (name, self.threads.to_string())));
        let fail = |message: &str| format!("{self}: {message}");
        let output = command.output().map_err(|error| fail(&error.to_string()))?;
        if !output.status.success() {
            let message = String::from_utf8_lossy(&output.stderr);
            return Err(fail(&format!("{}, {}", output.status, message.trim())));
        }
        let outcome = Outcome::in_output(&String::from_utf8_lossy(&output.stdout));
        let outcome = outcome.map_err(|error| fail(&error))?;
        self.check.map_or(Ok(()), |check| check.energies(&outcome)).map_err(|error| fail(&error))?;
        Ok(outcome)
    }
}

impl fmt::Display for Job {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.program.display(), self.arguments.join(" "))
    }
}

/// Kinetic and strain energy of the spinning block at its end by r; all programs agree in these digits.
fn energies(r: u32) -> Option<[f64; 2]> {
    let table: serde_json::Value = serde_json::from_str(include_str!("../peers/energies.json")).ok()?;
    serde_json::from_value(table[r.to_string()].clone()).ok()
}

impl Check {
    fn energies(self, outcome: &Outcome) -> Result<(), String> {
        let Some(expected) = energies(self.r) else { return Ok(()) };
        let found = [outcome.kinetic_energy, outcome.strain_energy];
        let agrees = |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance * b;
        let all_agree = match self.same_equations {
            true => (0..2).all(|i| agrees(found[i], expected[i], AGREEMENT)),
            false => agrees(found[0] + found[1], expected[0] + expected[1], ROUGH_AGREEMENT),
        };
        if all_agree {
            return Ok(());
        }
        Err(format!("kinetic and strain energy {found:?} differ from the other programs, {expected:?}"))
    }
}

/// A case of Emmy: an input with values changed as by `--set`.
#[derive(Debug, Clone)]
pub(crate) struct Case(Arguments);

impl Case {
    /// The block in free flight with cells of edge 1/r, by the mid-point rule: the work of the other programs.
    pub(crate) fn spinning_block(r: u32) -> Self {
        Case::new("benches/spinning-block.toml").cells(r)
    }

    /// The spinning block with the mesh of a file.
    pub(crate) fn spinning_block_of(file: &Path) -> Self {
        Case::new("benches/spinning-block.toml")
            .with("mesh", format!("{{ file = {:?} }}", file.display().to_string()))
    }

    /// The block of E = 1e7 under its load, with cells of edge 1/r.
    pub(crate) fn quasi_rigid_block(r: u32) -> Self {
        Case::new("examples/quasi-rigid.toml").cells(r)
    }

    /// The rubber mount on a shaker, by adaptive steps.
    pub(crate) fn shake() -> Self {
        Case::new("benches/shake.toml")
    }

    /// Two bars that meet face to face.
    pub(crate) fn contact() -> Self {
        Case::new("benches/contact.toml")
    }

    /// A report on a box with some cells along each edge.
    pub(crate) fn checked_box(n: u32) -> Self {
        let mut case = Case::new("benches/spinning-block.toml")
            .with("mesh", format!("{{ box = {{ size = [1.0, 1.0, 1.0], cells = [{n}, {n}, {n}] }} }}"));
        case.0.check = true;
        case
    }

    /// The bracket of steel, clamped at its foot, with a force on its tip.
    pub(crate) fn bracket() -> Self {
        Case::new("examples/steel-bracket.toml")
    }

    fn new(input: &str) -> Self {
        let input = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(input);
        let (set, state, longest, accuracy, check) = Default::default();
        Case(Arguments { input, set, threads: 1, assemblies: 0, state, accuracy, longest, check })
    }

    fn cells(self, r: u32) -> Self {
        self.with("mesh.l-block.cell_size", 1.0 / f64::from(r))
    }

    /// Its input file.
    pub(crate) fn input(&self) -> &Path {
        &self.0.input
    }

    /// The case with another value.
    pub(crate) fn with(mut self, key: &str, value: impl fmt::Display) -> Self {
        self.0.set.push(format!("{key}={value}"));
        self
    }

    /// The case with another scheme of a degree.
    pub(crate) fn scheme(self, scheme: &str, degree: usize) -> Self {
        self.with("time.scheme", scheme).with("time.degree", degree)
    }

    /// The case with steps of one size until a time.
    pub(crate) fn until(self, until: f64, step_size: f64) -> Self {
        self.with("time.steps", format!("[{{ until = {until:?}, size = {step_size:?} }}]"))
    }

    /// The case with a number of steps of one size.
    pub(crate) fn steps(self, count: u32, step_size: f64) -> Self {
        self.until(f64::from(count) * step_size, step_size)
    }

    /// The case with a number of threads.
    pub(crate) fn threads(mut self, threads: usize) -> Self {
        self.0.threads = threads;
        self
    }

    /// The case that gives up after some CPU seconds.
    pub(crate) fn at_longest(mut self, seconds: f64) -> Self {
        self.0.longest = Some(seconds);
        self
    }

    /// The case with assemblies measured after the run.
    pub(crate) fn assemblies(mut self, count: usize) -> Self {
        self.0.assemblies = count;
        self
    }

    /// The case with the statement on its accuracy in time.
    pub(crate) fn accuracy(mut self) -> Self {
        self.0.accuracy = true;
        self
    }

    /// The case with a file for its last state.
    pub(crate) fn state(mut self, file: PathBuf) -> Self {
        self.0.state = Some(file);
        self
    }

    /// r of the spinning block, if only the mesh is changed: the energies are known only then.
    fn known_block(&self) -> Option<u32> {
        let [size] = &self.0.set[..] else { return None };
        let size: f64 = size.strip_prefix("mesh.l-block.cell_size=")?.parse().ok()?;
        self.0.input.ends_with("spinning-block.toml").then_some((1.0 / size).round() as u32)
    }

    /// The command line of the process.
    fn words(&self) -> Vec<String> {
        let case = &self.0;
        let mut words = vec!["case".to_string(), case.input.display().to_string()];
        let mut flag = |name: &str, value: String| words.extend([format!("--{name}"), value]);
        flag("threads", case.threads.to_string());
        case.longest.into_iter().for_each(|seconds| flag("longest", seconds.to_string()));
        flag("assemblies", case.assemblies.to_string());
        case.set.iter().for_each(|set| flag("set", set.clone()));
        if let Some(file) = &case.state {
            flag("state", file.display().to_string());
        }
        let switches = [("--accuracy", case.accuracy), ("--check", case.check)];
        words.extend(switches.iter().filter(|(_, is_on)| *is_on).map(|(name, _)| name.to_string()));
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energies_are_known_of_the_unchanged_block_only() {
        assert_eq!(Case::spinning_block(6).known_block(), Some(6));
        assert_eq!(Case::spinning_block(6).scheme("DGM", 1).known_block(), None);
        assert_eq!(Case::quasi_rigid_block(1).known_block(), None);
        assert!(energies(6).is_some() && energies(3).is_none());
    }

    #[test]
    fn energies_of_other_programs_are_asked_for() {
        let outcome =
            Outcome { kinetic_energy: 462.2838305, strain_energy: 2.269828853, ..Default::default() };
        let check = |same_equations| Check { r: 1, same_equations };
        assert!(check(true).energies(&outcome).is_ok());
        let off = Outcome { strain_energy: 2.26982889, ..outcome };
        assert!(check(true).energies(&off).is_err() && check(false).energies(&off).is_ok());
    }
}
