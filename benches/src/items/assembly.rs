//! `assembly`: residual and tangent of real cells over the peak of the core.

use emmy::internals::element::element;
use emmy::mesh::CellKind;

use super::Settings;
use crate::job::Job;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::roofline::operations_per_second;
use crate::scratch::Scratch;
use crate::work::{Shape, Work};

/// Assemblies measured after each run.
const ASSEMBLIES: usize = 5;
/// Goal for the share of the peak, of quadratic cells.
const SHARE: f64 = 0.4;

/// Cells a second and operations a second of hex8, tet10 and hex20.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let (session, scratch) = (&settings.session, Scratch::new("assembly")?);
    let (r_of_hex8, r) = session.choose((1, 1), (4, 2));
    let kinds = [(CellKind::Hex8, r_of_hex8, 8), (CellKind::Tet10, r, 4), (CellKind::Hex20, r, 27)];
    let job = |&(kind, r, _): &(CellKind, u32, usize)| {
        let work = Work { shape: Shape::Block(kind, r), ..Work::hex8(r, false, 3) };
        Job::case(&work.case(&scratch)?.assemblies(ASSEMBLIES))
    };
    let runs = session.in_turns(&kinds.iter().map(job).collect::<Result<Vec<_>, _>>()?)?;
    let peak = operations_per_second();
    let note = format!(
        "Residual and tangent of neo-Hooke cells by the mid-point rule, one thread. Operations of a cell are those of \
         the formulas (`crates/emmy/benches/assembly.rs`); peak of the core: {:.1} GFLOP/s (fused multiplications and \
         additions).",
        peak * 1e-9
    );
    let mut report = Report::new("Assembly", note);
    let mut table = Table::new(1, &["cell", "cells/s", "operations a cell", "GFLOP/s", "of the peak"]);
    for ((kind, _, points), runs) in kinds.iter().zip(&runs) {
        let rate = runs.median_of_some(|o| o.assembled_cells_per_second).unwrap_or(f64::NAN);
        let operations = operations(element(*kind).nodes().len(), *points);
        let share = rate * operations / peak;
        let speed = rate * operations * 1e-9;
        table.push(vec![kind.to_string(), number(rate), number(operations), number(speed), number(share)]);
        if *kind != CellKind::Hex8 {
            let statement = format!("{kind}: residual and tangent over the peak of the core");
            report.goals.push(Goal::new(statement, Limit::AtLeast(SHARE), share));
        }
    }
    report.tables.push(table);
    Ok(vec![report])
}

/// Operations of a cell with n nodes: at each point 36 n + 371 for the residual and 27 n (n + 1) + 153 n + 744 for the
/// tangent.
fn operations(n_nodes: usize, n_points: usize) -> f64 {
    (n_points * (27 * n_nodes * (n_nodes + 1) + 189 * n_nodes + 1115)) as f64
}

#[cfg(test)]
mod tests {
    use super::operations;

    #[test]
    fn operations_of_hex8_are_those_of_the_table() {
        assert_eq!(operations(8, 8), 8.0 * (659.0 + 3912.0));
    }
}
