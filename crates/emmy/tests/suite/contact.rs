//! Contact of bodies with obstacles, against an independent implementation and closed forms.

#![allow(non_snake_case)]

use crate::shared::contact::{conserving, others, rubber};
use crate::shared::schemes::{DGM, at, dgm};
use emmy::body::{Contact, FieldName, Fields, LayerLaw, Obstacle, Viscosity};
use emmy::equilibrium::Equilibrium;
use emmy::internals::time::CentralDifferences;
use emmy::mesh::{CellKind, MeshBuilder};
use emmy::motion::{Adaptivity, Event, EventKind, NewtonSettings, Observer, ObserverResult, View};
use emmy::prelude::*;

/// A block of cells with the edge 1/2 above the plane y = 0, by a gap.
fn block_above(gap: f64) -> Mesh {
    let block = mesh::block([1.0; 3], [2; 3]).unwrap();
    let mut builder = MeshBuilder::new();
    block.points().iter().for_each(|X| _ = builder.point([X[0], X[1] + gap, X[2]]));
    block.cells().for_each(|cell| _ = builder.cell(cell.kind, cell.nodes).unwrap());
    let at = |place: [f64; 3]| block.points().iter().position(|X| *X == place).unwrap() as u32;
    builder.node_group("corner", [at([0.0; 3])]);
    builder.node_group("beside", [at([1.0, 0.0, 0.0])]);
    builder.build().unwrap()
}

const PLANE: Obstacle = Obstacle::Plane { point: [0.0; 3], normal: [0.0, 1.0, 0.0] };
const BALL: Obstacle = Obstacle::Sphere { centre: [0.6, -0.45, 0.4], radius: 0.5, inside: false };

fn contact(obstacle: Obstacle) -> Contact {
    Contact::of_all_with_obstacle(obstacle).with_stiffness(1333.0).with_distance(0.05)
}

/// The results of another implementation: kinetic and strain energy at t = 0.2, P, L, the place of the corner
/// (1, 1.1, 1), the largest energy of the contact and the smallest gap at the ends of steps.
struct Bounce {
    energies: [f64; 2],
    P: [f64; 3],
    L: [f64; 3],
    corner: [f64; 3],
    largest: f64,
    gap: f64,
}

fn assert_bounce(obstacle: Obstacle, k: usize, (velocity, spin): ([f64; 3], [f64; 3]), expected: &Bounce) {
    let mesh = block_above(0.1);
    let corner = mesh.points().iter().position(|X| *X == [1.0, 1.1, 1.0]).unwrap();
    let body = Body::builder(mesh).region(rubber()).contact(contact(obstacle)).build().unwrap();
    let thrown = InitialVelocity {
        velocity,
        angular_velocity: spin,
        about: [0.5, 0.6, 0.5],
        ..InitialVelocity::default()
    };
    let start = State::initial(&body, 0.0, &[thrown]).unwrap();
    let mut motion =
        Motion::new(&body, TimeElement::discrete_gradient(k).unwrap()).unwrap().from(start).unwrap();
    let (mut largest, mut gap, mut corrections) = (0.0f64, 1.0f64, 0);
    for _ in 0..40 {
        let record = motion.step(0.005).unwrap();
        largest = largest.max(record.contact_energy);
        gap = gap.min(record.smallest_gap.unwrap_or(1.0));
        corrections += record.newton_iterations;
        assert!(record.energy_residual.abs() < 1e-11 * record.total_energy, "{}", record.energy_residual);
        assert!(record.linear_momentum_residual < 1e-11 && record.angular_momentum_residual < 1e-11);
        assert_eq!(record.cuts, 0);
    }
    // Two of these are polish; steps without contact take some with the approximate tangent.
    assert!(corrections < 40 * 8, "{corrections} corrections");
    let record = motion.record();
    let near = |own: f64, expected: f64, scale: f64| {
        assert!((own - expected).abs() < 1e-7 * scale, "{own} {expected}");
    };
    near(record.kinetic_energy, expected.energies[0], record.total_energy);
    near(record.strain_energy, expected.energies[1], record.total_energy);
    near(record.contact_energy, 0.0, record.total_energy);
    near(largest, expected.largest, record.total_energy);
    near(gap, expected.gap / 0.05, 1.0);
    let place = motion.state().position(&body, corner);
    for d in 0..3 {
        near(record.linear_momentum[d], expected.P[d], 1.0);
        near(record.angular_momentum[d], expected.L[d], 1.0);
        near(place[d], expected.corner[d], 1.0);
    }
}

#[test]
fn a_block_bounces_off_a_plane() {
    let thrown = ([0.3, -2.0, 0.1], [0.5, 0.0, 3.0]);
    assert_bounce(
        PLANE,
        1,
        thrown,
        &Bounce {
            energies: [2.626_608_540_318_392_7, 0.194_224_793_014_350_53],
            P: [0.3, 1.752_802_964_609_129_4, 0.1],
            L: [-0.914_469_583_027_866_3, 0.1, 0.245_573_537_563_832_38],
            corner: [1.189_200_236_471_397_2, 1.111_576_088_911_445_9, 0.998_020_839_680_077],
            largest: 0.383_608_152_294_985_35,
            gap: 0.033_594_426_676_682_304,
        },
    );
    assert_bounce(
        PLANE,
        2,
        thrown,
        &Bounce {
            energies: [2.591_351_747_532_382, 0.229_481_585_795_991_04],
            P: [0.3, 1.776_657_236_766_547_6, 0.1],
            L: [-0.912_857_649_563_856_3, 0.1, 0.258_226_418_974_305_37],
            corner: [1.198_645_114_735_966, 1.096_389_495_670_728_7, 0.996_508_277_267_000_6],
            largest: 0.371_800_539_892_125_14,
            gap: 0.033_445_226_026_223_67,
        },
    );
}

