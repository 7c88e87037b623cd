//! Obstacles that move: motions are those with the obstacle at rest, seen from it, and its work closes the balance.

#![allow(non_snake_case)]

use crate::shared::contact::{conserving, rubber};
use crate::shared::schemes::{DGM, at};
use emmy::body::{Contact, Obstacle};
use emmy::equilibrium::Equilibrium;
use emmy::mesh::{MeshBuilder, Placement};
use emmy::motion::NewtonSettings;
use emmy::prelude::*;

/// A unit block above the plane y = 0, by 0.1.
fn block() -> Mesh {
    let above = Placement::default().shifted([0.0, 0.1, 0.0]);
    let mut builder = MeshBuilder::new();
    builder.part("block", &mesh::block([1.0; 3], [2; 3]).unwrap().placed(&above).unwrap()).unwrap();
    builder.build().unwrap()
}

const OBSTACLES: [Obstacle; 3] = [
    Obstacle::Plane { point: [0.0; 3], normal: [0.0, 1.0, 0.0] },
    Obstacle::Sphere { centre: [0.6, -0.45, 0.4], radius: 0.5, inside: false },
    Obstacle::Cylinder { point: [0.3, -0.5, 0.0], axis: [0.1, 0.0, 1.0], radius: 0.5, inside: false },
];

fn contact(obstacle: Obstacle) -> Contact {
    Contact::of_all_with_obstacle(obstacle).with_stiffness(1333.0).with_distance(0.05).named("wall")
}

fn moving_at(velocity: f64) -> TimeFunction {
    TimeFunction::smooth("v*t", move |t| [velocity * t, velocity, 0.0])
}

/// Galilei's principle: an obstacle that moves against a body at rest is one at rest that the body meets.
#[test]
fn an_obstacle_in_uniform_motion_is_one_at_rest() {
    const SPEED: f64 = 2.0;
    for obstacle in OBSTACLES {
        for ((region, scheme, size), (again, ..)) in conserving(0.004).into_iter().zip(conserving(0.004)) {
            let size = 0.5 * size;
            let body = |region: Region, contact: Contact| {
                Body::builder(block()).region(region).contact(contact).build().unwrap()
            };
            let at_rest = body(region, contact(obstacle));
            let moving = body(again, contact(obstacle).moved([None, Some(moving_at(SPEED)), None]));
            let falls = InitialVelocity { velocity: [0.3, -SPEED, 0.0], ..InitialVelocity::default() };
            let drifts = InitialVelocity { velocity: [0.3, 0.0, 0.0], ..falls.clone() };
            let start = |body: &Body, velocity| State::initial(body, 0.0, &[velocity]).unwrap();
            let settings = NewtonSettings::default();
            let mut expected = Motion::starting(&at_rest, scheme, settings, start(&at_rest, falls)).unwrap();
            let mut motion = Motion::starting(&moving, scheme, settings, start(&moving, drifts)).unwrap();
            let energy = motion.record().total_energy;
            let (mut touched, mut work, n) = (false, 0.0, at_rest.mesh().n_nodes());
            assert_eq!(moving.mesh().n_nodes(), n + 1);
            for _ in 0..(0.12 / size).ceil() as usize {
                let there = expected.step(size).unwrap();
                let (by_rest, there_momentum) = (there.contact_energy, there.linear_momentum);
                let record = motion.step(size).unwrap();
                touched |= by_rest > 1e-3;
                work = record.external_work;
                assert!((record.contact_energy - by_rest).abs() < 1e-9, "{scheme:?}");
                assert!(record.energy_residual.abs() < 1e-11, "{scheme:?} {}", record.energy_residual);
                assert!(record.linear_momentum_residual < 1e-11, "{scheme:?}");
                assert!(record.angular_momentum_residual < 1e-11, "{scheme:?}");
                assert!((record.linear_momentum[1] - SPEED - there_momentum[1]).abs() < 1e-9);
            }
            assert!(touched);
            // T + V + V_c has risen by the work of the obstacle, and no kinetic energy is that of a massless node.
            assert!((motion.record().total_energy - energy - work).abs() < 1e-11);
            let shift = SPEED * motion.state().time;
            for node in 0..n {
                let there = expected.state().position(&at_rest, node);
                let own = motion.state().position(&moving, node);
                let difference = [own[0] - there[0], own[1] - shift - there[1], own[2] - there[2]];
                assert!(difference.iter().all(|d| d.abs() < 1e-9), "{scheme:?} {difference:?}");
            }
            // Its work is that of the mean force on it, and the body has the opposite force.
            let [on_obstacle, on_body] = ["wall-obstacle", "wall"].map(|name| {
                let at = moving.supported_groups().position(|group| group == name).unwrap();
                motion.reactions()[at].force
            });
            assert!((on_obstacle[1] - on_body[1]).abs() < 1e-10);
            // The node that stands for it is no place of the body.
            assert!((motion.statistics().largest_displacement.node) < n);
        }
    }
}

