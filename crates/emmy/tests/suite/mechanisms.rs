//! Mechanisms with constraints that follow from others, and given motions of joints. Exact solutions are by an
//! integration in independent coordinates to 1e-13.

#![allow(non_snake_case)]

use std::f64::consts::PI;

use crate::shared::joints::{hinge, rigid};
use crate::shared::schemes::{DGM, assumed_strain, at, dgm};
use emmy::equilibrium::Equilibrium;
use emmy::motion::{Adaptivity, NewtonSettings, Record};
use emmy::prelude::*;

/// Two free bodies with a joint, which tumble.
fn tumbling(joint: Joint) -> (Body, State) {
    let body = Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("a", 2.0, [1.0, 0.0, 0.3], [0.5, 0.6, 0.8]))
        .rigid(RigidBody::new("b", 1.0, [-0.7, 0.4, 0.0], [0.3, 0.25, 0.2]))
        .joint(joint)
        .build()
        .unwrap();
    let flies = InitialVelocity { angular_velocity: [0.7, -1.1, 0.9], ..Default::default() };
    let state = State::initial(&body, 0.0, &[flies]).unwrap();
    (body, state)
}

fn started(body: &Body, scheme: Scheme, state: State) -> Motion<'_> {
    Motion::starting(body, scheme, NewtonSettings::default(), state).unwrap()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

/// A rod of length 1 and mass 1 between two points along an axis, with moments of inertia across and about it.
fn rod(name: &str, [a, b]: [[f64; 3]; 2], [across, about]: [f64; 2]) -> RigidBody {
    let along = (0..3).find(|&d| a[d] != b[d]).unwrap();
    let mut moments = [across; 3];
    moments[along] = about;
    RigidBody::new(name, 1.0, [0, 1, 2].map(|d| 0.5 * (a[d] + b[d])), moments)
}

/// Moments of a slender rod, none about itself.
const SLENDER: [f64; 2] = [1.0 / 12.0, 0.0];

/// Nothing determines the spin of a rod about itself, unless a joint holds it: balls do not.
#[test]
fn rods_need_a_joint_that_holds_their_spin() {
    let ends = [[0.0; 3], [0.0, 1.0, 0.0]];
    let ball = |name: &str, at| Joint::new(name, JointKind::Spherical, [rigid("rod"), JointEnd::Ground], at);
    let built = |joint: Joint| {
        Body::builder(Mesh::without_cells()).rigid(rod("rod", ends, SLENDER)).joint(joint).build()
    };
    assert!(built(hinge("foot", [rigid("rod"), JointEnd::Ground], ends[0], [0.0, 0.0, 1.0])).is_ok());
    for joint in [ball("foot", ends[0]), ball("top", ends[1])] {
        let error = built(joint).unwrap_err().to_string();
        assert!(error.contains("no joint holds its spin about [0, 1, 0]"), "{error}");
    }
}

/// The position of a point of a rigid body, from its place in the drawing.
fn position(body: &Body, record: &Record, name: &str, X: [f64; 3]) -> [f64; 3] {
    let number = body.rigid_bodies().position(|own| own.name == name).unwrap();
    let (own, motion) = (body.rigid_bodies().nth(number).unwrap(), record.rigid_bodies[number]);
    let centre = own.centre.unwrap();
    [0, 1, 2]
        .map(|d| motion.position[d] + (0..3).map(|i| motion.axes[i][d] * (X[i] - centre[i])).sum::<f64>())
}

/// Four-bars side by side (IFToMM A02): cranks on the ground, couplers between their tops, which start at a velocity.
fn four_bars(n: usize) -> (Body, InitialVelocity) {
    let z = [0.0, 0.0, 1.0];
    let mut builder = Body::builder(Mesh::without_cells());
    for i in 0..=n {
        let (foot, top, crank) = ([i as f64, 0.0, 0.0], [i as f64, 1.0, 0.0], format!("crank-{i}"));
        builder = builder.rigid(rod(&crank, [foot, top], SLENDER)).joint(hinge(
            &format!("foot-{i}"),
            [rigid(&crank), JointEnd::Ground],
            foot,
            z,
        ));
    }
    for i in 0..n {
        let ends = [[i as f64, 1.0, 0.0], [i as f64 + 1.0, 1.0, 0.0]];
        let coupler = format!("coupler-{i}");
        builder = builder.rigid(rod(&coupler, ends, SLENDER));
        for (side, end) in [i, i + 1].into_iter().zip(ends) {
            let between = [rigid(&coupler), rigid(&format!("crank-{side}"))];
            builder = builder.joint(hinge(&format!("top-{i}-{side}"), between, end, z));
        }
    }
    let body = builder.load(Load::acceleration([0.0, -9.81, 0.0])).build().unwrap();
    // Of a pure shear the joints allow what turns the cranks.
    let mut shear = InitialVelocity::default();
    shear.gradient[0][1] = 1.0;
    (body, shear)
}

