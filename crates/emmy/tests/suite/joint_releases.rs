//! Joints that are released while the body moves.

#![allow(non_snake_case)]

use crate::shared::joints::rigid;
use crate::shared::schemes::{DGM, at};
use emmy::motion::{Adaptivity, Event, EventKind, NewtonSettings, Observer, ObserverResult, Record, View};
use emmy::prelude::*;

const G: f64 = 9.81;

fn started<'a>(body: &'a Body, k: usize, start: &[InitialVelocity]) -> Motion<'a> {
    let state = State::initial(body, 0.0, start).unwrap();
    Motion::starting(body, at(DGM, k), NewtonSettings::default(), state).unwrap()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

/// A ball on a rod of length 1 about the origin, at first at 2 rad from the downward vertical.
fn thrown(until: f64) -> Body {
    let place = [2f64.sin(), 0.0, -(2f64.cos())];
    let kind = JointKind::Distance { to: [0.0; 3] };
    let rod = Joint::new("rod", kind, [rigid("ball"), JointEnd::Ground], place).until(until);
    let ball = RigidBody::point("ball", 2.0, place);
    let builder = Body::builder(Mesh::without_cells()).rigid(ball).joint(rod);
    builder.load(Load::acceleration([0.0, 0.0, -G])).build().unwrap()
}

/// The place of the ball.
fn place(record: &Record) -> [f64; 3] {
    record.rigid_bodies[0].position
}

#[test]
fn a_pendulum_that_is_released_flies_on_a_parabola() {
    let body = thrown(1.0);
    let flies = body.release().unwrap().1;
    assert_eq!((body.mobility().degrees_of_freedom, flies.mobility().degrees_of_freedom), (Some(2), Some(3)));
    assert_eq!((body.n_constraints(), flies.n_constraints()), (1, 0));
    for k in 1..=3 {
        let mut motion = started(&body, k, &[]);
        let energy = motion.record().total_energy;
        while motion.time() < 1.0 - 1e-9 {
            motion.step(0.05).unwrap();
        }
        let (p, velocity) = (place(motion.record()), motion.state().velocity.clone());
        let along: f64 = (0..3).map(|d| p[d] * velocity[d]).sum();
        assert!(along.abs() < 1e-13, "k = {k}: {along:e}");
        for n in 1..=20 {
            let record = motion.step(0.05).unwrap();
            let t = 0.05 * f64::from(n);
            let exact =
                [0, 1, 2].map(|d| p[d] + t * velocity[d] - if d == 2 { G * t * t / 2.0 } else { 0.0 });
            assert!(distance(place(record), exact) < 1e-12, "k = {k}, step {n}");
            assert!(record.energy_residual.abs() < 1e-12 && record.angular_momentum_residual < 1e-12);
            assert_eq!(record.joints[0].force, [0.0; 3]);
            assert_eq!((record.releases, record.constraint_residual), (usize::from(n == 1), 0.0));
            // The distance is still measured.
            let length = distance(place(record), [0.0; 3]);
            assert!((record.joints[0].coordinate - length).abs() < 1e-14);
        }
        let record = motion.record();
        assert!((record.total_energy - energy - record.external_work).abs() < 1e-12);
    }
}

#[test]
fn flights_after_a_release_converge_with_the_order_of_the_steps() {
    let body = thrown(1.0);
    let end = |k: usize, n: usize| {
        let mut motion = started(&body, k, &[]);
        let h = 1.0 / n as f64;
        (1..=2 * n).for_each(|step| {
            motion.step_to(step as f64 * h).unwrap();
        });
        place(motion.record())
    };
    let exact = end(4, 100);
    for (k, n) in [(1, 40), (2, 20), (3, 10)] {
        let errors = [n, 2 * n, 4 * n].map(|n| distance(end(k, n), exact));
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((order - 2.0 * k as f64).abs() < 0.02, "k = {k}: {order}, {errors:?}");
        }
    }
}

