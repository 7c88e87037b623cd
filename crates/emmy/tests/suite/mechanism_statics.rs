//! Static equilibria of rigid bodies and joints: against moments in independent coordinates, supports, merged meshes
//! and an independent implementation.

#![allow(non_snake_case)]

use crate::shared::joints::{plane_hinge, rigid};
use emmy::Error;
use emmy::equilibrium::{Equilibrium, unbalanced_force};
use emmy::mesh::{CellKind, MeshBuilder};
use emmy::modes::modes_about;
use emmy::motion::{MarchError, NewtonSettings};
use emmy::prelude::*;

const GRAVITY: f64 = 9.81;

fn weight() -> Load {
    Load::acceleration([0.0, -GRAVITY, 0.0])
}

fn equilibrium(body: &Body, time: f64) -> State {
    let found = Equilibrium::new(body, time, 4).unwrap().start(NewtonSettings::default(), &[], &mut []);
    let state = found.unwrap_or_else(|error| panic!("{error}"));
    // Joints carry what is not balanced at free degrees of freedom.
    let force = unbalanced_force(body, &state.displacement, time).unwrap();
    let free = force.iter().zip(body.fixed()).filter(|(_, fixed)| !**fixed).map(|(f, _)| f.abs());
    let (left, all) = (free.fold(0.0, f64::max), force.iter().map(|f| f.abs()).fold(1.0, f64::max));
    assert!(left < 1e-8 * all, "{left:e} of {all:e}");
    state
}

/// The coordinate of a joint in an equilibrium.
fn coordinate(body: &Body, state: &State, name: &str) -> f64 {
    let motion = Motion::new(body, "DGM".parse::<Scheme>().unwrap()).unwrap().from(state.clone()).unwrap();
    assert!(motion.record().constraint_residual < 1e-13, "{}", motion.record().constraint_residual);
    motion.record().joints[body.joints().iter().position(|joint| joint.name == name).unwrap()].coordinate
}