#[test]
fn a_block_bounces_off_a_ball() {
    assert_bounce(
        BALL,
        1,
        ([0.2, -2.0, 0.1], [0.0, 0.0, 1.0]),
        &Bounce {
            energies: [2.056_590_544_918_337, 0.051_742_788_413_905_29],
            P: [-0.085_895_719_282_064_74, 1.623_587_557_109_855_3, 0.072_887_182_206_045_7],
            L: [-0.377_234_254_836_662_1, -0.048_090_597_036_453_4, 1.092_166_127_255_651_8],
            corner: [0.876_827_869_980_543_9, 1.144_281_848_785_773, 1.183_193_730_509_266],
            largest: 0.306_039_214_337_508_4,
            gap: 0.032_210_880_283_619_625,
        },
    );
}

/// Equilibria of a block on a plane of another implementation; the force of the plane is the weight.
#[test]
fn a_block_rests_on_a_plane() {
    for (gravity, strain, energy, smallest, top) in [
        (
            9.81,
            0.010_925_627_883_327_547,
            0.007_887_755_513_118_731,
            0.047_478_551_685_424_995,
            1.043_965_572_757_106_7,
        ),
        (
            200.0,
            4.095_554_955_555_603,
            0.642_253_667_768_787_1,
            0.039_205_583_069_024_094,
            0.971_380_811_864_185_9,
        ),
    ] {
        let body = Body::builder(block_above(0.049))
            .region(rubber())
            .contact(contact(PLANE).named("floor"))
            // The plane does not hold it along itself; no force acts there.
            .support(Support::of_components("corner", [true, false, true]))
            .support(Support::of_components("beside", [false, false, true]))
            .load(Load::acceleration([0.0, -gravity, 0.0]))
            .build()
            .unwrap();
        let found = Equilibrium::new(&body, 0.0, 1).unwrap().start(NewtonSettings::default(), &[], &mut []);
        let state = found.unwrap_or_else(|error| panic!("{error}"));
        let mut motion =
            Motion::new(&body, TimeElement::discrete_gradient(1).unwrap()).unwrap().from(state).unwrap();
        let record = motion.record();
        assert!((record.strain_energy / strain - 1.0).abs() < 1e-8, "{}", record.strain_energy);
        assert!((record.contact_energy / energy - 1.0).abs() < 1e-8, "{}", record.contact_energy);
        assert!((record.smallest_gap.unwrap() - smallest / 0.05).abs() < 1e-7);
        let upper = (0..27).filter(|node| body.mesh().points()[*node][1] > 1.0);
        let mean = upper.map(|node| motion.state().position(&body, node)[1]).sum::<f64>() / 9.0;
        assert!((mean - top).abs() < 1e-8);
        // It stays at rest, and the floor bears its weight.
        for _ in 0..20 {
            let record = motion.step(0.01).unwrap();
            assert!(record.kinetic_energy < 1e-16 && record.energy_residual.abs() < 1e-12 * strain);
        }
        assert!((motion.reactions()[2].force[1] - gravity).abs() < 1e-8 * gravity);
    }
}

/// A block thrown at a plane, with a formulation and a scheme.
fn thrown(region: Region, scheme: Scheme) -> (Body, Scheme, State) {
    let body = Body::builder(block_above(0.06)).region(region).contact(contact(PLANE).named("floor"));
    let body = body.build().unwrap();
    let thrown = InitialVelocity {
        velocity: [0.3, -2.0, 0.1],
        angular_velocity: [0.5, 0.0, 3.0],
        about: [0.5, 0.56, 0.5],
        ..InitialVelocity::default()
    };
    let start = State::initial(&body, 0.0, &[thrown]).unwrap();
    (body, scheme, start)
}

/// Flies, hits and flies again; the largest energy of the contact.
fn largest_contact_energy(motion: &mut Motion<'_>, h: f64, n: usize) -> f64 {
    (0..n).fold(0.0, |most: f64, _| most.max(motion.step(h).unwrap().contact_energy))
}

#[test]
fn time_elements_of_every_degree_keep_all_energy() {
    for (region, scheme, h) in conserving(0.005) {
        let name = format!("{scheme:?} {h}");
        let (body, scheme, start) = thrown(region, scheme);
        let mut motion = Motion::new(&body, scheme).unwrap().from(start).unwrap();
        let energy = motion.record().total_energy;
        let n = (0.15 / h).ceil() as usize;
        let largest = largest_contact_energy(&mut motion, h, n);
        let record = motion.record();
        assert!(largest > 0.1 && record.linear_momentum[1] > 1.0, "{name}: {largest} {record:?}");
        assert!(
            (record.total_energy - energy).abs() < 1e-10 * energy,
            "{name}: {}",
            record.total_energy - energy
        );
        // The plane exerts no force along itself.
        assert!(
            (record.linear_momentum[0] - 0.3).abs() < 1e-12
                && (record.linear_momentum[2] - 0.1).abs() < 1e-12
        );
    }
}

