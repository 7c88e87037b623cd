//! `locking`: nearly incompressible rubber and bending, by the formulations against locking.

use std::path::Path;

use emmy::mesh::CellKind;

use super::Settings;
use crate::job::Case;
use crate::mesh_file::block_file;
use crate::outcome::Outcome;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::scratch::Scratch;
use crate::session::{Runs, step_seconds};

/// Kinds of cells with their formulation, and cells per unit length.
const KINDS: [(CellKind, &str, u32); 5] = [
    (CellKind::Hex8, "projected-volume", 4),
    (CellKind::Hex20, "projected-volume", 2),
    (CellKind::Hex27, "projected-volume", 2),
    (CellKind::Tet10, "projected-volume", 2),
    (CellKind::Hex8, "incompatible-modes", 4),
];
const SCHEMES: [&str; 3] = ["AS(5)", "DGM", "FE(1)"];
/// Kinds with goals, and limits of the time and the memory of projected cells over standard ones.
const WITH_GOALS: [CellKind; 2] = [CellKind::Hex8, CellKind::Tet10];
const TIME: f64 = 1.8;
const MEMORY: f64 = 2.5;
/// Bulk modulus over shear modulus of the cells with the standard formulation and with incompatible modes, and of those
/// with a projected volume.
const RATIOS: [f64; 2] = [2.0, 1e4];
const STEP: f64 = 0.02;

/// Time of a step of nearly incompressible rubber relative to one of soft rubber with standard cells, in the same mesh.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let scratch = Scratch::new("locking")?;
    let steps = session.choose(3, 30);
    let mut report = Report::new("Cells against locking", NOTE);
    let mut table = Table::new(
        4,
        &[
            "cells",
            "formulation",
            "K/mu",
            "scheme",
            "dofs",
            "CPU s a step",
            "standard, K/mu = 2",
            "ratio",
            "Newton",
            "MB",
            "ratio",
        ],
    );
    for (kind, formulation, r) in KINDS {
        let r = session.choose(1, r);
        let file = block_file(&scratch, kind, r)?;
        let ratio = if formulation == "projected-volume" { RATIOS[1] } else { RATIOS[0] };
        for scheme in SCHEMES {
            let case = |formulation, ratio| case(&file, (scheme, 1), formulation, ratio).steps(steps, STEP);
            let runs = session.cases(&[case(formulation, ratio), case("standard", RATIOS[0])])?;
            let over = runs[0].ratio(&runs[1], step_seconds);
            let megabytes = |o: &Outcome| o.peak_megabytes.unwrap_or(f64::NAN);
            let memory = runs[0].ratio(&runs[1], megabytes);
            let mut row = row(kind, formulation, ratio, scheme, &runs, over);
            row.extend([number(runs[0].median(megabytes)), number(memory)]);
            table.push(row);
            if WITH_GOALS.contains(&kind) && formulation == "projected-volume" {
                for (what, limit, over) in [("a step", TIME, over), ("memory", MEMORY, memory)] {
                    let statement =
                        format!("{scheme}, {kind}: {what} at K/mu = 1e4 over that of standard cells at 2");
                    report.goals.push(Goal::new(statement, Limit::AtMost(limit), over));
                }
            }
        }
    }
    report.tables.push(table);
    Ok(vec![report])
}

const NOTE: &str = "The L-shaped block of isochoric neo-Hooke rubber in free flight (`benches/spinning-block.toml` \
                    with other cells), steps of 0.02, one thread.";

pub(super) fn case(file: &Path, scheme: (&str, usize), formulation: &str, ratio: f64) -> Case {
    let bulk = 500.0 * ratio;
    Case::spinning_block_of(file)
        .with(
            "region.material",
            format!("{{ neo-hooke-isochoric = {{ mu = 500.0, bulk_modulus = {bulk:?} }} }}"),
        )
        .with("region.formulation", formulation)
        .with("initial.gradient", "[[0.2, 0.0, 0.0], [0.0, -0.1, 0.0], [0.0, 0.0, -0.1]]")
        .scheme(scheme.0, scheme.1)
}

fn row(kind: CellKind, formulation: &str, ratio: f64, scheme: &str, runs: &[Runs], over: f64) -> Vec<String> {
    vec![
        kind.to_string(),
        formulation.to_string(),
        format!("{ratio:e}"),
        scheme.to_string(),
        runs[0].last().dofs.to_string(),
        number(runs[0].median(step_seconds)),
        number(runs[1].median(step_seconds)),
        number(over),
        number(runs[0].last().newton_per_step),
    ]
}
