//! `shake`: steps chosen by their error beside equal ones, where a record has a kink in every tenth of a millisecond.

use super::Settings;
use super::degrees::distance;
use crate::job::Case;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::scratch::Scratch;
use crate::session::Session;

/// Degrees and sizes of equal steps, those of the input's degree first.
const EQUAL: [(usize, f64); 7] =
    [(2, 5e-4), (1, 5e-4), (1, 2.5e-4), (1, 1.25e-4), (2, 1e-3), (2, 2.5e-4), (3, 1e-3)];
/// Degree and step size of the reference.
const REFERENCE: (usize, f64) = (3, 2.5e-4);
const END: f64 = 0.03;
/// Limit of the time of adaptive steps over that of the first equal ones, or of the cheapest whose error is not larger.
const LIMIT: f64 = 1.5;

/// CPU time and error at the end by adaptive and by equal steps.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let scratch = Scratch::new("shake")?;
    let (end, n_equal, reference) = session.choose((0.002, 1, (2, 1e-3)), (END, EQUAL.len(), REFERENCE));
    let equal = |(k, h): (usize, f64), file: &str| {
        Case::shake()
            .scheme("DGM", k)
            .with("time.adaptive", "")
            .with("time.until", "")
            .until(end, h)
            .state(scratch.file(file))
    };
    // The reference once: its time is not needed.
    Session { rounds: 1, ..session.clone() }.cases(&[equal(reference, "reference")])?;
    let reference = scratch.numbers("reference")?;
    let mut cases = vec![Case::shake().with("time.until", end).state(scratch.file("0"))];
    cases.extend(EQUAL[..n_equal].iter().zip(1..).map(|(&steps, i)| equal(steps, &format!("{i}"))));
    let runs = session.cases(&cases)?;
    let ratio = |i: usize| runs[0].ratio(&runs[i], |o| o.cpu_seconds);
    let seconds = |i: usize| runs[i].median(|o| o.cpu_seconds);
    let error = |i: usize| -> Result<f64, String> {
        let n = runs[i].last().dofs;
        Ok(distance(&scratch.numbers(&i.to_string())?[..n], &reference[..n]))
    };
    let errors = (0..runs.len()).map(error).collect::<Result<Vec<_>, _>>()?;
    let note = format!(
        "A rubber mount on a shaker (`benches/shake.toml`) to t = {end} by DGM, one thread: CPU seconds of the motion, \
         and the relative error of the displacement at its end."
    );
    let mut report = Report::new("Adaptive steps on a shaker", note);
    let mut table = Table::new(1, &["steps", "CPU s", "error", "Newton", "adaptive / this"]);
    for (i, runs_of) in runs.iter().enumerate() {
        let name = match i {
            0 => "adaptive".to_string(),
            _ => format!("k = {}, h = {}", EQUAL[i - 1].0, EQUAL[i - 1].1),
        };
        let newton = number(runs_of.last().newton_per_step);
        table.push(vec![name, number(seconds(i)), format!("{:.1e}", errors[i]), newton, number(ratio(i))]);
    }
    report.tables.push(table);
    let as_exact = (1..runs.len()).filter(|&i| errors[i] <= errors[0]);
    let cheapest = as_exact.min_by(|&a, &b| seconds(a).total_cmp(&seconds(b)));
    let over = ratio(1).min(cheapest.map_or(f64::INFINITY, ratio));
    let statement =
        "adaptive steps over equal ones of 5e-4 and the same degree, or over the cheapest of their error";
    report.goals.push(Goal::new(statement, Limit::AtMost(LIMIT), over));
    Ok(vec![report])
}