/// The impulse of the plane in fine steps of the DGM; the others approach it.
#[test]
fn other_schemes_rebound_alike() {
    let rebound = |scheme: Scheme, h: f64| {
        let (body, scheme, start) = thrown(rubber(), scheme);
        let mut motion = Motion::new(&body, scheme).unwrap().from(start).unwrap();
        let largest = largest_contact_energy(&mut motion, h, (0.16 / h).round() as usize);
        (motion.record().linear_momentum[1], largest, motion.record().clone())
    };
    let (exact, largest, _) = rebound(at(DGM, 3), 0.001);
    for (scheme, h) in others(0.0005) {
        let (own, most, record) = rebound(scheme, h);
        assert!(record.linear_momentum_residual < 1e-12, "{scheme:?}");
        if scheme == Scheme::CentralDifferences {
            // Its lumped mass strikes the plane with a quarter of the whole; the rebound is nearly the same.
            assert!((own - exact).abs() < 0.04 * 2.0 && most < 1.0, "{own} {exact} {most}");
            continue;
        }
        // Of the momentum before; energies are those at the ends of steps.
        assert!((own - exact).abs() < 0.02 * 2.0, "{scheme:?}: {own} {exact}");
        assert!((most - largest).abs() < 0.05 * largest, "{scheme:?}: {most} {largest}");
    }
}

/// The energy that a dissipative scheme takes is in the balance.
#[test]
fn dissipated_energy_is_in_the_balance() {
    let (body, scheme, start) = thrown(rubber(), at(dgm(0.5), 2));
    let mut motion = Motion::new(&body, scheme).unwrap().from(start).unwrap();
    let energy = motion.record().total_energy;
    largest_contact_energy(&mut motion, 0.005, 30);
    let record = motion.record();
    let sum = record.total_energy + record.dissipated_energy;
    assert!(record.dissipated_energy > 1e-6 && (sum - energy).abs() < 1e-11 * energy, "{record:?}");
}

#[test]
fn a_motion_resumed_in_an_impact_has_the_same_bits() {
    for scheme in [at(DGM, 1), at(DGM, 2), Scheme::from_name("HHT(0)").unwrap()] {
        let (body, scheme, start) = thrown(rubber(), scheme);
        let mut motion = Motion::new(&body, scheme).unwrap().from(start).unwrap();
        largest_contact_energy(&mut motion, 0.002, 12);
        assert!(motion.record().contact_energy > 0.0);
        let snapshot = motion.snapshot();
        let settings = NewtonSettings::default();
        let mut resumed = Motion::resumed(&body, scheme, settings, snapshot).unwrap();
        for _ in 0..20 {
            assert_eq!(motion.step(0.002).unwrap(), resumed.step(0.002).unwrap());
        }
    }
}

#[test]
fn results_do_not_depend_on_threads() {
    let record = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let obstacle = Obstacle::Sphere { centre: [0.5, -0.6, 0.4], radius: 0.5, inside: false };
            let body = Body::builder(mesh::block([1.0; 3], [8; 3]).unwrap())
                .region(rubber())
                .contact(Contact::of_all_with_obstacle(obstacle))
                .build()
                .unwrap();
            let falls = InitialVelocity { velocity: [0.0, -2.0, 0.0], ..InitialVelocity::default() };
            let start = State::initial(&body, 0.0, &[falls]).unwrap();
            let mut motion = Motion::new(&body, at(DGM, 1)).unwrap().from(start).unwrap();
            assert!(largest_contact_energy(&mut motion, 0.005, 15) > 0.0);
            motion.record().clone()
        })
    };
    assert_eq!(record(1), record(4));
}

/// A body inside of a cylinder keeps the angular momentum about its axis.
#[test]
fn a_round_wall_exerts_no_moment() {
    let wall =
        Obstacle::Cylinder { point: [0.5, 0.0, 0.5], axis: [0.0, 3.0, 0.0], radius: 0.8, inside: true };
    let body = Body::builder(block_above(0.1)).region(rubber()).contact(contact(wall)).build().unwrap();
    let thrown = InitialVelocity {
        velocity: [2.0, 0.5, 0.3],
        angular_velocity: [0.0, 3.0, 0.0],
        about: [0.5, 0.6, 0.5],
        ..InitialVelocity::default()
    };
    for k in [1, 2] {
        let start = State::initial(&body, 0.0, std::slice::from_ref(&thrown)).unwrap();
        let mut motion = Motion::new(&body, at(DGM, k)).unwrap().from(start).unwrap();
        // About the axis, which leads through (0.5, 0, 0.5).
        let about_axis = |record: &Record| {
            let [x, _, z] = record.linear_momentum;
            record.angular_momentum[1] - (0.5 * x - 0.5 * z)
        };
        let before = (about_axis(motion.record()), motion.record().total_energy);
        assert!(largest_contact_energy(&mut motion, 0.005, 60) > 0.01);
        let record = motion.record();
        assert!((about_axis(record) - before.0).abs() < 1e-11, "{}", about_axis(record) - before.0);
        assert!((record.total_energy - before.1).abs() < 1e-10 * before.1);
        assert!((record.linear_momentum[1] - 0.5).abs() < 1e-12);
    }
}

