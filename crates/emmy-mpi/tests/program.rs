//! The program `emmy-mpi` under `mpirun`, against `emmy` on one process.

use std::collections::HashMap;
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// Time after which a start counts as one that waits for ever.
const LIMIT: Duration = Duration::from_secs(180);

/// `mpirun` on the program with some ranks, in a directory.
struct Ranks {
    child: Child,
    begun: Instant,
}

/// How it ended.
#[derive(Debug)]
struct Ended {
    code: Option<i32>,
    output: String,
    messages: String,
}

impl Ranks {
    fn start(size: usize, directory: &Path, arguments: &[&str]) -> Ranks {
        let size = size.to_string();
        Ranks::start_as(directory, &[&["-n", &size, env!("CARGO_BIN_EXE_emmy-mpi")][..], arguments].concat())
    }

    /// `mpirun` with some arguments.
    fn start_as(directory: &Path, arguments: &[&str]) -> Ranks {
        let child = Command::new("mpirun")
            .args(arguments)
            .current_dir(directory)
            // Open MPI: as root in a container, and with more ranks than cores.
            .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
            .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
            .env("OMPI_MCA_rmaps_base_oversubscribe", "1")
            .env("OMPI_MCA_mpi_yield_when_idle", "1")
            .env("OMP_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("mpirun starts");
        Ranks { child, begun: Instant::now() }
    }

    /// Sends a signal to `mpirun`.
    fn signal(&self, name: &str) {
        let status = Command::new("kill").args([name, &self.child.id().to_string()]).status();
        assert!(status.unwrap().success());
    }

    /// Waits until something is so.
    fn wait_for(&mut self, what: &str, is_so: impl Fn() -> bool) {
        while !is_so() {
            assert!(self.begun.elapsed() < LIMIT, "{what} within {LIMIT:?}");
            assert!(self.child.try_wait().unwrap().is_none(), "the program ended before {what}");
            thread::sleep(Duration::from_millis(20));
        }
    }

    fn end(mut self) -> Ended {
        // Both pipes are read to their ends, so that none of them fills up.
        let (mut stdout, mut stderr) = (self.child.stdout.take().unwrap(), self.child.stderr.take().unwrap());
        let reader = thread::spawn(move || {
            let mut text = String::new();
            stderr.read_to_string(&mut text).map(|_| text)
        });
        let watched = self.child.id();
        let begun = self.begun;
        let (ended, is_ended) = std::sync::mpsc::channel::<()>();
        let watch = thread::spawn(move || {
            let left = LIMIT.saturating_sub(begun.elapsed());
            if is_ended.recv_timeout(left) == Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
                let _ = Command::new("kill").args(["-KILL", &watched.to_string()]).status();
            }
        });
        let mut output = String::new();
        stdout.read_to_string(&mut output).unwrap();
        let messages = reader.join().unwrap().unwrap();
        let status = self.child.wait().unwrap();
        let _ = ended.send(());
        watch.join().unwrap();
        assert!(self.begun.elapsed() < LIMIT, "the ranks wait for ever: {messages}");
        Ended { code: status.code(), output, messages }
    }
}

fn run(size: usize, directory: &Path, arguments: &[&str]) -> Ended {
    Ranks::start(size, directory, arguments).end()
}

fn run_well(size: usize, directory: &Path, arguments: &[&str]) -> Ended {
    let ended = run(size, directory, arguments);
    assert_eq!(ended.code, Some(0), "{size} ranks, {arguments:?}: {}", ended.messages);
    ended
}

/// A host that keeps nothing.
struct Silent;

impl emmy_cli::Host for Silent {
    fn output(&self, _: &str) -> io::Result<()> {
        Ok(())
    }

    fn message(&self, _: &str) {}

    fn is_interrupted(&self) -> bool {
        false
    }
}

/// `emmy` on this process.
fn emmy(arguments: &[&str]) {
    emmy_cli::run_verb(arguments, &Silent).unwrap();
}

