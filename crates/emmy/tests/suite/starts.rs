//! Velocity and momentum of a start belong together, and to the body.

use emmy::body::{Body, InitialVelocity, Region, Rotation, Support, TimeFunction};
use emmy::material::NeoHooke;
use emmy::motion::{Motion, NewtonSettings, State};
use emmy::time::Scheme;
use emmy::{Error, mesh};

use crate::shared::schemes::{DGM, at, fe};

/// A block of volume 2.
fn block(density: f64, supports: &[Support]) -> Body {
    let rubber = Region::new(NeoHooke::new(600.0, 400.0).unwrap(), density);
    let mesh = mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    Body::builder(mesh).region(rubber).supports(supports).build().unwrap()
}

fn state(body: &Body, angular_velocity: [f64; 3]) -> State {
    let field = InitialVelocity { velocity: [1.0, 0.0, 0.0], angular_velocity, ..Default::default() };
    State::initial(body, 0.0, &[field]).unwrap()
}

/// The state after three steps.
fn moved(body: &Body, scheme: Scheme, start: State) -> State {
    let mut motion = Motion::starting(body, scheme, NewtonSettings::default(), start).unwrap();
    for _ in 0..3 {
        motion.step(0.005).unwrap();
    }
    motion.state().clone()
}

fn schemes() -> Vec<Scheme> {
    let classic = ["trapezoidal", "HHT(0.1)", "Bathe", "central-differences", "DGM(0.5)"];
    let parsed = classic.iter().map(|name| at(name.parse::<Scheme>().unwrap(), 1));
    parsed.chain([at(DGM, 1), at(DGM, 3), at(fe(2), 2)]).collect()
}

#[test]
fn a_kick_is_a_velocity_with_its_momentum() {
    let body = block(1.0, &[]);
    for scheme in schemes() {
        let mut kicked = moved(&body, scheme, state(&body, [0.0; 3]));
        kicked.velocity.iter_mut().skip(1).step_by(3).for_each(|v| *v += 2.0);
        let start = |state| Motion::starting(&body, scheme, NewtonSettings::default(), state);
        match start(kicked.clone()) {
            // A corner has an eighth of the mass 1 of its cell.
            Err(Error::StartMomentum { node: _, momentum: [x, y, z], product: [_, kicked, _] }) => {
                assert!(y.abs() < 1e-12 && z.abs() < 1e-12 && (kicked - 2.0 * x).abs() < 1e-12, "{scheme}");
            }
            other => panic!("{scheme}: {other:?}"),
        }
        let time = kicked.time;
        let mut motion = start(kicked.transferred(&body, time).unwrap()).unwrap();
        for _ in 0..4 {
            // m (1 + 4)/2 with m = 2; the block does not deform.
            assert!((motion.record().kinetic_energy - 5.0).abs() < 1e-11, "{scheme}");
            motion.step(0.005).unwrap();
        }
        assert!(motion.state().velocity.as_chunks::<3>().0.iter().all(|v| (v[1] - 2.0).abs() < 1e-11));
    }
}

/// The energy of the start is `v . M v/2` with the mass of the new scheme, and a balance that closes needs it.
#[test]
fn every_scheme_goes_on_from_every_other() {
    let body = block(1.0, &[]);
    let lumped = |v: &[f64]| -> f64 {
        v.iter().enumerate().map(|(dof, v)| 0.5 * body.lumped_mass()[dof / 3] * v * v).sum()
    };
    let consistent = |v: &[f64]| -> f64 {
        let mut p = vec![0.0; v.len()];
        body.mass_product(v, &mut p);
        v.iter().zip(&p).map(|(v, p)| 0.5 * v * p).sum()
    };
    for first in schemes() {
        let state = moved(&body, first, state(&body, [0.5, 0.3, 1.0]));
        for second in schemes() {
            let settings = NewtonSettings::default();
            let motion = Motion::starting(&body, second, settings, state.clone()).unwrap();
            let expected = match second {
                Scheme::CentralDifferences => lumped(&state.velocity),
                _ => consistent(&state.velocity),
            };
            let found = motion.record().kinetic_energy;
            assert!((found / expected - 1.0).abs() < 1e-13, "{second} after {first}: {found} {expected}");
        }
    }
}

