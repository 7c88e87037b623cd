//! `schemes`: cost of the conserving schemes relative to the mid-point rule, and of materials that need eigenvectors.

use super::Settings;
use crate::job::Case;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::session::{Runs, Session, step_seconds};

/// Schemes with the limit of their step relative to FE(1), which comes first.
const SCHEMES: [(&str, Option<f64>); 5] =
    [("FE(1)", None), ("AS(1)", Some(1.15)), ("DGM", Some(1.15)), ("AS(5)", Some(1.15)), ("FE(5)", None)];

/// Materials of the same moduli at rest; the first one needs no eigenvectors.
const MATERIALS: [&str; 3] = [
    "{ neo-hooke = { lambda = 1000.0, mu = 500.0 } }",
    "{ hencky = { lambda = 1000.0, mu = 500.0 } }",
    "{ ogden = { mu = [450.0, -50.0], alpha = [2.0, -2.0], bulk_modulus = 1333.3 } }",
];
/// Schemes of these materials, and the limit of their step relative to the first material.
const SCHEMES_OF_MATERIALS: [&str; 3] = ["FE(1)", "AS(5)", "DGM"];
const EIGENVECTORS: f64 = 2.5;

/// Whole steps of the schemes relative to FE(1), of materials relative to neo-Hooke.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let (r, steps) = session.choose((1, 3), (4, 20));
    let block = |scheme: &str| Case::spinning_block(r).scheme(scheme, 1).steps(steps, 0.02);
    Ok(vec![schemes(session, (r, steps), block)?, materials(session, block)?])
}

fn schemes(
    session: &Session,
    (r, steps): (u32, u32),
    block: impl Fn(&str) -> Case,
) -> Result<Report, String> {
    let cases = SCHEMES.map(|(name, _)| block(name));
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
    Ok(report)
}

fn materials(session: &Session, block: impl Fn(&str) -> Case) -> Result<Report, String> {
    let note = "The same motion with materials whose stress needs eigenvectors of the strain.";
    let mut report = Report::new("Materials with eigenvectors", note);
    let mut table =
        Table::new(2, &["material", "scheme", "CPU s a step", "Newton", "linear", "over neo-hooke"]);
    for scheme in SCHEMES_OF_MATERIALS {
        let runs =
            session.cases(&MATERIALS.map(|material| block(scheme).with("region.material", material)))?;
        for (material, runs_of) in MATERIALS.iter().zip(&runs) {
            let name = material.split_whitespace().nth(1).unwrap_or_default();
            let ratio = runs_of.ratio(&runs[0], step_seconds);
            let mut row = row(scheme, runs_of, ratio);
            row.insert(0, name.into());
            table.push(row);
            if name != "neo-hooke" {
                let statement = format!("a step of {name} over one of neo-hooke by {scheme}");
                report.goals.push(Goal::new(statement, Limit::AtMost(EIGENVECTORS), ratio));
            }
        }
    }
    report.tables.push(table);
    Ok(report)
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