/// A chain of a hundred bodies on hinges; the first hinge is driven, and the last body meets the first by a rod.
#[test]
fn a_hundred_hinged_bodies_are_counted() {
    let turns = TimeFunction::smooth("t", |t| [t, 1.0, 0.0]);
    let mut builder = Body::builder(Mesh::without_cells());
    let names: Vec<String> = (0..100).map(|i| format!("link-{i}")).collect();
    for (i, name) in names.iter().enumerate() {
        let x = i as f64;
        let other = if i == 0 { JointEnd::Ground } else { rigid(&names[i - 1]) };
        let axis = [0.3 * x.sin(), 0.2 * x.cos(), 1.0];
        let own = hinge(&format!("hinge-{i}"), [rigid(name), other], [x, 0.1 * x.cos(), 0.0], axis);
        builder = builder.rigid(RigidBody::new(name, 1.0, [x + 0.5, 0.0, 0.1], [0.1, 0.2, 0.2]));
        builder = builder.joint(if i == 0 { own.driven(turns.clone()) } else { own });
    }
    let kind = JointKind::Distance { to: [0.5, 0.0, 0.0] };
    let rod = Joint::new("rod", kind, [rigid("link-99"), rigid("link-0")], [99.5, 0.3, 0.0]);
    let body = builder.joint(rod).build().unwrap();
    let mobility = body.mobility();
    assert_eq!((mobility.n_constraints, mobility.n_redundant), (502, 0));
    assert_eq!((mobility.degrees_of_freedom, mobility.n_driven), (Some(99), 1));
}

#[test]
fn four_bars_move_as_their_cranks() {
    let exact = [[-0.195_020_302, -0.980_799_206, 0.0], [0.057_815_796, 0.998_327_268, 0.0]];
    let (body, _) = four_bars(2);
    let mobility = body.mobility();
    // Seven hinges; each loop of hinges has three constraints too many.
    assert_eq!((mobility.n_bodies, mobility.n_joints, mobility.n_constraints), (5, 7, 35));
    assert_eq!((mobility.n_redundant, mobility.degrees_of_freedom), (6, Some(1)));
    // The kinetic energy of cranks and couplers at 1 rad/s, and the fall of their centres.
    let start = {
        let turning = |group: &str, about: [f64; 3]| InitialVelocity {
            group: Some(group.into()),
            angular_velocity: [0.0, 0.0, -1.0],
            about,
            ..Default::default()
        };
        let cranks = (0..3).map(|i| turning(&format!("crank-{i}"), [i as f64, 0.0, 0.0]));
        let couplers = (0..2).map(|i| InitialVelocity {
            group: Some(format!("coupler-{i}")),
            velocity: [1.0, 0.0, 0.0],
            ..Default::default()
        });
        cranks.chain(couplers).collect::<Vec<_>>()
    };
    let energies = body.initial_energies(0.0, &start).unwrap();
    assert!((energies[0] - energies[1]).abs() < 1e-14, "{energies:?}");
    // Errors at the end of an independent implementation.
    for (k, h, expected) in [(1, 0.01, 1.568_318e-4), (2, 0.02, 3.533_342e-7)] {
        let state = State::initial(&body, 0.0, &start).unwrap();
        let mut motion = started(&body, at(DGM, k), state);
        let energy = motion.record().total_energy;
        let (mut work, mut error) = (0.0, 0.0);
        for (end, exact) in exact.into_iter().enumerate() {
            while motion.state().time < (end + 1) as f64 - 1e-9 {
                let record = motion.step(h).unwrap();
                assert!(record.constraint_residual < 1e-14, "k = {k}: {record:?}");
                assert!(record.energy_residual.abs() < 1e-12, "k = {k}: {record:?}");
                work = record.external_work;
            }
            let top = position(&body, motion.record(), "crank-0", [0.0, 1.0, 0.0]);
            error = distance(top, exact);
            assert!(error < 5.0 * expected, "k = {k}: {error:e}");
        }
        assert!((error / expected - 1.0).abs() < 0.02, "k = {k}: {error:e}");
        assert!((motion.record().total_energy - energy - work).abs() < 1e-11);
    }
}

/// Of more velocity than the joints allow a motion keeps the nearest part: the cranks turn by the mean of their ends.
#[test]
fn joints_take_what_they_do_not_allow_from_the_start() {
    let (body, shear) = four_bars(1);
    let shear = InitialVelocity { velocity: [0.3, 0.2, 0.0], ..shear };
    let [given, allowed] = body.initial_energies(0.0, std::slice::from_ref(&shear)).unwrap();
    assert!(allowed < given && allowed > 0.0, "{given} {allowed}");
    let state = State::initial(&body, 0.0, &[shear]).unwrap();
    let mut motion = started(&body, at(DGM, 2), state);
    assert!((motion.record().kinetic_energy - allowed).abs() < 1e-14);
    assert!(motion.record().hidden_constraint < 1e-14, "{:?}", motion.record());
    let spins: Vec<[f64; 3]> = motion.record().rigid_bodies.iter().map(|own| own.spin).collect();
    assert!(distance(spins[0], spins[1]) < 1e-13 && distance(spins[2], [0.0; 3]) < 1e-13, "{spins:?}");
    motion.step(0.05).unwrap();
}

