//! Rigid bodies and joints, without a mesh. Exact solutions are by elliptic functions and quadrature, errors of the
//! method those of an independent implementation.

#![allow(non_snake_case)]

use crate::shared::joints::rigid;
use crate::shared::schemes::{DGM, at};
use emmy::motion::{NewtonSettings, Record};
use emmy::prelude::*;

const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

fn joint(kind: JointKind, between: [JointEnd; 2], at: [f64; 3]) -> Joint {
    Joint::new("joint", kind, between, at)
}

/// A heavy rigid body that a joint at the origin joins to the ground.
fn hung(body: RigidBody, kind: JointKind) -> Body {
    let joint = joint(kind, [rigid(&body.name), JointEnd::Ground], [0.0; 3]);
    let builder = Body::builder(Mesh::without_cells()).rigid(body).joint(joint);
    builder.load(Load::acceleration(GRAVITY)).build().unwrap()
}

/// Nodes of a rigid body: centre and ends of the axes.
fn frame(body: &Body, name: &str) -> [u32; 4] {
    let begin = body.nodes_of_rigid_body(name).unwrap().start;
    [begin, begin + 1, begin + 2, begin + 3]
}

fn spin(angular_velocity: [f64; 3]) -> InitialVelocity {
    InitialVelocity { angular_velocity, ..Default::default() }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

/// Runs to a time. Returns the motion's state and the records of all steps.
fn run(body: &Body, scheme: Scheme, start: &InitialVelocity, h: f64, until: f64) -> (State, Vec<Record>) {
    let state = State::initial(body, 0.0, std::slice::from_ref(start)).unwrap();
    let mut motion = Motion::starting(body, scheme, NewtonSettings::default(), state).unwrap();
    let steps = (until / h).round() as usize;
    let records = (0..steps).map(|_| motion.step(h).unwrap().clone()).collect();
    (motion.state().clone(), records)
}

#[test]
fn a_rigid_pendulum_on_a_hinge_has_the_errors_of_the_method() {
    let exact = [0.4852565253255716, 0.0, -0.1205242906179201];
    let centre = [0.5 * 2f64.sin(), 0.0, -0.5 * 2f64.cos()];
    let pendulum = RigidBody::new("pendulum", 3.0, centre, [0.3, 0.4, 0.2]);
    let body = hung(pendulum, JointKind::Revolute { axis: [0.0, 1.0, 0.0] });
    let node = body.nodes_of_rigid_body("pendulum").unwrap().start as usize;
    for (k, h, expected) in [(1, 0.01, 6.919_155e-4), (2, 0.02, 1.162_718e-6), (3, 0.05, 1.289_744e-7)] {
        let (state, records) = run(&body, at(DGM, k), &spin([0.0; 3]), h, 2.0);
        let error = distance(state.position(&body, node), exact);
        assert!((error / expected - 1.0).abs() < 0.02, "k = {k}: {error:e} is not {expected:e}");
        for record in &records {
            assert!(
                record.energy_residual.abs() < 1e-11 && record.linear_momentum_residual < 1e-11,
                "{record:?}"
            );
        }
    }
}

#[test]
fn a_free_top_turns_by_the_elliptic_functions() {
    // The axes in space.
    let exact = [
        [0.615815258840697, -0.35433097807812175, -0.7037194930888011],
        [-0.5620366633795358, -0.8235028316287469, -0.0771872743179245],
        [-0.5521651528267182, 0.4430492571640728, -0.7062726100665373],
    ];
    let top = RigidBody::new("top", 1.0, [0.0; 3], [0.4, 0.5, 0.8]);
    let body = Body::builder(Mesh::without_cells()).rigid(top).build().unwrap();
    let nodes = frame(&body, "top");
    let flies = spin([0.1, 3.0, 0.2]);
    for (k, h, expected) in [(1, 0.01, 9.543_365e-4), (2, 0.05, 1.005_370e-5), (3, 0.1, 1.727_162e-7)] {
        let (state, records) = run(&body, at(DGM, k), &flies, h, 5.0);
        let [centre, ends @ ..] = nodes.map(|node| state.position(&body, node as usize));
        let size = distance(body.mesh().points()[nodes[1] as usize], [0.0; 3]);
        let axes = ends.map(|end| [0, 1, 2].map(|d| (end[d] - centre[d]) / size));
        let error = (0..9).map(|at| (axes[at / 3][at % 3] - exact[at / 3][at % 3]).abs()).fold(0.0, f64::max);
        assert!((error / expected - 1.0).abs() < 0.02, "k = {k}: {error:e} is not {expected:e}");
        for record in &records {
            assert!((record.total_energy - 2.268).abs() < 1e-12, "{record:?}");
            assert!(distance(record.angular_momentum, [0.04, 1.5, 0.16]) < 1e-13, "{record:?}");
        }
    }
}

#[test]
fn a_heavy_top_nods_and_precesses() {
    let exact = [0.5095952148872175, -0.24667568140632803, 0.8242959572670331];
    let axis = [0.0, -(0.6f64.sin()), 0.6f64.cos()];
    let inertia =
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| 0.2 * axis[i] * axis[j] + if i == j { 0.3 } else { 0.0 }));
    let top = RigidBody { inertia: Some(inertia), ..RigidBody::point("top", 1.0, axis) };
    let body = hung(top, JointKind::Spherical);
    let centre = body.nodes_of_rigid_body("top").unwrap().start as usize;
    for (k, h, expected) in [(1, 0.0025, 8.564_459e-5), (2, 0.01, 2.152_286e-6), (3, 0.02, 1.170_326e-7)] {
        let (state, records) = run(&body, at(DGM, k), &spin(axis.map(|a| 20.0 * a)), h, 1.0);
        let error = distance(state.position(&body, centre), exact);
        assert!((error / expected - 1.0).abs() < 0.02, "k = {k}: {error:e} is not {expected:e}");
        for record in &records {
            assert!(
                record.energy_residual.abs() < 1e-11 && record.angular_momentum_residual < 1e-11,
                "{record:?}"
            );
        }
    }
}