/// The zero of a function that grows.
fn zero(function: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (-3.0, 3.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if function(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// A bar of 2 along x on a hinge at the origin.
fn bar(joint: impl Fn(Joint) -> Joint, loads: &[Load]) -> Body {
    Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("bar", 2.0, [0.5, 0.0, 0.0], [0.3, 0.3, 0.4]))
        .joint(joint(plane_hinge("pin", [rigid("bar"), JointEnd::Ground], [0.0; 3])))
        .loads(loads)
        .build()
        .unwrap()
}

/// A torsion spring under a weight: k theta = m g l cos theta. The bar swings about it with omega^2 = (k + m g l sin
/// theta) / J.
#[test]
fn a_bar_sags_on_a_torsion_spring() {
    let body = bar(|pin| pin.with_spring(20.0, None), &[weight()]);
    let state = equilibrium(&body, 0.0);
    let sag = zero(|theta| 20.0 * theta - GRAVITY * theta.cos());
    let found = coordinate(&body, &state, "pin");
    assert!((found + sag).abs() < 1e-11, "{found} {sag}");
    let mode = &modes_about(&body, &state, 1).unwrap()[0];
    let expected = ((20.0 + GRAVITY * sag.sin()) / 0.9).sqrt();
    assert!((mode.angular_frequency / expected - 1.0).abs() < 1e-11, "{} {expected}", mode.angular_frequency);
    // The pin carries the weight, and the spring turns it back.
    let loaded = body.in_proportion(0.0);
    let rest = State::initial(&loaded, 0.0, &[]).unwrap();
    let mut increments = Motion::starting(&loaded, Scheme::Static, NewtonSettings::default(), rest).unwrap();
    for _ in 0..2 {
        increments.step(0.5).unwrap();
    }
    let pin = &increments.record().joints[0];
    assert!((pin.force[1] - 2.0 * GRAVITY).abs() < 1e-10, "{pin:?}");
    assert!(pin.force[0].abs() < 1e-10 && (pin.drive - 20.0 * sag).abs() < 1e-10, "{pin:?}");
    assert!((pin.coordinate + sag).abs() < 1e-11, "{pin:?}");
    // It stays there.
    let mut motion = Motion::new(&body, "DGM".parse::<Scheme>().unwrap()).unwrap().from(state).unwrap();
    assert!(motion.step(0.1).unwrap().kinetic_energy < 1e-18, "{}", motion.record().kinetic_energy);
}

/// A torque of 5 turns a spring of 20 by a quarter; so does a moment on the body, in parts of the time.
#[test]
fn torques_turn_springs() {
    let grows = || TimeFunction::new(vec![(0.0, 0.0), (2.0, 10.0)]).unwrap();
    let by_motor = bar(|pin| pin.with_spring(20.0, None).with_motor(grows()), &[]);
    let moment = Load::moment("bar", [0.0, 0.0, 1.0]).over([(0.0, 0.0), (2.0, 10.0)]).unwrap();
    let by_moment = bar(|pin| pin.with_spring(20.0, None), &[moment]);
    for body in [by_motor, by_moment] {
        let state = equilibrium(&body, 1.0);
        let found = coordinate(&body, &state, "pin");
        assert!((found - 0.25).abs() < 1e-12, "{found}");
    }
}

/// A driven hinge turns by its angle at the time, and the second bar hangs on its spring.
#[test]
fn driven_joints_are_where_they_are_at_the_time() {
    let drive = TimeFunction::smooth("0.3 * t", |t| [0.3 * t, 0.3, 0.0]);
    let body = Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("a", 2.0, [0.4, 0.0, 0.0], [0.1, 0.25, 0.3]))
        .rigid(RigidBody::new("b", 1.5, [1.6, 0.0, 0.0], [0.1, 0.15, 0.2]))
        .joint(plane_hinge("ground", [rigid("a"), JointEnd::Ground], [0.0; 3]).driven(drive))
        .joint(plane_hinge("knee", [rigid("b"), rigid("a")], [1.0, 0.0, 0.0]).with_spring(20.0, None))
        .load(weight())
        .build()
        .unwrap();
    let state = equilibrium(&body, 2.0);
    assert!((coordinate(&body, &state, "ground") - 0.6).abs() < 1e-12);
    let bend = zero(|phi| 20.0 * phi + 1.5 * GRAVITY * 0.6 * (0.6 + phi).cos());
    assert!((coordinate(&body, &state, "knee") - bend).abs() < 1e-11);
}

/// Three cranks that couplers keep parallel, pushed aside: k theta = 3.5 g cos theta. Six constraints follow from the
/// others.
#[test]
fn cranks_in_parallel_balance() {
    let rod = |name: &str, centre: [f64; 3], along: usize| {
        let mut moments = [1.0 / 12.0; 3];
        moments[along] = 1e-3;
        RigidBody::new(name, 1.0, centre, moments)
    };
    let mut builder = Body::builder(Mesh::without_cells());
    for i in 0..3 {
        let (x, name) = (i as f64, format!("crank-{i}"));
        let foot = plane_hinge(&format!("foot-{i}"), [rigid(&name), JointEnd::Ground], [x, 0.0, 0.0]);
        let foot = if i == 0 { foot.with_spring(60.0, None) } else { foot };
        builder = builder.rigid(rod(&name, [x, 0.5, 0.0], 1)).joint(foot);
    }
    for i in 0..2 {
        let (x, name) = (i as f64, format!("coupler-{i}"));
        builder = builder.rigid(rod(&name, [x + 0.5, 1.0, 0.0], 0));
        for side in [i, i + 1] {
            let ends = [rigid(&name), rigid(&format!("crank-{side}"))];
            builder = builder.joint(plane_hinge(&format!("top-{i}-{side}"), ends, [side as f64, 1.0, 0.0]));
        }
    }
    let body = builder.load(Load::acceleration([GRAVITY, 0.0, 0.0])).build().unwrap();
    let state = equilibrium(&body, 0.0);
    let angle = zero(|theta| 60.0 * theta - 3.5 * GRAVITY * theta.cos());
    for name in ["foot-0", "foot-2"] {
        assert!((coordinate(&body, &state, name) + angle).abs() < 1e-11, "{name}");
    }
}

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0)
}

fn nodes(mesh: &Mesh, is_chosen: impl Fn([f64; 3]) -> bool) -> Vec<u32> {
    (0..).zip(mesh.points()).filter(|(_, X)| is_chosen(**X)).map(|(node, _)| node).collect()
}

fn assert_same(own: &[f64], other: &[f64], size: f64) {
    let difference = own.iter().zip(other).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    assert!(difference < size, "{difference:e}");
}

