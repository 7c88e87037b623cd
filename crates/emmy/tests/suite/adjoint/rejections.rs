//! Motions that the adjoint does not cover.

use emmy::Error;
use emmy::adjoint::{Goal, Parameter, Trajectory};
use emmy::body::{Body, Load, LoadKind, Region, Support, TimeFunction};
use emmy::material::NeoHooke;
use emmy::mesh;
use emmy::motion::{MarchError, Motion, Phase, State, StepPlan};
use emmy::time::Scheme;

use super::problems::*;
use crate::shared::schemes::{DGM, at};

#[test]
fn unsupported_problems_are_rejected() {
    let block = || mesh::block([1.0, 1.0, 2.0], [1, 1, 2]).unwrap();
    let rubber = || vec![Region::new(NeoHooke::new(30.0, 15.0).unwrap(), 1.0)];
    let held = |until| Support { group: "z-min".into(), fix: [true; 3], until, ..Default::default() };
    let rate = TimeFunction::smooth("0.1*t^2", |t| [0.1 * t * t, 0.2 * t, 0.2]);
    let driven = Support { displacement: [Some(rate), None, None], fix: [false; 3], ..held(None) };
    let kind = LoadKind::Pressure { group: "z-max".into(), pressure: 1.0 };
    let pressure = Load { kind, time_function: TimeFunction::constant() };
    let rejected = |supports: &[Support], loads: &[Load], scheme: Scheme| {
        let body = Body::builder(block()).regions(rubber()).supports(supports).loads(loads).build().unwrap();
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let motion = Motion::starting(&body, at(scheme, 1), settings(), state).unwrap();
        Trajectory::new(&motion).unwrap_err().to_string()
    };
    let cases = [
        (rejected(&[driven], &[], DGM), "driven supports"),
        (rejected(&[held(Some(0.5))], &[], DGM), "supports that are released"),
        (rejected(&[], &[pressure], DGM), "pressures that follow"),
        (rejected(&[], &[], Scheme::CentralDifferences), "time element without dissipation"),
    ];
    for (message, expected) in cases {
        assert!(message.starts_with("adjoint: ") && message.contains(expected), "{message}");
    }
}

#[test]
fn a_trajectory_with_gaps_is_rejected() {
    let body = rubber();
    let goal = Goal::displacement_at(&body, 11, [1.0, 0.0, 0.0]);
    let mut motion = Motion::starting(&body, at(DGM, 1), settings(), disturbed(&body, 0.0, 0.5)).unwrap();
    let mut trajectory = Trajectory::new(&motion).unwrap();
    trajectory.record(&motion).unwrap();
    let has = |error: Error, part: &str| assert!(error.to_string().contains(part), "{error}");
    has(trajectory.gradient(&goal, &[]).unwrap_err(), "no step");
    motion.step(0.1).unwrap();
    trajectory.record(&motion).unwrap();
    trajectory.record(&motion).unwrap();
    assert_eq!(trajectory.n_steps(), 1);
    let short = Goal { displacement: vec![1.0], velocity: vec![1.0] };
    has(trajectory.gradient(&short, &[]).unwrap_err(), "number of degrees of freedom");
    let free = Parameter::linear(1.0, 1.0, |density| {
        let rubber = Region::new(NeoHooke::new(30.0, 15.0)?, density);
        Body::builder(mesh::block([1.0, 1.0, 2.0], [1, 1, 2])?).region(rubber).build()
    });
    has(trajectory.gradient(&goal, &[free.unwrap()]).unwrap_err(), "other degrees of freedom or supports");
    let pressed = Parameter::linear(1.0, 1.0, |pressure| {
        let kind = LoadKind::Pressure { group: "z-max".into(), pressure };
        let rubber = Region::new(NeoHooke::new(30.0, 15.0)?, 1.0);
        let load = Load { kind, time_function: TimeFunction::constant() };
        Body::builder(mesh::block([1.0, 1.0, 2.0], [1, 1, 2])?).region(rubber).load(load).build()
    });
    has(trajectory.gradient(&goal, &[pressed.unwrap()]).unwrap_err(), "pressures that follow");
    (2..4).for_each(|_| {
        motion.step(0.1).unwrap();
    });
    has(trajectory.record(&motion).unwrap_err(), "did not see");
    let march = motion
        .march(&StepPlan::new(0.3, vec![Phase { until: 0.5, size: 0.1 }]).unwrap(), &mut [&mut trajectory]);
    assert!(matches!(march, Err(MarchError::Observer(_))));
    let other = Motion::starting(&body, at(DGM, 2), settings(), disturbed(&body, 0.0, 0.5)).unwrap();
    has(trajectory.record(&other).unwrap_err(), "another body, scheme or settings");
    assert!(Parameter::linear(1.0, 0.0, |_| Ok(rubber())).is_err());
}
