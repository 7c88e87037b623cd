//! `schemes`: cost of the conserving schemes relative to the mid-point rule.

use super::Settings;
use crate::job::Case;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::session::{Runs, step_seconds};

/// Schemes with the limit of their step relative to FE(1), which comes first.
const SCHEMES: [(&str, Option<f64>); 5] =
    [("FE(1)", None), ("AS(1)", Some(1.15)), ("DGM", Some(1.15)), ("AS(5)", Some(1.15)), ("FE(5)", None)];

/// Whole steps of the schemes relative to FE(1).
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let (r, steps) = session.choose((1, 3), (4, 20));
    let cases = SCHEMES.map(|(name, _)| Case::spinning_block(r).scheme(name, 1).steps(steps, 0.02));
    let runs = session.cases(&cases)?;
    let note =
        format!("The spinning block at r = {r}, h = 0.02, {steps} steps, one thread; CPU seconds a step.");
    let mut report = Report::new("Schemes", note);
    let mut table = Table::new(1, &["scheme", "CPU s a step", "Newton", "linear", "over FE(1)"]);
    for ((name, limit), runs_of) in SCHEMES.iter().zip(&runs) {
        let ratio = runs_of.ratio(&runs[0], step_seconds);
        table.push(row(name, runs_of, ratio));
        if let Some(limit) = limit {
            let statement = format!("a step of {name} over one of FE(1)");
            report.goals.push(Goal::new(statement, Limit::AtMost(*limit), ratio));
        }
    }
    let inner_points = runs[3].ratio(&runs[1], step_seconds);
    report.goals.push(Goal::new("a step of AS(5) over one of AS(1)", Limit::AtMost(1.1), inner_points));
    report.tables.push(table);
    Ok(vec![report])
}

fn row(name: &str, runs: &Runs, ratio: f64) -> Vec<String> {
    let last = runs.last();
    vec![
        name.into(),
        number(runs.median(step_seconds)),
        number(last.newton_per_step),
        number(last.linear_per_step),
        number(ratio),
    ]
}
