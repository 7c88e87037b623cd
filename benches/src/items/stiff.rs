//! `stiff`: the quasi-rigid block, where the stiffness dominates the matrix.

use super::Settings;
use crate::job::Case;
use crate::report::{Goal, Limit, Report, Table, number, number_or_dash};
use crate::session::step_seconds;

/// Step sizes with the number of steps and the limit of a step over one factorisation. The large ones reach beyond the
/// load, which ends at t = 1.
const STEP_SIZES: [(f64, u32, f64); 2] = [(0.01, 20, 2.0), (0.2, 8, 8.0)];
/// Factorisations measured after each run.
const FACTORIZATIONS: usize = 3;

/// Time of a step relative to one sparse Cholesky factorisation in the same run.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let r = session.choose(1, 4);
    let case = |(h, steps, _)| {
        Case::stiff_block(r).steps(session.choose(3, steps), h).factorizations(FACTORIZATIONS)
    };
    let runs = session.cases(&STEP_SIZES.map(case))?;
    let note = format!(
        "The block of E = 1e7 under its load (`examples/quasi-rigid.toml`, AS(1)) at r = {r}, one thread; CPU seconds \
         a step, and of one sparse Cholesky factorisation of a matrix with the same pattern in the same process."
    );
    let mut report = Report::new("A stiff body", note);
    let mut table =
        Table::new(0, &["h", "CPU s a step", "Newton", "linear", "factorisation, s", "step / factorisation"]);
    for ((h, _, limit), runs) in STEP_SIZES.iter().zip(&runs) {
        let (last, one) = (runs.last(), runs.median_of_some(|o| o.factorization_seconds));
        let ratio = runs.median_of_some(|o| Some(step_seconds(o) / o.factorization_seconds?));
        table.push(vec![
            h.to_string(),
            number(runs.median(step_seconds)),
            number(last.newton_per_step),
            number(last.linear_per_step),
            number_or_dash(one),
            number_or_dash(ratio),
        ]);
        let statement = format!("a step at h = {h} over one factorisation");
        report.goals.push(Goal::new(statement, Limit::AtMost(*limit), ratio.unwrap_or(f64::NAN)));
    }
    report.tables.push(table);
    Ok(vec![report])
}