/// Two free bodies on a hinge, with a spring or not, which tumble and part at t = 0.6.
fn parting(stiffness: f64) -> (Body, InitialVelocity) {
    let hinge = JointKind::Revolute { axis: [0.3, -0.2, 0.9] };
    let hinge = Joint::new("hinge", hinge, [rigid("a"), rigid("b")], [0.4, 0.1, -0.2]).until(0.6);
    let hinge = if stiffness > 0.0 { hinge.with_spring(stiffness, Some(0.3)) } else { hinge };
    let body = Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("a", 2.0, [1.0, 0.0, 0.3], [0.5, 0.6, 0.8]))
        .rigid(RigidBody::new("b", 1.0, [-0.7, 0.4, 0.0], [0.3, 0.25, 0.2]))
        .joint(hinge)
        .build()
        .unwrap();
    (body, InitialVelocity { angular_velocity: [0.7, -1.1, 0.9], ..Default::default() })
}

#[test]
fn bodies_that_part_keep_the_momenta_and_the_energy_of_the_whole() {
    for (k, stiffness) in [(1, 0.0), (2, 0.0), (3, 0.0), (2, 5.0)] {
        let (body, flies) = parting(stiffness);
        assert_eq!(body.release().unwrap().1.mobility().degrees_of_freedom, Some(12));
        let mut motion = started(&body, k, &[flies]);
        let start = motion.record().clone();
        let mut parts = None;
        for n in 1..=24 {
            let record = motion.step(0.05).unwrap().clone();
            assert!(distance(record.linear_momentum, start.linear_momentum) < 1e-13, "k = {k}: {record:?}");
            assert!(distance(record.angular_momentum, start.angular_momentum) < 1e-12, "k = {k}: {record:?}");
            assert!(record.energy_residual.abs() < 1e-12, "k = {k}: {record:?}");
            let energy = record.total_energy - record.external_work;
            assert!((energy - start.total_energy).abs() < 1e-12, "k = {k}, step {n}: {record:?}");
            if n > 12 {
                // Each body keeps the velocity of its centre.
                let velocities = [0, 1].map(|own| record.rigid_bodies[own].velocity);
                let first = parts.get_or_insert(velocities);
                assert!((0..2).all(|own| distance(first[own], velocities[own]) < 1e-13), "k = {k}");
                assert_eq!((record.strain_energy, record.joints[0].moment), (0.0, [0.0; 3]));
            }
        }
    }
}

/// A release takes what the joints do not allow from the kinetic energy, and the energy of the spring.
#[test]
fn energy_that_a_release_takes_is_booked_as_work() {
    let work = |k: usize, n: usize| {
        let (body, flies) = parting(0.0);
        let mut motion = started(&body, k, &[flies]);
        (0..n).for_each(|_| {
            motion.step(0.6 / n as f64).unwrap();
        });
        motion.record().external_work
    };
    for k in 1..=3 {
        // Steps of degree 3 meet rounding with 24.
        let [coarse, fine] = if k < 3 { [12, 24] } else { [6, 12] }.map(|n| work(k, n));
        assert!(coarse < 0.0 && coarse < fine && fine < 1e-15, "k = {k}: {coarse:e}, {fine:e}");
        assert!(coarse / fine > 3.5, "k = {k}: {coarse:e}, {fine:e}");
    }
    let (body, flies) = parting(5.0);
    let mut motion = started(&body, 3, &[flies]);
    (0..12).for_each(|_| {
        motion.step(0.05).unwrap();
    });
    let (stored, work) = (motion.record().strain_energy, motion.record().external_work);
    let stretch = motion.record().joints[0].coordinate - 0.3;
    assert!((stored - 2.5 * stretch * stretch).abs() < 1e-14 && stored > 1e-3);
    let after = motion.step(0.05).unwrap();
    assert!((after.external_work - work + stored).abs() < 1e-14, "{after:?}");
}

