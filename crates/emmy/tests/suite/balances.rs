//! Balances of energy and momentum under loads and supports (section 6 of the method): identities of the conserving
//! schemes, at round-off in every step, for any position of the kinks of the time functions.

use emmy::body::{Body, InitialVelocity, Load, LoadKind, Region, Support, TimeFunction};
use emmy::material::NeoHooke;
use emmy::motion::{Motion, NewtonSettings, Phase, Record, State, StepPlan};
use emmy::time::Scheme;

use crate::shared::schemes::{DGM, TRAPEZOIDAL, assumed_strain, at, fe};

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 0.7)
}

fn time_function(entries: &[(f64, f64)]) -> TimeFunction {
    TimeFunction::new(entries.to_vec()).unwrap()
}

/// A traction with a kink and a jump, a force, and gravity that is switched on; no kink at the end of a step.
fn loads() -> Vec<Load> {
    let traction = LoadKind::Traction { group: "y-max".into(), traction: [20.0, -10.0, 15.0] };
    let force = LoadKind::Force { group: "x-max".into(), force: [0.0, 30.0, 40.0] };
    let gravity = LoadKind::Acceleration { group: None, acceleration: [1.0, -9.81, 2.0] };
    vec![
        Load {
            kind: traction,
            time_function: time_function(&[(0.0, 0.0), (0.13, 1.0), (0.21, 1.0), (0.21, -0.5), (0.33, 0.0)]),
        },
        Load { kind: force, time_function: time_function(&[(0.05, 0.0), (0.3, 1.0)]) },
        Load { kind: gravity, time_function: TimeFunction::constant() },
    ]
}

fn records(supports: &[Support], loads: &[Load], scheme: Scheme, degree: usize) -> Vec<Record> {
    records_to(NewtonSettings::default(), supports, loads, at(scheme, degree))
}

fn records_to(settings: NewtonSettings, supports: &[Support], loads: &[Load], scheme: Scheme) -> Vec<Record> {
    let mesh = emmy::mesh::block([1.0, 3.0, 1.0], [1, 3, 1]).unwrap();
    let body = Body::builder(mesh).region(rubber()).supports(supports).loads(loads).build().unwrap();
    let spin = InitialVelocity { angular_velocity: [1.0, 2.0, -1.0], ..Default::default() };
    let state = State::initial(&body, 0.0, &[spin]).unwrap();
    let mut motion = Motion::starting(&body, scheme, settings, state).unwrap();
    let plan = [Phase { until: 0.2, size: 0.03 }, Phase { until: 0.4, size: 0.07 }];
    StepPlan::new(0.0, plan.to_vec())
        .unwrap()
        .steps()
        .map(|s| motion.step_of_plan(&s).unwrap().clone())
        .collect()
}

fn assert_closed(records: &[Record], what: &str) {
    let energy = records.iter().map(|r| r.kinetic_energy + r.strain_energy).fold(0.0, f64::max);
    for record in records {
        assert!(record.energy_residual.abs() < 1e-12 * energy, "{what}: {record:?}");
        assert!(record.linear_momentum_residual < 1e-11, "{what}: {record:?}");
        assert!(record.angular_momentum_residual < 1e-11, "{what}: {record:?}");
    }
}

#[test]
fn free_body_under_load() {
    for degree in 1..=3 {
        for scheme in [DGM, assumed_strain(10)] {
            assert_closed(&records(&[], &loads(), scheme, degree), &format!("{scheme} k = {degree}"));
        }
    }
}

/// The solution depends on the tolerance, and the balances do not.
#[test]
fn balances_of_a_free_body_close_whatever_the_tolerance() {
    for degree in 1..=3 {
        let with = |tolerance: f64, scheme| {
            let settings = NewtonSettings { tolerance, ..NewtonSettings::default() };
            records_to(settings, &[], &loads(), at(scheme, degree))
        };
        for scheme in [DGM, assumed_strain(10)] {
            let [exact, rough] = [1e-13, 1e-6].map(|tolerance| with(tolerance, scheme));
            assert_closed(&rough, &format!("{scheme} k = {degree}"));
            let difference = exact.iter().zip(&rough).map(|(a, b)| (a.strain_energy - b.strain_energy).abs());
            assert!(difference.fold(0.0, f64::max) > 1e-10, "{scheme} k = {degree}");
        }
        for record in with(1e-6, fe(degree)) {
            assert!(record.linear_momentum_residual < 1e-11, "FE({degree}): {record:?}");
            assert!(record.angular_momentum_residual < 1e-11, "FE({degree}): {record:?}");
        }
    }
}

#[test]
fn supported_body_under_load() {
    let supports = [
        Support { group: "y-min".into(), fix: [true, true, false], ..Default::default() },
        Support { group: "x-min".into(), fix: [false, false, true], ..Default::default() },
    ];
    for degree in 1..=3 {
        for scheme in [DGM, assumed_strain(10)] {
            let records = records(&supports, &loads(), scheme, degree);
            assert_closed(&records, &format!("{scheme} k = {degree}"));
            // The supports take momentum: without their reactions the balance would not close.
            let change = records[1].linear_momentum[1] - records[0].linear_momentum[1];
            assert!(change.abs() > 1e-3);
        }
    }
}

