//! `large`: how cost and memory grow with the mesh.

use super::Settings;
use crate::job::Case;
use crate::report::{Goal, Limit, Report, Table, count, number, number_or_dash};
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

/// Cost of a step over the number of degrees of freedom; or the one mesh of 1.5 million of them.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let sizes = sizes(settings);
    let case = |&r: &u32| Case::spinning_block(r).steps(STEPS, STEP_SIZE_TIMES_R / f64::from(r));
    let runs = session.cases(&sizes.iter().map(case).collect::<Vec<_>>())?;
    let note = format!(
        "The spinning block by the mid-point rule with h = {STEP_SIZE_TIMES_R}/r, {STEPS} steps, one thread: the same CFL number on \
         all meshes. CPU seconds a step without the first."
    );
    let mut report = Report::new("Large meshes", note);
    report.tables.push(table(&sizes, &runs));
    if sizes.len() > 1 {
        let statement = "exponent of CPU time over degrees of freedom";
        report.goals.push(Goal::new(statement, Limit::AtMost(EXPONENT), exponent(&runs)));
    }
    if let Some(index) = sizes.iter().position(|&r| r == MILLION) {
        let peak = runs[index].median_of_some(|o| o.peak_megabytes).unwrap_or(f64::NAN);
        report.goals.push(Goal::new("peak memory in MB", Limit::AtMost(MEMORY.floor()), peak));
    }
    Ok(vec![report])
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
    let heading = ["r", "dofs", "CPU s a step", "Newton", "linear", "us a dof", "peak MB", "bytes a dof"];
    let mut table = Table::new(0, &heading);
    for (r, runs) in sizes.iter().zip(runs) {
        let (last, seconds) = (runs.last(), runs.median(step_seconds));
        table.push(vec![
            r.to_string(),
            count(last.dofs),
            number(seconds),
            number(last.newton_per_step),
            number(last.linear_per_step),
            number(1e6 * seconds / last.dofs as f64),
            number_or_dash(runs.median_of_some(|o| o.peak_megabytes)),
            number_or_dash(runs.median_of_some(|o| o.bytes_per_dof())),
        ]);
    }
    table
}

/// Slope of the logarithm of the cost over the logarithm of the degrees of freedom, by least squares.
fn exponent(runs: &[Runs]) -> f64 {
    let points = |runs: &Runs| ((runs.last().dofs as f64).ln(), runs.median(step_seconds).ln());
    slope(&runs.iter().map(points).collect::<Vec<_>>())
}

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
