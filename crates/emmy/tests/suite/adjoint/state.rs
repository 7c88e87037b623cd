//! Gradients by the initial state: differences of motions, formulae, symmetries.

use emmy::adjoint::{Goal, Parameter};
use emmy::body::{Body, Formulation, GroundSpring, InitialVelocity, PointTerms, Region};
use emmy::material::{Hencky, Link, NeoHookeIsochoric, Ogden, SaintVenantKirchhoff, Volumetric};
use emmy::mesh::{self, CellKind};
use emmy::motion::{Phase, State, StepPlan};
use emmy::time::Scheme;

use super::problems::*;
use crate::shared::schemes::{DGM, assumed_strain, fe};

/// Largest relative difference between the gradient by the initial state and differences of whole motions, along some
/// directions.
fn error_by_differences(
    body: &Body,
    (scheme, degree): (Scheme, usize),
    start: &State,
    plan: &StepPlan,
    goal: &Goal,
) -> f64 {
    let gradient = trajectory(body, scheme, degree, start, plan).gradient(goal, &[]).unwrap();
    let value = |direction: [&[f64]; 2], d: f64| {
        let mut state = start.clone();
        shift(body, &mut state, d, direction[0], d, direction[1]);
        goal.value(&end(body, scheme, degree, &state, plan))
    };
    let (n, zero) = (body.n_dofs(), vec![0.0; body.n_dofs()]);
    let directions =
        (5..7).flat_map(|seed| [[scattered(n, seed), zero.clone()], [zero.clone(), scattered(n, seed)]]);
    let error = |direction: [Vec<f64>; 2]| {
        let [du, dv] = [&direction[0], &direction[1]];
        let along = dot(&gradient.displacement, du) + dot(&gradient.velocity, dv);
        // The correction of DGM is homogeneous of degree two in the strain rates: its derivatives are large where they
        // pass zero.
        (along - slope(5e-5, |d| value([du, dv], d))).abs() / size(&gradient, [du, dv])
    };
    directions.map(error).fold(0.0, f64::max)
}

#[test]
fn gradients_by_the_initial_state_are_differences_of_motions() {
    let body = rubber();
    let (start, goal) = (disturbed(&body, 0.05, 0.5), scattered_goal(&body));
    for k in 1..=3 {
        // Steps of two sizes, with kinks of the load inside.
        let plan = StepPlan::new(
            0.0,
            vec![Phase { until: 0.4, size: 0.1 * k as f64 }, Phase { until: 0.9, size: 0.15 * k as f64 }],
        )
        .unwrap();
        for scheme in schemes(k) {
            let error = error_by_differences(&body, (scheme, k), &start, &plan, &goal);
            println!("{scheme}, k = {k}: {error:.1e}");
            assert!(error < 1e-9, "{scheme}, k = {k}: {error:e}");
        }
    }
}

#[test]
fn gradients_of_links_and_ground_terms_are_differences_of_motions() {
    let body = springs(20.0).unwrap();
    let (start, goal) = (disturbed(&body, 0.1, 1.0), scattered_goal(&body));
    for k in 1..=3 {
        let plan = equal(1.2, 0.1 * k as f64);
        for scheme in schemes(k) {
            let error = error_by_differences(&body, (scheme, k), &start, &plan, &goal);
            println!("{scheme}, k = {k}: {error:.1e}");
            assert!(error < 1e-9, "{scheme}, k = {k}: {error:e}");
        }
    }
}

/// Materials of principal stretches, whose derivatives involve the eigenvectors, and cells of other kinds in more than
/// one batch.
#[test]
fn gradients_of_other_materials_and_cells_are_differences_of_motions() {
    let ogden = Ogden::new(&[(12.0, 1.3), (-2.0, -2.0)], 40.0, Volumetric::SimoTaylor).unwrap();
    let hencky = Hencky::from_engineering(40.0, 0.3).unwrap();
    let plate = SaintVenantKirchhoff::new(30.0, 15.0).unwrap();
    let block = || mesh::block([1.0, 1.0, 2.0], [1, 1, 2]).unwrap();
    let with_modes = Region::new(hencky, 1.0).with_formulation(Formulation::IncompatibleModes);
    let bodies = [
        ("incompatible modes", block(), with_modes),
        ("Ogden", block(), Region::new(ogden, 1.0)),
        ("Hencky", block(), Region::new(hencky, 1.0)),
        ("plate", mesh::rectangle([4.0, 3.0], [4, 3]).unwrap(), Region::new(plate, 1.0).with_thickness(0.3)),
    ];
    for (name, mesh, region) in bodies {
        let body = Body::builder(mesh).region(region).build().unwrap();
        let (start, goal) = (disturbed(&body, 0.02, 0.5), scattered_goal(&body));
        for (scheme, k) in [(fe(1), 1), (assumed_strain(3), 2), (DGM, 1), (DGM, 2)] {
            let error = error_by_differences(&body, (scheme, k), &start, &equal(0.45, 0.15), &goal);
            println!("{name}, {scheme}, k = {k}: {error:.1e}");
            assert!(error < 1e-9, "{name}, {scheme}, k = {k}: {error:e}");
        }
    }
}

