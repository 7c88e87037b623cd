//! `stiff`: bodies so stiff that the stiffness dominates the matrix.

use super::Settings;
use super::side_by_side::{Figure, SideBySide};
use crate::job::Case;
use crate::peers::Recorded;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::session::{Session, step_seconds};
use crate::work::Work;

/// Goals for a step of a scheme: the fastest solver of DOLFINx over it.
const SCHEMES: [(&str, f64); 3] = [("FE(1)", 4.0), ("AS(1)", 10.0), ("DGM", 10.0)];
/// The same for the steps with the start.
const WITH_START: f64 = 6.0;
const STEPS: u32 = 12;

/// Limit for a step of the quasi-rigid block over the recorded one, at [`QUASI_RIGID_AT`].
const QUASI_RIGID: f64 = 0.25;
const QUASI_RIGID_AT: u32 = 8;
/// Steps of the quasi-rigid block, which reach beyond its load.
const QUASI_RIGID_STEPS: (f64, u32) = (0.2, 8);

/// The stiff spinning block beside DOLFINx.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    Ok(vec![spinning(settings, &sizes(settings))?])
}

/// The quasi-rigid block.
pub(super) fn measure_quasi_rigid(settings: &Settings) -> Result<Vec<Report>, String> {
    Ok(vec![quasi_rigid(&settings.session, &sizes(settings))?])
}

fn sizes(settings: &Settings) -> Vec<u32> {
    settings.cells.clone().unwrap_or(settings.session.choose(vec![1], vec![4, 6, 8]))
}

/// The stiff spinning block of some sizes.
pub(super) fn works(session: &Session, sizes: &[u32]) -> Vec<Work> {
    let steps = session.choose(3, STEPS);
    sizes.iter().map(|&r| Work::hex8(r, true, steps)).collect()
}

fn spinning(settings: &Settings, sizes: &[u32]) -> Result<Report, String> {
    let works = works(&settings.session, sizes);
    let runs = SideBySide::measure(settings, &works, &SCHEMES.map(|(name, _)| name))?;
    let note = format!(
        "The spinning block with moduli times 1e4, h = 0.02, {} steps, one thread: CPU seconds a step without the \
         first two, then of all steps with the start. DOLFINx by the mid-point rule, which is FE(1), with energies \
         equal to 1e-8; an asterisk marks recorded figures.",
        works[0].steps
    );
    let mut report = Report::new("A stiff block beside DOLFINx", note);
    report.tables = vec![runs.table(Figure::Step), runs.table(Figure::WithStart)];
    for (scheme, least) in SCHEMES {
        report.goals.extend(runs.goals(scheme, Figure::Step, least));
        report.goals.extend(runs.goals(scheme, Figure::WithStart, WITH_START));
    }
    Ok(report)
}

fn quasi_rigid(session: &Session, sizes: &[u32]) -> Result<Report, String> {
    let before = Recorded::read()?.quasi_rigid_before;
    let (h, steps) = (QUASI_RIGID_STEPS.0, session.choose(3, QUASI_RIGID_STEPS.1));
    let note = format!(
        "The block of E = 1e7 under its load (`examples/quasi-rigid.toml`), h = {h}, {steps} steps, one thread; CPU \
         seconds a step without the first two. In brackets: before algebraic multigrid, recorded."
    );
    let mut report = Report::new("A quasi-rigid block", note);
    let heading = ["scheme", "k"].map(String::from).into_iter();
    let heading = heading.chain(sizes.iter().map(|r| format!("r = {r}")));
    let mut table = Table::with_heading(1, heading.collect());
    for (scheme, k) in [("AS(1)", 1), ("DGM", 1), ("AS(2)", 2), ("DGM", 2)] {
        let case = |&r: &u32| Case::quasi_rigid_block(r).scheme(scheme, k).steps(steps, h);
        let runs = session.cases(&sizes.iter().map(case).collect::<Vec<_>>())?;
        let mut row = vec![scheme.to_string(), k.to_string()];
        for (&r, runs) in sizes.iter().zip(&runs) {
            let seconds = runs.median(step_seconds);
            let before = before.get(&format!("{scheme}, k = {k}, r = {r}")).copied();
            row.push(
                number(seconds) + &before.map_or(String::new(), |before| format!(" ({})", number(before))),
            );
            if let Some(before) = before.filter(|_| r == QUASI_RIGID_AT) {
                let statement = format!("{scheme}, k = {k}, r = {r}: a step over the recorded one");
                report.goals.push(Goal::new(statement, Limit::AtMost(QUASI_RIGID), seconds / before));
            }
        }
        table.push(row);
    }
    report.tables.push(table);
    Ok(report)
}
