//! `check`: the report on an input, which runs nothing.

use super::Settings;
use crate::job::Case;
use crate::report::{Goal, Limit, Report, Table, count, number_or_dash};

/// Cells along an edge of the boxes; the last one has a goal.
const CELLS: [u32; 3] = [16, 32, 64];
/// Limit of its CPU time \[s\].
const LIMIT: f64 = 0.5;

/// CPU time and memory of the whole process.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let cells = session.choose(&CELLS[..1], &CELLS[..]);
    let runs = session.cases(&cells.iter().map(|&n| Case::checked_box(n)).collect::<Vec<_>>())?;
    let note = "A box of hex8 cells, `emmy check` on one thread: CPU seconds of the process. Up to 30,000 degrees of \
                freedom it computes the lowest mode, too.";
    let mut report = Report::new("Check of an input", note);
    let mut table = Table::new(0, &["cells", "dofs", "CPU s", "peak MB"]);
    for runs in &runs {
        let seconds = runs.median_of_some(|o| o.cpu_seconds_with_start);
        let [cells, dofs] = [runs.last().cells, runs.last().dofs].map(count);
        let peak = runs.median_of_some(|o| o.peak_megabytes);
        table.push(vec![cells, dofs, number_or_dash(seconds), number_or_dash(peak)]);
    }
    report.tables.push(table);
    let n = cells[cells.len() - 1];
    let seconds = runs[runs.len() - 1].median_of_some(|o| o.cpu_seconds_with_start).unwrap_or(f64::NAN);
    report.goals.push(Goal::new(
        format!("CPU seconds of a box of {n}^3 cells"),
        Limit::AtMost(LIMIT),
        seconds,
    ));
    Ok(vec![report])
}