/// The columns of a history.
fn history(directory: &Path) -> HashMap<String, Vec<f64>> {
    let text = fs::read_to_string(directory.join("history.csv")).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns: HashMap<String, Vec<f64>> = HashMap::new();
    for line in lines {
        for (name, number) in names.iter().zip(line.split(',')) {
            columns.entry(name.to_string()).or_default().push(number.parse().unwrap_or(f64::NAN));
        }
    }
    columns
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

/// Compares energies, works, momenta and probes of all steps, to a part of the largest.
fn assert_near(own: &Path, other: &Path, tolerance: f64, name: &str) {
    let (own, other) = (history(own), history(other));
    let energy = largest(&other["kinetic_energy"]).max(largest(&other["strain_energy"]));
    let size_of = |prefix: &str| {
        ["x", "y", "z"].iter().map(|axis| largest(&other[&format!("{prefix}_{axis}")])).fold(0.0, f64::max)
    };
    // The forces on a block in flight cancel: its linear momentum is zero.
    let of_motion = size_of("angular_momentum") / size_of("tip");
    let mut compared = 0;
    for (column, values) in &own {
        let vector =
            ["linear_momentum_", "angular_momentum_", "tip_"].into_iter().find(|own| column.starts_with(own));
        let size = match (column.as_str(), vector) {
            ("kinetic_energy" | "strain_energy" | "total_energy" | "external_work", _) => energy,
            (_, Some(prefix)) if !column.ends_with("residual") => match prefix {
                "linear_momentum_" => size_of("linear_momentum").max(of_motion),
                _ => size_of(prefix.trim_end_matches('_')),
            },
            _ => continue,
        };
        compared += 1;
        assert_eq!(values.len(), other[column].len(), "{name}: steps");
        for (step, (own, other)) in values.iter().zip(&other[column]).enumerate() {
            let difference = (own - other).abs() / size.max(1e-300);
            assert!(
                difference <= tolerance,
                "{name}: {column} of step {step}: {own} and {other}, {difference:e}"
            );
        }
    }
    assert!(compared >= 10, "{name}: columns are missing");
}

/// Compares the peaks of the probe in the summary with those of the rows of the history.
fn assert_peaks(directory: &Path) {
    let (history, summary) =
        (history(directory), fs::read_to_string(directory.join("summary.json")).unwrap());
    let of = |name: &str| {
        let found = summary.lines().find_map(|line| line.trim().strip_prefix(&format!("\"{name}\": ")));
        found.unwrap_or_else(|| panic!("{name}")).trim_end_matches(',').parse::<f64>().unwrap()
    };
    for axis in ["x", "y", "z"] {
        let name = format!("tip_{axis}");
        let [low, high] = [f64::min, f64::max].map(|of| history[&name].iter().copied().reduce(of).unwrap());
        let time =
            |number: f64| history["time"][history[&name].iter().position(|own| *own == number).unwrap()];
        let own = ["_min", "_min_time", "_max", "_max_time", ""].map(|ending| of(&format!("{name}{ending}")));
        assert_eq!(own, [low, time(low), high, time(high), *history[&name].last().unwrap()], "{name}");
    }
}

fn input(name: &str) -> String {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("inputs").join(name).display().to_string()
}

/// Inputs whose runs on ranks equal that on one process, and what the linear solver needs.
const INPUTS: [&str; 4] = ["l-block.toml", "quasi-rigid.toml", "bracket.toml", "rubber.toml"];

/// Whether the program has the solvers of PETSc, which the inputs need for stiff rubber.
fn has_solvers_for(name: &str) -> bool {
    cfg!(feature = "petsc") || name != "rubber.toml"
}

#[test]
fn runs_on_ranks_are_those_of_one_process_also_resumed_on_other_numbers() {
    let temp = TempDir::new().unwrap();
    let at = temp.path();
    for name in INPUTS.into_iter().filter(|name| has_solvers_for(name)) {
        let file = input(name);
        let alone = at.join(format!("alone-{name}"));
        emmy(&["run", &file, "--quiet", "--output", alone.to_str().unwrap()]);
        for size in 1..=4 {
            let output = format!("{size}-{name}");
            run_well(size, at, &["run", &file, "--quiet", "--output", &output]);
            assert_near(&at.join(&output), &alone, 1e-12, &format!("{name} on {size} ranks"));
        }
        // Stopped half-way on three ranks, resumed on two, one and four.
        let end = history(&alone)["time"].last().copied().unwrap();
        let until = |part: f64| format!("{}", part * end);
        for size in [1, 2, 4] {
            let output = format!("moved-{size}-{name}");
            run_well(3, at, &["run", &file, "--quiet", "--output", &output, "--until", &until(0.5)]);
            run_well(size, at, &["resume", &output, "--quiet", "--until", &until(1.0)]);
            assert_near(&at.join(&output), &alone, 1e-12, &format!("{name}, from 3 ranks to {size}"));
        }
    }
}

#[test]
fn a_run_moves_between_one_process_and_ranks() {
    let temp = TempDir::new().unwrap();
    let at = temp.path();
    let file = input("l-block.toml");
    let alone = at.join("alone");
    emmy(&["run", &file, "--quiet", "--output", alone.to_str().unwrap()]);
    let there = at.join("there");
    emmy(&["run", &file, "--quiet", "--output", there.to_str().unwrap(), "--until", "0.3"]);
    run_well(2, at, &["resume", "there", "--quiet", "--until", "0.6"]);
    emmy(&["resume", there.to_str().unwrap(), "--quiet", "--until", "1"]);
    assert_near(&there, &alone, 1e-12, "one process, two ranks, one process");
    assert_peaks(&there);
    run_well(2, at, &["run", &file, "--quiet", "--output", "ranks", "--until", "0.6"]);
    run_well(3, at, &["resume", "ranks", "--quiet", "--until", "1"]);
    assert_peaks(&at.join("ranks"));
}

#[test]
fn ranks_read_their_parts_of_a_mesh_that_was_split() {
    let temp = TempDir::new().unwrap();
    let at = temp.path();
    let file = input("l-block.toml");
    let parts = at.join("block.parts");
    emmy(&["split", &file, "--parts", "3", "--output", parts.to_str().unwrap()]);
    run_well(3, at, &["run", &file, "--quiet", "--output", "sent", "--until", "0.3"]);
    run_well(
        3,
        at,
        &["run", &file, "--quiet", "--output", "read", "--until", "0.3", "--parts", "block.parts"],
    );
    assert!(bits(&at.join("read")) == bits(&at.join("sent")));
    run_well(3, at, &["resume", "read", "--quiet", "--until", "0.5", "--parts", "block.parts"]);
    for (size, set, message) in [
        (2, "title=\"as before\"", "is split into 3 parts, but the team has 2 ranks"),
        (3, "mesh.l-block.cell_size=0.5", "are of another `[mesh]` than that of the input"),
    ] {
        let arguments = ["run", &file, "--output", "none", "--parts", "block.parts", "--set", set];
        let ended = run(size, at, &arguments);
        assert_eq!(ended.code, Some(2), "{}", ended.messages);
        assert_eq!(ended.messages.matches(message).count(), 1, "{}", ended.messages);
        assert!(!at.join("none").exists());
    }
}

/// The mesh file may be missing where the parts are, but not have other content.
#[test]
fn parts_of_another_mesh_file_are_rejected() {
    let temp = TempDir::new().unwrap();
    let at = temp.path();
    let (file, mesh) = (input("bracket.toml"), at.join("bracket.msh"));
    let there = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/meshes/bracket.msh");
    fs::copy(there, &mesh).unwrap();
    let set = format!("mesh.file={mesh:?}");
    emmy(&["split", &file, "--parts", "2", "--output", at.join("parts").to_str().unwrap(), "--set", &set]);
    let run = |output| {
        let steps = "time.steps=[{until=2e-5,size=2e-5}]";
        let arguments = ["run", &file, "--quiet", "--output", output, "--parts", "parts"];
        run(2, at, &[&arguments[..], &["--set", &set, "--set", steps]].concat())
    };
    let ended = run("same");
    assert_eq!(ended.code, Some(0), "{}", ended.messages);
    fs::write(&mesh, [&fs::read(&mesh).unwrap()[..], b"\n"].concat()).unwrap();
    let ended = run("other");
    assert_eq!(ended.code, Some(2), "{}", ended.messages);
    assert_eq!(ended.messages.matches("are of another content of").count(), 1, "{}", ended.messages);
    assert!(!at.join("other").exists());
    fs::remove_file(&mesh).unwrap();
    let ended = run("without");
    assert_eq!(ended.code, Some(0), "{}", ended.messages);
}

/// Launchers that do not know the MPI start processes that would each compute the whole body.
#[test]
fn processes_that_are_not_connected_are_rejected() {
    let temp = TempDir::new().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_emmy-mpi"))
        .args(["run", &input("l-block.toml"), "--output", "out"])
        .current_dir(temp.path())
        .env("SLURM_STEP_NUM_TASKS", "4")
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .output()
        .unwrap();
    let messages = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{messages}");
    assert!(messages.contains("4 processes were started, but MPI does not connect them"), "{messages}");
    assert!(!temp.path().join("out").exists());
}

/// The history without the time that the run took.
fn bits(directory: &Path) -> Vec<(String, Vec<u64>)> {
    let mut columns: Vec<(String, Vec<u64>)> = history(directory)
        .into_iter()
        .filter(|(name, _)| name != "wall_seconds")
        .map(|(name, values)| (name, values.into_iter().map(f64::to_bits).collect()))
        .collect();
    columns.sort();
    columns
}

/// A long run of the block: its steps are stopped from outside.
fn long(at: &Path, output: &str) -> Ranks {
    let file = input("l-block.toml");
    let set = ["--set", "output.checkpoint_every=1", "--set", "output.every=5"];
    let arguments = [&["run", &file, "--quiet", "--output", output, "--until", "500"][..], &set[..]].concat();
    Ranks::start(3, at, &arguments)
}

fn n_rows(directory: &Path) -> usize {
    fs::read_to_string(directory.join("history.csv")).map_or(0, |text| text.lines().count().saturating_sub(1))
}

#[test]
fn a_signal_the_stop_file_and_a_kill_leave_runs_that_resume_with_the_same_bits() {
    let temp = TempDir::new().unwrap();
    let at = temp.path();
    for how in ["signal", "file", "kill"] {
        let directory = at.join(how);
        let mut ranks = long(at, how);
        ranks.wait_for("a few steps", || n_rows(&directory) > 4);
        match how {
            // Batch systems send it before they end a job.
            "signal" => ranks.signal("-USR1"),
            "file" => fs::write(directory.join("stop"), "").unwrap(),
            _ => {
                let own =
                    fs::read_to_string(format!("/proc/{0}/task/{0}/children", ranks.child.id())).unwrap();
                let rank = own.split_whitespace().last().unwrap();
                assert!(Command::new("kill").args(["-KILL", rank]).status().unwrap().success());
            }
        }
        let ended = ranks.end();
        if how == "kill" {
            assert!(ended.code != Some(0), "{how}: {}", ended.messages);
        } else {
            assert_eq!(ended.code, Some(130), "{how}: {}", ended.messages);
            let stops = ended.messages.matches("stopped after step").count();
            assert_eq!(stops, 1, "{}", ended.messages);
            assert!(
                ended.messages.contains(&format!("`mpirun -n 3 emmy-mpi resume {how}` resumes from here"))
            );
        }
        let end = format!("{}", 0.1 * (n_rows(&directory) + 4) as f64);
        let moved = format!("{how}-moved");
        assert!(Command::new("cp").args(["-r", how, &moved]).current_dir(at).status().unwrap().success());
        run_well(3, at, &["resume", how, "--quiet", "--until", &end]);
        let whole = format!("{how}-whole");
        let file = input("l-block.toml");
        run_well(3, at, &["run", &file, "--quiet", "--output", &whole, "--until", &end]);
        assert!(bits(&directory) == bits(&at.join(&whole)), "{how}: the resumed run has other bits");
        assert!(!directory.join("stop").exists());
        run_well(2, at, &["resume", &moved, "--quiet", "--until", &end]);
        assert_near(&at.join(&moved), &at.join(&whole), 1e-11, &format!("{how}, resumed on two ranks"));
    }
}

#[test]
fn bad_input_is_one_message_and_nothing_is_written() {
    let temp = TempDir::new().unwrap();
    let at = temp.path();
    let file = input("l-block.toml");
    for (set, message) in [
        ("time.scheme=\"DMG\"", "DGM"),
        ("load.0.group=face-c", "face-c"),
        ("mesh.l-block.cell_size=0.3", "cell_size"),
        ("solver.kind=fast", "iterative"),
    ] {
        let ended = run(3, at, &["run", &file, "--output", "results", "--set", set]);
        assert_eq!(ended.code, Some(2), "{set}: {}", ended.messages);
        let faults = ended.messages.matches('×').count().max(ended.messages.matches("Error").count());
        assert!(ended.messages.contains(message) && faults <= 1, "{set}: {}", ended.messages);
        assert!(!at.join("results").exists(), "{set}");
    }
    let ended = run(2, at, &["run", "missing.toml"]);
    assert_eq!(
        (ended.code, ended.messages.matches("missing.toml").count()),
        (Some(2), 1),
        "{}",
        ended.messages
    );
    let ended = run(2, at, &["report", "results"]);
    assert_eq!(ended.code, Some(2), "{}", ended.messages);
}

/// A box that spins freely.
const SPINNING: &str = "mesh.box = { size = [1, 4, 1], cells = [2, 8, 2] }\n[[region]]\ndensity = 1.0\n\
                        material.neo-hooke = { youngs_modulus = 1000.0, poissons_ratio = 0.3 }\n\
                        [initial]\nangular_velocity = [0.5, 0.3, 1]\n\
                        [time]\nscheme = 'DGM'\nsteps = [{ until = 0.8, size = 0.02 }]\n";

/// Two ranks with commands of their own.
fn run_two(directory: &Path, first: &[&str], second: &[&str]) -> Ended {
    Ranks::start_as(directory, &[&["-n", "1"][..], first, &[":", "-n", "1"], second].concat()).end()
}

#[test]
fn ranks_with_two_commands_or_two_inputs_are_one_message_and_nothing_is_written() {
    let temp = TempDir::new().unwrap();
    let at = temp.path();
    fs::write(at.join("own.toml"), SPINNING).unwrap();
    let program = env!("CARGO_BIN_EXE_emmy-mpi");
    let command = [program, "run", "own.toml", "--output", "out", "--quiet"];
    for (from, to) in [
        ("density = 1.0", "density = 2.0"),
        ("until = 0.8", "until = 0.6"),
        ("DGM", "AS(3)"),
        ("[2, 8, 2]", "[2, 9, 2]"),
    ] {
        fs::write(at.join("other.toml"), SPINNING.replace(from, to)).unwrap();
        let other = [program, "run", "other.toml", "--output", "out", "--quiet"];
        let ended = run_two(at, &command, &other);
        assert_eq!(ended.code, Some(2), "{to}: {}", ended.messages);
        assert_eq!(ended.messages.matches("rank 1 has another input").count(), 1, "{to}: {}", ended.messages);
    }
    for other in [
        &["run", "own.toml", "--output", "out", "--quiet", "--until", "0.6"][..],
        &["run", "own.toml", "--output", "out", "--quiet", "--estimate-error"],
        &["run", "own.toml", "--output", "out", "--quiet", "--no-such-flag"],
        &["check", "own.toml", "--output", "out"],
        &["resume", "out"],
    ] {
        let ended = run_two(at, &command, &[&[program][..], other].concat());
        assert_eq!(ended.code, Some(2), "{other:?}: {}", ended.messages);
        let count = ended.messages.matches("rank 1 has another command than rank 0").count();
        assert_eq!(count, 1, "{other:?}: {}", ended.messages);
    }
    assert!(!at.join("out").exists());
    let ended = run_two(at, &command, &[&command[..], &["--threads", "1"]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.messages);
}

#[test]
#[cfg(unix)]
fn a_limit_on_files_is_a_message_with_the_name_of_the_file() {
    let temp = TempDir::new().unwrap();
    let at = temp.path();
    fs::write(at.join("own.toml"), SPINNING).unwrap();
    let program = env!("CARGO_BIN_EXE_emmy-mpi");
    let command = [program, "run", "own.toml", "--output", "out", "--quiet"];
    let limited = [&["bash", "-c", "ulimit -f 2; exec \"$0\" \"$@\""][..], &command].concat();
    let ended = run_two(at, &command, &limited);
    assert_eq!(ended.code, Some(1), "{}", ended.messages);
    assert!(
        ended.messages.contains("out/") && ended.messages.contains("File too large"),
        "{}",
        ended.messages
    );
    let summary = fs::read_to_string(at.join("out/summary.json")).unwrap();
    assert!(summary.contains("\"status\": \"failed\""), "{summary}");
}

#[test]
fn a_step_that_fails_is_one_message_with_the_exit_code_3() {
    let temp = TempDir::new().unwrap();
    let file = input("l-block.toml");
    let sets = ["--set", "newton.max_iterations=1", "--set", "time.smallest_step=0.1"];
    let ended = run(2, temp.path(), &[&["run", &file, "--quiet", "--output", "out"][..], &sets[..]].concat());
    assert_eq!(ended.code, Some(3), "{}", ended.messages);
    assert_eq!(ended.messages.matches("the results up to the step before are written").count(), 1);
    assert_eq!(n_rows(&temp.path().join("out")), 1);
}

#[test]
fn check_reports_the_body_once_and_its_division() {
    let temp = TempDir::new().unwrap();
    let ended = run_well(3, temp.path(), &["check", &input("l-block.toml")]);
    let line = |name: &str| ended.output.lines().filter(|line| line.trim_start().starts_with(name)).count();
    assert_eq!((line("input"), line("ranks"), line("neighbours")), (1, 1, 1), "{}", ended.output);
    assert!(ended.output.contains("computed more than once"), "{}", ended.output);
    assert_eq!(fs::read_dir(temp.path()).unwrap().count(), 0);
    // More ranks than nodes.
    fs::write(temp.path().join("own.toml"), SPINNING.replace("[2, 8, 2]", "[1, 1, 1]")).unwrap();
    let ended = run(9, temp.path(), &["check", "own.toml"]);
    assert_eq!((ended.code, ended.output.as_str()), (Some(2), ""), "{}", ended.messages);
}
