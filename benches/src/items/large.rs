//! `large`: how cost and memory grow with the mesh.

use super::side_by_side::Figure;
use super::{Settings, stiff};
use crate::job::Case;
use crate::report::{Goal, Limit, Report, Table, count, number, number_or_dash};
use crate::scratch::Scratch;
use crate::session::{Runs, step_seconds};

/// Step size times r: the same CFL number on all meshes.
const STEP_SIZE_TIMES_R: f64 = 0.08;
const STEPS: u32 = 8;
/// Limit of the exponent of cost over degrees of freedom.
const EXPONENT: f64 = 1.15;
/// r of the mesh of 1.5 million degrees of freedom.
const MILLION: u32 = 16;
/// Limit of the memory for 1.5 million degrees of freedom \[MB\].
const MEMORY: f64 = 24e9 / 1048576.0;
/// Limit of the memory for a stiff block \[MB\].
const STIFF_MEMORY: f64 = 8e9 / 1048576.0;

/// Cost over the number of degrees of freedom, of a soft and of a stiff block; or the one mesh of 1.5 million of them.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    Ok(vec![soft(settings)?, stiff(settings)?])
}

fn soft(settings: &Settings) -> Result<Report, String> {
    let session = &settings.session;
    let sizes = sizes(settings);
    let case = |&r: &u32| Case::spinning_block(r).steps(STEPS, STEP_SIZE_TIMES_R / f64::from(r));
    let runs = session.cases(&sizes.iter().map(case).collect::<Vec<_>>())?;
    let note = format!(
        "The spinning block by the mid-point rule with h = {STEP_SIZE_TIMES_R}/r, {STEPS} steps, one thread: the same CFL number on \
         all meshes. CPU seconds a step without the first two."
    );
    let mut report = Report::new("Large meshes", note);
    report.tables.push(table(&sizes, &runs));
    report.goals.extend(exponent(&runs, Figure::Step, ""));
    report.goals.extend(memory(&sizes, &runs, MILLION, MEMORY));
    Ok(report)
}

fn stiff(settings: &Settings) -> Result<Report, String> {
    let session = &settings.session;
    let sizes = sizes(settings);
    let works = stiff::works(session, &sizes);
    let scratch = Scratch::new("large")?;
    let cases: Result<Vec<Case>, String> =
        works.iter().map(|work| Ok(work.case(&scratch)?.scheme("DGM", 1))).collect();
    let runs = session.cases(&cases?)?;
    let note = format!(
        "The spinning block with moduli times 1e4 by DGM, h = 0.02, {} steps, one thread. CPU seconds a step without the \
         first two, and of all steps with the start.",
        works[0].steps
    );
    let mut report = Report::new("Large stiff meshes", note);
    report.tables.push(table(&sizes, &runs));
    report.goals.extend(memory(&sizes, &runs, sizes[sizes.len() - 1], STIFF_MEMORY));
    Ok(report)
}

/// The goal for the exponent of a time, if there are several meshes.
pub(super) fn exponent(runs: &[Runs], figure: Figure, scheme: &str) -> Option<Goal> {
    let of = match figure {
        Figure::Step => "of a step",
        Figure::WithStart => "of all steps with the start",
    };
    let statement = format!("exponent of the CPU time {of}{scheme} over degrees of freedom");
    let point = |runs: &Runs| ((runs.last().dofs as f64).ln(), runs.median(|o| figure.of(o)).ln());
    let points: Vec<_> = runs.iter().map(point).collect();
    (runs.len() > 1).then(|| Goal::new(statement, Limit::AtMost(EXPONENT), slope(&points)))
}

/// The goal for the memory of the mesh with r cells per unit length, if it is among the sizes.
fn memory(sizes: &[u32], runs: &[Runs], r: u32, limit: f64) -> Option<Goal> {
    let index = sizes.iter().position(|&size| size == r)?;
    let peak = runs[index].median_of_some(|o| o.peak_megabytes).unwrap_or(f64::NAN);
    Some(Goal::new(format!("peak memory in MB at r = {r}"), Limit::AtMost(limit.floor()), peak))
}

fn sizes(settings: &Settings) -> Vec<u32> {
    let million = settings.million.then_some(MILLION);
    match (&settings.cells, settings.session.quick) {
        (Some(cells), _) => cells.iter().copied().chain(million).collect(),
        (None, true) => vec![1, 2],
        (None, false) => million.map_or(vec![4, 6, 8, 12], |million| vec![million]),
    }
}

fn table(sizes: &[u32], runs: &[Runs]) -> Table {
    let heading =
        ["r", "dofs", "CPU s a step", "with start", "Newton", "linear", "us a dof", "peak MB", "bytes a dof"];
    let mut table = Table::new(0, &heading);
    for (r, runs) in sizes.iter().zip(runs) {
        let (last, seconds) = (runs.last(), runs.median(step_seconds));
        table.push(vec![
            r.to_string(),
            count(last.dofs),
            number(seconds),
            number(runs.median(|o| Figure::WithStart.of(o))),
            number(last.newton_per_step),
            number(last.linear_per_step),
            number(1e6 * seconds / last.dofs as f64),
            number_or_dash(runs.median_of_some(|o| o.peak_megabytes)),
            number_or_dash(runs.median_of_some(|o| o.bytes_per_dof())),
        ]);
    }
    table
}

/// Slope of a line through points by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (x, y) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let products: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    products / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    #[test]
    fn slope_of_a_line() {
        let points = [0.0, 1.0, 4.0].map(|x| (x, 2.0 - 1.5 * x));
        assert!((super::slope(&points) + 1.5).abs() < 1e-15);
    }
}
