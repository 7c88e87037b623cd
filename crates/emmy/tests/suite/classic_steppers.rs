//! Steppers that are not time elements, in large rotation and under loads: conserved and non-conserved quantities.

use emmy::Error;
use emmy::body::{Body, InitialVelocity, Load, LoadKind, Region, Support, TimeFunction};
use emmy::internals::element::element;
use emmy::internals::time::CentralDifferences;
use emmy::material::NeoHooke;
use emmy::mesh::{CellKind, MeshBuilder};
use emmy::motion::{Motion, NewtonSettings, Record, State};
use emmy::time::Scheme;

use crate::shared::schemes::at;

const ALL: [&str; 5] =
    ["Newmark(0.25, 0.5)", "HHT(0.05)", "generalized-alpha(0.8)", "Bathe", "central-differences"];

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 0.5)
}

fn spin() -> InitialVelocity {
    InitialVelocity {
        angular_velocity: [3.0, 5.0, 8.0],
        gradient: [[2.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.2]],
        ..Default::default()
    }
}

fn tractions() -> Vec<Load> {
    let ramp = || TimeFunction::new(vec![(0.0, 0.0), (0.11, 1.0), (0.29, -0.5)]).unwrap();
    let traction = |group: &str, traction| Load {
        kind: LoadKind::Traction { group: group.into(), traction },
        time_function: ramp(),
    };
    vec![traction("face-a", [256.0, 512.0, 768.0]), traction("face-b", [-200.0, 100.0, 300.0])]
}

fn clamp() -> Vec<Support> {
    vec![Support { group: "face-a".into(), fix: [true, true, false], ..Default::default() }]
}

/// Records of the L-block until t = 0.4.
fn l_block(scheme: &str, h: f64, supports: &[Support], loads: &[Load]) -> Vec<Record> {
    let body = Body::builder(emmy::mesh::l_block(1.0).unwrap())
        .region(rubber())
        .supports(supports)
        .loads(loads)
        .build()
        .unwrap();
    let state = State::initial(&body, 0.0, &[spin()]).unwrap();
    let mut motion =
        Motion::starting(&body, at(scheme.parse().unwrap(), 1), NewtonSettings::default(), state).unwrap();
    let n_steps = (0.4 / h).round() as usize;
    (1..=n_steps).map(|_| motion.step(h).unwrap().clone()).collect()
}

