//! The other programs: recorded figures, and how to run them.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;

use crate::job::{Check, Job};

/// The other programs with their recorded figures (`benches/peers/recorded.toml`).
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Recorded {
    /// The machine of the recorded figures.
    pub machine: String,
    /// The programs.
    #[serde(rename = "peer")]
    pub peers: Vec<Peer>,
    /// CPU seconds a step of DOLFINx and CalculiX, and of the whole run, by motion and solver.
    pub side_by_side: BTreeMap<String, BTreeMap<String, [f64; 2]>>,
}

/// Another program with one of its linear solvers.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Peer {
    /// Name of its script (`NAME_block.py`), of its environment, and of the module to import.
    pub name: String,
    /// Argument of the script.
    pub solver: String,
    /// Further arguments.
    #[serde(default)]
    pub arguments: Vec<String>,
    /// Name in the tables.
    pub label: String,
    /// Finest mesh at which it is run.
    pub largest_r: u32,
    /// Whether material and scheme, and so the energies, agree with the others.
    #[serde(default = "yes")]
    pub same_equations: bool,
    /// Goal for Emmy's speed relative to this program, by r.
    #[serde(default)]
    pub times_faster: BTreeMap<String, f64>,
    cpu_seconds_per_step: BTreeMap<String, f64>,
    /// Cells per second and core in the assembly of residual and tangent.
    pub assembled_cells_per_second: Option<f64>,
    /// Largest resident memory at r = 4 \[MB\].
    pub peak_megabytes: Option<f64>,
}

fn yes() -> bool {
    true
}

impl Recorded {
    /// The recorded figures.
    ///
    /// # Errors
    /// A message if the file is invalid.
    pub(crate) fn read() -> Result<Recorded, String> {
        toml::from_str(include_str!("../peers/recorded.toml")).map_err(|error| error.to_string())
    }
}

impl Peer {
    /// Recorded CPU seconds per step.
    pub(crate) fn recorded_seconds(&self, r: u32) -> Option<f64> {
        self.cpu_seconds_per_step.get(&r.to_string()).copied()
    }

    /// The job that computes the block.
    pub(crate) fn job(&self, python: &Path, r: u32) -> Job {
        let check = Check { r, same_equations: self.same_equations };
        let words = [r.to_string(), self.solver.clone()].into_iter().chain(self.arguments.iter().cloned());
        Job::script(python, &script(&self.name), words.collect(), Some(check))
    }
}

/// Interpreters of the other programs.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interpreters(HashMap<String, PathBuf>);

impl Interpreters {
    /// Interpreters from a command line: `NAME=PATH`, several.
    ///
    /// # Errors
    /// A message for a name that is not a program.
    pub(crate) fn new(words: &[String]) -> Result<Self, String> {
        let peers = Recorded::read()?.peers;
        let mut paths = HashMap::new();
        for word in words {
            let (name, path) = word.split_once('=').ok_or("write --python NAME=PATH")?;
            if !peers.iter().any(|peer| peer.name == name) {
                return Err(format!("--python {word}: there is no program {name}"));
            }
            paths.insert(name.to_string(), PathBuf::from(path));
        }
        Ok(Interpreters(paths))
    }

    /// The interpreter that can import a program's module: the one named, else the environment below `benches/peers`,
    /// else the system's.
    pub(crate) fn of(&self, name: &str) -> Option<PathBuf> {
        let own = folder().join("environments").join(name).join("bin/python");
        let of_system = [own, "/usr/bin/python3".into(), "python3".into()];
        let candidates = match self.0.get(name) {
            Some(path) => vec![path.clone()],
            None => of_system.to_vec(),
        };
        candidates.into_iter().find(|python| can_import(python, module(name)))
    }
}

/// Module that the interpreter of a program must import; CalculiX is a program beside it.
fn module(name: &str) -> &str {
    match name {
        "kratos" => "KratosMultiphysics",
        "calculix" => "shutil, sys; sys.exit(shutil.which('ccx') is None)",
        _ => name,
    }
}

/// Script of a program.
pub(crate) fn script(name: &str) -> PathBuf {
    folder().join(format!("{name}_block.py"))
}

fn can_import(python: &Path, module: &str) -> bool {
    let trial = Command::new(python).args(["-c", &format!("import {module}")]).output();
    trial.is_ok_and(|output| output.status.success())
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("peers")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recorded_program_has_a_script() {
        let recorded = Recorded::read().unwrap();
        assert!(recorded.peers.len() > 5);
        for peer in &recorded.peers {
            let script = script(&peer.name);
            let text = std::fs::read_to_string(&script).unwrap_or_else(|_| panic!("{}", script.display()));
            assert!(text.contains(&format!("\"{}\"", peer.solver)), "{} {}", peer.name, peer.solver);
            assert!(peer.recorded_seconds(2).is_some());
        }
    }

    #[test]
    fn interpreters_belong_to_installed_programs() {
        assert!(Interpreters::new(&["ngsolve=/x/python".into()]).is_ok());
        assert!(Interpreters::new(&["ngsolv=/x/python".into()]).is_err());
        assert!(Interpreters::new(&["ngsolve".into()]).is_err());
    }
}