/// Six hinges in a ring that moves only because its axes stand as they do: 7 of 66 constraints follow from the others.
#[test]
fn bricards_mechanism_moves_at_every_degree() {
    let exact = [
        (1.0, [0.510_501_461_188, -1.649_167_599_395, 0.140_123_114_553]),
        (2.0, [-0.969_340_344_777, -1.221_246_894_957, 0.754_278_010_778]),
    ];
    let corners = [[0., 0., 0.], [1., 0., 0.], [1., -1., 0.], [1., -1., 1.], [0., -1., 1.], [0., 0., 1.]];
    let axes = [[0., 1., 0.], [0., 0., 1.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 0., 0.]];
    let mut builder = Body::builder(Mesh::without_cells());
    for i in 0..5 {
        builder =
            builder.rigid(rod(&format!("rod-{i}"), [corners[i], corners[i + 1]], [1.01 / 12.0, 0.02 / 12.0]));
    }
    let end = |i: i32| if (0..5).contains(&i) { rigid(&format!("rod-{i}")) } else { JointEnd::Ground };
    for i in 0..6 {
        let between = [end(i as i32 - 1), end(i as i32)];
        builder = builder.joint(hinge(&format!("hinge-{i}"), between, corners[i], axes[i]));
    }
    let body = builder.load(Load::acceleration([0.0, -9.81, 0.0])).build().unwrap();
    let mobility = body.mobility();
    assert_eq!((mobility.n_redundant, mobility.degrees_of_freedom), (1, Some(1)));
    for (scheme, h, tolerance) in [
        (at(DGM, 1), 0.01, 3e-4),
        (at(DGM, 2), 0.05, 3e-5),
        (at(DGM, 3), 0.05, 1e-7),
        (at(assumed_strain(3), 2), 0.05, 3e-5),
    ] {
        let mut motion = Motion::new(&body, scheme).unwrap();
        for (time, exact) in exact {
            while motion.state().time < time - 1e-9 {
                let record = motion.step(h).unwrap();
                assert!(record.constraint_residual < 1e-13, "{scheme}: {record:?}");
                assert!(record.energy_residual.abs() < 1e-11, "{scheme}: {record:?}");
            }
            let point = position(&body, motion.record(), "rod-2", corners[3]);
            let error = distance(point, exact);
            assert!(error < tolerance, "{scheme} at {time}: {error:e}");
        }
        let record = motion.record();
        assert!((record.total_energy - record.external_work).abs() < 1e-11, "{scheme}: {record:?}");
    }
}

/// A body turns by a given angle against another one, both in free flight: the drive does the work of the energy.
#[test]
fn a_driven_hinge_turns_by_its_angle() {
    let law = TimeFunction::smooth("4*pi*(t/2 - sin(pi*t)/(2*pi))", |t| {
        [
            2.0 * PI * t - 2.0 * (PI * t).sin(),
            2.0 * PI * (1.0 - (PI * t).cos()),
            2.0 * PI * PI * (PI * t).sin(),
        ]
    });
    let axis = [0.3, -0.2, 0.9];
    let driven = hinge("drive", [rigid("a"), rigid("b")], [0.4, 0.1, -0.2], axis).driven(law);
    let (body, state) = tumbling(driven);
    for k in 1..=3 {
        let mut motion = started(&body, at(DGM, k), state.clone());
        let first = motion.record().clone();
        for _ in 0..40 {
            let record = motion.step(0.05).unwrap();
            assert!(record.energy_residual.abs() < 1e-11, "k = {k}: {record:?}");
            assert!(record.constraint_residual < 1e-13, "k = {k}: {record:?}");
            assert!(distance(record.angular_momentum, first.angular_momentum) < 1e-12, "k = {k}: {record:?}");
        }
        let last = motion.record();
        assert!((last.joints[0].coordinate - 4.0 * PI).abs() < 1e-12, "k = {k}: {:?}", last.joints);
        assert!((last.total_energy - first.total_energy - last.external_work).abs() < 1e-11);
    }
}

/// A body on a slider and one on a link whose motions are given: positions are those of the functions.
#[test]
fn driven_slides_and_distances_are_their_functions() {
    let law = || TimeFunction::smooth("0.3*t^2", |t| [0.3 * t * t, 0.6 * t, 0.6]);
    let axis = [0.0, 0.6, 0.8];
    let slider = Joint::new("s", JointKind::Prismatic { axis }, [rigid("cart"), JointEnd::Ground], [0.0; 3]);
    let link = JointKind::Distance { to: [0.0; 3] };
    let rope = Joint::new("l", link, [rigid("ball"), JointEnd::Ground], [2.0, 0.0, 0.0]);
    let body = Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("cart", 2.0, [1.0, 0.0, 0.0], [0.5, 0.6, 0.8]))
        .rigid(RigidBody::point("ball", 3.0, [2.0, 0.0, 0.0]))
        .joint(slider.driven(law()))
        .joint(rope.driven(law()))
        .build()
        .unwrap();
    for k in 1..=3 {
        let mut motion = Motion::new(&body, at(DGM, k)).unwrap();
        for _ in 0..10 {
            let record = motion.step(0.1).unwrap();
            assert!(record.energy_residual.abs() < 1e-12, "k = {k}: {record:?}");
        }
        let record = motion.record();
        let shift = axis.map(|a| 0.3 * a);
        assert!(distance(record.rigid_bodies[0].position, [1.0, shift[1], shift[2]]) < 1e-12, "{record:?}");
        assert!(distance(record.rigid_bodies[1].position, [2.3, 0.0, 0.0]) < 1e-12, "{record:?}");
        assert!((record.joints[1].coordinate - 2.3).abs() < 1e-12);
        // The masses 2 and 3 at an acceleration of 0.6.
        assert!((record.joints[0].drive - 1.2).abs() < 1e-10, "{:?}", record.joints);
        assert!((record.joints[1].drive - 1.8).abs() < 1e-10, "{:?}", record.joints);
    }
}