#[test]
fn states_of_driven_bodies_belong_to_them() {
    let turned = Support {
        group: "y-min".into(),
        rotation: Some(Rotation {
            axis: [0.0, 0.0, 1.0],
            about: [0.5, 0.0, 0.5],
            angle: TimeFunction::smooth("sin(3 t)", |t| {
                [(3.0 * t).sin(), 3.0 * (3.0 * t).cos(), -9.0 * (3.0 * t).sin()]
            }),
        }),
        ..Default::default()
    };
    let body = block(1.0, &[turned]);
    let start = || State::initial(&body, 0.0, &[]).unwrap();
    for scheme in [at(DGM, 1), at(DGM, 3), at(fe(2), 2)] {
        let state = moved(&body, scheme, start());
        moved(&body, at(DGM, 2), state);
    }
}

#[test]
fn a_start_of_another_body_is_an_error() {
    let (light, heavy) = (block(1.0, &[]), block(3.0, &[]));
    let start = state(&light, [0.0, 0.0, 1.0]);
    let settings = NewtonSettings::default();
    let scheme = at(DGM, 1);
    let failed = Motion::starting(&heavy, scheme, settings, start.clone()).map(|_| ());
    assert!(matches!(failed, Err(Error::StartMomentum { .. })), "{failed:?}");
    let snapshot = Motion::starting(&light, scheme, settings, start.clone()).unwrap().snapshot();
    let failed = Motion::resumed(&heavy, scheme, settings, snapshot).map(|_| ());
    assert!(matches!(failed, Err(Error::StartMomentum { .. })), "{failed:?}");
    // With the masses of the new body, and the same velocity: three times the energy.
    let energy =
        |body, state| Motion::starting(body, scheme, settings, state).unwrap().record().kinetic_energy;
    let transferred = start.clone().transferred(&heavy, 0.0).unwrap();
    assert!((energy(&heavy, transferred) / energy(&light, start.clone()) - 3.0).abs() < 1e-13);

    let held = block(1.0, &[Support::fixed("y-min")]);
    let failed = Motion::starting(&held, scheme, settings, start.clone()).map(|_| ());
    assert!(matches!(failed, Err(Error::StartHeld { .. })), "{failed:?}");
    let rest = start.transferred(&held, 0.0).unwrap();
    assert!(Motion::starting(&held, scheme, settings, rest).is_ok());

    let mut broken = state(&light, [0.0; 3]);
    broken.momentum[7] = f64::NAN;
    assert!(Motion::starting(&light, scheme, settings, broken).is_err());
}

/// A kick of a node that a heavy one outweighs by far.
#[test]
fn a_light_node_beside_a_heavy_one_counts() {
    use emmy::body::{PointMass, PointTerms};
    let heavy =
        PointTerms { masses: vec![PointMass { group: "y-max".into(), mass: 1e12 }], ..Default::default() };
    let rubber = Region::new(NeoHooke::new(600.0, 400.0).unwrap(), 1.0);
    let mesh = mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    let body = Body::builder(mesh).region(rubber).point_terms(heavy).build().unwrap();
    let mut kicked = state(&body, [0.0; 3]);
    let node = body.mesh().points().iter().position(|point| *point == [0.0; 3]).unwrap();
    kicked.velocity[3 * node] += 1e-4;
    let failed = Motion::starting(&body, at(DGM, 1), NewtonSettings::default(), kicked).map(|_| ());
    assert!(matches!(failed, Err(Error::StartMomentum { .. })), "{failed:?}");
}

/// The nodes that a support held until its release move in the state after it; the free body keeps its linear momentum.
#[test]
fn a_state_after_a_release_is_a_start() {
    let body = block(1.0, &[Support::fixed("y-min").until(0.01)]);
    for scheme in schemes() {
        let released = moved(&body, scheme, state(&body, [0.0, 0.0, 1.0]));
        assert!(released.velocity[..3].iter().any(|v| v.abs() > 1e-3), "{scheme}");
        let start = Motion::starting(&body, scheme, NewtonSettings::default(), released);
        let mut motion = start.unwrap_or_else(|error| panic!("{scheme}: {error}"));
        let before = motion.record().linear_momentum;
        let after = motion.step(0.005).unwrap().linear_momentum;
        assert!((0..3).all(|i| (after[i] - before[i]).abs() < 1e-12), "{scheme}: {before:?} {after:?}");
    }
}
