//! `locking`: nearly incompressible rubber and bending, by the formulations against locking.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

use emmy::mesh::{CellKind, Mesh, l_block};

use super::Settings;
use crate::job::Case;
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
        ],
    );
    for (kind, formulation, r) in KINDS {
        let r = session.choose(1, r);
        let file = scratch.file(&format!("{kind}-{r}.vtu"));
        std::fs::write(&file, vtu(kind, r)?).map_err(|error| format!("{}: {error}", file.display()))?;
        let ratio = if formulation == "projected-volume" { RATIOS[1] } else { RATIOS[0] };
        for scheme in SCHEMES {
            let case = |formulation, ratio| case(&file, scheme, formulation, ratio).steps(steps, STEP);
            let runs = session.cases(&[case(formulation, ratio), case("standard", RATIOS[0])])?;
            let over = runs[0].ratio(&runs[1], step_seconds);
            table.push(row(kind, formulation, ratio, scheme, &runs, over));
            if kind == CellKind::Hex8 && formulation == "projected-volume" && scheme != "FE(1)" {
                let statement =
                    format!("{scheme}, hex8: a step at K/mu = 1e4 over one of standard cells at 2");
                report.goals.push(Goal::new(statement, Limit::AtMost(2.0), over));
            }
        }
    }
    report.tables.push(table);
    Ok(vec![report])
}

const NOTE: &str = "The L-shaped block of isochoric neo-Hooke rubber in free flight (`benches/spinning-block.toml` \
                    with other cells), steps of 0.02, one thread.";

fn case(file: &Path, scheme: &str, formulation: &str, ratio: f64) -> Case {
    let bulk = 500.0 * ratio;
    Case::spinning_block_of(file)
        .with(
            "region.material",
            format!("{{ neo-hooke-isochoric = {{ mu = 500.0, bulk_modulus = {bulk:?} }} }}"),
        )
        .with("region.formulation", formulation)
        .with("initial.gradient", "[[0.2, 0.0, 0.0], [0.0, -0.1, 0.0], [0.0, 0.0, -0.1]]")
        .scheme(scheme, 1)
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

/// The L-shaped block in cells of a kind, as the text of a VTK file.
fn vtu(kind: CellKind, r: u32) -> Result<String, String> {
    let block = l_block(1.0 / f64::from(r)).map_err(|error| error.to_string())?;
    let (points, cells) = refined(&block, kind);
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\"><UnstructuredGrid>\n<Piece \
         NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" \
         format=\"ascii\">\n",
        points.len(),
        cells.len()
    );
    let failed = |error: std::fmt::Error| error.to_string();
    points.iter().try_for_each(|[x, y, z]| writeln!(text, "{x:?} {y:?} {z:?}")).map_err(failed)?;
    text.push_str(
        "</DataArray></Points>\n<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n",
    );
    let words = |numbers: &[usize]| numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    cells.iter().try_for_each(|nodes| writeln!(text, "{}", words(nodes))).map_err(failed)?;
    let n = kind.n_nodes();
    for (name, numbers) in [
        ("offsets", (1..=cells.len()).map(|cell| n * cell).collect::<Vec<_>>()),
        ("types", vec![usize::from(kind.info().vtk_type); cells.len()]),
    ] {
        let head = format!("</DataArray>\n<DataArray type=\"Int64\" Name=\"{name}\" format=\"ascii\">\n");
        text.push_str(&head);
        text.push_str(&words(&numbers));
    }
    text.push_str("\n</DataArray></Cells>\n</Piece></UnstructuredGrid></VTKFile>\n");
    Ok(text)
}

type Points = Vec<[f64; 3]>;

/// Points and cells of a kind in the place of hex8 cells; six tetrahedra in each.
fn refined(block: &Mesh, kind: CellKind) -> (Points, Vec<Vec<usize>>) {
    let (mut points, mut numbers, mut cells) = (Points::new(), HashMap::new(), Vec::new());
    let mut number = |place: [f64; 3]| {
        *numbers.entry(place.map(|x| (1e6 * x).round() as i64)).or_insert_with(|| {
            points.push(place);
            points.len() - 1
        })
    };
    let reference = kind.info().element.nodes();
    for cell in block.cells() {
        let corner = |local: usize| block.points()[cell.nodes[local] as usize];
        let (low, high) = (corner(0), corner(6));
        let inside = |t: [f64; 3]| [0, 1, 2].map(|d| low[d] + t[d] * (high[d] - low[d]));
        if kind == CellKind::Tet10 {
            for corners in tetrahedra() {
                let place =
                    |xi: &[f64; 3]| [0, 1, 2].map(|d| (0..3).map(|k| xi[k] * corners[k + 1][d]).sum::<f64>());
                cells.push(reference.iter().map(|xi| number(inside(place(xi)))).collect());
            }
        } else {
            let place = |xi: &[f64; 3]| xi.map(|x| 0.5 * (x + 1.0));
            cells.push(reference.iter().map(|xi| number(inside(place(xi)))).collect());
        }
    }
    (points, cells)
}

/// Corners of the six tetrahedra along the diagonal of the unit cube.
fn tetrahedra() -> [[[f64; 3]; 4]; 6] {
    // Even permutations of the axes, then odd ones, whose tetrahedra are turned.
    [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]].map(|order| {
        let mut corners = [[0.0; 3]; 4];
        for (step, axis) in order.into_iter().enumerate() {
            corners[step + 1] = corners[step];
            corners[step + 1][axis] = 1.0;
        }
        if (order[1] + 3 - order[0]) % 3 == 2 {
            corners.swap(1, 2);
        }
        corners
    })
}
