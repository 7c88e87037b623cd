//! `solvers`: whether the solver that Emmy chooses is about as fast as the best one.

use super::side_by_side::Figure;
use super::{Settings, real, stiff};
use crate::job::Job;
use crate::measure::UNSOLVED;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::scratch::Scratch;
use crate::session::Runs;

/// Kinds of `[solver]`; the first one chooses among the others.
const KINDS: [&str; 4] = ["auto", "iterative", "direct", "multigrid"];
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
            let jobs = KINDS.map(|kind| Job::case(&case.clone().with("solver.kind", kind)));
            let jobs = jobs.into_iter().collect::<Result<Vec<_>, _>>()?;
            let runs = solved(session.attempts(&jobs, is_unsolved))?;
            let seconds = |runs: &Runs| number(runs.median(|o| Figure::WithStart.of(o)));
            // A choice that fails is infinitely worse.
            let over = |other: &Runs| {
                runs[0].as_ref().map_or(f64::INFINITY, |auto| auto.ratio(other, |o| Figure::WithStart.of(o)))
            };
            let ratio = runs.iter().flatten().map(over).fold(0.0, f64::max);
            let mut row = vec![work.to_string(), scheme.to_string()];
            row.extend(runs.iter().map(|runs| runs.as_ref().map_or("fails".into(), seconds)));
            row.push(number(ratio));
            table.push(row);
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

/// Whether a run failed because a kind does not suit the motion, which is a result.
fn is_unsolved(message: &str) -> bool {
    message.contains(UNSOLVED)
}

/// The runs of the kinds that suit; an error for any other failure.
fn solved(attempts: Vec<Result<Runs, String>>) -> Result<Vec<Option<Runs>>, String> {
    let solved = |attempt: Result<Runs, String>| match attempt {
        Ok(runs) => Ok(Some(runs)),
        Err(message) if is_unsolved(&message) => Ok(None),
        Err(message) => Err(message),
    };
    attempts.into_iter().map(solved).collect()
}