/// The force of a joint is the weight of what hangs on it, and its moment holds a cantilever.
#[test]
fn joints_report_their_forces() {
    for (between, sign) in [([rigid("arm"), JointEnd::Ground], 1.0), ([JointEnd::Ground, rigid("arm")], -1.0)]
    {
        let body = Body::builder(Mesh::without_cells())
            .rigid(RigidBody::new("arm", 2.0, [0.5, 0.0, 0.0], [0.1, 0.2, 0.2]))
            .joint(Joint::new("wall", JointKind::Fixed, between, [0.0; 3]))
            .load(Load::acceleration([0.0, 0.0, -10.0]))
            .build()
            .unwrap();
        let mut motion = Motion::new(&body, at(DGM, 2)).unwrap();
        let joint = motion.step(0.1).unwrap().joints[0];
        assert!(distance(joint.force, [0.0, 0.0, sign * 20.0]) < 1e-11, "{joint:?}");
        // The weight turns about +y with 0.5 * 20; the wall turns the arm back.
        assert!(distance(joint.moment, [0.0, -sign * 10.0, 0.0]) < 1e-11, "{joint:?}");
    }
}

/// A parallelogram drawn flat can fold in two ways, so a constraint more than elsewhere follows from the others. It
/// moves on in the way in which it starts.
#[test]
fn a_start_in_a_singular_position_takes_the_higher_rank() {
    let z = [0.0, 0.0, 1.0];
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let body = Body::builder(Mesh::without_cells())
        .rigid(rod("left", [points[0], points[1]], SLENDER))
        .rigid(rod("right", [points[1], points[2]], SLENDER))
        .rigid(rod("coupler", [points[1], points[2]], SLENDER))
        .joint(hinge("a", [rigid("left"), JointEnd::Ground], points[0], z))
        .joint(hinge("b", [rigid("right"), JointEnd::Ground], points[1], z))
        .joint(hinge("c", [rigid("coupler"), rigid("left")], points[1], z))
        .joint(hinge("d", [rigid("coupler"), rigid("right")], points[2], z))
        .build()
        .unwrap();
    assert_eq!((body.mobility().n_redundant, body.mobility().degrees_of_freedom), (4, Some(2)));
    let turning = |group: &str, about| InitialVelocity {
        group: Some(group.into()),
        angular_velocity: z,
        about,
        ..Default::default()
    };
    let lifted =
        InitialVelocity { group: Some("coupler".into()), velocity: [0.0, 1.0, 0.0], ..Default::default() };
    let start = [turning("left", points[0]), turning("right", points[1]), lifted];
    for k in 1..=3 {
        let state = State::initial(&body, 0.0, &start).unwrap();
        let mut motion = started(&body, at(DGM, k), state);
        for _ in 0..40 {
            let record = motion.step(0.05).unwrap();
            assert!(record.constraint_residual < 1e-13, "k = {k}: {record:?}");
            assert!(record.energy_residual.abs() < 1e-13, "k = {k}: {record:?}");
        }
        // Without forces the cranks turn evenly.
        let expected = [2.0f64.cos(), 2.0f64.sin(), 0.0];
        let left = position(&body, motion.record(), "left", points[1]);
        let right = position(&body, motion.record(), "right", points[2]);
        let tolerance = [2e-3, 1e-6, 1e-9][k - 1];
        assert!(distance(left, expected) < tolerance, "k = {k}: {left:?}");
        assert!(distance(right, [1.0 + left[0], left[1], 0.0]) < 1e-12, "k = {k}: {left:?} {right:?}");
    }
}

#[test]
fn given_motions_that_contradict_each_other_are_no_motion() {
    let law = |f: fn(f64) -> [f64; 3]| TimeFunction::smooth("turns", f);
    let z = [0.0, 0.0, 1.0];
    let with = |other: fn(f64) -> [f64; 3]| {
        let drive = |name: &str, f| hinge(name, [rigid("arm"), JointEnd::Ground], [0.0; 3], z).driven(law(f));
        Body::builder(Mesh::without_cells())
            .rigid(RigidBody::new("arm", 2.0, [0.5, 0.0, 0.0], [0.1, 0.2, 0.2]))
            .joint(drive("first", |t| [t, 1.0, 0.0]))
            .joint(drive("second", other))
            .build()
            .unwrap()
    };
    // At the start their rates tell, later the joints do.
    let names = ["first".to_string(), "second".to_string()];
    let error = State::initial(&with(|t| [2.0 * t, 2.0, 0.0]), 0.0, &[]).unwrap_err();
    assert!(matches!(&error, emmy::Error::NoMotion { driven, .. } if *driven == names), "{error}");
    let body = with(|t| [t + t * t, 1.0 + 2.0 * t, 2.0]);
    let error = Motion::new(&body, at(DGM, 2)).unwrap().step(0.1).unwrap_err();
    assert!(
        matches!(&error, emmy::Error::ConstraintsLost { driven, joints, .. } if [joints, driven] == [&names; 2]),
        "{error:?}"
    );
    // The same motion twice is no contradiction, but one torque suffices.
    let body = with(|t| [t, 1.0, 0.0]);
    let mobility = body.mobility();
    assert_eq!((mobility.redundant, mobility.n_redundant), (vec![names[1].clone()], 6));
    assert_eq!([mobility.indeterminate, mobility.indeterminate_drives], [names.to_vec(), names.to_vec()]);
    let mut motion = Motion::new(&body, at(DGM, 2)).unwrap();
    (0..10).for_each(|_| _ = motion.step(0.1).unwrap());
    assert!((motion.record().joints[0].coordinate - 1.0).abs() < 1e-12);
}