/// A projected volume couples the points of a cell, also through the pressures at the start of a step.
#[test]
fn gradients_with_projected_volumes_are_differences_of_motions() {
    let isochoric = || NeoHookeIsochoric::new(15.0, 150.0, Volumetric::Miehe).unwrap();
    let trace = SaintVenantKirchhoff::new(60.0, 15.0).unwrap();
    let projected = |region: Region| region.with_formulation(Formulation::ProjectedVolume(None));
    let quadratic = crate::locking::mapped(CellKind::Hex20, [1, 1, 1], |x| x).build().unwrap();
    let block = || mesh::block([1.0, 1.0, 2.0], [1, 1, 2]).unwrap();
    let bodies = [
        ("constant", block(), projected(Region::new(isochoric(), 1.0))),
        ("trace", block(), projected(Region::new(trace, 1.0))),
        ("linear", quadratic, projected(Region::new(isochoric(), 1.0))),
    ];
    for (name, mesh, region) in bodies {
        let body = Body::builder(mesh).region(region).build().unwrap();
        let (start, goal) = (disturbed(&body, 0.02, 0.5), scattered_goal(&body));
        for (scheme, k) in [(fe(2), 1), (assumed_strain(3), 1), (assumed_strain(3), 2), (DGM, 1), (DGM, 3)] {
            let error = error_by_differences(&body, (scheme, k), &start, &equal(0.3, 0.1), &goal);
            println!("{name}, {scheme}, k = {k}: {error:.1e}");
            assert!(error < 1e-8, "{name}, {scheme}, k = {k}: {error:e}");
        }
    }
}

/// One step: its effect on a direction, times a goal at its end, equals that direction times the goal at its start.
#[test]
fn the_adjoint_of_a_step_is_its_transposed() {
    let body = held_block([30.0, 15.0], 1.0, 2.0, false).unwrap();
    let (start, goal) = (disturbed(&body, 0.05, 0.5), scattered_goal(&body));
    for k in 1..=3 {
        for scheme in schemes(k) {
            let error = error_by_differences(&body, (scheme, k), &start, &equal(0.2, 0.2), &goal);
            assert!(error < 1e-9, "{scheme}, k = {k}: {error:e}");
        }
    }
}

/// A free body with a translated or rotated start has the same motion, translated or rotated. This part of a gradient
/// is known, also in stiff bodies and with large steps.
#[test]
fn gradients_know_the_symmetries_of_space() {
    let w = [0.4, -0.7, 0.5];
    let cross = |q: &[f64]| [w[1] * q[2] - w[2] * q[1], w[2] * q[0] - w[0] * q[2], w[0] * q[1] - w[1] * q[0]];
    for (name, youngs, size) in [("soft", 40.0, 0.1), ("stiff", 1e7, 0.2)] {
        let material = SaintVenantKirchhoff::from_engineering(youngs, 0.3).unwrap();
        let mesh = mesh::block([1.0, 3.0, 1.0], [1, 3, 1]).unwrap();
        let body = Body::builder(mesh).region(Region::new(material, 1.0)).build().unwrap();
        let spin = InitialVelocity { angular_velocity: [0.3, 0.5, 0.8], ..Default::default() };
        let start = State::initial(&body, 0.0, &[spin]).unwrap();
        let turned = |state: &State| -> [Vec<f64>; 2] {
            let q = (0..body.mesh().n_nodes()).flat_map(|node| cross(&state.position(&body, node)));
            [q.collect(), state.velocity.chunks(3).flat_map(cross).collect()]
        };
        let goal = Goal::displacement_at(&body, 5, [1.0, 0.0, 0.0]);
        for k in 1..=3 {
            for scheme in schemes(k) {
                // With FE the middle of a step is shrunk, and a stiff body rotates only a little per step.
                let energy_momentum = scheme.time_element().unwrap().rule.is_energy_momentum();
                let size = if energy_momentum { size } else { 0.01 };
                let plan = equal(5.0 * size, size);
                let trajectory = trajectory(&body, scheme, k, &start, &plan);
                let gradient = trajectory.gradient(&goal, &[]).unwrap();
                let along =
                    |[du, dv]: &[Vec<f64>; 2]| dot(&gradient.displacement, du) + dot(&gradient.velocity, dv);
                let (ones, zeros) =
                    (|| [1.0, 0.0, 0.0].repeat(body.mesh().n_nodes()), vec![0.0; body.n_dofs()]);
                let moved = (along(&[ones(), zeros.clone()]) - 1.0).abs();
                let drifted = (along(&[zeros, ones()]) - 5.0 * size).abs();
                let end = end(&body, scheme, k, &start, &plan);
                let turn = (along(&turned(&start)) - dot(&goal.displacement, &turned(&end)[0])).abs();
                println!("{name}, {scheme}, k = {k}: {moved:.1e} {drifted:.1e} {turn:.1e}");
                assert!(moved < 1e-9 && drifted < 1e-9 && turn < 1e-8, "{name}, {scheme}, k = {k}");
            }
        }
    }
}