/// A four-bar linkage has three constraints too many; when its last hinge is released, two arms swing.
#[test]
fn redundant_joints_are_released() {
    let z = JointKind::Revolute { axis: [0.0, 0.0, 1.0] };
    let rod = |name: &str, centre: [f64; 3], along: usize| {
        let mut moments = [1.0 / 12.0; 3];
        moments[along] = 1e-3;
        RigidBody::new(name, 1.0, centre, moments)
    };
    let body = Body::builder(Mesh::without_cells())
        .rigid(rod("left", [0.0, 0.5, 0.0], 1))
        .rigid(rod("right", [1.0, 0.5, 0.0], 1))
        .rigid(rod("coupler", [0.5, 1.0, 0.0], 0))
        .joint(Joint::new("a", z, [rigid("left"), JointEnd::Ground], [0.0; 3]))
        .joint(Joint::new("b", z, [rigid("right"), JointEnd::Ground], [1.0, 0.0, 0.0]))
        .joint(Joint::new("c", z, [rigid("coupler"), rigid("left")], [0.0, 1.0, 0.0]))
        .joint(Joint::new("d", z, [rigid("coupler"), rigid("right")], [1.0, 1.0, 0.0]).until(0.5))
        .load(Load::acceleration([0.0, -G, 0.0]))
        .build()
        .unwrap();
    let after = body.release().unwrap().1;
    let counts = |body: &Body| {
        let mobility = body.mobility();
        (mobility.n_constraints, mobility.n_redundant, mobility.degrees_of_freedom)
    };
    assert_eq!((counts(&body), counts(after)), ((20, 3, Some(1)), (15, 0, Some(3))));
    let turns = InitialVelocity { angular_velocity: [0.0, 0.0, -1.0], ..Default::default() };
    for k in 1..=2 {
        let mut motion = started(&body, k, std::slice::from_ref(&turns));
        let energy = motion.record().total_energy;
        for _ in 0..50 {
            let record = motion.step(0.02).unwrap();
            assert!(record.constraint_residual < 1e-14 && record.energy_residual.abs() < 1e-11, "{record:?}");
            assert!((record.total_energy - energy - record.external_work).abs() < 1e-11, "{record:?}");
        }
        assert_eq!(motion.record().joints[3].force, [0.0; 3]);
        let opening = |end: usize| {
            let record = motion.record();
            let tip = |own: usize, X: [f64; 3]| {
                let motion = record.rigid_bodies[own];
                [0, 1, 2].map(|d| motion.position[d] + (0..3).map(|i| motion.axes[i][d] * X[i]).sum::<f64>())
            };
            let ends = [([-0.5, 0.0, 0.0], 0), ([0.5, 0.0, 0.0], 1)];
            let (own, other) = ends[end];
            distance(tip(2, own), tip(other, [0.0, 0.5, 0.0]))
        };
        assert!(opening(0) < 1e-13 && opening(1) > 0.1, "{} {}", opening(0), opening(1));
    }
}

/// A driven hinge lets go at the angular velocity of its motion, whose table ends there.
#[test]
fn a_driven_body_is_let_go_with_the_rate_of_its_motion() {
    let z = JointKind::Revolute { axis: [0.0, 0.0, 1.0] };
    let turned = TimeFunction::new(vec![(0.0, 0.0), (1.0, 3.0)]).unwrap();
    let axle = Joint::new("axle", z, [rigid("wheel"), JointEnd::Ground], [0.0; 3]).driven(turned).until(1.0);
    let wheel = RigidBody::new("wheel", 2.0, [0.0; 3], [0.1, 0.1, 0.18]);
    let body = Body::builder(Mesh::without_cells()).rigid(wheel).joint(axle).build().unwrap();
    let mut motion = started(&body, 2, &[]);
    for n in 1..=20 {
        let record = motion.step(0.1).unwrap();
        let spin = record.rigid_bodies[0].spin;
        assert!(distance(spin, [0.0, 0.0, 3.0]) < 1e-13, "step {n}: {spin:?}");
        // A free turn by x a step is x^5/720 short.
        let short = f64::from((n - 10).max(0)) * 0.3f64.powi(5) / 720.0;
        let angle = 0.3 * f64::from(n) - short;
        assert!((record.joints[0].coordinate - angle).abs() < 1e-6, "step {n}: {record:?}");
        assert!(record.energy_residual.abs() < 1e-13);
    }
}