#[test]
fn impossible_contacts_have_a_reason() {
    let reason = |contact: Contact| {
        let built = Body::builder(block_above(0.1)).region(rubber()).contact(contact).build();
        built.unwrap_err().to_string()
    };
    for (contact, words) in [
        (contact(PLANE).with_stiffness(-1.0), "its stiffness must be a positive number, not -1"),
        (contact(PLANE).with_distance(f64::NAN), "its distance must be a positive number, not NaN"),
        (contact(Obstacle::Plane { point: [0.0; 3], normal: [0.0; 3] }), "has no direction"),
        (
            contact(Obstacle::Sphere { centre: [0.0; 3], radius: 0.0, inside: false }),
            "the radius of its obstacle must be",
        ),
        (
            contact(Obstacle::Sphere { centre: [0.0; 3], radius: 1.0, inside: false }),
            "is not outside of the obstacle: the node at [0, 0.1, 0] lies 0.9 behind it: move the body",
        ),
        (
            contact(Obstacle::Sphere { centre: [0.0; 3], radius: 9.0, inside: false }),
            "if it is to be inside, say so",
        ),
        (contact(Obstacle::Sphere { centre: [9.0; 3], radius: 1.0, inside: true }), "leave out `inside`"),
        (
            contact(Obstacle::Plane { point: [0.0; 3], normal: [0.0, -2.0, 0.0] }),
            "take the opposite one, [0, 2, 0]",
        ),
        (
            contact(Obstacle::Plane { point: [0.0, 0.5, 0.0], normal: [0.0, -2.0, 0.0] }),
            "lies 0.6 behind it: move",
        ),
        (
            contact(Obstacle::Plane { point: [0.0, 0.1, 0.0], normal: [0.0, 2.0, 0.0] }),
            "touches the obstacle at [",
        ),
        (Contact::with_obstacle("sole", PLANE), "sole"),
    ] {
        let own = reason(contact);
        assert!(own.contains(words), "{own}");
    }
    let (body, scheme, start) = thrown(rubber(), at(DGM, 1));
    let motion = Motion::new(&body, scheme).unwrap().from(start).unwrap();
    let error = emmy::adjoint::Trajectory::new(&motion).unwrap_err().to_string();
    assert!(error.contains("contact is not covered"), "{error}");
}

/// Rigid parts and ties follow other nodes, to which the forces of the layer move.
#[test]
fn rigid_parts_and_tied_meshes_bounce_without_loss() {
    let group = |mesh: Mesh| {
        let n = mesh.n_nodes() as u32;
        mesh.with_node_group("block", 0..n).unwrap()
    };
    let rigid = Body::builder(group(block_above(0.06)))
        .region(rubber())
        .rigid(RigidBody::group("stone", "block"))
        .contact(contact(PLANE));
    // Two layers of cells that share no nodes.
    let mut builder = MeshBuilder::new();
    for (height, n) in [(0.06, 2), (0.56, 3)] {
        let layer = mesh::block([1.0, 0.5, 1.0], [n, 1, n]).unwrap();
        let first =
            layer.points().iter().map(|X| builder.point([X[0], X[1] + height, X[2]])).collect::<Vec<_>>()[0];
        for cell in layer.cells() {
            let nodes: Vec<u32> = cell.nodes.iter().map(|node| first + node).collect();
            builder.cell(cell.kind, &nodes).unwrap();
        }
    }
    builder.cell_group("below", 0..4);
    let mesh = builder.build().unwrap();
    let faces = |mesh: &Mesh, from: usize, to: usize| -> Vec<u32> {
        (from..to)
            .filter(|node| (mesh.points()[*node][1] - 0.56).abs() < 1e-12)
            .map(|node| node as u32)
            .collect()
    };
    let upper = faces(&mesh, 18, 50);
    let mesh = mesh.with_node_group("upper", upper).unwrap();
    let tied = Body::builder(mesh).region(rubber()).tie(Tie::nodes("upper", "below"));
    let tied = tied.contact(contact(PLANE));
    for (what, builder) in [("rigid", rigid), ("tied", tied)] {
        let body = match builder.build() {
            Ok(body) => body,
            Err(error) => panic!("{what}: {error}"),
        };
        let falls = InitialVelocity { velocity: [0.2, -1.0, 0.1], ..InitialVelocity::default() };
        for k in [1, 2] {
            let start = State::initial(&body, 0.0, std::slice::from_ref(&falls)).unwrap();
            let mut motion = Motion::new(&body, at(DGM, k)).unwrap().from(start).unwrap();
            let energy = motion.record().total_energy;
            let largest = largest_contact_energy(&mut motion, 0.004, 60);
            let record = motion.record();
            assert!(largest > 0.05 && record.linear_momentum[1] > 0.5, "{what}: {largest} {record:?}");
            assert!((record.total_energy - energy).abs() < 1e-10 * energy, "{what}");
            assert!((record.linear_momentum[0] - 0.2).abs() < 1e-11, "{what}");
            if what == "rigid" {
                // Nothing takes up energy: it leaves with the velocity that it had.
                assert!((record.linear_momentum[1] - 1.0).abs() < 1e-9, "{}", record.linear_momentum[1]);
            }
        }
    }
}

