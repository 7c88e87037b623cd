//! Agreement of Emmy with the reference: histories, summaries, modes and masses.

mod gradients;
mod modes;
mod rows;

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex};

use emmy::team::{Team, Threads};
use emmy_cli::{Host, run_verb};

use crate::case::{Case, INCREMENTS};
use crate::features::{Choice, describe, refusals};
use crate::place::Place;
use crate::reference::motion::{Motion, Row, State};
use gradients::{compare_gradient, gradient};
use modes::{compare_masses, compare_modes};
use rows::{compare_history, compare_summary};

/// Largest difference from the reference, relative to the largest number of its kind.
const TOLERANCE: f64 = 2e-9;

/// A host that keeps all text.
#[derive(Default)]
struct Kept {
    output: Mutex<String>,
    team: Option<Arc<dyn Team>>,
}

impl Host for Kept {
    fn output(&self, text: &str) -> io::Result<()> {
        self.output.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push_str(text);
        Ok(())
    }

    fn message(&self, _: &str) {}

    fn is_interrupted(&self) -> bool {
        false
    }

    fn team(&self) -> Option<&Arc<dyn Team>> {
        self.team.as_ref()
    }
}

/// Runs a verb; its output, or exit code and message.
fn call(arguments: &[&str], ranks: usize) -> Result<String, (u8, String)> {
    let run = |team: Option<Arc<dyn Team>>| {
        let host = Kept { team, ..Kept::default() };
        let ended = run_verb(arguments.iter().copied(), &host)
            .map_err(|failure| (failure.code(), failure.to_string()));
        ended.map(|()| host.output.into_inner().unwrap_or_default())
    };
    if ranks == 1 {
        return run(None);
    }
    let all = Threads::run(ranks, |team| run(Some(team))).map_err(|error| (101, error.to_string()))?;
    all.into_iter().collect::<Result<Vec<String>, _>>().map(|texts| texts.concat())
}

/// Computes a choice of features with Emmy and with the reference, or sees that Emmy refuses it.
///
/// # Errors
/// The first difference, or another end than that of the table.
pub fn agrees(choice: &Choice, seed: u64) -> Result<(), String> {
    let place = Place::new();
    agrees_in(&place, choice, seed).map_err(|fault| format!("{fault} [{}; seed {seed}]", describe(choice)))
}

/// [`agrees`] in a directory.
///
/// # Errors
/// As there.
pub fn agrees_in(place: &Place, choice: &Choice, seed: u64) -> Result<(), String> {
    let case = Case::new(choice, seed);
    place.write("mesh.msh", case.mesh.text());
    let in_place = |text: &str| {
        // Directories of results are relative to the working directory.
        let own = |name: &str| format!("{:?}", place.path(name).display().to_string());
        text.replace("directory = \"run\"", &format!("directory = {}", own("run")))
            .replace("directory = \"first\"", &format!("directory = {}", own("first")))
    };
    place.write("case.toml", in_place(&case.text));
    let path = |name: &str| place.path(name).display().to_string();
    let (input, modes) = (path("case.toml"), path("modes"));
    let words = refusals(choice);
    if let Some((text, ..)) = &case.first {
        place.write("first.toml", in_place(text));
        let ended = call(&["run", &path("first.toml"), "--quiet"], 1);
        if let Err((code, message)) = ended
            && words.is_empty()
        {
            return Err(format!("the first run ends with {code}: {message}"));
        }
    }
    if case.chosen("run") == "gradient" {
        let computed = gradient(&place.path("case.toml"), &case);
        return match (computed, words.is_empty()) {
            (Err(message), false) if words.iter().any(|word| message.contains(word)) => Ok(()),
            (Err(message), false) => Err(format!("refused without any of {words:?}: {message}")),
            (Ok(_), false) => Err("not refused: it was computed".into()),
            (Err(message), true) if message.contains("inside out") => confirm_collapse(&case, message),
            (Err(message), true) if message.contains(NO_EQUILIBRIUM) => {
                confirm_no_equilibrium(&case, &message)
            }
            (computed, true) => compare_gradient(choice, seed, &computed?),
        };
    }
    let ranks = if case.chosen("run") == "ranks" { 2 } else { 1 };
    let ended = if case.chosen("run") == "resumed" {
        let [part, end] = [2.0, 3.0].map(|steps| format!("{:?}", steps * case.step()));
        let first = call(&["run", &input, "--quiet", "--until", &part], 1);
        first.and_then(|_| call(&["resume", &path("run"), "--quiet", "--until", &end], 1))
    } else {
        call(&["run", &input, "--quiet"], ranks)
    };
    if !words.is_empty() {
        return match ended {
            Err((2, message)) if words.iter().any(|word| message.contains(word)) => Ok(()),
            Err((code, message)) => Err(format!("refused without any of {words:?}: {code}, {message}")),
            Ok(_) => Err("not refused: it was computed".into()),
        };
    }
    if let Err((3, message)) = &ended
        && message.contains(NO_EQUILIBRIUM)
    {
        return confirm_no_equilibrium(&case, message);
    }
    let has_collapsed =
        ended.as_ref().is_err_and(|(code, message)| *code == 3 && message.contains("inside out"));
    if let Err((code, message)) = ended
        && !has_collapsed
    {
        return Err(format!("run ends with {code}: {message}"));
    }
    let mut columns = history(&place.path("run/history.csv"))?;
    if has_collapsed {
        return compare_until_collapse(&case, &mut columns);
    }
    if columns["time"].len() < MIN_ROWS {
        return Err(format!("{} rows of a motion to its end", columns["time"].len()));
    }
    let mut rows = reference_rows(&case, &columns["time"], 1.0)?;
    if let Err(fault) = compare_history(&case, &columns, &rows) {
        // A large step may have several solutions: another guess may lead to that of Emmy.
        rows = reference_rows(&case, &columns["time"], 0.5)?;
        compare_history(&case, &columns, &rows).map_err(|_| fault)?;
    }
    compare_summary(&place.path("run/summary.json"), &rows)?;
    call(&["modes", &input, "--quiet", "--output", &modes], 1)
        .map_err(|(code, message)| format!("modes ends with {code}: {message}"))?;
    compare_modes(&case, &history(&place.path("modes/modes.csv"))?, &rows[0])?;
    let report = call(&["check", &input], 1);
    let report = report.map_err(|(code, message)| format!("check ends with {code}: {message}"))?;
    compare_masses(&case, &report)
}

