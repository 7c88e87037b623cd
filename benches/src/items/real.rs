//! `real`: soft linear cells, and quadratic ones, as meshes of real parts have them.

use emmy::mesh::CellKind;

use super::Settings;
use super::side_by_side::{Figure, OTHERS, SideBySide};
use crate::report::Report;
use crate::session::Session;
use crate::work::{MATERIALS, Shape, Work};

const SCHEMES: [&str; 2] = ["FE(1)", "DGM"];
const STEPS: u32 = 12;

/// Blocks of hex8, tet10 and hex20 and a bracket of tet10 beside other programs.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let works = works(&settings.session);
    let runs = SideBySide::measure(settings, &works, &SCHEMES)?;
    let note = format!(
        "The spinning block in soft hex8 and in quadratic cells (h = 0.02) and a clamped bracket with a pulse on its tip (h = 5e-5), \
         moduli of 1e3 and 1e7, of steel and 1e-4 of it, {} steps, one thread: CPU seconds a step without the first \
         two, then of all steps with the start. {OTHERS}",
        works[0].steps
    );
    let mut report = Report::new("Real cells beside other programs", note);
    report.tables = vec![runs.table(Figure::Step), runs.table(Figure::WithStart)];
    for scheme in SCHEMES {
        report.goals.extend(runs.goals(scheme, Figure::Step, |_| true));
    }
    Ok(vec![report])
}

/// Soft blocks of hex8; three bodies, soft and stiff, of two materials; in the quick set one of each of the three.
fn works(session: &Session) -> Vec<Work> {
    let (r, steps) = session.choose((1, 3), (2, STEPS));
    let blocks: &[u32] = session.choose(&[], &[4, 6]);
    let mut works: Vec<_> = blocks.iter().map(|&r| Work::hex8(r, false, steps)).collect();
    for shape in [Shape::Block(CellKind::Tet10, r), Shape::Block(CellKind::Hex20, r), Shape::Bracket] {
        for stiff in [false, true] {
            works.extend(MATERIALS.map(|material| Work { shape, stiff, material, steps }));
        }
    }
    works.into_iter().step_by(session.choose(5, 1)).collect()
}
