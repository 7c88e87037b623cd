//! `run.log`: command, machine, steps and events of a run, to be read by people. A resumed run appends to it.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use emmy::internals::number::short;
use emmy::internals::sparse::SolverChoice;
use emmy::motion::{Event, Record};

use crate::input::Problem;
use crate::message::counted;
use crate::whole_file::named;

/// The file; every line is written at once.
#[derive(Debug)]
pub struct RunLog {
    file: File,
    path: PathBuf,
    /// The solver named last.
    solver: Option<SolverChoice>,
}

impl RunLog {
    /// Opens the log with a header; `after`: step and time after which the run is resumed.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn open(path: &Path, problem: &Problem, after: Option<(usize, f64)>) -> io::Result<Self> {
        let mut options = File::options();
        let options = match after {
            None => options.write(true).create(true).truncate(true),
            Some(_) => options.append(true).create(true),
        };
        let file = options.open(path).map_err(named(path))?;
        let mut log = RunLog { file, path: path.to_path_buf(), solver: None };
        if let Some((step, time)) = after {
            log.line(&format!(
                "\nresumed after step {step}, t = {}; later steps above were discarded",
                short(time)
            ))?;
        }
        for line in heading(problem) {
            log.line(&line)?;
        }
        Ok(log)
    }

    /// Writes a line.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn line(&mut self, text: &str) -> io::Result<()> {
        self.file.write_all(format!("{text}\n").as_bytes()).map_err(named(&self.path))
    }

    /// Writes the linear solver of a step, if it has changed.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn solver(&mut self, record: &Record) -> io::Result<()> {
        if let Some(solver) = record.solver.filter(|solver| self.solver != Some(*solver)) {
            self.line(&format!("linear solver: {solver}"))?;
            self.solver = Some(solver);
        }
        Ok(())
    }

    /// Writes a step.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn step(&mut self, record: &Record) -> io::Result<()> {
        let Record { step, newton_iterations, linear_iterations, .. } = record;
        let time = short(record.time);
        let step_size = short(record.step_size);
        self.line(&format!(
            "step {step}  t = {time}  h = {step_size}  corrections {newton_iterations} (linear {linear_iterations})  \
             E {:.6e}  balances: E {:.1e}, p {:.1e}, L {:.1e}",
            record.total_energy,
            record.energy_residual,
            record.linear_momentum_residual,
            record.angular_momentum_residual,
        ))
    }

    /// Writes an event.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn event(&mut self, event: &Event) -> io::Result<()> {
        self.line(&format!(
            "{} (step {}, t = {}): {}",
            event.kind.name(),
            event.step,
            short(event.time),
            event.message
        ))
    }
}

fn heading(problem: &Problem) -> Vec<String> {
    let command: Vec<String> = std::env::args_os().map(|part| part.to_string_lossy().into_owned()).collect();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let [nodes, cells] = problem.mesh_size();
    let ranks = Some(problem.body.ranks().size()).filter(|&size| size > 1);
    let ranks = ranks.map(|size| counted(size, "rank", "ranks") + " of ");
    let mut lines = vec![
        format!("emmy {}", env!("CARGO_PKG_VERSION")),
        format!("command: {}", command.join(" ")),
        format!(
            "machine: {} {}, {}, {}{}, {}",
            std::env::consts::OS,
            std::env::consts::ARCH,
            counted(cores, "core", "cores"),
            ranks.unwrap_or_default(),
            counted(rayon::current_num_threads(), "thread", "threads"),
            instruction_set()
        ),
        format!(
            "mesh: {}, {}; {} degrees of freedom",
            counted(nodes, "node", "nodes"),
            counted(cells, "cell", "cells"),
            problem.body.n_dofs_of_ranks()
        ),
        format!(
            "scheme: {} of degree {}, to t = {}",
            problem.scheme.name(),
            problem.scheme.degree(),
            short(problem.plan.end())
        ),
    ];
    lines.extend(problem.units.description().map(|units| format!("units: {units}")));
    lines.extend(problem.notes.iter().map(|note| format!("note: {note}")));
    lines
}

/// The vector instructions of the machine.
fn instruction_set() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx512f") {
        return "AVX-512";
    } else if std::arch::is_x86_feature_detected!("avx2") {
        return "AVX2";
    }
    if cfg!(target_arch = "aarch64") { "NEON" } else { "no vector instructions in use" }
}
