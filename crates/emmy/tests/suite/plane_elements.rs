//! Every kind of plane cell in a distorted patch: the patch test, free flight, and the equivalent slab of bricks.

#![allow(non_snake_case)]

use crate::shared::flight::every_kind_flies;
use crate::shared::plane_patch::plane_patch;
use crate::shared::schemes::{DGM, at};
use emmy::body::{Body, InitialVelocity, Load, LoadKind, Region, Support, TimeFunction};
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{StepDamping, StepInput};
use emmy::internals::quadrature::gauss;
use emmy::material::{
    EnergyFormula, EngineeringConstants, Expression, HolzapfelGasserOgden, Invariant, NeoHooke, Orthotropic,
    Volumetric,
};
use emmy::mesh::{CellKind, Mesh, block, rectangle};
use emmy::motion::{Motion, NewtonSettings, State};
use emmy::time::Scheme;

const THICKNESS: f64 = 0.4;

fn rubber() -> Vec<Region> {
    vec![Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0).with_thickness(THICKNESS)]
}

const H: [[f64; 2]; 2] = [[0.1, 0.05], [-0.03, 0.2]];

/// First Piola-Kirchhoff stress in the plane and W of the neo-Hookean material with mu = 500, lambda = 1000 at F = I +
/// H, F_33 = 1: P = mu (F - F^-T) + lambda ln J F^-T, W = mu/2 (tr C - 3) + lambda/2 (ln J)^2 - mu ln J.
fn stress_and_energy() -> ([[f64; 2]; 2], f64) {
    let F = [[1.0 + H[0][0], H[0][1]], [H[1][0], 1.0 + H[1][1]]];
    let J = F[0][0] * F[1][1] - F[0][1] * F[1][0];
    let cofactor = [[F[1][1], -F[1][0]], [-F[0][1], F[0][0]]];
    let P = [0, 1].map(|i| [0, 1].map(|j| 500.0 * F[i][j] + (1000.0 * J.ln() - 500.0) * cofactor[i][j] / J));
    let trace = F.iter().flatten().map(|f| f * f).sum::<f64>() + 1.0;
    (P, 250.0 * (trace - 3.0) + 500.0 * J.ln().powi(2) - 500.0 * J.ln())
}

/// Tractions P n on the four edges.
fn tractions(P: [[f64; 2]; 2]) -> Vec<Load> {
    let mut loads = Vec::new();
    for (axis, name) in ["x", "y"].into_iter().enumerate() {
        for (side, sign) in [("min", -1.0), ("max", 1.0)] {
            let traction = [sign * P[0][axis], sign * P[1][axis], 0.0];
            let kind = LoadKind::Traction { group: format!("{name}-{side}"), traction };
            loads.push(Load { kind, time_function: TimeFunction::constant() });
        }
    }
    loads
}

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

/// A linear displacement gives the forces of its constant stress at every node: zero inside, the tractions P n on the
/// edges, with the thickness.
#[test]
fn every_kind_passes_the_patch_test() {
    let (P, energy) = stress_and_energy();
    for kind in CellKind::PLANES {
        let body = Body::builder(plane_patch(kind, 3)).regions(rubber()).loads(tractions(P)).build().unwrap();
        let quality = emmy::mesh::quality(body.mesh());
        assert!(quality.inverted.is_empty() && quality.scaled_jacobian.value < 0.95, "{kind}: {quality:?}");
        assert!((quality.volume - 1.0).abs() < 1e-14 && (body.regions()[0].volume - THICKNESS).abs() < 1e-14);
        let u = |X: &[f64; 3]| [H[0][0] * X[0] + H[0][1] * X[1], H[1][0] * X[0] + H[1][1] * X[1], 0.0];
        let displacement: Vec<f64> = body.mesh().points().iter().flat_map(u).collect();
        let (force, mut loads) = (internal_force(&body, &displacement), vec![0.0; body.n_dofs()]);
        body.loads_at(0.0, &mut loads).unwrap();
        for (f, load) in force.iter().zip(&loads) {
            assert!((f - load).abs() < 1e-12, "{kind}: {f} is not {load}");
        }
        assert!(loads.iter().any(|load| load.abs() > 1.0));
        let W = THICKNESS * energy;
        assert!((body.strain_energy(&displacement) - W).abs() < 1e-12 * W, "{kind}");
    }
}

#[test]
fn every_kind_flies_free_with_three_materials() {
    let field = InitialVelocity {
        velocity: [1.0, 0.5, 0.0],
        angular_velocity: [0.0, 0.0, 5.0],
        gradient: [[3.0, 1.0, 0.0], [0.0, -2.0, 0.0], [0.0; 3]],
        ..Default::default()
    };
    every_kind_flies(&CellKind::PLANES, |kind| plane_patch(kind, 3), &field);
}