/// The balance shows non-conserved quantities: Table III by running.
#[test]
fn defects_of_standard_rules_are_seen() {
    let worst = |scheme| {
        // FE(8) conserves more digits of the energy than the tolerance has.
        let settings = NewtonSettings { tolerance: 1e-13, ..NewtonSettings::default() };
        let records = records_to(settings, &[], &loads(), at(scheme, 1));
        let energy = records.iter().map(|r| r.energy_residual.abs()).fold(0.0, f64::max);
        (energy, records.iter().map(|r| r.angular_momentum_residual).fold(0.0, f64::max))
    };
    let (energy, momentum) = worst(fe(1));
    assert!(energy > 1e-5 && momentum < 1e-11);
    let (energy, momentum) = worst(fe(8));
    assert!(energy < 1e-10 && momentum > 1e-5);
    let (energy, momentum) = worst(TRAPEZOIDAL);
    assert!(energy > 1e-5 && momentum > 1e-5);
}

/// A force at each of n nodes gives n times the force, regardless of their areas: after a time t with constant forces
/// the momentum is n F t.
#[test]
fn forces_at_nodes_add_up() {
    let kind = LoadKind::NodalForce { group: "y-max".into(), force: [0.0, 2.0, -1.0] };
    let records = records(&[], &[Load { kind, time_function: TimeFunction::constant() }], DGM, 1);
    assert_closed(&records, "forces at nodes");
    let change = |d: usize| records[records.len() - 1].linear_momentum[d] - records[0].linear_momentum[d];
    let duration = records[records.len() - 1].time - records[0].time;
    assert!((change(1) - 4.0 * 2.0 * duration).abs() < 1e-12 && (change(2) + 4.0 * duration).abs() < 1e-12);
}

/// The impulse of a load is the integral of its time function, and equals the momentum of a free body.
#[test]
fn momentum_is_the_integral_of_the_load() {
    let load = Load {
        kind: LoadKind::Force { group: "x-max".into(), force: [3.0, 0.0, 0.0] },
        time_function: time_function(&[(0.02, 0.0), (0.1, 1.0), (0.15, 1.0), (0.15, 0.0)]),
    };
    let records = records(&[], &[load], assumed_strain(2), 2);
    let before = records[0].linear_momentum[0] - 3.0 * (0.01 * 0.01 / 0.08 / 2.0);
    let after = records[records.len() - 1].linear_momentum[0];
    assert!((after - before - 3.0 * (0.04 + 0.05)).abs() < 1e-12);
}

/// A freely falling body is exact: the time element reproduces a parabola from degree 2 on, and the mid-point rule its
/// end points.
#[test]
fn free_fall() {
    let gravity = Load {
        kind: LoadKind::Acceleration { group: Some("body".into()), acceleration: [0.0, 0.0, -10.0] },
        time_function: TimeFunction::constant(),
    };
    for degree in 1..=2 {
        let body = Body::builder(emmy::mesh::block([1.0; 3], [2; 3]).unwrap())
            .region(rubber())
            .loads([&gravity])
            .build()
            .unwrap();
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let mut motion = Motion::starting(&body, at(DGM, degree), NewtonSettings::default(), state).unwrap();
        motion.march(&StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.25 }]).unwrap(), &mut []).unwrap();
        assert!(motion.state().displacement.iter().skip(2).step_by(3).all(|u| (u + 5.0).abs() < 1e-12));
        assert!((motion.record().external_work - 0.7 * 10.0 * 5.0).abs() < 1e-11);
    }
}

/// Parts own rows: the numbers are bitwise identical for any number of threads.
#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mesh = emmy::mesh::block([1.0, 3.0, 1.0], [4, 12, 4]).unwrap();
            let body = Body::builder(mesh).region(rubber()).loads(loads()).build().unwrap();
            let state = State::initial(&body, 0.0, &[]).unwrap();
            let mut motion = Motion::starting(&body, at(DGM, 2), NewtonSettings::default(), state).unwrap();
            motion
                .march(&StepPlan::new(0.0, vec![Phase { until: 0.1, size: 0.02 }]).unwrap(), &mut [])
                .unwrap();
            motion.state().clone()
        })
    };
    let one = run(1);
    assert!([2, 3, 5].into_iter().all(|threads| run(threads) == one));
}

/// A moving body without load has no force at its starting point, but rest is not a solution.
#[test]
fn a_moving_body_is_never_solved_without_an_iteration() {
    let body = Body::builder(emmy::mesh::l_block(1.0).unwrap()).region(rubber()).build().unwrap();
    let spin = InitialVelocity { angular_velocity: [0.3, 0.5, 0.8], ..Default::default() };
    for (scheme, degree, size) in
        [(DGM, 2, 5.0), (assumed_strain(5), 1, 1.0), (fe(1), 1, 5.0), (TRAPEZOIDAL, 1, 0.8), (DGM, 3, 0.8)]
    {
        let state = State::initial(&body, 0.0, std::slice::from_ref(&spin)).unwrap();
        let mut motion =
            Motion::starting(&body, at(scheme, degree), NewtonSettings::default(), state).unwrap();
        for _ in 1..=3 {
            // A step of this size may fail, but it must not accept rest as a solution.
            let Ok(record) = motion.step(size) else { break };
            assert!(record.newton_iterations > 0, "{scheme} k = {degree}");
            assert!(record.linear_momentum_residual < 1e-9 * 40.0, "{scheme} k = {degree}: {record:?}");
        }
    }
}