/// A plate of eight cells around a hole, clamped at one side; a force acts at a point above the hole, which is rigid
/// (reference of an independent implementation, four corrections).
#[test]
fn a_bracket_is_loaded_through_its_bolt_hole() {
    let mut builder = MeshBuilder::new();
    let number = |at: [usize; 3]| (at[0] + 4 * (at[1] + 4 * at[2])) as u32;
    for at in (0..32).map(|at| [at % 4, at / 4 % 4, at / 16]) {
        builder.point(at.map(|x| x as f64));
    }
    for [i, j] in (0..9).map(|cell| [cell % 3, cell / 3]).filter(|cell| *cell != [1, 1]) {
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
        let cell: Vec<u32> = (0..2).flat_map(|k| corners.map(|[a, b]| number([i + a, j + b, k]))).collect();
        builder.cell(CellKind::Hex8, &cell).unwrap();
    }
    builder.node_group(
        "hole",
        [1, 2]
            .into_iter()
            .flat_map(|i| [1, 2].map(|j| [i, j]))
            .flat_map(|[i, j]| [0, 1].map(|k| number([i, j, k]))),
    );
    builder.node_group("wall", (0..4).flat_map(|i| [0, 1].map(|k| number([i, 0, k]))));
    let bolt = RigidBody { centre: Some([1.5; 3]), ..RigidBody::group("bolt", "hole") };
    let body = Body::builder(builder.build().unwrap())
        .region(rubber())
        .rigid(bolt)
        .support(Support::fixed("wall"))
        .load(Load::nodal_force("bolt", [10.0, 30.0, 20.0]))
        .build()
        .unwrap();
    let state = equilibrium(&body, 0.0);
    let point = body.mesh().nearest_node([1.5; 3]);
    let expected = [0.022_326_134_137_688_285, 0.028_729_154_350_893_94, -0.002_314_693_355_087_049];
    assert_same(&state.displacement[3 * point..3 * point + 3], &expected, 1e-11);
    let motion = Motion::new(&body, "DGM".parse::<Scheme>().unwrap()).unwrap().from(state.clone()).unwrap();
    let reaction = motion.with_static_reactions().unwrap().reactions()[0].force;
    assert_same(&reaction, &[-10.0, -30.0, -20.0], 1e-9);
    assert!((body.strain_energy(&state.displacement) - 0.516_100_241_735_654_9).abs() < 1e-11);
}

/// The constraint of a given angle holds half a turn off, too: increments that end there are cut.
#[test]
fn given_angles_are_not_half_a_turn_off() {
    for (angle, increments) in [(2.0, 1), (3.0, 1), (4.0, 2), (20.0, 10), (20.0, 5)] {
        let hinge = Joint::new(
            "hinge",
            JointKind::Revolute { axis: [0.0, 0.0, 1.0] },
            [rigid("wheel"), JointEnd::Ground],
            [0.0; 3],
        );
        let given = TimeFunction::smooth("angle", move |t| [angle * t, angle, 0.0]);
        let body = Body::builder(Mesh::without_cells())
            .rigid(RigidBody::new("wheel", 2.0, [0.1, 0.0, 0.0], [0.5, 0.5, 0.8]))
            .joint(hinge.driven(given))
            .build()
            .unwrap();
        let found = Equilibrium::new(&body, 1.0, increments).unwrap();
        let state = found.start(NewtonSettings::default(), &[], &mut []).unwrap();
        assert!(
            (state.coordinates[0] - angle).abs() < 1e-9,
            "{angle}, {increments}: {:?}",
            state.coordinates
        );
        let centre = state.position(&body, 0);
        assert!((centre[0] - 0.1 * angle.cos()).abs() < 1e-9 && (centre[1] - 0.1 * angle.sin()).abs() < 1e-9);
    }
}

fn beam(cells: [usize; 3]) -> Mesh {
    mesh::block([4.0, 1.0, 0.5], cells).unwrap()
}

/// A face that is rigid, and fixed to the ground by a joint, is a support: a beam bends far under a weight.
#[test]
fn a_rigid_face_on_a_fixed_joint_is_a_support() {
    let load = || Load::acceleration([0.0, 0.0, -1.0]);
    let face = Joint::new("wall", JointKind::Fixed, [rigid("plate"), JointEnd::Ground], [0.0; 3]);
    let joined = Body::builder(beam([6, 2, 1])).region(rubber()).rigid(RigidBody::group("plate", "x-min"));
    let joined = joined.joint(face).load(load()).build().unwrap();
    let held = Body::builder(beam([6, 2, 1])).region(rubber()).support(Support::fixed("x-min"));
    let held = held.load(load()).build().unwrap();
    let [own, other] = [&joined, &held].map(|body| equilibrium(body, 0.0).displacement);
    let tip = 3 * held.mesh().nearest_node([4.0, 0.0, 0.0]) + 2;
    assert!(other[tip] < -0.3, "{}", other[tip]);
    assert_same(&own[..other.len()], &other, 1e-9);

    // The joint carries the weight from the start on.
    let motion = Motion::new(&joined, "DGM".parse::<Scheme>().unwrap()).unwrap();
    let mut motion = motion.from(equilibrium(&joined, 0.0)).unwrap().with_static_reactions().unwrap();
    let first = motion.record().joints[0];
    assert_same(&first.force, &[0.0, 0.0, joined.regions()[0].mass], 1e-9);
    assert!(first.moment[1] < -1.0, "{first:?}");
    let next = motion.step(0.01).unwrap().joints[0];
    assert_same(&[first.force, first.moment].concat(), &[next.force, next.moment].concat(), 1e-7);
}

