//! `stiff`: bodies so stiff that the stiffness dominates the matrix.

use super::Settings;
use super::large::exponent;
use super::side_by_side::{Figure, OTHERS, SideBySide};
use crate::report::Report;
use crate::session::Session;
use crate::work::Work;

const SCHEMES: [&str; 2] = ["FE(1)", "DGM"];
/// Mesh (r) with a goal for the fastest solver of DOLFINx over Emmy, all steps with the start.
const WITH_START_AT: u32 = 6;
const STEPS: u32 = 12;

/// The stiff spinning block beside DOLFINx.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let sizes = settings.cells.clone().unwrap_or(settings.session.choose(vec![1, 2], vec![4, 6, 8]));
    let works = works(&settings.session, &sizes);
    let runs = SideBySide::measure(settings, &works, &SCHEMES)?;
    let note = format!(
        "The spinning block with moduli times 1e4, h = 0.02, {} steps, one thread: CPU seconds a step without the \
         first two, then of all steps with the start. {OTHERS}",
        works[0].steps
    );
    let mut report = Report::new("A stiff block beside other programs", note);
    report.tables = vec![runs.table(Figure::Step), runs.table(Figure::WithStart)];
    for scheme in SCHEMES {
        report.goals.extend(runs.goals(scheme, Figure::Step, |_| true));
        report.goals.extend(
            runs.goals(scheme, Figure::WithStart, |work| {
                *work == Work::hex8(WITH_START_AT, true, work.steps)
            }),
        );
        report.goals.extend(exponent(&runs.of(scheme), Figure::WithStart, &format!(" by {scheme}")));
    }
    Ok(vec![report])
}

/// The stiff spinning block of some sizes.
pub(super) fn works(session: &Session, sizes: &[u32]) -> Vec<Work> {
    let steps = session.choose(3, STEPS);
    sizes.iter().map(|&r| Work::hex8(r, true, steps)).collect()
}