/// Angle of rotation of an oscillator with omega h = z in a step of degree k, from the diagonal Pade approximation of
/// `exp(i z)`.
fn angle(k: usize, z: f64) -> f64 {
    let (re, im) = match k {
        1 => (1.0, z / 2.0),
        2 => (1.0 - z * z / 12.0, z / 2.0),
        _ => (1.0 - z * z / 10.0, z / 2.0 - z * z * z / 120.0),
    };
    2.0 * f64::atan2(im, re)
}

/// Two masses on springs to the ground with the same frequency s sqrt 9; the spring between them stays at rest.
pub(super) fn oscillator(square: f64) -> Result<Body> {
    let spring = |i: usize, k: f64| GroundSpring { group: i.to_string(), stiffness: k * square };
    let (masses, springs) = (masses(&[0.5, 1.0]), vec![spring(0, 4.5), spring(1, 9.0)]);
    let region = Region::links(Link::spring(20.0, None)?, 0.0);
    let mesh = network(&[[1.0, 0.0, 0.0], [3.0, 1.0, 0.0]], &[[0, 1]]);
    Body::builder(mesh)
        .region(region)
        .point_terms(PointTerms { masses, springs, ..Default::default() })
        .build()
}

#[test]
fn gradients_of_an_oscillator_match_its_formula() {
    let (body, n, h) = (oscillator(1.0).unwrap(), 12.0, 0.2);
    let (u, v) = (0.3, -0.8);
    let (mut start, n_dofs) = (State::initial(&body, 0.0, &[]).unwrap(), body.n_dofs());
    shift(&body, &mut start, u, &vec![1.0; n_dofs], v, &vec![1.0; n_dofs]);
    let goal = Goal::displacement_at(&body, 1, [0.0, 1.0, 0.0]);
    for k in 1..=3 {
        for scheme in schemes(k) {
            let trajectory = trajectory(&body, scheme, k, &start, &equal(n * h, h));
            let stiffness = Parameter::linear(1.0, 1.0, oscillator).unwrap();
            let gradient = trajectory.gradient(&goal, &[stiffness]).unwrap();
            let along_y = |list: &[f64]| list.iter().skip(1).step_by(3).sum::<f64>();
            let turned = n * angle(k, 3.0 * h);
            assert!((along_y(&gradient.displacement) - turned.cos()).abs() < 1e-11, "{scheme}, k = {k}");
            assert!((along_y(&gradient.velocity) - turned.sin() / 3.0).abs() < 1e-11, "{scheme}, k = {k}");
            // p = m v at each node.
            let along =
                gradient.velocity.iter().zip(&gradient.momentum).zip([0.5; 3].iter().chain(&[1.0; 3]));
            assert!(along.clone().all(|((v, p), m)| (v - m * p).abs() < 1e-13));
            let end = |square: f64| {
                let omega = 3.0 * square.sqrt();
                let turned = n * angle(k, omega * h);
                turned.cos() * u + turned.sin() / omega * v
            };
            let by_stiffness = slope(5e-5, |d| end(1.0 + d));
            assert!((gradient.parameters[0] - by_stiffness).abs() < 1e-9, "{scheme}, k = {k}");
        }
    }
}