/// Two bodies that tumble: no joint has a resultant or a moment, does work, or opens.
#[test]
fn every_kind_of_joint_keeps_energy_momenta_and_itself() {
    let axis = [0.3, -0.2, 0.9];
    let kinds = [
        JointKind::Spherical,
        JointKind::Revolute { axis },
        JointKind::Universal { axes: [axis, [1.0, 0.2, 0.1]] },
        JointKind::Cylindrical { axis },
        JointKind::Prismatic { axis },
        JointKind::Inline { axis },
        JointKind::Planar { axis },
        JointKind::Fixed,
    ];
    for (kind, k) in kinds.into_iter().flat_map(|kind| (1..=3).map(move |k| (kind, k))) {
        let place = [0.4, 0.1, -0.2];
        let own = joint(kind, [rigid("a"), rigid("b")], place);
        let body = Body::builder(Mesh::without_cells())
            .rigid(RigidBody::new("a", 2.0, [1.0, 0.0, 0.3], [0.5, 0.6, 0.8]))
            .rigid(RigidBody::new("b", 1.0, [-0.7, 0.4, 0.0], [0.3, 0.25, 0.2]))
            .joint(own)
            .build()
            .unwrap();
        let start = InitialVelocity { velocity: [0.1, 0.2, -0.3], ..spin([0.7, -1.1, 0.9]) };
        let (state, records) = run(&body, at(DGM, k), &start, 0.05, 2.0);
        let (first, last) = (&records[0], &records[39]);
        let drift = (last.total_energy - first.total_energy).abs() / first.total_energy;
        assert!(drift < 1e-12, "{kind:?}, k = {k}: {drift:e}");
        for record in &records {
            assert!(distance(record.linear_momentum, first.linear_momentum) < 1e-12, "{kind:?}: {record:?}");
            assert!(
                distance(record.angular_momentum, first.angular_momentum) < 1e-12,
                "{kind:?}: {record:?}"
            );
        }
        // The bodies move as one at first, but turn apart if the joint lets them.
        let frames = ["a", "b"].map(|name| frame(&body, name));
        let axes = frames.map(|nodes| {
            let [centre, ends @ ..] = nodes.map(|node| state.position(&body, node as usize));
            let size =
                distance(body.mesh().points()[nodes[0] as usize], body.mesh().points()[nodes[1] as usize]);
            ends.map(|end| [0, 1, 2].map(|d| (end[d] - centre[d]) / size))
        });
        for own in axes {
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                let product: f64 = (0..3).map(|d| own[i][d] * own[j][d]).sum();
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((product - expected).abs() < 1e-12, "{kind:?}, k = {k}: {product}");
            }
        }
        let apart = (0..3).map(|i| distance(axes[0][i], axes[1][i])).fold(0.0, f64::max);
        let turns = !matches!(kind, JointKind::Fixed | JointKind::Prismatic { .. });
        assert_eq!(apart > 1e-3, turns, "{kind:?}, k = {k}: {apart:e}");
    }
}

