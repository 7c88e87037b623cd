//! `degrees`: cost of a step of degree k, and the error reached in a given time.

use super::Settings;
use crate::job::Case;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::scratch::Scratch;
use crate::session::{Runs, Session, step_seconds};
use crate::work::Work;

const DEGREES: [usize; 3] = [1, 2, 3];
/// Limits of the time of a step of degree k, relative to degree 1.
const LIMITS: [f64; 3] = [1.0, 2.2, 3.6];
/// Time at which errors are measured, as in the spinning block.
const END: f64 = 0.4;
/// Step sizes of degree 1, 2, 3. The start has a strain rate at a surface without tractions, which excites the highest
/// frequencies of the mesh: `2 sqrt 3 c` over the edge, with the speed of pressure waves c = 63, is above 400 at r = 2.
/// The orders of convergence appear where the step resolves these frequencies.
const STEP_SIZES: [[f64; 4]; 3] =
    [[0.01, 0.005, 0.0025, 0.00125], [0.02, 0.01, 0.005, 0.0025], [0.02, 0.01, 0.005, 0.0025]];
/// Degree and step size of the reference, whose error is far below the errors in the table.
const REFERENCE: (usize, f64) = (3, 0.00125);
const QUICK_REFERENCE: (usize, f64) = (3, 0.01);

/// Cost of a step by degree, then error over time.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    Ok(vec![cost(&settings.session)?, error(&settings.session)?])
}

fn cost(session: &Session) -> Result<Report, String> {
    let (r, steps) = session.choose((1, 3), (4, 20));
    let works = [Work::hex8(r, false, steps), Work::hex8(r, true, steps), Work::steel_bracket(steps)];
    let scratch = Scratch::new("degrees")?;
    let schemes = |k: usize| [("DGM".to_string(), k), (format!("FE({k})"), k)];
    let members: Vec<(String, usize)> = DEGREES.iter().flat_map(|&k| schemes(k)).collect();
    let note = format!("{steps} steps of h = 0.02 or 5e-5, one tolerance, one thread; CPU seconds a step.");
    let mut report = Report::new("Degrees in time", note);
    let heading = ["motion", "scheme", "k", "CPU s a step", "Newton", "linear", "over k = 1"];
    let mut table = Table::new(2, &heading);
    for work in works {
        let case = work.case(&scratch)?;
        let case = |(name, k): &(String, usize)| case.clone().scheme(name, *k);
        let runs = session.cases(&members.iter().map(case).collect::<Vec<_>>())?;
        for (index, ((name, k), runs_of)) in members.iter().zip(&runs).enumerate() {
            let ratio = runs_of.ratio(&runs[index % 2], step_seconds);
            table.push(row(&work, name, *k, runs_of, ratio));
            if *k > 1 {
                let statement = format!("{work}: a step of {name} at k = {k} over one at k = 1");
                report.goals.push(Goal::new(statement, Limit::AtMost(LIMITS[k - 1]), ratio));
            }
        }
    }
    report.tables.push(table);
    Ok(report)
}

fn row(work: &Work, name: &str, k: usize, runs: &Runs, ratio: f64) -> Vec<String> {
    let last = runs.last();
    vec![
        work.to_string(),
        name.into(),
        k.to_string(),
        number(runs.median(step_seconds)),
        number(last.newton_per_step),
        number(last.linear_per_step),
        number(ratio),
    ]
}

/// Error of the displacement at the end over the CPU time of the whole run.
fn error(session: &Session) -> Result<Report, String> {
    let (r, n_sizes, reference) = session.choose((1, 1, QUICK_REFERENCE), (2, 4, REFERENCE));
    let scratch = Scratch::new("degrees")?;
    let name = |(k, h): (usize, f64)| format!("k{k}-h{h}");
    let case = |&member: &(usize, f64)| {
        let file = scratch.file(&name(member));
        Case::spinning_block(r).scheme("DGM", member.0).until(END, member.1).state(file)
    };
    // The reference once: it takes the longest, and its time is not needed.
    Session { rounds: 1, ..session.clone() }.cases(&[case(&reference)])?;
    let sizes = |&k: &usize| STEP_SIZES[k - 1][..n_sizes].iter().map(move |&h| (k, h));
    let members: Vec<(usize, f64)> = DEGREES.iter().flat_map(sizes).collect();
    let runs = session.cases(&members.iter().map(case).collect::<Vec<_>>())?;
    let mut report = Report::new("Error within a time", error_note(r, reference));
    let reference = scratch.numbers(&name(reference))?;
    let mut table = Table::new(0, &["k", "h", "steps", "CPU s", "error"]);
    for (&(k, h), runs) in members.iter().zip(&runs) {
        let n_dofs = runs.last().dofs;
        let error = distance(&scratch.numbers(&name((k, h)))?[..n_dofs], &reference[..n_dofs]);
        let seconds = number(runs.median(|o| o.cpu_seconds));
        let steps = (END / h).round().to_string();
        table.push(vec![k.to_string(), h.to_string(), steps, seconds, format!("{error:.1e}")]);
    }
    report.tables.push(table);
    Ok(report)
}

fn error_note(r: u32, (k, h): (usize, f64)) -> String {
    format!(
        "DGM on the spinning block at r = {r} to t = {END}, one thread: relative error of the displacement at the end against \
         k = {k}, h = {h}, over the CPU seconds of the whole run."
    )
}

/// Euclidean distance of two vectors over the norm of the second.
pub(super) fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / b.iter().map(|b| b * b).sum::<f64>()).sqrt()
}