#[test]
fn adaptive_steps_end_at_releases() {
    let body = thrown(0.8);
    let exact = {
        let mut motion = started(&body, 4, &[]);
        (0..60).for_each(|_| {
            motion.step(0.02).unwrap();
        });
        place(motion.record())
    };
    let mut last = f64::INFINITY;
    for tolerance in [1e-4, 1e-6] {
        let plan = StepPlan::adaptive(0.0, 1.2, Adaptivity::new(tolerance)).unwrap().with_end_at(0.8);
        let mut motion = started(&body, 2, &[]);
        motion.march(&plan, &mut []).unwrap();
        let error = distance(place(motion.record()), exact);
        assert!(error < 30.0 * tolerance && error < 0.1 * last, "{tolerance:e}: {error:e}");
        assert_eq!(motion.statistics().releases, 1);
        last = error;
    }
}

#[test]
fn resumed_motions_release_the_same_joints() {
    for (k, stiffness) in [(1, 0.0), (2, 5.0)] {
        let (body, flies) = parting(stiffness);
        let mut whole = started(&body, k, std::slice::from_ref(&flies));
        let steps = |motion: &mut Motion<'_>, n: usize| {
            (0..n).for_each(|_| {
                motion.step(0.05).unwrap();
            });
        };
        steps(&mut whole, 20);
        for first in [3, 11, 12, 13, 17] {
            let mut motion = started(&body, k, std::slice::from_ref(&flies));
            steps(&mut motion, first);
            let scheme = at(DGM, k);
            let mut resumed =
                Motion::resumed(&body, scheme, NewtonSettings::default(), motion.snapshot()).unwrap();
            steps(&mut resumed, 20 - first);
            assert_eq!(resumed.state(), whole.state(), "k = {k}, {first}");
            assert_eq!(resumed.record(), whole.record(), "k = {k}, {first}");
        }
    }
}

#[test]
fn releases_are_events_with_the_names_of_the_joints() {
    struct Events(Vec<String>);
    impl Observer for Events {
        fn observe(&mut self, _: View<'_>) -> ObserverResult {
            Ok(())
        }

        fn notice(&mut self, event: &Event) -> ObserverResult {
            assert_eq!((event.kind, event.step), (EventKind::Release, 4));
            self.0.push(event.message.clone());
            Ok(())
        }
    }
    let z = JointKind::Revolute { axis: [0.0, 0.0, 1.0] };
    let mut builder = Body::builder(Mesh::without_cells());
    for (name, x) in [("a", 0.0), ("b", 3.0)] {
        let hinge = Joint::new(format!("of-{name}"), z, [rigid(name), JointEnd::Ground], [x, 0.0, 0.0]);
        let arm = RigidBody::new(name, 1.0, [x + 1.0, 0.0, 0.0], [0.1, 0.2, 0.2]);
        builder = builder.rigid(arm).joint(hinge.until(0.3));
    }
    let body = builder.build().unwrap();
    let plan = StepPlan::new(0.0, vec![Phase { until: 0.5, size: 0.1 }]).unwrap();
    let mut events = Events(Vec::new());
    started(&body, 1, &[]).march(&plan, &mut [&mut events]).unwrap();
    assert_eq!(events.0, ["the joints of-a, of-b were released (until = 0.3)"]);
}
