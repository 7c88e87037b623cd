//! Every kind of solid cell in a distorted patch: states of constant strain are reproduced to round-off, and the
//! conserving scheme keeps its balances in free flight.

#![allow(non_snake_case)]

use crate::shared::flight::every_kind_flies;
use crate::shared::patch::Patch;
use crate::shared::stiffness::stiffness;
use emmy::body::{Body, InitialVelocity, Load, LoadKind, Region, TimeFunction};
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{StepDamping, StepInput};
use emmy::internals::quadrature::gauss;
use emmy::material::NeoHooke;
use emmy::mesh::{CellKind, Mesh};

/// The distorted patch of 2 x 2 x 2 bricks.
fn patch(kind: CellKind, curved: bool) -> Mesh {
    Patch { bricks: 2, curved, distortion: 1.0 }.mesh(kind)
}

const H: [[f64; 3]; 3] = [[0.1, 0.05, -0.02], [-0.03, 0.2, 0.04], [0.06, -0.01, -0.15]];

/// First Piola-Kirchhoff stress P = mu (F - F^-T) + lambda ln J F^-T and energy W of the neo-Hookean material with mu =
/// 500, lambda = 1000 at F = I + H, independent of the library.
fn stress_and_energy() -> ([[f64; 3]; 3], f64) {
    let F = [0, 1, 2].map(|i| [0, 1, 2].map(|j| H[i][j] + f64::from(u8::from(i == j))));
    let cofactor = [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let at = |a: usize, b: usize| F[(i + a) % 3][(j + b) % 3];
            at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)
        })
    });
    let J: f64 = (0..3).map(|j| F[0][j] * cofactor[0][j]).sum();
    let P = [0, 1, 2]
        .map(|i| [0, 1, 2].map(|j| 500.0 * F[i][j] + (1000.0 * J.ln() - 500.0) * cofactor[i][j] / J));
    let trace: f64 = F.iter().flatten().map(|f| f * f).sum();
    (P, 250.0 * (trace - 3.0) + 500.0 * J.ln().powi(2) - 500.0 * J.ln())
}

/// Tractions P n on the six faces of the cube.
fn tractions(P: [[f64; 3]; 3]) -> Vec<Load> {
    let mut loads = Vec::new();
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        for (side, sign) in [("min", -1.0), ("max", 1.0)] {
            let traction = [0, 1, 2].map(|i| sign * P[i][axis]);
            let kind = LoadKind::Traction { group: format!("{name}-{side}"), traction };
            loads.push(Load { kind, time_function: TimeFunction::constant() });
        }
    }
    loads
}

fn rubber() -> Vec<Region> {
    vec![Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0)]
}

/// Internal force at the displacement u = H X: one evaluation of the mid-point rule without rates.
fn internal_force(body: &Body, displacement: &[f64]) -> Vec<f64> {
    let (rule, rates) = (Rule::standard(1, &gauss(1)), vec![0.0; body.n_dofs()]);
    let step = StepInput {
        rule: &rule,
        tangent_factor: 1.0,
        displacement,
        rates: &rates,
        coordinates: &[],
        damping: StepDamping::default(),
        local: None,
    };
    let mut assembly = body.assembly(step.rule);
    body.assemble(&step, Request::Stress, &[0.0], &mut assembly).unwrap();
    let mut force = vec![0.0; body.n_dofs()];
    assembly.matrix.copy_force(&mut force);
    force
}

fn linear_displacement(mesh: &Mesh) -> Vec<f64> {
    let u = |X: &[f64; 3]| [0, 1, 2].map(|i| (0..3).map(|j| H[i][j] * X[j]).sum::<f64>());
    mesh.points().iter().flat_map(u).collect()
}

