//! The same mechanisms in EXUDYN, a program of multibody dynamics.

use std::path::Path;
use std::process::Command;

use serde::Deserialize;

use super::data::Problem;
use super::run;
use crate::claim::Item;

/// Goal for its steps over those of Emmy at an error that is not larger.
const FEWER_STEPS: f64 = 100.0;

/// A problem, its name in the script, numbers of steps there, and degrees and step sizes of Emmy.
type Comparison = (&'static str, &'static str, [usize; 3], &'static [(usize, f64)]);

const COMPARISONS: [Comparison; 4] = [
    (
        "pendulum",
        "pendulum",
        [1000, 10_000, 100_000],
        &[(3, 0.1), (3, 0.05), (3, 0.025), (3, 0.0125), (4, 0.1), (4, 0.05), (5, 0.1)],
    ),
    ("four-bars-2", "four-bars", [1000, 10_000, 100_000], &[(2, 0.025), (3, 0.05), (3, 0.025)]),
    ("four-bars-2", "four-bars-3d", [1000, 10_000, 100_000], &[(2, 0.025), (3, 0.05), (3, 0.025)]),
    (
        "heavy-top",
        "heavy-top",
        [2000, 20_000, 200_000],
        &[(2, 0.00125), (3, 0.01), (3, 0.005), (3, 0.0025), (4, 0.01), (4, 0.005)],
    ),
];

/// Result of a run: number of steps, error of the position at the end, CPU time.
#[derive(Debug, Clone, Deserialize)]
struct Found {
    steps: usize,
    error: f64,
    cpu_seconds: f64,
}

/// Claims about steps and CPU time at equal errors.
///
/// # Errors
/// The message of a run of Emmy that fails, or of a script that cannot be run.
pub(super) fn beside(item: &mut Item, problems: &[Problem], python: &Path) -> Result<(), String> {
    let header = ["mechanism", "program", "steps", "error of the position", "CPU s"];
    let mut table = vec![header.map(String::from).to_vec()];
    let row = |problem: &str, program: String, found: &Found| {
        let Found { steps, error, cpu_seconds } = found;
        vec![problem.into(), program, steps.to_string(), format!("{error:.1e}"), format!("{cpu_seconds:.4}")]
    };
    for (name, own_name, steps, runs) in COMPARISONS {
        let problem = problems.iter().find(|problem| problem.name == name).ok_or("no such problem")?;
        let emmy = emmy(problem, runs)?;
        table.extend(
            emmy.iter().map(|(degree, found)| row(own_name, format!("Emmy, DGM, k = {degree}"), found)),
        );
        let mut others = Vec::new();
        for (solver, steps) in
            ["trapezoidal", "alpha"].into_iter().flat_map(|solver| steps.map(|n| (solver, n)))
        {
            let program = format!("EXUDYN, {solver}");
            match script(python, [own_name, solver, &steps.to_string()])? {
                Some(found) => {
                    table.push(row(own_name, program, &found));
                    others.push(found);
                }
                None => table.push(vec![
                    own_name.into(),
                    program,
                    steps.to_string(),
                    "fails".into(),
                    String::new(),
                ]),
            }
        }
        compare(item, own_name, &emmy, &others);
    }
    item.tables.push(table);
    Ok(())
}

/// Claims about one problem, at the smallest error of the other program.
fn compare(item: &mut Item, name: &str, emmy: &[(usize, Found)], others: &[Found]) {
    let Some(best) = others.iter().min_by(|a, b| a.error.total_cmp(&b.error)) else { return };
    let smaller = || emmy.iter().map(|(_, own)| own).filter(|own| own.error <= best.error);
    let Some(few) = smaller().min_by_key(|own| own.steps) else { return };
    let ratio = best.steps as f64 / few.steps as f64;
    item.claim(
        format!(
            "{name}: a hundredth of the steps of EXUDYN's most accurate run, at an error that is not larger"
        ),
        format!("{ratio:.0} times fewer, errors {:.1e} and {:.1e}", few.error, best.error),
        ratio >= FEWER_STEPS,
    );
    let fast = smaller().map(|own| own.cpu_seconds).fold(f64::INFINITY, f64::min);
    item.claim(
        format!("{name}: less CPU time than EXUDYN's most accurate run, at an error that is not larger"),
        format!("{fast:.3} s and {:.3} s", best.cpu_seconds),
        fast < best.cpu_seconds,
    );
}

/// Runs of Emmy, of short ones the shortest of three.
fn emmy(problem: &Problem, runs: &[(usize, f64)]) -> Result<Vec<(usize, Found)>, String> {
    let mut problem = problem.clone();
    // Of a motion the script compares the position alone.
    problem.state.iter_mut().for_each(|state| state.value.truncate(3));
    let input = problem.case().problem()?;
    let mut found = Vec::new();
    for &(degree, size) in runs {
        let own = run::run(&problem, &input, degree, size)?;
        let mut cpu_seconds = own.seconds;
        let again = if cpu_seconds < 1.0 { 2 } else { 0 };
        for _ in 0..again {
            cpu_seconds = cpu_seconds.min(run::run(&problem, &input, degree, size)?.seconds);
        }
        found.push((degree, Found { steps: own.steps, error: own.error, cpu_seconds }));
    }
    Ok(found)
}

/// Runs of the script, the shortest of three; `None` if its solver fails.
fn script(python: &Path, words: [&str; 3]) -> Result<Option<Found>, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../benches/peers/exudyn_mechanism.py");
    let mut shortest: Option<Found> = None;
    for _ in 0..3 {
        let output = Command::new(python).arg(&path).args(words).output();
        let output = output.map_err(|error| format!("{}: {error}", python.display()))?;
        if !output.status.success() {
            let message = String::from_utf8_lossy(&output.stderr);
            if message.contains("the solver fails") {
                return Ok(None);
            }
            return Err(format!("{}: {message}", path.display()));
        }
        let text = String::from_utf8_lossy(&output.stdout);
        let found = text.lines().find(|line| line.starts_with('{')).ok_or("the script prints nothing")?;
        let found: Found = serde_json::from_str(found).map_err(|error| error.to_string())?;
        if shortest.as_ref().is_none_or(|best| found.cpu_seconds < best.cpu_seconds) {
            shortest = Some(found);
        }
    }
    Ok(shortest)
}