/// Two wheels spin freely and opposite on one axle, each by 2 rad a step: the ends of steps do not tell that they turn
/// by 4 rad against each other. A wheel under a constant torque turns by `t^2/2 torque/inertia`; no turn is lost.
#[test]
fn angles_are_counted_over_full_turns_within_a_step() {
    let axle = hinge("axle", [rigid("wheel"), JointEnd::Ground], [0.0; 3], [0.0, 0.0, 1.0]);
    let body = Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("wheel", 2.0, [0.0; 3], [0.4, 0.4, 0.5]))
        .joint(axle.with_motor(TimeFunction::constant()))
        .build()
        .unwrap();
    let run = |k: usize, h: f64, until: f64| {
        let mut motion = Motion::new(&body, at(DGM, k)).unwrap();
        let plan = StepPlan::new(0.0, vec![Phase { until, size: h }]).unwrap();
        motion.march(&plan, &mut []).unwrap();
        let (record, statistics) = (motion.record().clone(), motion.statistics().clone());
        (record.joints[0].coordinate, record.external_work, statistics.unresolved_turns)
    };
    for (k, h) in [(2, 0.05), (2, 0.1), (3, 0.1), (3, 0.125)] {
        let (angle, work, missed) = run(k, h, 10.0);
        assert!((angle - 100.0).abs() < PI && missed == 0, "k = {k}, {h}: {angle}, {missed}");
        assert!((work - 100.0).abs() < 1e-2, "k = {k}, {h}: {work}");
    }
    let z = [0.0, 0.0, 1.0];
    let free = hinge("axle", [rigid("left"), rigid("right")], [0.0; 3], z);
    let wheels = Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("left", 2.0, [0.0; 3], [0.4, 0.4, 0.5]))
        .rigid(RigidBody::new("right", 2.0, [0.0, 0.0, 1.0], [0.4, 0.4, 0.5]))
        .joint(free)
        .build()
        .unwrap();
    let spin = |group: &str, rate: f64| InitialVelocity {
        group: Some(group.into()),
        angular_velocity: z.map(|z| rate * z),
        ..Default::default()
    };
    for k in 2..=3 {
        let state = State::initial(&wheels, 0.0, &[spin("left", 2.0), spin("right", -2.0)]).unwrap();
        let mut motion = started(&wheels, at(DGM, k), state);
        (0..10).for_each(|_| _ = motion.step(1.0).unwrap());
        let angle = motion.record().joints[0].coordinate;
        assert!((angle - 40.0).abs() < PI, "k = {k}: {angle}");
        assert_eq!(motion.statistics().unresolved_turns, 0);
    }
    // Beyond half a turn a step the motion is not that of the wheel, and the run says so; at low degrees before.
    let (_, _, missed) = run(3, 0.5, 10.0);
    assert!(missed > 5, "{missed}");
    for (k, rate, coarse) in [(1, 1.0, 0), (1, 1.2, 10), (2, 2.8, 0), (2, 3.0, 10), (3, 3.1, 0)] {
        let state = State::initial(&wheels, 0.0, &[spin("left", rate)]).unwrap();
        let mut motion = started(&wheels, at(DGM, k), state);
        (0..10).for_each(|_| _ = motion.step(1.0).unwrap());
        assert_eq!(motion.statistics().unresolved_turns, coarse, "k = {k}, {rate}");
    }
}

/// A slider whose given speed jumps: with the impulse at the jump its energy and momentum are those of its speed.
#[test]
fn given_motions_may_have_kinks() {
    let speeds = TimeFunction::new(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 0.0), (2.0, 0.0)]).unwrap();
    let rail = JointKind::Prismatic { axis: [1.0, 0.0, 0.0] };
    let slider = Joint::new("rail", rail, [rigid("cart"), JointEnd::Ground], [0.0; 3]).driven(speeds);
    let body = Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("cart", 3.0, [0.0; 3], [0.5, 0.6, 0.8]))
        .joint(slider)
        .build()
        .unwrap();
    // Steps that end at the kinks, and steps that do not.
    for (k, n) in (1..=3).flat_map(|k| [20, 19].map(|n| (k, n))) {
        let mut motion = Motion::new(&body, at(DGM, k)).unwrap();
        for step in 1..=n {
            let record = motion.step(1.6 / n as f64).unwrap();
            assert!(record.energy_residual.abs() < 1e-12, "k = {k}, {n}: {record:?}");
            assert!(record.linear_momentum_residual < 1e-12, "k = {k}, {n}: {record:?}");
            let speed = match 1.6 * step as f64 / n as f64 {
                t if t < 0.5 - 1e-9 => 2.0,
                t if t < 1.0 - 1e-9 => -2.0,
                _ => 0.0,
            };
            let momentum = record.linear_momentum[0];
            assert!((momentum - 3.0 * speed).abs() < 1e-11, "k = {k}, {n}, step {step}: {momentum}");
            assert!((record.kinetic_energy - 1.5 * speed * speed).abs() < 1e-11);
        }
    }
}