/// Fibres that lean out of the plane make shears xz and yz, whose couples about x and y the planes bear: the balance of
/// the angular momentum is that of its z component.
#[test]
fn fibres_out_of_the_plane_keep_the_balances() {
    let fibre = [1.0, 0.3, 1.0];
    let tissue =
        HolzapfelGasserOgden::new(20.0, [30.0, 1.0], 0.0, &[fibre], 200.0, Volumetric::default()).unwrap();
    let ply = EngineeringConstants {
        youngs_moduli: [100.0, 30.0, 20.0],
        poissons_ratios: [0.2, 0.25, 0.3],
        shear_moduli: [15.0, 10.0, 12.0],
    };
    let ply = Orthotropic::new(ply, [[1.0, 2.0, -0.5], [0.0, 1.0, 1.0]]).unwrap();
    let [i1, j, i4] = [Invariant::I1, Invariant::J, Invariant::I4].map(Expression::from);
    let energy =
        10.0 * (i1 - 3.0) - 20.0 * j.clone().ln() + 50.0 * j.ln().power(2.0) + 15.0 * (i4 - 1.0).power(2.0);
    let formula = EnergyFormula::new(&energy, Some(fibre)).unwrap();
    let regions = [Region::new(tissue, 1.2), Region::new(ply, 1.2), Region::new(formula, 1.2)];
    let field = InitialVelocity {
        angular_velocity: [0.0, 0.0, 2.0],
        gradient: [[1.5, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0; 3]],
        ..Default::default()
    };
    for region in regions {
        let body = Body::builder(rectangle([1.0, 2.0], [2, 4]).unwrap()).region(region).build().unwrap();
        for scheme in [at(DGM, 1), at(DGM, 2), Scheme::CentralDifferences] {
            let state = State::initial(&body, 0.0, std::slice::from_ref(&field)).unwrap();
            let settings = NewtonSettings { tolerance: 1e-13, ..Default::default() };
            let mut motion = Motion::starting(&body, scheme, settings, state).unwrap();
            let (first, mut sheared) = (motion.record().clone(), 0f64);
            for _ in 1..=100 {
                let record = motion.step(0.005).unwrap();
                assert!(record.angular_momentum_residual < 1e-12, "{scheme}: {record:?}");
                assert!(record.linear_momentum_residual < 1e-12, "{scheme}: {record:?}");
                let turn = record.angular_momentum[2] - first.angular_momentum[2];
                assert!(turn.abs() < 1e-11 * first.angular_momentum[2], "{scheme}: {record:?}");
                let force = body.internal_force(&motion.state().displacement).unwrap();
                sheared =
                    force.iter().skip(2).step_by(3).fold(sheared, |largest, force| largest.max(force.abs()));
            }
            // The shears are there: the planes bear forces along z.
            assert!(sheared > 1e-2, "{scheme}: {sheared:e}");
        }
    }
}

/// History of a cantilever under a load at its end: energies and the position of a corner.
fn cantilever(mesh: Mesh, thickness: f64, supports: &[Support]) -> Vec<[f64; 4]> {
    let region = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0).with_thickness(thickness);
    let kind = LoadKind::Traction { group: "y-max".into(), traction: [20.0, 5.0, 0.0] };
    let load = Load { kind, time_function: TimeFunction::new(vec![(0.0, 0.0), (0.1, 1.0)]).unwrap() };
    let corner = mesh.nearest_node([0.0, 4.0, 0.0]);
    let body = Body::builder(mesh).region(region).supports(supports).load(load).build().unwrap();
    let state = State::initial(&body, 0.0, &[]).unwrap();
    let mut motion = Motion::starting(&body, at(DGM, 1), NewtonSettings::default(), state).unwrap();
    let mut history = Vec::new();
    for _ in 1..=40 {
        let record = motion.step(0.02).unwrap().clone();
        assert!(record.energy_residual.abs() < 1e-12 * record.total_energy.max(1.0));
        assert!(record.linear_momentum_residual < 1e-11 && record.angular_momentum_residual < 1e-11);
        let at = motion.state().position(&body, corner);
        history.push([record.kinetic_energy, record.strain_energy, at[0], at[1]]);
    }
    history
}

#[test]
fn plane_strain_is_a_slab_that_keeps_its_thickness() {
    let clamp = || Support { group: "y-min".into(), fix: [true; 3], ..Default::default() };
    let plane = cantilever(rectangle([1.0, 4.0], [2, 6]).unwrap(), 0.5, &[clamp()]);
    let flat = Support { group: "body".into(), fix: [false, false, true], ..Default::default() };
    let slab = cantilever(block([1.0, 4.0, 0.5], [2, 6, 1]).unwrap(), 1.0, &[clamp(), flat]);
    for (plane, slab) in plane.iter().zip(&slab) {
        for (a, b) in plane.iter().zip(slab) {
            assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{plane:?} {slab:?}");
        }
    }
    assert!(plane[39][2] > 0.5, "{:?}", plane[39]);
}