/// An elastic door on a rigid frame, numbers of an independent implementation.
#[test]
fn a_door_swings_on_a_flying_frame_as_elsewhere() {
    let mesh = mesh::block([3.0, 0.5, 2.0], [3, 1, 2]).unwrap();
    let node = |X: [f64; 3]| mesh.points().iter().position(|Y| distance(*Y, X) < 1e-12).unwrap();
    let hinges = [[0.0; 3], [0.0, 0.0, 2.0]];
    let corner = node([3.0, 0.0, 0.0]);
    let rubber = Region::new(NeoHooke::new(4000.0, 2000.0).unwrap(), 1.0);
    let mut builder = Body::builder(mesh.clone()).region(rubber).rigid(RigidBody::new(
        "frame",
        5.0,
        [-0.5, 0.0, 1.0],
        [2.0, 2.5, 1.0],
    ));
    for place in hinges {
        let ends = [JointEnd::Node(node(place) as u32), rigid("frame")];
        builder = builder.joint(joint(JointKind::Spherical, ends, place));
    }
    let body = builder.build().unwrap();
    let centre = body.nodes_of_rigid_body("frame").unwrap().start as usize;
    let swing = InitialVelocity { group: Some("body".into()), ..spin([0.2, 0.1, 2.3]) };
    for (k, h, kinetic, strain, at_corner, at_centre) in [
        (
            1,
            0.05,
            22.656310899953493,
            0.12993910004505801,
            [-2.207360915742579, 0.5112459089585566, 0.4616972598228196],
            [0.5966932254937707, 2.4454681235573377, 0.7919468901554889],
        ),
        (
            2,
            0.05,
            22.676734905857177,
            0.10951509414249672,
            [-2.2054562791101127, 0.5005178502045893, 0.46761605011585133],
            [0.5966190919652725, 2.447056135250055, 0.7917096507575111],
        ),
        (
            3,
            0.1,
            22.675751632788305,
            0.11049836721260087,
            [-2.2051846707690235, 0.5009365567802221, 0.4671732340788525],
            [0.5964951864594819, 2.4470423848866334, 0.7916725165529851],
        ),
    ] {
        let state = State::initial(&body, 0.0, &[spin([0.2, 0.1, 0.3]), swing.clone()]).unwrap();
        let mut motion = Motion::starting(&body, at(DGM, k), NewtonSettings::default(), state).unwrap();
        let mut corrections = 0;
        for _ in 0..(2.0f64 / h).round() as usize {
            let record = motion.step(h).unwrap();
            corrections += record.newton_iterations;
            assert!(
                record.energy_residual.abs() < 1e-11 && record.angular_momentum_residual < 1e-11,
                "{record:?}"
            );
        }
        let record = motion.record();
        assert!((record.kinetic_energy - kinetic).abs() < 1e-8, "k = {k}: {}", record.kinetic_energy);
        assert!((record.strain_energy - strain).abs() < 1e-8, "k = {k}: {}", record.strain_energy);
        for (node, expected) in [(corner, at_corner), (centre, at_centre)] {
            let q = motion.state().position(&body, node);
            assert!(distance(q, expected) < 1e-8, "k = {k}: {q:?}");
        }
        assert!(corrections < 800, "k = {k}: {corrections}");
    }
}