/// A rigid block rests on a layer and bobs with `omega^2 = A psi''(g)/m`, where `A psi'(g)` is its weight.
#[test]
fn modes_have_the_stiffness_of_the_layer() {
    let mesh = block_above(0.045);
    let n = mesh.n_nodes() as u32;
    let builder = Body::builder(mesh.with_node_group("block", 0..n).unwrap())
        .region(rubber())
        .rigid(RigidBody::group("stone", "block"))
        .contact(contact(PLANE).with_law(LayerLaw::Linear))
        .load(Load::acceleration([0.0, -60.0, 0.0]));
    // The plane does not hold it along itself, and not against a turn about the normal.
    let slide = Joint::new(
        "slide",
        JointKind::Prismatic { axis: [0.0, 1.0, 0.0] },
        [JointEnd::Rigid("stone".into()), JointEnd::Ground],
        [0.5, 0.0, 0.5],
    );
    let body = builder.joint(slide).build().unwrap();
    let found = Equilibrium::new(&body, 0.0, 1).unwrap().start(NewtonSettings::default(), &[], &mut []);
    let state = found.unwrap_or_else(|error| panic!("{error}"));
    let gap = 0.045 + state.displacement[1];
    let (c, d) = (1333.0 * 0.05 / 8.0, 0.05f64);
    let (y, by_gap) = (gap * gap / (d * d), 2.0 * gap / (d * d));
    let slope = -c * (1.0 / (y * y) - 1.0) * by_gap;
    assert!((slope + 60.0).abs() < 1e-8 * 60.0, "{slope}");
    let stiffness = 2.0 * c / (y * y * y) * by_gap * by_gap + slope / gap;
    let modes = emmy::modes::modes_about(&body, &state, 1).unwrap();
    let omega = 2.0 * std::f64::consts::PI * modes[0].frequency();
    assert!((omega * omega / stiffness - 1.0).abs() < 1e-8, "{} {stiffness}", omega * omega);
}

/// A rigid block on a hinge swings against a wall; viscosity, a follower pressure and plane cells.
#[test]
fn contact_goes_with_joints_loads_and_damping() {
    let mesh = block_above(0.0);
    let n = mesh.n_nodes() as u32;
    let wall = Obstacle::Plane { point: [0.0, -0.1, 0.0], normal: [0.0, 1.0, 0.0] };
    let hinge = Joint::new(
        "hinge",
        JointKind::Revolute { axis: [0.0, 0.0, 1.0] },
        [JointEnd::Rigid("door".into()), JointEnd::Ground],
        [0.0, 0.5, 0.5],
    );
    let door = Body::builder(mesh.with_node_group("block", 0..n).unwrap())
        .region(rubber())
        .rigid(RigidBody::group("door", "block"))
        .joint(hinge)
        .contact(contact(wall));
    let swings = InitialVelocity {
        angular_velocity: [0.0, 0.0, -1.0],
        about: [0.0, 0.5, 0.5],
        ..InitialVelocity::default()
    };
    let falls = InitialVelocity { velocity: [0.0, -1.0, 0.0], ..InitialVelocity::default() };
    let viscous = rubber().with_viscosity(Viscosity { time: 0.002, ..Viscosity::default() });
    let pressed = Load::pressure("y-max", 5.0);
    let block = mesh::block([1.0; 3], [2; 3]).unwrap();
    let damped = Body::builder(block).region(viscous).contact(contact(wall)).load(pressed);
    let flat = mesh::rectangle([1.0, 1.0], [3, 3]).unwrap();
    let plane = Body::builder(flat).region(rubber()).contact(contact(wall));
    for (what, builder, start) in
        [("door", door, swings), ("damped", damped, falls.clone()), ("plane", plane, falls)]
    {
        let body = builder.build().unwrap_or_else(|error| panic!("{what}: {error}"));
        for k in [1, 2] {
            let start = State::initial(&body, 0.0, std::slice::from_ref(&start)).unwrap();
            let mut motion = Motion::new(&body, at(DGM, k)).unwrap().from(start).unwrap();
            let before = motion.record().total_energy;
            let largest = largest_contact_energy(&mut motion, 0.004, 100);
            let record = motion.record();
            assert!(largest > 0.02, "{what}: {largest}");
            let sum = record.total_energy + record.dissipated_energy - record.external_work;
            assert!((sum - before).abs() < 1e-10 * before, "{what} {k}: {}", sum - before);
            assert_eq!(record.dissipated_energy > 0.0, what == "damped");
        }
    }
}

/// Adaptive steps find the impact, and the error that they promise is kept.
#[test]
fn adaptive_steps_find_the_impact() {
    let (body, scheme, start) = thrown(rubber(), at(DGM, 2));
    let exact = {
        let mut motion = Motion::new(&body, at(DGM, 3)).unwrap().from(start.clone()).unwrap();
        largest_contact_energy(&mut motion, 0.0005, 120);
        motion.state().displacement.clone()
    };
    let mut errors = Vec::new();
    for tolerance in [1e-3, 1e-4] {
        let mut motion = Motion::new(&body, scheme).unwrap().from(start.clone()).unwrap();
        let plan = StepPlan::adaptive(0.0, 0.06, Adaptivity::new(tolerance)).unwrap();
        let energy = motion.record().total_energy;
        motion.march(&plan, &mut []).unwrap();
        assert!((motion.record().total_energy - energy).abs() < 1e-10 * energy);
        let difference = motion.state().displacement.iter().zip(&exact).map(|(u, exact)| (u - exact).abs());
        errors.push((motion.record().step, difference.fold(0.0, f64::max)));
    }
    let [(coarse, error), (fine, smaller)] = errors[..] else { panic!("{errors:?}") };
    assert!(coarse < fine && smaller < 0.3 * error && error < 0.02, "{errors:?}");
}