/// The patch test: a linear displacement gives the forces of its constant stress at every node. They vanish at inner
/// nodes and equal the tractions P n on the surface.
fn passes_the_patch_test(kind: CellKind, curved: bool) {
    let (P, energy) = stress_and_energy();
    let body = Body::builder(patch(kind, curved)).regions(rubber()).loads(tractions(P)).build().unwrap();
    let volume = body.regions()[0].volume;
    assert!((volume - 1.0).abs() < 1e-14, "{kind}: volume {volume}");
    let displacement = linear_displacement(body.mesh());
    let (force, mut loads) = (internal_force(&body, &displacement), vec![0.0; body.n_dofs()]);
    body.loads_at(0.0, &mut loads).unwrap();
    // Rounding of sums of about 100 terms of the size of a nodal force, which is below the stress (300) times the area.
    for (dof, (f, load)) in force.iter().zip(&loads).enumerate() {
        assert!((f - load).abs() < 1e-12, "{kind}: {f} is not {load} at node {}", dof / 3);
    }
    assert!(loads.iter().any(|load| load.abs() > 1.0));
    assert!((body.strain_energy(&displacement) - energy).abs() < 1e-12 * energy, "{kind}");
}

#[test]
fn patches_are_distorted_and_have_inner_nodes() {
    for kind in CellKind::SOLIDS {
        let mesh = patch(kind, false);
        let quality = emmy::mesh::quality(&mesh);
        assert!(quality.inverted.is_empty() && quality.scaled_jacobian.value < 0.95, "{kind}: {quality:?}");
        let inside = |X: &&[f64; 3]| X.iter().all(|&x| x > 0.01 && x < 0.99);
        assert!(mesh.points().iter().filter(inside).count() > 0, "{kind}");
    }
}

#[test]
fn every_kind_passes_the_patch_test() {
    CellKind::SOLIDS.into_iter().for_each(|kind| passes_the_patch_test(kind, false));
}

/// tet10 is not included: its four points integrate the gradients of curved cells almost exactly, but not quite.
#[test]
fn curved_cells_pass_it_too() {
    for kind in [CellKind::Hex20, CellKind::Hex27, CellKind::Wedge15, CellKind::Pyramid13] {
        passes_the_patch_test(kind, true);
    }
}

/// Rank by elimination with full pivoting: pivots below 1e-9 of the first are rounding.
fn rank(mut A: Vec<Vec<f64>>) -> usize {
    let (n, mut first) = (A.len(), 0.0);
    for k in 0..n {
        let places = (k..n).flat_map(|i| (k..n).map(move |j| (i, j)));
        let (i, j) = places.max_by(|a, b| A[a.0][a.1].abs().total_cmp(&A[b.0][b.1].abs())).unwrap();
        A.swap(k, i);
        A.iter_mut().for_each(|row| row.swap(k, j));
        let pivot = A[k][k];
        first = if k == 0 { pivot } else { first };
        if pivot.abs() < 1e-9 * first.abs() {
            return k;
        }
        let (above, below) = A.split_at_mut(k + 1);
        for row in below {
            let factor = row[k] / pivot;
            (k..n).for_each(|j| row[j] -= factor * above[k][j]);
        }
    }
    n
}

/// The quadrature leaves no deformation without energy: only the six rigid motions of a cell have zero energy.
#[test]
fn no_kind_has_modes_without_energy() {
    for kind in CellKind::SOLIDS {
        assert_eq!(rank(stiffness(kind, rubber().remove(0))), 3 * kind.n_nodes() - 6, "{kind}");
    }
}

/// In the distorted patch, quadratic cells with curved edges.
#[test]
fn every_kind_flies_free_with_three_materials() {
    let field = InitialVelocity {
        velocity: [1.0, 0.0, 0.5],
        angular_velocity: [3.0, 2.0, 5.0],
        gradient: [[3.0, 1.0, 0.0], [0.0, -2.0, 0.0], [1.0, 0.0, 1.0]],
        ..Default::default()
    };
    every_kind_flies(&CellKind::SOLIDS, |kind| patch(kind, true), &field);
}
