//! Motions that start from an equilibrium.

use emmy::body::{Body, InitialVelocity, Load, Region, Support, TimeFunction};
use emmy::equilibrium::Equilibrium;
use emmy::material::NeoHooke;
use emmy::mesh::block;
use emmy::motion::{Motion, NewtonSettings, Record, State};
use emmy::time::Scheme;

use super::equilibrium;
use crate::shared::schemes::{DGM, assumed_strain, at};

fn rubber() -> Region {
    Region::new(NeoHooke::new(60.0, 30.0).unwrap(), 2.0)
}

/// A block under gravity and a follower pressure; its far end is held at a displacement, if `driven`.
fn preloaded(driven: bool) -> Body {
    let away = TimeFunction::new(vec![(0.0, 0.3)]).unwrap();
    let end = Support::driven("x-max", [Some(away.clone()), None, Some(away)]);
    Body::builder(block([4.0, 1.0, 1.0], [4, 1, 1]).unwrap())
        .region(rubber())
        .support(Support::fixed("x-min"))
        .supports(driven.then_some(end))
        .load(Load::acceleration([0.0, 0.0, -0.4]))
        .load(Load::pressure("z-max", 1.5))
        .build()
        .unwrap()
}

fn stays_at_rest(body: &Body, scheme: Scheme) {
    let start = equilibrium(body, 4);
    let mut motion = Motion::starting(body, scheme, NewtonSettings::default(), start.clone()).unwrap();
    let energy = motion.record().strain_energy;
    assert!(energy > 0.1 && motion.record().external_work == 0.0);
    let mut fastest = 0.0f64;
    for _ in 0..1000 {
        let record = motion.step(0.05).unwrap();
        assert!(record.energy_residual.abs() < 1e-14 * energy, "{scheme}: {record:?}");
        fastest = motion.state().velocity.iter().fold(fastest, |fastest, v| fastest.max(v.abs()));
    }
    // The speed of sound is 8, the largest displacement 0.7.
    assert!(fastest < 1e-12, "{scheme}: {fastest:e}");
    let moved = start.displacement.iter().zip(&motion.state().displacement);
    assert!(moved.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) < 1e-12, "{scheme}");
}

#[test]
fn a_preloaded_body_stays_at_rest() {
    let held = preloaded(false);
    for scheme in [DGM, at(DGM, 2), assumed_strain(2), "Newmark(0.25, 0.5)".parse().unwrap()] {
        stays_at_rest(&held, scheme);
    }
    let driven = preloaded(true);
    for scheme in [DGM, at(DGM, 2), assumed_strain(2)] {
        stays_at_rest(&driven, scheme);
    }
}

/// Pulled and released: the motion has the energy that was stored.
#[test]
fn a_released_body_keeps_the_stored_energy() {
    let pull = Load::traction("x-max", [3.0, 0.0, 2.0]).over([(0.0, 1.0), (0.1, 1.0), (0.1, 0.0)]).unwrap();
    let body = Body::builder(block([4.0, 1.0, 1.0], [4, 1, 1]).unwrap())
        .region(rubber())
        .support(Support::fixed("x-min"))
        .load(pull)
        .build()
        .unwrap();
    let start = equilibrium(&body, 4);
    for degree in [1, 2] {
        let mut motion =
            Motion::starting(&body, at(DGM, degree), NewtonSettings::default(), start.clone()).unwrap();
        let stored = motion.record().strain_energy;
        let mut records: Vec<Record> = Vec::new();
        for _ in 0..200 {
            records.push(motion.step(0.05).unwrap().clone());
        }
        let fastest = records.iter().map(|record| record.kinetic_energy).fold(0.0, f64::max);
        assert!(fastest > 0.5 * stored, "{fastest} {stored}");
        let drift = records.iter().map(|record| (record.total_energy - stored).abs()).fold(0.0, f64::max);
        assert!(drift < 1e-12 * stored, "degree {degree}: {:e}", drift / stored);
    }
}

/// The start at another time than 0, with velocities, and the state of one motion as the start of another body's.
#[test]
fn starts_have_their_time_and_their_velocities() {
    let grows = Load::acceleration([0.0, 0.0, -1.0]).over([(0.0, 0.0), (4.0, 2.0)]).unwrap();
    let builder =
        || Body::builder(block([4.0, 1.0, 1.0], [4, 1, 1]).unwrap()).region(rubber()).load(grows.clone());
    let body = builder().support(Support::fixed("x-min")).build().unwrap();
    let fling = InitialVelocity { velocity: [0.0, 1.0, 0.0], ..Default::default() };
    let at_two = Equilibrium::new(&body, 2.0, 2).unwrap();
    let state = at_two.start(NewtonSettings::default(), &[fling], &mut []).unwrap();
    assert_eq!((state.time, state.step), (2.0, 0));
    let lowest =
        |state: &State| state.displacement.iter().skip(2).step_by(3).fold(0.0, |a: f64, &b| a.min(b));
    let constant = Body::builder(block([4.0, 1.0, 1.0], [4, 1, 1]).unwrap())
        .region(rubber())
        .support(Support::fixed("x-min"))
        .load(Load::acceleration([0.0, 0.0, -1.0]))
        .build()
        .unwrap();
    assert!((lowest(&state) / lowest(&equilibrium(&constant, 5)) - 1.0).abs() < 1e-12);
    let free = builder().build().unwrap();
    let foot = body.mesh().nearest_node([0.0; 3]);
    assert!(state.velocity[3 * foot + 1] == 0.0 && state.velocity.iter().any(|&v| v == 1.0));

    let moved = state.clone().transferred(&free, 0.5).unwrap();
    assert_eq!(
        (moved.time, &moved.displacement, &moved.velocity),
        (0.5, &state.displacement, &state.velocity)
    );
    let back = moved.transferred(&body, 0.0).unwrap();
    assert_eq!(back.momentum, state.momentum);
}