/// The statistics of a contact, against the reactions of the steps and the momentum.
#[test]
fn statistics_have_the_force_and_the_times_of_each_contact() {
    let away = Obstacle::Plane { point: [0.0, 9.0, 0.0], normal: [0.0, -1.0, 0.0] };
    let body = Body::builder(block_above(0.1))
        .region(rubber())
        .contact(contact(away).named("ceiling"))
        .contact(contact(PLANE).named("floor"))
        .build()
        .unwrap();
    let falls = InitialVelocity { velocity: [0.0, -2.0, 0.0], ..InitialVelocity::default() };
    let start = State::initial(&body, 0.0, std::slice::from_ref(&falls)).unwrap();
    let mut motion = Motion::new(&body, at(DGM, 1)).unwrap().from(start).unwrap();
    let (mut steps, mut halfway) = (Vec::new(), None);
    for step in 0..60 {
        motion.step(0.004).unwrap();
        // The impulse of the floor over the step size is the change of the momentum in it.
        let [_, force, _] = motion.reactions()[1].force;
        steps.push((motion.record().time, force));
        if step == 20 {
            halfway = Some(motion.snapshot());
        }
    }
    let touching: Vec<(f64, f64)> = steps.into_iter().filter(|(_, force)| *force != 0.0).collect();
    let largest = touching.iter().copied().fold((0.0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
    let [ceiling, floor] = &motion.statistics().contacts[..] else { panic!("{:?}", motion.statistics()) };
    assert_eq!((ceiling.name.as_str(), ceiling.largest_force, ceiling.duration), ("ceiling", None, 0.0));
    assert_eq!((ceiling.largest_force_time, ceiling.first_time, ceiling.last_time), (None, None, None));
    let lifts = touching.windows(2).filter(|pair| pair[1].0 - pair[0].0 > 1.5 * 0.004).count();
    assert_eq!((floor.name.as_str(), floor.intervals, ceiling.intervals), ("floor", 1 + lifts, 0));
    assert!(touching.len() > 10, "{touching:?}");
    let near = |own: Option<f64>, expected: f64| (own.unwrap() - expected).abs() < 1e-12;
    assert!(near(floor.largest_force, largest.1) && near(floor.largest_force_time, largest.0), "{floor:?}");
    assert!(near(floor.first_time, touching[0].0 - 0.004), "{floor:?}");
    assert!(near(floor.last_time, touching[touching.len() - 1].0), "{floor:?}");
    assert!(near(Some(floor.duration), 0.004 * touching.len() as f64), "{floor:?}");
    // The layer begins 0.05 below the block, which falls with 2 until there.
    assert!((floor.first_time.unwrap() - 0.025).abs() < 0.004, "{floor:?}");
    let impulse: f64 = touching.iter().map(|(_, force)| 0.004 * force).sum();
    assert!((motion.record().linear_momentum[1] + 2.0 - impulse).abs() < 1e-11);
    // A motion that is resumed goes on with them.
    let settings = NewtonSettings::default();
    let mut resumed = Motion::resumed(&body, at(DGM, 1), settings, halfway.unwrap()).unwrap();
    (21..60).for_each(|_| _ = resumed.step(0.004).unwrap());
    assert_eq!(resumed.statistics(), motion.statistics());
}

/// Steps that would lead through a layer are cut, with an event of their own, by planned and by adaptive steps.
#[test]
fn steps_in_which_something_would_pass_are_cut() {
    #[derive(Default)]
    struct Cuts(Vec<EventKind>);
    impl Observer for Cuts {
        fn observe(&mut self, _: View<'_>) -> ObserverResult {
            Ok(())
        }
        fn notice(&mut self, event: &Event) -> ObserverResult {
            if event.kind == EventKind::Passed {
                assert!(event.message.contains("would pass through its opponent"), "{}", event.message);
            }
            self.0.push(event.kind);
            Ok(())
        }
    }
    // The block moves by ten times the thickness of the layer in a step.
    let thin = contact(PLANE).with_distance(0.001);
    let body = Body::builder(block_above(0.105)).region(rubber()).contact(thin).build().unwrap();
    let falls = InitialVelocity { velocity: [0.0, -2.0, 0.0], ..InitialVelocity::default() };
    let start = || State::initial(&body, 0.0, std::slice::from_ref(&falls)).unwrap();
    let mut motion = Motion::new(&body, Scheme::CentralDifferences).unwrap().from(start()).unwrap();
    motion.allow_cuts(None);
    let mut cuts = Cuts::default();
    let plan = StepPlan::new(0.0, vec![Phase { until: 0.06, size: 0.005 }]).unwrap();
    motion.march(&plan, &mut [&mut cuts]).unwrap();
    assert!(cuts.0.contains(&EventKind::Passed), "{:?}", cuts.0);
    assert!(motion.statistics().cuts > 0 && motion.record().smallest_gap.is_none_or(|gap| gap > 0.0));
}

/// A body at rest on a plane has the force of its weight from the start on.
#[test]
fn statistics_begin_with_the_equilibrium() {
    let body = Body::builder(block_above(0.045))
        .region(rubber())
        .contact(contact(PLANE).named("floor"))
        .support(Support::of_components("corner", [true, false, true]))
        .support(Support::of_components("beside", [false, false, true]))
        .load(Load::acceleration([0.0, -10.0, 0.0]))
        .build()
        .unwrap();
    let state = Equilibrium::new(&body, 1.0, 1).unwrap();
    let state = state.start(NewtonSettings::default(), &[], &mut []).unwrap();
    let motion = Motion::new(&body, at(DGM, 1)).unwrap().from(state).unwrap();
    let mut motion = motion.with_static_reactions().unwrap();
    let of_start = motion.statistics().contacts[0].clone();
    assert_eq!((of_start.first_time, of_start.largest_force_time), (Some(1.0), Some(1.0)));
    assert!((of_start.largest_force.unwrap() - 10.0).abs() < 1e-7 && of_start.duration == 0.0);
    (0..3).for_each(|_| _ = motion.step(0.25).unwrap());
    let after = &motion.statistics().contacts[0];
    assert_eq!((after.first_time, after.last_time, after.duration), (Some(1.0), Some(1.75), 0.75));
    assert_eq!((of_start.intervals, after.intervals), (1, 1));
}

/// The pressure of a layer at a gap: `kappa/4 (g/d) (3 e^2 y + e^3)/y^2` with `y = (g/d)^2`, `e = 1 - y`.
fn pressure_of_layer(gap: f64, distance: f64) -> f64 {
    let y = (gap / distance).powi(2);
    let e = (1.0 - y).max(0.0);
    1333.0 / 4.0 * (gap / distance) * (3.0 * e * e * y + e.powi(3)) / (y * y)
}

/// A plane presses uniformly on every node of every kind of facet; below half the thickness guards press as well.
#[test]
fn fields_of_contact_have_the_uniform_pressure_of_a_plane() {
    let kinds = [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet4, CellKind::Tet10];
    for kind in kinds {
        let mesh = crate::locking::mapped(kind, [2, 2, 2], |[x, y, z]| [x, y + 0.1, z]).build().unwrap();
        let body = Body::builder(mesh).region(rubber()).contact(contact(PLANE)).build().unwrap();
        let fields = Fields::new(&body);
        let names = [FieldName::ContactPressure, FieldName::ContactGap];
        assert!(names.iter().all(|name| fields.has(*name) && body.has_field(*name)));
        for gap in [0.09, 0.045, 0.035, 0.03] {
            let lowered: Vec<f64> =
                (0..body.n_dofs()).map(|dof| if dof % 3 == 1 { gap - 0.1 } else { 0.0 }).collect();
            let found = fields.at([&lowered, &lowered], &names);
            let [pressures, gaps] = [0, 1].map(|field| &found[field].numbers);
            let expected = pressure_of_layer(gap, 0.05);
            let largest = pressures.iter().copied().fold(0.0, f64::max);
            for (node, X) in body.mesh().points().iter().enumerate() {
                if X[1] < 0.1 + 1e-12 {
                    assert!(
                        (pressures[node] - expected).abs() <= 1e-9 * largest,
                        "{kind:?} {gap}: {pressures:?}"
                    );
                    assert!((gaps[node] - gap).abs() < 1e-15, "{kind:?} {gap}: {gaps:?}");
                } else {
                    assert!(pressures[node] == 0.0 && gaps[node].is_nan(), "{kind:?} {gap}: {X:?}");
                }
            }
            assert_eq!(largest > 0.0, gap < 0.05);
        }
    }
    // Guards have a layer of half the thickness and, on linear facets, the same areas.
    let body = Body::builder(block_above(0.02)).region(rubber()).contact(contact(PLANE)).build().unwrap();
    let rest = vec![0.0; body.n_dofs()];
    let fields = Fields::new(&body);
    let middle = body.mesh().points().iter().position(|X| *X == [0.5, 0.02, 0.5]).unwrap() as u32;
    let two = fields.on(&fields.select_nodes(&[0, middle]), [&rest, &rest], FieldName::ContactPressure);
    let (own, of_guard) = (two[0], pressure_of_layer(0.02, 0.025));
    // The guard of the corner has the areas of three facets, of which one is pressed.
    for (own, n) in two.iter().zip([3.0, 1.0]) {
        let expected = pressure_of_layer(0.02, 0.05) + n * of_guard;
        assert!((own / expected - 1.0).abs() < 1e-13, "{own} {expected}");
    }
    // Two contacts add up, and the nearer one has the gap; behind the surface there is no pressure.
    let lower = Obstacle::Plane { point: [0.0, -0.02, 0.0], normal: [0.0, 1.0, 0.0] };
    let both = Body::builder(block_above(0.02)).region(rubber()).contacts([contact(lower), contact(PLANE)]);
    let both = Fields::new(&both.build().unwrap());
    let found = both.at([&rest, &rest], &[FieldName::ContactPressure, FieldName::ContactGap]);
    assert!((found[0].numbers[0] - own - pressure_of_layer(0.04, 0.05)).abs() < 1e-12 * own);
    assert!((found[1].numbers[0] - 0.02).abs() < 1e-15);
    let behind: Vec<f64> = (0..body.n_dofs()).map(|dof| if dof % 3 == 1 { -0.03 } else { 0.0 }).collect();
    let found = fields.at([&behind, &behind], &[FieldName::ContactPressure, FieldName::ContactGap]);
    assert!(found[0].numbers[0].is_nan() && (found[1].numbers[0] + 0.01).abs() < 1e-15);
    // A body without contact has neither field.
    let alone = Body::builder(block_above(0.02)).region(rubber()).build().unwrap();
    assert!(!alone.has_field(FieldName::ContactPressure) && !Fields::new(&alone).has(FieldName::ContactGap));
}

/// On a slanted, round surface the pressures times the areas of the nodes are still the force.
#[test]
fn the_field_of_the_pressure_adds_up_to_the_force() {
    let wall = Obstacle::Sphere { centre: [0.5, 8.0, 0.5], radius: 8.02, inside: true };
    let body = Body::builder(block_above(0.04)).region(rubber());
    let body = body.contact(Contact { surface: None, ..contact(wall) }).build().unwrap();
    let rest = vec![0.0; body.n_dofs()];
    let found = Fields::new(&body).at([&rest, &rest], &[FieldName::ContactPressure]);
    let motion = Motion::new(&body, at(DGM, 1)).unwrap().with_static_reactions().unwrap();
    let force = motion.reactions()[0].force;
    let (mut sum, mut n) = (0.0, 0);
    for (X, pressure) in body.mesh().points().iter().zip(&found[0].numbers) {
        // A quarter of each facet of 1/4 around a node.
        let half = |x: f64| if x == 0.5 { 0.5 } else { 0.25 };
        sum += if X[1] < 0.05 { pressure * half(X[0]) * half(X[2]) } else { 0.0 };
        n += usize::from(*pressure > 0.0);
    }
    assert!(n == 9 && force[1] > 1.0, "{n} {force:?}");
    // The normals lean by up to an eleventh.
    assert!((sum / force[1] - 1.0).abs() < 0.005 && force[1] < sum, "{sum} {force:?}");
}

/// The critical step of central differences with a pressed layer: that of the body at the gap is not below the bound,
/// and the bound is that of a mass on the spring of its layer where the body is soft.
#[test]
fn the_critical_step_falls_with_the_gap() {
    let critical = |mu: f64, law: LayerLaw| {
        let soft = Region::new(NeoHooke::new(0.0, mu).unwrap(), 1.0);
        let floor = Obstacle::Plane { point: [0.0, -0.1, 0.0], normal: [0.0, 1.0, 0.0] };
        let body = Body::builder(mesh::block([1.0; 3], [2; 3]).unwrap()).region(soft);
        let sole = Contact { surface: Some("y-min".into()), ..contact(floor).with_law(law) };
        let body = body.contact(sole).build().unwrap();
        let lowered = |gap: f64| -> Vec<f64> {
            (0..body.n_dofs()).map(|dof| if dof % 3 == 1 { gap - 0.1 } else { 0.0 }).collect()
        };
        let [away, half] = [0.1, 0.025 * (1.0 + 1e-12)]
            .map(|gap| CentralDifferences::critical_steps(&body, &lowered(gap)).unwrap()[0]);
        let bound = CentralDifferences::critical_step_in_contact(&body, &lowered(0.1)).unwrap().unwrap();
        (away, half, bound)
    };
    for law in [LayerLaw::Smooth, LayerLaw::Linear] {
        // psi'' at g = d/2 by differences of the pressure of the law, -psi'.
        let energy = |g: f64| {
            let (y, c) = ((g / 0.05f64).powi(2), 1333.0 * 0.05 / 8.0);
            c * (1.0 - y).powi(if law == LayerLaw::Smooth { 3 } else { 2 }) / y
        };
        let h = 1e-4;
        let stiffness = (energy(0.025 + h) - 2.0 * energy(0.025) + energy(0.025 - h)) / (h * h);
        // A node below has the area 1/4 of a facet and the mass 1/8 of a cell for each cell around it.
        let of_node = 2.0 / (stiffness * (0.25 / 4.0) / (0.125 / 8.0)).sqrt();
        let (away, half, bound) = critical(500.0, law);
        assert!(bound < half * (1.0 + 1e-6) && half < away && bound > 0.9 * half, "{bound} {half} {away}");
        let (_, half, bound) = critical(1e-6, law);
        assert!((bound / of_node - 1.0).abs() < 1e-3, "{law:?}: {bound} {of_node}");
        // All nodes below move alike in the fastest mode.
        assert!((half / bound - 1.0).abs() < 1e-3, "{law:?}: {half} {bound}");
    }
    let alone = Body::builder(block_above(0.1)).region(rubber()).build().unwrap();
    assert_eq!(CentralDifferences::critical_step_in_contact(&alone, &vec![0.0; 81]).unwrap(), None);
}

/// An iteration that fails in an impact has the name of the contact.
#[test]
fn failed_iterations_name_the_contact() {
    let (body, scheme, start) = thrown(rubber(), at(DGM, 1));
    let settings = NewtonSettings { max_iterations: 1, ..NewtonSettings::default() };
    let found = |gap_before: f64| {
        let mut motion = Motion::new(&body, scheme).unwrap().from(start.clone()).unwrap();
        while motion.record().smallest_gap.is_none_or(|gap| gap > gap_before) {
            motion.step(0.0025).unwrap();
        }
        let mut motion = Motion::starting(&body, scheme, settings, motion.state().clone()).unwrap();
        motion.step(0.0025).unwrap_err().to_string()
    };
    let told = found(0.7);
    assert!(told.contains("no convergence") && told.contains(" in contact \"floor\"; try"), "{told}");
}