/// A constant moment about a principal axis: the angle is M t^2 / (2 J), the angular momentum M t.
#[test]
fn a_moment_about_a_principal_axis_turns_a_body_as_a_motor_does() {
    let wheel = || RigidBody::new("wheel", 2.0, [0.3, 0.1, -0.2], [0.1, 0.12, 0.18]);
    let turned = |load: Load| Body::builder(Mesh::without_cells()).rigid(wheel()).load(load).build().unwrap();
    let body = turned(Load::moment("wheel", [0.0, 0.0, 0.36]));
    let resultant = body.load_resultants()[0];
    assert!(
        distance(resultant.torque, [0.0, 0.0, 0.36]) < 1e-16 && distance(resultant.force, [0.0; 3]) < 1e-16
    );
    let angle = |k: usize, h: f64| {
        let (_, records) = run(&body, at(DGM, k), &spin([0.0; 3]), h, 2.0);
        for record in &records {
            let momentum = [0.0, 0.0, 0.36 * record.time];
            assert!(distance(record.angular_momentum, momentum) < 1e-12, "k = {k}: {record:?}");
            assert!(distance(record.linear_momentum, [0.0; 3]) < 1e-13);
            assert!(record.energy_residual.abs() < 1e-12 && record.angular_momentum_residual < 1e-12);
            assert!((record.total_energy - record.external_work).abs() < 1e-12, "k = {k}: {record:?}");
            assert!(
                record.constraint_residual < 1e-14 && record.newton_iterations <= 8,
                "k = {k}: {record:?}"
            );
        }
        let axis = records.last().unwrap().rigid_bodies[0].axes[0];
        axis[1].atan2(axis[0])
    };
    // 4 rad, less a turn.
    let exact = 4.0 - 2.0 * std::f64::consts::PI;
    for (k, h) in [(1, 0.05), (2, 0.1), (3, 0.2)] {
        let errors = [h, 0.5 * h].map(|h| (angle(k, h) - exact).abs());
        let order = (errors[0] / errors[1]).log2();
        assert!((order - 2.0 * k as f64).abs() < 0.15 && errors[1] < 2e-3, "k = {k}: {errors:?}, {order}");
    }
    assert!((angle(4, 0.05) - exact).abs() < 1e-12, "{:e}", angle(4, 0.05) - exact);
    // A history: L is its integral.
    let history = TimeFunction::smooth("t^3", |t| [t * t * t, 3.0 * t * t, 6.0 * t]);
    let body = turned(Load::moment("wheel", [0.2, -0.1, 0.3]).with_time_function(history));
    for k in 1..=3 {
        let (_, records) = run(&body, at(DGM, k), &spin([0.3, -0.2, 0.1]), 0.1, 2.0);
        // J w and the centre's part, c x m (w x c).
        let start = [0.3 * 0.1 + 0.054, -0.2 * 0.12 - 0.066, 0.1 * 0.18 + 0.048];
        for record in &records {
            let growth = record.time.powi(4) / 4.0;
            let momentum = [0, 1, 2].map(|d| start[d] + growth * [0.2, -0.1, 0.3][d]);
            assert!(distance(record.angular_momentum, momentum) < 1e-12, "k = {k}: {record:?}");
            assert!(record.energy_residual.abs() < 1e-12, "k = {k}: {record:?}");
        }
    }
}

/// A large moment on a tumbling symmetric top on its tip: the angular momentum about the tip is that of gravity and of
/// the moment; without gravity L = L0 + M t about the centre of a free one.
#[test]
fn a_heavy_moment_on_a_top_keeps_the_balances() {
    let moment = [3.0, -2.0, 4.0];
    let free = RigidBody::new("top", 1.0, [0.0; 3], [0.3, 0.3, 0.5]);
    let body =
        Body::builder(Mesh::without_cells()).rigid(free).load(Load::moment("top", moment)).build().unwrap();
    for k in 1..=3 {
        let (_, records) = run(&body, at(DGM, k), &spin([1.0, 2.0, 20.0]), 0.05, 2.0);
        for record in &records {
            let momentum = [0, 1, 2].map(|d| [0.3, 0.6, 10.0][d] + record.time * moment[d]);
            assert!(distance(record.angular_momentum, momentum) < 1e-12, "k = {k}: {record:?}");
            assert!(record.energy_residual.abs() < 1e-11, "k = {k}: {record:?}");
        }
        let (first, last) = (&records[0], records.last().unwrap());
        let energy = 0.5 * (0.3 + 1.2 + 200.0);
        assert!((last.total_energy - last.external_work - energy).abs() < 1e-11, "k = {k}: {last:?}");
        assert!(last.newton_iterations <= first.newton_iterations + 4, "k = {k}: {last:?}");
    }
    let axis = [0.0, -(0.6f64.sin()), 0.6f64.cos()];
    let inertia =
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| 0.2 * axis[i] * axis[j] + if i == j { 0.3 } else { 0.0 }));
    let top = RigidBody { inertia: Some(inertia), ..RigidBody::point("top", 1.0, axis) };
    let tip = joint(JointKind::Spherical, [rigid("top"), JointEnd::Ground], [0.0; 3]);
    let builder = Body::builder(Mesh::without_cells()).rigid(top).joint(tip);
    let body = builder.load(Load::acceleration(GRAVITY)).load(Load::moment("top", moment)).build().unwrap();
    let (_, records) = run(&body, at(DGM, 2), &spin(axis.map(|a| 20.0 * a)), 0.01, 1.0);
    for record in &records {
        assert!(
            record.energy_residual.abs() < 1e-12 && record.angular_momentum_residual < 1e-12,
            "{record:?}"
        );
        assert!(record.linear_momentum_residual < 1e-12 && record.constraint_residual < 1e-14, "{record:?}");
    }
}

#[test]
fn moments_need_directions() {
    let ball = RigidBody::point("ball", 1.0, [0.0; 3]);
    let refused = |builder: emmy::body::BodyBuilder| builder.build().unwrap_err().to_string();
    let builder =
        Body::builder(Mesh::without_cells()).rigid(ball).load(Load::moment("ball", [0.0, 0.0, 1.0]));
    assert_eq!(refused(builder), "a moment acts on a rigid body with an inertia, and \"ball\" is none");
}
