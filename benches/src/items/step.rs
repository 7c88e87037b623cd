//! `step`: the block in free flight by the mid-point rule, as computed by every program.

use super::{Settings, comparison};
use crate::job::{Case, Job};
use crate::report::{Goal, Limit, Report, Table, count, number, number_or_dash};
use crate::session::{Runs, step_seconds};

/// Cells a second in the assembly of residual and tangent, at a mesh (r).
const ASSEMBLED: (u32, f64) = (4, 6e5);

/// Assemblies measured after each run.
const ASSEMBLIES: usize = 5;

/// Emmy's steps by r with one thread, and the other programs.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let sizes = settings.cells.clone().unwrap_or(session.choose(vec![1], vec![1, 2, 4, 6]));
    let peers = comparison::Peers::find(settings)?;
    let cases = sizes.iter().map(|&r| Job::case(&Case::spinning_block(r).assemblies(ASSEMBLIES)));
    let mut jobs = cases.collect::<Result<Vec<_>, _>>()?;
    jobs.extend(peers.jobs(&sizes));
    let mut runs = session.in_turns(&jobs)?;
    let of_peers = runs.split_off(sizes.len());
    Ok(vec![steps(&sizes, &runs), comparison::report(&sizes, &runs, &peers, &of_peers)])
}

fn steps(sizes: &[u32], runs: &[Runs]) -> Report {
    let note = "The spinning block by the mid-point rule FE(1), h = 0.02, 20 steps, one thread, a process each; CPU seconds a step \
        without the first. Energies at the end are those of the other programs, to 1e-8.";
    let heading = [
        "r",
        "cells",
        "dofs",
        "CPU s a step, mean",
        "median",
        "Newton",
        "linear",
        "assembled cells/s",
        "peak MB",
        "bytes a dof",
    ];
    let mut table = Table::new(0, &heading);
    for (r, runs) in sizes.iter().zip(runs) {
        let last = runs.last();
        let rate = runs.median_of_some(|o| o.assembled_cells_per_second);
        table.push(vec![
            r.to_string(),
            count(last.cells),
            count(last.dofs),
            number(runs.median(step_seconds)),
            number(runs.median(|o| o.cpu_seconds_per_step)),
            number(last.newton_per_step),
            number(last.linear_per_step),
            number_or_dash(rate),
            number_or_dash(runs.median_of_some(|o| o.peak_megabytes)),
            number_or_dash(runs.median_of_some(|o| o.bytes_per_dof())),
        ]);
    }
    let mut report = Report::new("A step of Emmy", note);
    for (r, runs) in sizes.iter().zip(runs).filter(|(r, _)| **r == ASSEMBLED.0) {
        if let Some(rate) = runs.median_of_some(|o| o.assembled_cells_per_second) {
            let statement = format!("cells a second in the assembly of residual and tangent at r = {r}");
            report.goals.push(Goal::new(statement, Limit::AtLeast(ASSEMBLED.1), rate));
        }
    }
    report.tables.push(table);
    report
}