/// Ball joints between all nodes of two faces join them as one mesh does. The far part has no support of its own.
#[test]
fn ball_joints_at_nodes_are_a_merged_mesh() {
    let mut apart = MeshBuilder::new();
    for (x, name) in [(0.0, "left"), (2.0, "right")] {
        let own = mesh::block([2.0, 1.0, 0.5], [3, 1, 1]).unwrap();
        let numbers: Vec<u32> = own.points().iter().map(|X| apart.point([X[0] + x, X[1], X[2]])).collect();
        for cell in own.cells() {
            let cell_nodes: Vec<u32> = cell.nodes.iter().map(|&node| numbers[node as usize]).collect();
            let number = apart.cell(cell.kind, &cell_nodes).unwrap();
            apart.cell_group(name, [number]);
        }
    }
    let apart = apart.build().unwrap();
    let wall = nodes(&apart, |X| X[0] == 0.0);
    let apart = apart.with_node_group("wall", wall).unwrap();
    let seam = nodes(&apart, |X| X[0] == 2.0);
    let load = || Load::acceleration([0.0, 0.3, -1.0]);
    let mut builder =
        Body::builder(apart.clone()).region(rubber()).support(Support::fixed("wall")).load(load());
    for (i, &node) in seam.iter().enumerate() {
        let X = apart.points()[node as usize];
        let same = seam[i + 1..].iter().find(|&&other| apart.points()[other as usize] == X);
        let Some(&other) = same else { continue };
        let ends = [JointEnd::Node(node), JointEnd::Node(other)];
        builder = builder.joint(Joint::new(format!("seam-{i}"), JointKind::Spherical, ends, X));
    }
    let joined = builder.build().unwrap();
    let merged = Body::builder(beam([6, 1, 1])).region(rubber()).support(Support::fixed("x-min"));
    let merged = merged.load(load()).build().unwrap();
    let [own, other] = [&joined, &merged].map(|body| equilibrium(body, 0.0).displacement);
    for (node, X) in joined.mesh().points().iter().enumerate() {
        let same = 3 * merged.mesh().nearest_node(*X);
        assert_same(&own[3 * node..3 * node + 3], &other[same..same + 3], 1e-9);
    }
}

/// The free motions of parts that joints alone hold.
#[test]
fn parts_that_can_turn_are_named() {
    let says = |body: &Body, expected: &str| {
        let found = Equilibrium::new(body, 0.0, 1).unwrap().start(NewtonSettings::default(), &[], &mut []);
        let Err(MarchError::Step(error @ Error::NotHeld { .. })) = found else { panic!("{found:?}") };
        assert!(error.to_string().contains(expected), "{error}");
    };
    says(
        &bar(|pin| pin, &[weight()]),
        "nothing holds the part `bar` against rotation about z through [0, 0, 0]",
    );
    // A leaf of rubber on a rigid edge.
    let hinged = |pin: Joint| {
        let edge = RigidBody { centre: Some([0.0, 0.5, 0.25]), ..RigidBody::group("leaf", "x-min") };
        let body = Body::builder(beam([4, 1, 1])).region(rubber()).rigid(edge).load(weight()).joint(pin);
        body.build().unwrap()
    };
    let pin = || plane_hinge("pin", [rigid("leaf"), JointEnd::Ground], [0.0, 0.5, 0.0]);
    says(&hinged(pin()), "nothing holds the part `leaf` against rotation about z through [0, 0.5, 0]");
    equilibrium(&hinged(pin().with_spring(500.0, None)), 0.0);
    let floating = Body::builder(beam([4, 1, 1])).region(rubber()).support(Support::fixed("x-min"));
    let floating = floating.rigid(RigidBody::new("hub", 1.0, [9.0, 0.0, 0.0], [1.0; 3])).build().unwrap();
    says(&floating, "nothing holds the part `hub` against rotation about x");
}
