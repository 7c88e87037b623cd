//! A uniform pressure that passes through the contact of two blocks whose meshes do not match.

#![allow(non_snake_case)]

use emmy::body::{Body, Contact, LayerLaw};
use emmy::equilibrium::Equilibrium;
use emmy::internals::element::{element, jacobian};
use emmy::mesh::{CellKind, Mesh, MeshBuilder, Placement};
use emmy::motion::NewtonSettings;
use emmy::prelude::{Load, Support};

use super::data::{Problem, Run};
use super::{Measured, ball};
use crate::items::locking::{Face, Grid};
use crate::measure::cpu_seconds;

/// Young's modulus is 1.
const POISSON: f64 = 0.3;
const PRESSURE: f64 = 0.02;

/// Largest and root-mean-square difference of the normal stress from the pressure, over the pressure, in 3 x 3 x 3
/// Gauss points of the cells at the surface. The lower block has 2 x 2 x 2 cells, the upper one those of the run.
///
/// # Errors
/// The message of an equilibrium that is not found.
pub(super) fn measure(_: &Problem, run: &Run) -> Result<Measured, String> {
    let text = |error: emmy::Error| error.to_string();
    let begin = cpu_seconds();
    let kind = match run.kind.as_deref() {
        Some("hex20") => CellKind::Hex20,
        Some("hex27") => CellKind::Hex27,
        _ => CellKind::Hex8,
    };
    let thickness = run.distance.ok_or("a distance is needed")?;
    let gap = 0.93 * thickness;
    let (lower, upper) = (block(kind, 2)?, block(kind, run.cells)?);
    let place = Placement::default().shifted([0.0, 0.0, 1.0 + gap]);
    let mut builder = MeshBuilder::new();
    builder.part("lower", &lower).map_err(text)?;
    builder.part("upper", &upper.placed(&place).map_err(text)?).map_err(text)?;
    let sides = [("x-min", [true, false, false]), ("y-min", [false, true, false])];
    let sides = ["lower", "upper"]
        .into_iter()
        .flat_map(|part| sides.map(|(side, held)| Support::of_components(format!("{part}-{side}"), held)));
    let body = Body::builder(builder.build().map_err(text)?)
        .region(ball::rubber(1.0, POISSON, 1.0)?)
        .supports(sides)
        .support(Support::of_components("lower-z-min", [false, false, true]))
        .load(Load::traction("upper-z-max", [0.0, 0.0, -PRESSURE]))
        .contact(
            Contact::between("lower-z-max", "upper-z-min")
                .with_distance(thickness)
                .with_stiffness(1.0)
                .with_law(LayerLaw::Smooth),
        )
        .build()
        .map_err(text)?;
    let settings = NewtonSettings { tolerance: 1e-13, ..NewtonSettings::default() };
    let state = Equilibrium::new(&body, 0.0, 1).map_err(text)?.start(settings, &[], &mut []);
    let displacement = state.map_err(|error| error.to_string())?.displacement;
    let mesh = body.mesh();
    let moved = |node: usize, d: usize| mesh.points()[node][d] + displacement[3 * node + d];
    let far = mesh.nearest_node([1.0, 1.0, 2.0 + gap]);
    let section = moved(far, 0) * moved(far, 1);
    let errors: Vec<f64> = normal_stresses(mesh, &moved, 1.0 + 0.5 * gap, run.cells)
        .map(|stress| stress * section / PRESSURE + 1.0)
        .collect();
    let square = errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64;
    let largest = errors.iter().map(|error| error.abs()).fold(0.0, f64::max);
    Ok(Measured {
        values: vec![largest, square.sqrt()],
        seconds: cpu_seconds() - begin,
        ..Measured::default()
    })
}

/// A unit block with the groups of its sides.
fn block(kind: CellKind, n: usize) -> Result<Mesh, String> {
    let map = |x: [f64; 3]| x.map(|x| x / n as f64);
    let face = |d: usize, at: f64| move |x: [f64; 3]| (x[d] - at).abs() < 1e-9;
    let faces =
        [("x-min", face(0, 0.0)), ("y-min", face(1, 0.0)), ("z-min", face(2, 0.0)), ("z-max", face(2, 1.0))];
    let faces: Vec<Face<'_>> = faces.iter().map(|(name, on)| (*name, on as _)).collect();
    Grid { kind, n: [n; 3], map: &map }.mesh(&faces)
}

/// The Cauchy stress along z in the cells next to a height, of the neo-Hookean material with the constants above. Cells
/// are cubes.
fn normal_stresses<'a>(
    mesh: &'a Mesh,
    moved: &'a dyn Fn(usize, usize) -> f64,
    height: f64,
    n_upper: usize,
) -> impl Iterator<Item = f64> + 'a {
    let near = move |z: f64| {
        if z < height { height - z < 0.5 } else { z - height < 1.0 / n_upper as f64 }
    };
    let mean = |nodes: &[u32]| {
        nodes.iter().map(|&node| mesh.points()[node as usize][2]).sum::<f64>() / nodes.len() as f64
    };
    let abscissas = [-(0.6f64.sqrt()), 0.0, 0.6f64.sqrt()];
    let points: Vec<[f64; 3]> =
        (0..27).map(|i| [i % 3, i / 3 % 3, i / 9].map(|own| abscissas[own])).collect();
    let cells = mesh.cells().filter(move |cell| near(mean(cell.nodes)));
    cells.flat_map(move |cell| {
        let nodes: Vec<usize> = cell.nodes.iter().map(|&node| node as usize).collect();
        let X: Vec<[f64; 3]> = nodes.iter().map(|&node| mesh.points()[node]).collect();
        let x: Vec<[f64; 3]> = nodes.iter().map(|&node| [0, 1, 2].map(|d| moved(node, d))).collect();
        points
            .iter()
            .map(|xi| {
                let mut dN = vec![[0.0; 3]; nodes.len()];
                element(cell.kind).gradient(*xi, &mut dN);
                let edge = jacobian(cell.kind, &X, &dN)[0][0];
                stress_zz(jacobian(cell.kind, &x, &dN).map(|row| row.map(|own| own / edge)))
            })
            .collect::<Vec<_>>()
    })
}

/// `mu/J (F F^T - 1) + lambda ln J / J`.
fn stress_zz(F: [[f64; 3]; 3]) -> f64 {
    let mu = 0.5 / (1.0 + POISSON);
    let lambda = POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    let minor = |i: usize, j: usize| F[1][i] * F[2][j] - F[1][j] * F[2][i];
    let J = F[0][0] * minor(1, 2) - F[0][1] * minor(0, 2) + F[0][2] * minor(0, 1);
    let square = F[2].iter().map(|own| own * own).sum::<f64>();
    (mu * (square - 1.0) + lambda * J.ln()) / J
}