/// Largest residuals of energy, linear and angular momentum, relative to their sizes.
fn defects(records: &[Record]) -> [f64; 3] {
    let largest = |of: fn(&Record) -> f64| records.iter().map(of).fold(0.0, f64::max);
    let norm = |x: &[f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let momentum = records.iter().map(|r| norm(&r.linear_momentum)).fold(1.0, f64::max);
    let angular = records.iter().map(|r| norm(&r.angular_momentum)).fold(1.0, f64::max);
    [
        largest(|r| r.energy_residual.abs()) / largest(|r| r.total_energy),
        largest(|r| r.linear_momentum_residual) / momentum,
        largest(|r| r.angular_momentum_residual) / angular,
    ]
}

#[test]
fn central_differences_conserve_both_momenta() {
    for (supports, loads) in
        [(vec![], vec![]), (vec![], tractions()), (clamp(), vec![]), (clamp(), tractions())]
    {
        let records = l_block("central-differences", 0.004, &supports, &loads);
        let [energy, linear, angular] = defects(&records);
        println!("{energy:e} {linear:e} {angular:e}");
        assert!(linear < 1e-13 && angular < 1e-13, "{linear:e} {angular:e}");
        // Symplectic: each step has an energy error, but the errors do not accumulate.
        assert!(energy > 1e-8);
        let balance: f64 = records.iter().map(|record| record.energy_residual).sum();
        assert!(balance.abs() < 0.02 * records[records.len() - 1].total_energy, "{balance}");
    }
}

#[test]
fn newmark_and_bathe_conserve_linear_momentum_only() {
    for scheme in ["Newmark(0.25, 0.5)", "Newmark(0.3025, 0.6)", "Bathe"] {
        for (supports, loads) in [(vec![], vec![]), (vec![], tractions()), (clamp(), tractions())] {
            let [energy, linear, angular] = defects(&l_block(scheme, 0.02, &supports, &loads));
            println!("{scheme} {energy:e} {linear:e} {angular:e}");
            assert!(linear < 1e-12, "{scheme}: {linear:e}");
            assert!(energy > 1e-6 && angular > 1e-6, "{scheme}: {energy:e} {angular:e}");
        }
    }
}

/// Inertia and forces are averaged at different times: the momentum follows an averaged load, and is exactly conserved
/// without loads.
#[test]
fn alpha_methods_conserve_linear_momentum_in_free_flight() {
    for scheme in ["HHT(0.05)", "generalized-alpha(0.8)"] {
        let [energy, linear, angular] = defects(&l_block(scheme, 0.02, &[], &[]));
        println!("{scheme} {energy:e} {linear:e} {angular:e}");
        assert!(linear < 1e-12 && energy > 1e-6 && angular > 1e-6, "{scheme}");
        let [_, loaded, _] = defects(&l_block(scheme, 0.02, &[], &tractions()));
        assert!(loaded > 1e-6, "{scheme}: {loaded:e}");
    }
}

#[test]
fn average_acceleration_is_the_time_element_with_the_trapezoidal_rule() {
    let (newmark, element) =
        (l_block("Newmark(0.25, 0.5)", 0.02, &[], &[]), l_block("trapezoidal", 0.02, &[], &[]));
    for (a, b) in newmark.iter().zip(&element) {
        let scale = b.total_energy;
        assert!((a.total_energy - b.total_energy).abs() < 1e-9 * scale);
        assert!((a.energy_residual - b.energy_residual).abs() < 1e-9 * scale);
        assert!((a.angular_momentum_residual - b.angular_momentum_residual).abs() < 1e-7);
    }
}

/// A falling body: a constant force gives a parabola, which every method reproduces, with work and impulse.
#[test]
fn free_fall_is_exact() {
    let gravity = Load {
        kind: LoadKind::Acceleration { group: None, acceleration: [0.0, 0.0, -10.0] },
        time_function: TimeFunction::constant(),
    };
    let mesh = emmy::mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    let body = Body::builder(mesh).region(rubber()).load(gravity).build().unwrap();
    for scheme in ALL {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let mut motion =
            Motion::starting(&body, at(scheme.parse().unwrap(), 1), NewtonSettings::default(), state)
                .unwrap();
        for _ in 1..=100 {
            let record = motion.step(0.004).unwrap();
            assert!(
                record.energy_residual.abs() < 1e-12 && record.linear_momentum_residual < 1e-12,
                "{scheme}"
            );
            assert!(record.angular_momentum_residual < 1e-12, "{scheme}");
        }
        let fall = motion.state().displacement.iter().skip(2).step_by(3);
        assert!(fall.into_iter().all(|u| (u + 5.0 * 0.16).abs() < 1e-11), "{scheme}");
        assert!((motion.record().external_work - 10.0 * 0.8).abs() < 1e-11, "{scheme}");
    }
}

#[test]
fn free_flight_has_no_work_and_no_impulse() {
    let body = Body::builder(emmy::mesh::l_block(1.0).unwrap()).region(rubber()).build().unwrap();
    for scheme in ALL {
        let mut state = State::initial(&body, 0.0, &[spin()]).unwrap();
        let scheme: Scheme = scheme.parse().unwrap();
        let mut stepper = scheme.stepper(&body, NewtonSettings::default(), &mut state).unwrap();
        let outcome = stepper.advance(&mut state, 0.004).unwrap();
        assert_eq!(outcome.impulses, Default::default(), "{scheme}");
        assert_eq!(stepper.newton_history().is_empty(), scheme == Scheme::CentralDifferences);
    }
}

/// The momenta of the state use the lumped mass; total mass and linear momentum equal those of the body.
#[test]
fn central_differences_report_the_lumped_mass() {
    let body = Body::builder(emmy::mesh::l_block(1.0).unwrap()).region(rubber()).build().unwrap();
    let drift = InitialVelocity { velocity: [2.0, 0.0, -1.0], ..Default::default() };
    let state = State::initial(&body, 0.0, &[drift]).unwrap();
    let motion =
        Motion::starting(&body, at(Scheme::CentralDifferences, 1), NewtonSettings::default(), state).unwrap();
    let mass = 0.5 * 117.0;
    assert!((body.lumped_mass().iter().sum::<f64>() - mass).abs() < 1e-11);
    assert!((motion.record().linear_momentum[0] - 2.0 * mass).abs() < 1e-11);
    assert!((motion.record().kinetic_energy - 2.5 * mass).abs() < 1e-11);
}

/// Mass fractions at the nodes of one cell: row sums for linear cells; scaled diagonals are 1/36 and 4/27 for a tet10,
/// and products of 1/6, 4/6, 1/6 for a hex27 (Hughes (1987), section 7.3.2). All are positive, also for a hex20.
#[test]
fn lumped_masses_are_positive() {
    for (kind, corner, last) in [
        (CellKind::Hex8, Some(1.0 / 8.0), 1.0 / 8.0),
        (CellKind::Tet4, Some(1.0 / 4.0), 1.0 / 4.0),
        (CellKind::Tet10, Some(1.0 / 36.0), 4.0 / 27.0),
        (CellKind::Hex27, Some(1.0 / 216.0), 64.0 / 216.0),
        (CellKind::Hex20, None, 0.0),
    ] {
        let mut mesh = MeshBuilder::new();
        let nodes: Vec<u32> = element(kind).nodes().iter().map(|&point| mesh.point(point)).collect();
        mesh.cell(kind, &nodes).unwrap();
        let body = Body::builder(mesh.build().unwrap()).region(rubber()).build().unwrap();
        let (masses, mass) = (body.lumped_mass(), body.regions()[0].mass);
        assert!((masses.iter().sum::<f64>() / mass - 1.0).abs() < 1e-14, "{kind}");
        assert!(masses.iter().all(|&m| m > 0.0), "{kind}: {masses:?}");
        if let Some(corner) = corner {
            assert!((masses[0] / mass - corner).abs() < 1e-14, "{kind}: {masses:?}");
            assert!((masses[nodes.len() - 1] / mass - last).abs() < 1e-14, "{kind}: {masses:?}");
        }
    }
}

/// The critical step belongs to the current shape: a compressed body stiffens, and the run stops in time.
#[test]
fn the_critical_step_follows_the_deformation() {
    let press = Load {
        kind: LoadKind::Traction { group: "x-max".into(), traction: [-3000.0, 0.0, 0.0] },
        time_function: TimeFunction::new(vec![(0.0, 0.0), (10.0, 1.0)]).unwrap(),
    };
    let mesh = emmy::mesh::block([1.0; 3], [1; 3]).unwrap();
    let wall = Support { group: "x-min".into(), fix: [true, false, false], ..Default::default() };
    let body = Body::builder(mesh).region(rubber()).support(wall).load(press).build().unwrap();
    let mut state = State::initial(&body, 0.0, &[]).unwrap();
    let at_rest = CentralDifferences::new(&body, &mut state).unwrap().critical_step();
    let h = 0.9 * at_rest;
    let mut motion =
        Motion::starting(&body, at(Scheme::CentralDifferences, 1), NewtonSettings::default(), state).unwrap();
    let error = (1..2000).find_map(|_| motion.step(h).err()).unwrap();
    let Error::StepTooLarge { step, critical, .. } = error else { panic!("{error}") };
    assert!(step > 50 && critical < h / 0.98, "{step} {critical}");
    // It stopped before it became unstable: the last good step is still quasi-static.
    assert!(motion.record().kinetic_energy < 1e-3 * motion.record().strain_energy, "{:?}", motion.record());
}

#[test]
fn a_step_that_fails_leaves_the_state_as_it_was() {
    let body =
        Body::builder(emmy::mesh::l_block(1.0).unwrap()).region(rubber()).loads(tractions()).build().unwrap();
    let hurry = NewtonSettings { tolerance: 1e-14, max_iterations: 1, ..NewtonSettings::default() };
    for scheme in ALL {
        let state = State::initial(&body, 0.0, &[spin()]).unwrap();
        let mut motion = Motion::starting(&body, at(scheme.parse().unwrap(), 1), hurry, state).unwrap();
        let before = motion.state().clone();
        let error = motion.step(0.5).unwrap_err();
        assert!(
            matches!(error, Error::NoConvergence { step: 1, .. } | Error::StepTooLarge { .. }),
            "{error}"
        );
        assert_eq!(*motion.state(), before);
    }
}