/// A press that goes down by 0.15 and a table that goes up by 0.15 press a block equally.
#[test]
fn a_press_in_equilibrium_is_a_table_that_rises() {
    let press = Obstacle::Plane { point: [0.0, 1.13, 0.0], normal: [0.0, -1.0, 0.0] };
    let contact = Contact::with_obstacle("block-y-max", press).named("press").with_distance(0.02);
    let displacement = |sign: f64| [None, Some(moving_at(0.15 * sign)), None];
    let table = Support { fix: [true, false, true], ..Support::driven("block-y-min", displacement(1.0)) };
    let risen = Body::builder(block()).region(rubber()).support(table).contact(contact.clone());
    let pressed = Body::builder(block())
        .region(rubber())
        .support(Support::fixed("block-y-min"))
        .contact(contact.moved(displacement(-1.0)));
    let [risen, pressed] = [risen, pressed].map(|builder| builder.build().unwrap());
    let [up, down] = [&risen, &pressed].map(|body| {
        Equilibrium::new(body, 1.0, 5).unwrap().start(NewtonSettings::default(), &[], &mut []).unwrap()
    });
    for node in 0..risen.mesh().n_nodes() {
        let (a, b) = (up.position(&risen, node), down.position(&pressed, node));
        let difference = [a[0] - b[0], a[1] - 0.15 - b[1], a[2] - b[2]];
        assert!(difference.iter().all(|d| d.abs() < 1e-9), "{difference:?}");
    }
    let top = risen.mesh().points().iter().position(|X| X[1] > 1.05 && X[0] == 0.5 && X[2] == 0.5).unwrap();
    // Pressed by at least 0.15 less the first gap and less the layer.
    assert!(down.position(&pressed, top)[1] < 1.1 - 0.1);
}

/// Impossible contacts are refused with a reason.
#[test]
fn what_cannot_move_is_refused() {
    let reason = |builder: emmy::body::BodyBuilder| builder.build().unwrap_err().to_string();
    let builder = || Body::builder(block()).region(rubber());
    let [plane, ..] = OBSTACLES;
    let held = builder().support(Support::fixed("block-y-min"));
    let message = reason(held.contact(Contact::with_obstacle("block-y-min", plane)));
    assert!(message.contains("nothing of \"block-y-min\" can move"), "{message}");
    let two = Contact::between("block-y-min", "block-y-max").moved([None, Some(moving_at(1.0)), None]);
    let message = reason(builder().contact(two));
    assert!(message.contains("a motion is one of an obstacle"), "{message}");
    let flat = Obstacle::Plane { point: [0.0; 3], normal: [0.0; 3] };
    let message = reason(builder().contact(contact(flat).moved([None, Some(moving_at(1.0)), None])));
    assert!(message.contains("has no direction"), "{message}");
    // Two walls that move: one node each.
    let ceiling = Obstacle::Plane { point: [0.0, 1.2, 0.0], normal: [0.0, -1.0, 0.0] };
    let ceiling = Contact::of_all_with_obstacle(ceiling).named("ceiling");
    let both = [contact(plane), ceiling].map(|own| own.moved([Some(moving_at(0.1)), None, None]));
    let body = builder().contacts(both).build().unwrap();
    assert_eq!(body.mesh().n_nodes(), block().n_nodes() + 2);
    let mut motion = Motion::new(&body, at(DGM, 1)).unwrap();
    // Walls that slide along themselves do no work.
    assert!(motion.step(0.1).unwrap().kinetic_energy < 1e-20);
}
