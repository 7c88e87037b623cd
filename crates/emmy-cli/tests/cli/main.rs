//! The binary from outside: verbs, files, exit codes, messages.

mod accuracy;
mod adaptive;
mod cell_modes;
mod compare;
mod contact;
mod converge;
mod couplings;
mod decks;
mod endings;
mod equilibrium;
mod examples;
mod formulations;
mod hostile;
mod in_process;
mod joints;
mod killed_frames;
mod large_output;
mod links;
mod listings;
mod masses;
mod materials;
mod mistakes;
mod modes;
mod pages;
mod parts;
mod pictures;
mod quantities;
mod records;
mod reference;
mod report;
mod results;
mod resume;
mod resume_rejections;
mod run;
mod short_forms;
mod spectra;
mod sweep;
mod ties;
mod units;
mod unwritable;
mod verbs;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

/// A small box that runs very fast, with every section.
const BOX: &str = r#"title = "box"

[mesh]
box = { size = [1, 2, 1], cells = [1, 2, 1] }

[[region]]
group = "body"
density = 2.0
material.neo-hooke = { lambda = 1000.0, mu = 500.0 }

[[load]]
group = "y-max"
traction = [0.0, 0.0, 10.0]
history = [[0.0, 0.0], [0.5, 1.0]]

[[support]]
group = "y-min"
fix = ["x", "y", "z"]

[initial]
velocity = [0, 0, 0]

[time]
scheme = "AS(2)"
degree = 1
steps = [{ until = 0.2, size = 0.1 }, { until = 0.5, size = 0.05 }]

[newton]
tolerance = 1e-10
max_iterations = 20

[solver]
kind = "auto"

[output]
directory = "out"
every = 2
probes = [{ name = "tip", point = [0, 2, 0] }]

[limits]
energy = 1e-2
"#;

/// A directory for the files of a test.
struct Place {
    directory: TempDir,
}

/// Result of a call of the binary.
#[derive(Debug)]
struct Outcome {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Place {
    /// An empty one.
    fn new() -> Self {
        Place { directory: tempfile::tempdir().unwrap() }
    }

    /// One with an input file `box.toml`.
    fn with(input: &str) -> Self {
        let place = Place::new();
        place.write("box.toml", input);
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        std::fs::write(self.path(name), text).unwrap();
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Names in a directory, sorted.
    fn names(&self, directory: &str) -> Vec<String> {
        names(&self.path(directory))
    }

    /// Runs the binary here.
    fn emmy(&self, arguments: &[&str]) -> Outcome {
        let output = Command::new(env!("CARGO_BIN_EXE_emmy"))
            .args(arguments)
            .current_dir(self.directory.path())
            .env("NO_COLOR", "1")
            .output()
            .unwrap();
        Outcome {
            code: output.status.code().unwrap(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Runs the binary here, which must succeed.
    fn succeed(&self, arguments: &[&str]) -> Outcome {
        let outcome = self.emmy(arguments);
        assert_eq!(outcome.code, 0, "{arguments:?}\n{}", outcome.stderr);
        outcome
    }

    /// Columns of a history.
    fn history(&self, directory: &str) -> BTreeMap<String, Vec<f64>> {
        let text = self.read(&format!("{directory}/history.csv"));
        let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let names = lines.next().unwrap();
        let mut columns: BTreeMap<String, Vec<f64>> =
            names.iter().map(|name| (name.to_string(), vec![])).collect();
        for line in lines {
            assert_eq!(line.len(), names.len());
            for (name, number) in names.iter().zip(line) {
                let is_known = !number.is_empty() && *name != "limited_by";
                let number = if is_known { number.parse().unwrap() } else { f64::NAN };
                columns.get_mut(*name).unwrap().push(number);
            }
        }
        columns
    }

    fn summary(&self, directory: &str) -> serde_json::Value {
        serde_json::from_str(&self.read(&format!("{directory}/summary.json"))).unwrap()
    }
}

fn names(directory: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(directory).unwrap_or_else(|error| panic!("{directory:?}: {error}"));
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