/// Words of the message where there is no equilibrium.
const NO_EQUILIBRIUM: &str = "no equilibrium was found";

/// Rows of the history of a complete run, at the least: the start and three steps.
const MIN_ROWS: usize = 4;

/// Smallest det F from which on a material without resistance to compression is about to let a cell turn inside out.
const COLLAPSE: f64 = 0.1;

/// Compares the steps before a cell turns inside out, which ends the motion.
fn compare_until_collapse(case: &Case, columns: &mut BTreeMap<String, Vec<f64>>) -> Result<(), String> {
    let determinants = columns.get("smallest_determinant").ok_or("there are no determinants")?;
    let collapse = determinants.iter().position(|det| *det < COLLAPSE);
    let collapse = collapse.ok_or(format!("a cell is turned inside out after {determinants:?}"))?;
    columns.values_mut().for_each(|column| column.truncate(collapse));
    let rows = reference_rows(case, &columns["time"], 1.0)?;
    compare_history(case, columns, &rows)
}

/// Checks that the reference, too, finds no equilibrium; else the message of Emmy.
fn confirm_no_equilibrium(case: &Case, message: &str) -> Result<(), String> {
    let parts: Vec<f64> = (1..=INCREMENTS).map(|i| i as f64 / INCREMENTS as f64).collect();
    match case.motion().equilibria(&parts) {
        Ok(_) => Err(format!("the reference has an equilibrium: {message}")),
        Err(_) => Ok(()),
    }
}

/// Checks that a cell collapses in the reference, too, where the motion of a gradient ends by this; else its message.
fn confirm_collapse(case: &Case, message: String) -> Result<(), String> {
    let times: Vec<f64> = (0..MIN_ROWS).map(|step| step as f64 * case.step()).collect();
    match reference_rows(case, &times, 1.0) {
        Ok(rows) if rows.iter().all(|row| row.determinant >= COLLAPSE) => Err(message),
        Err(error) if !error.contains("does not converge") => Err(error),
        _ => Ok(()),
    }
}

/// Columns of a CSV file; an empty cell is NaN.
fn history(path: &Path) -> Result<BTreeMap<String, Vec<f64>>, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    let column = |i: usize| rows.iter().map(|row| row[i]).collect();
    Ok(names.iter().enumerate().map(|(i, name)| (name.to_string(), column(i))).collect())
}

fn reference_rows(case: &Case, times: &[f64], guess: f64) -> Result<Vec<Row>, String> {
    let fault = |error: String| format!("the reference fails: {error}");
    let motion = Motion { guess, ..case.motion() };
    if case.chosen("run") == "static" {
        if times.len() != INCREMENTS + 1 {
            return Err(format!("{} rows of a static analysis", times.len()));
        }
        let path = motion.equilibria(&times[1..]).map_err(fault)?;
        let start = State { u: vec![0.0; 3 * case.body.n_all], v: vec![0.0; 3 * case.body.n_all] };
        let mut rows = motion.rows(start, &[0.0], false).map_err(fault)?;
        rows[0].velocity.fill(0.0);
        (rows[0].kinetic, rows[0].momenta) = (0.0, [[0.0; 3]; 2]);
        for (u, fraction) in path.into_iter().zip(&times[1..]) {
            let (strain, determinant) = case.body.energy(&u);
            let reactions = motion.static_reactions(&u, *fraction);
            rows.push(Row {
                time: *fraction,
                strain,
                determinant,
                work: strain - rows[0].strain,
                reactions,
                displacement: u,
                kinetic: 0.0,
                momenta: [[0.0; 3]; 2],
                ..rows[0].clone()
            });
        }
        return Ok(rows);
    }
    let is_equilibrium = case.chosen("start") == "equilibrium";
    motion.rows(case.start().map_err(fault)?, times, is_equilibrium).map_err(fault)
}

/// Numbers of one kind, with what they are compared with.
struct Kind {
    scale: f64,
    pairs: Vec<(String, Vec<f64>, Vec<f64>)>,
}

impl Kind {
    fn new(scale: f64) -> Self {
        Kind { scale, pairs: Vec::new() }
    }

    fn check(&self, tolerance: f64) -> Result<(), String> {
        let numbers = self.pairs.iter().flat_map(|(_, own, expected)| own.iter().chain(expected));
        let scale = numbers.filter(|x| x.is_finite()).fold(self.scale, |m, x| m.max(x.abs()));
        for (name, own, expected) in &self.pairs {
            if own.len() != expected.len() {
                return Err(format!("{name}: {} rows for {}", own.len(), expected.len()));
            }
            for (row, (a, b)) in own.iter().zip(expected).enumerate() {
                if a.is_nan() && b.is_nan() {
                    continue;
                }
                let difference = (a - b).abs() / scale.max(1e-300);
                // Numbers that are not finite differ.
                if difference > tolerance || difference.is_nan() {
                    return Err(format!(
                        "{name}: row {row} has {a:e}, the reference {b:e} ({difference:.1e})"
                    ));
                }
            }
        }
        Ok(())
    }
}
