//! `solvers`: whether the solver that Emmy chooses is about as fast as the best one.

use super::side_by_side::Figure;
use super::{Settings, real, stiff};
use crate::report::{Goal, Limit, Report, Table, number};
use crate::scratch::Scratch;

/// Kinds of `[solver]`; the first one chooses among the others.
const KINDS: [&str; 3] = ["auto", "iterative", "direct"];
const SCHEMES: [&str; 2] = ["FE(1)", "DGM"];
/// Limit of the time with the first kind over that with the best one.
const LIMIT: f64 = 1.3;

/// Whole runs of the motions of `stiff` (on smaller meshes) and `real` by each kind.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let mut works = stiff::works(session, &session.choose(vec![1], vec![2, 4]));
    works.extend(real::works(session));
    let scratch = Scratch::new("solvers")?;
    let note = format!(
        "The motions of `stiff` and `real`, {} steps with the start, one thread; CPU seconds by `[solver]`.",
        works[0].steps
    );
    let mut report = Report::new("Solvers", note);
    let heading = ["motion", "scheme"].into_iter().chain(KINDS).chain(["auto / best"]);
    let mut table = Table::with_heading(2, heading.map(String::from).collect());
    let mut largest = (0.0, String::new());
    for work in works {
        for scheme in SCHEMES {
            let case = work.case(&scratch)?.scheme(scheme, 1);
            let runs = session.cases(&KINDS.map(|kind| case.clone().with("solver.kind", kind)))?;
            let seconds = runs.iter().map(|runs| number(runs.median(|o| Figure::WithStart.of(o))));
            let others = runs.iter().map(|other| runs[0].ratio(other, |o| Figure::WithStart.of(o)));
            let ratio = others.fold(0.0, f64::max);
            let names = [work.to_string(), scheme.to_string()];
            table.push(names.into_iter().chain(seconds).chain([number(ratio)]).collect());
            if ratio > largest.0 {
                largest = (ratio, format!("{work}, {scheme}"));
            }
        }
    }
    report.tables.push(table);
    let statement = format!("auto over the best kind, largest of all ({})", largest.1);
    report.goals.push(Goal::new(statement, Limit::AtMost(LIMIT), largest.0));
    Ok(vec![report])
}