/// Where steps end at the kinks of a given motion, its force has no part in the impulse there, whose work is booked.
#[test]
fn impulses_at_kinks_are_in_no_force() {
    let speeds = TimeFunction::new(vec![(0.0, 0.0), (0.2, 0.0), (0.6, 0.8), (1.0, 0.8)]).unwrap();
    let rail = JointKind::Prismatic { axis: [1.0, 0.0, 0.0] };
    let slider = Joint::new("rail", rail, [rigid("cart"), JointEnd::Ground], [0.0; 3]).driven(speeds);
    let cart = RigidBody::new("cart", 3.0, [0.0; 3], [0.5, 0.6, 0.8]);
    let body = Body::builder(Mesh::without_cells()).rigid(cart).joint(slider).build().unwrap();
    let mut motion = Motion::new(&body, at(DGM, 2)).unwrap();
    for step in 1..=10 {
        let record = motion.step(0.1).unwrap();
        assert!(record.joints[0].drive.abs() < 1e-7, "step {step}: {record:?}");
        let kinetic = if (2..6).contains(&step) { 1.5 * 4.0 } else { 0.0 };
        assert!((record.external_work - kinetic).abs() < 1e-11, "step {step}: {record:?}");
    }
}

/// A ball on a spring of zero length in rest to the ground: an ellipse, whose period is that of the oscillator; and a
/// damped and driven hinge, whose energies are booked.
#[test]
fn springs_dampers_and_motors_of_joints_are_booked() {
    let free = [rigid("a"), rigid("b")];
    let (axis, place) = ([0.3, -0.2, 0.9], [0.4, 0.1, -0.2]);
    let motor = || {
        TimeFunction::smooth("0.5*sin(3*t)", |t| {
            [0.5 * (3.0 * t).sin(), 1.5 * (3.0 * t).cos(), -4.5 * (3.0 * t).sin()]
        })
    };
    let line = JointKind::Line { to: [-1.0, 0.2, 0.1] };
    let joints = [
        ("torsion spring", hinge("j", free.clone(), place, axis).with_spring(4.0, None)),
        ("wound spring", hinge("j", free.clone(), place, axis).with_spring(4.0, Some(1.0))),
        ("damper", hinge("j", free.clone(), place, axis).with_damping(0.3)),
        ("motor", hinge("j", free.clone(), place, axis).with_motor(motor())),
        ("line", Joint::new("j", line, free.clone(), place).with_spring(20.0, Some(1.0)).with_damping(0.2)),
        (
            "slide",
            Joint::new("j", JointKind::Prismatic { axis }, free, place)
                .with_spring(9.0, Some(0.2))
                .with_damping(0.1)
                .with_motor(motor()),
        ),
    ];
    for (name, joint) in joints {
        let (body, state) = tumbling(joint);
        for k in 1..=3 {
            let mut motion = started(&body, at(DGM, k), state.clone());
            let first = motion.record().clone();
            for _ in 0..40 {
                let record = motion.step(0.05).unwrap();
                assert!(record.energy_residual.abs() < 1e-12, "{name}, k = {k}: {record:?}");
                let change = distance(record.angular_momentum, first.angular_momentum);
                assert!(change < 1e-11, "{name}, k = {k}: {change:e}");
            }
            let last = motion.record();
            let balance =
                last.total_energy - first.total_energy - last.external_work + last.dissipated_energy;
            assert!(balance.abs() < 1e-11, "{name}, k = {k}: {balance:e}");
            assert_eq!(last.dissipated_energy > 1e-3, ["damper", "line", "slide"].contains(&name), "{name}");
            assert_eq!(last.external_work != 0.0, ["motor", "slide"].contains(&name), "{name}");
        }
    }
}

/// A wheel on a torsion spring and a damper: `theta = e^(-d t) (cos w t + d/w sin w t) theta_0`.
#[test]
fn a_wheel_on_a_spring_swings_as_an_oscillator() {
    let (stiffness, damping, inertia, angle) = (4.0f64, 0.3, 0.8, 1.0);
    let wheel = hinge("axle", [rigid("wheel"), JointEnd::Ground], [0.0; 3], [0.0, 0.0, 1.0]);
    let body = Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("wheel", 2.0, [0.0; 3], [0.5, 0.5, inertia]))
        .joint(wheel.with_spring(stiffness, Some(-angle)).with_damping(damping))
        .build()
        .unwrap();
    let d = 0.5 * damping / inertia;
    let w = (stiffness / inertia - d * d).sqrt();
    let exact = |t: f64| (-d * t).exp() * ((w * t).cos() + d / w * (w * t).sin()) * angle - angle;
    for (k, h, tolerance) in [(1, 0.01, 2e-4), (2, 0.05, 2e-5), (3, 0.1, 1e-6)] {
        let mut motion = Motion::new(&body, at(DGM, k)).unwrap();
        for _ in 0..(2.0f64 / h).round() as usize {
            let record = motion.step(h).unwrap();
            assert!(record.angular_momentum_residual < 1e-13, "k = {k}: {record:?}");
        }
        let error = motion.record().joints[0].coordinate - exact(2.0);
        assert!(error.abs() < tolerance, "k = {k}: {error:e}");
    }
}

/// A wheel on a torsion spring with a stiffness of 0.05 and an inertia of 0.8.
fn wound(axle: impl FnOnce(Joint) -> Joint) -> Body {
    let wheel = hinge("axle", [rigid("wheel"), JointEnd::Ground], [0.0; 3], [0.0, 0.0, 1.0]);
    Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("wheel", 2.0, [0.0; 3], [0.5, 0.5, 0.8]))
        .joint(axle(wheel.with_spring(0.05, None)))
        .build()
        .unwrap()
}

/// A spring is wound up by seven turns and unwinds: `theta = w_0/w sin w t`. The angle is a part of the state.
#[test]
fn springs_are_wound_up_over_full_turns() {
    let body = wound(|axle| axle);
    let (w, spin) = ((0.05f64 / 0.8).sqrt(), 12.0);
    let field = InitialVelocity { angular_velocity: [0.0, 0.0, spin], ..Default::default() };
    let state = State::initial(&body, 0.0, &[field]).unwrap();
    // A step turns by the diagonal Pade approximation of the exponential, with the error x^(2k+1)/c. The torque of the
    // spring adds some of the same order.
    for (k, h, c) in [(1, 0.025, 12.0), (2, 0.1, 720.0), (3, 0.1, 100_800.0)] {
        let tolerance = 1.5 * spin / w * (spin * h).powi(2 * k as i32) / c;
        let mut motion = started(&body, at(DGM, k), state.clone());
        let energy = motion.record().total_energy;
        let (mut largest, mut resumed) = (0f64, None);
        for step in 0..(12.0f64 / h).round() as usize {
            if step == 60 {
                let snapshot = motion.snapshot();
                let settings = NewtonSettings::default();
                resumed = Some(Motion::resumed(&body, at(DGM, k), settings, snapshot).unwrap());
            }
            let record = motion.step(h).unwrap();
            assert!((record.total_energy - energy).abs() < 1e-11 * energy, "k = {k}: {record:?}");
            let angle = record.joints[0].coordinate;
            let spring = 0.5 * 0.05 * angle * angle;
            assert!((record.strain_energy - spring).abs() < 1e-12 * energy, "k = {k}: {record:?}");
            let error = angle - spin / w * (w * record.time).sin();
            assert!(error.abs() < tolerance, "k = {k}: {error:e}");
            largest = largest.max(angle);
            if let Some(resumed) = &mut resumed {
                assert_eq!(resumed.step(h).unwrap(), record, "k = {k}");
            }
        }
        assert!((largest - spin / w).abs() < tolerance + 0.02, "k = {k}: {largest}");
    }
}

/// A motor winds up the spring at rest, by 8 rad, and goes on holding it in a motion.
#[test]
fn springs_are_wound_up_at_rest() {
    let body = wound(|axle| axle.with_motor(TimeFunction::new(vec![(0.0, 0.4)]).unwrap()));
    let found = Equilibrium::new(&body, 0.0, 10).unwrap();
    let state = found.start(NewtonSettings::default(), &[], &mut []).unwrap();
    let mut motion = started(&body, at(DGM, 2), state);
    for _ in 0..10 {
        let record = motion.record();
        assert!((record.joints[0].coordinate - 8.0).abs() < 1e-9, "{record:?}");
        assert!((record.strain_energy - 0.025 * 64.0).abs() < 1e-9, "{record:?}");
        motion.step(0.1).unwrap();
    }
}

/// A pendulum on a hinge, released at 2 rad from below, in the plane of x and z.
fn pendulum() -> Body {
    let centre = [0.5 * 2f64.sin(), 0.0, -0.5 * 2f64.cos()];
    let pendulum = RigidBody::new("pendulum", 3.0, centre, [0.3, 0.4, 0.2]);
    Body::builder(Mesh::without_cells())
        .rigid(pendulum)
        .joint(hinge("pivot", [rigid("pendulum"), JointEnd::Ground], [0.0; 3], [0.0, 1.0, 0.0]))
        .load(Load::acceleration([0.0, 0.0, -9.81]))
        .build()
        .unwrap()
}

/// Errors of adaptive steps are those that they are asked for: velocities that joints allow are estimated.
#[test]
fn adaptive_steps_know_joints() {
    let exact = [0.485_256_525_325_571_6, 0.0, -0.120_524_290_617_920_1];
    let body = pendulum();
    for k in 1..=3 {
        let mut last = f64::INFINITY;
        for tolerance in [1e-4, 1e-6] {
            let mut motion = Motion::new(&body, at(DGM, k)).unwrap();
            let plan = StepPlan::adaptive(0.0, 2.0, Adaptivity::new(tolerance)).unwrap();
            motion.march(&plan, &mut []).unwrap();
            let error = distance(motion.record().rigid_bodies[0].position, exact);
            assert!(error < 100.0 * tolerance, "k = {k}, {tolerance:e}: {error:e}");
            assert!(error < 0.3 * last, "k = {k}, {tolerance:e}: {error:e}");
            assert!(motion.record().constraint_residual < 1e-13);
            last = error;
        }
    }
}

/// The torque of a drive, J 3.6 t^2, is that in the middle of the step up to an error of order h^2 at every degree.
#[test]
fn torques_belong_to_the_middle_of_a_step() {
    let law = TimeFunction::smooth("0.3*t^4", |t| [0.3 * t.powi(4), 1.2 * t.powi(3), 3.6 * t * t]);
    let pin = hinge("pin", [rigid("bar"), JointEnd::Ground], [0.0; 3], [0.0, 0.0, 1.0]).driven(law);
    let bar = RigidBody::new("bar", 2.0, [0.5, 0.0, 0.0], [0.3, 0.3, 0.4]);
    let body = Body::builder(Mesh::without_cells()).rigid(bar).joint(pin).build().unwrap();
    for k in 1..=3 {
        let [coarse, fine] = [0.025, 0.0125].map(|h: f64| {
            let mut motion = Motion::new(&body, at(DGM, k)).unwrap();
            let mut error = 0.0f64;
            for _ in 0..(1.0 / h).round() as usize {
                let record = motion.step(h).unwrap();
                let exact = 0.9 * 3.6 * (record.time - 0.5 * h).powi(2);
                error = error.max((record.joints[0].drive - exact).abs());
            }
            error
        });
        assert!((1.8..2.2).contains(&(coarse / fine).log2()), "k = {k}: {coarse:e} {fine:e}");
        assert!(fine < 0.01, "k = {k}: {fine:e}");
    }
}

/// Schemes with dissipation lose the energy that they book, and neither momenta nor joints.
#[test]
fn dissipative_schemes_keep_joints() {
    let sprung =
        hinge("h", [rigid("a"), rigid("b")], [0.4, 0.1, -0.2], [0.3, -0.2, 0.9]).with_spring(50.0, Some(0.3));
    let (body, state) = tumbling(sprung);
    for k in 1..=2 {
        let mut motion = started(&body, at(dgm(0.5), k), state.clone());
        let mut last = motion.record().clone();
        let angular = last.angular_momentum;
        for _ in 0..40 {
            let record = motion.step(0.05).unwrap().clone();
            assert!(record.energy_residual.abs() < 1e-12, "k = {k}: {record:?}");
            assert!(record.total_energy <= last.total_energy + 1e-13, "k = {k}: {record:?}");
            assert!(distance(record.angular_momentum, angular) < 1e-12, "k = {k}: {record:?}");
            assert!(record.constraint_residual < 1e-13, "k = {k}: {record:?}");
            last = record;
        }
        assert!(last.dissipated_energy > 1e-6, "k = {k}: {last:?}");
    }
}

/// Two discs on one axis turn steadily against each other, each in a relative equilibrium: for k = 1 nothing dissipates
/// that, as the motion of one body relative to the other is no deformation.
#[test]
fn dissipation_spares_bodies_that_turn_against_each_other() {
    let axis = [0.0, 0.0, 1.0];
    let body = Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("a", 2.0, [0.0; 3], [0.5, 0.5, 0.8]))
        .rigid(RigidBody::new("b", 1.0, [0.0, 0.0, 0.3], [0.3, 0.3, 0.4]))
        .joint(hinge("shaft", [rigid("a"), rigid("b")], [0.0, 0.0, 0.1], axis))
        .build()
        .unwrap();
    let turns = |group: &str, spin: f64| InitialVelocity {
        group: Some(group.into()),
        angular_velocity: [0.0, 0.0, spin],
        ..Default::default()
    };
    let state = State::initial(&body, 0.0, &[turns("a", 1.0), turns("b", -2.0)]).unwrap();
    let mut motion = started(&body, at(dgm(0.5), 1), state);
    let energy = motion.record().total_energy;
    assert!((energy - 1.2).abs() < 1e-14, "{energy}"); // (0.8 1^2 + 0.4 2^2)/2
    (0..40).for_each(|_| _ = motion.step(0.1).unwrap());
    assert!((motion.record().total_energy - energy).abs() < 1e-13, "{:?}", motion.record());
}

/// A motion goes on bit for bit, with its angles over full turns and its rank.
#[test]
fn mechanisms_are_resumed_bit_for_bit() {
    let (body, _) = four_bars(2);
    for scheme in [at(DGM, 2), at(dgm(0.8), 1)] {
        let mut motion = Motion::new(&body, scheme).unwrap();
        (0..8).for_each(|_| _ = motion.step(0.1).unwrap());
        let snapshot = motion.snapshot();
        let mut resumed = Motion::resumed(&body, scheme, NewtonSettings::default(), snapshot).unwrap();
        for _ in 0..8 {
            assert_eq!(resumed.step(0.1).unwrap(), motion.step(0.1).unwrap());
            assert_eq!(resumed.state(), motion.state());
        }
    }
}
