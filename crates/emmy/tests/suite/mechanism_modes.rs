//! Natural modes of rigid bodies and joints: against theory, small eigenproblems in independent coordinates by NumPy,
//! and the same bodies with supports and merged meshes.

#![allow(non_snake_case)]

use crate::shared::joints::{plane_hinge, rigid};
use emmy::Error;
use emmy::body::Formulation;
use emmy::mesh::MeshBuilder;
use emmy::modes::{Mode, lowest_elastic_mode, modes, modes_about, n_modes};
use emmy::prelude::*;

const GRAVITY: f64 = 9.81;

fn frequencies(modes: &[Mode]) -> Vec<f64> {
    modes.iter().map(|mode| mode.angular_frequency).collect()
}

fn all_modes(body: &Body) -> Vec<f64> {
    frequencies(&modes(body, n_modes(body)).unwrap())
}

fn assert_close(found: &[f64], expected: &[f64], relative: f64) {
    let is_close = |(a, b): (&f64, &f64)| (a - b).abs() <= relative * b.abs();
    let are_close = found.len() == expected.len() && found.iter().zip(expected).all(is_close);
    assert!(are_close, "{found:?} is not {expected:?}");
}

/// A bar on a hinge at the origin, along a direction in the plane.
fn pendulum(along: [f64; 3], joint: impl Fn(Joint) -> Joint) -> Body {
    let bar = RigidBody::new("bar", 2.0, along.map(|x| 0.5 * x), [0.3, 0.3, 0.4]);
    Body::builder(Mesh::without_cells())
        .rigid(bar)
        .joint(joint(plane_hinge("pin", [rigid("bar"), JointEnd::Ground], [0.0; 3])))
        .load(Load::acceleration([0.0, -GRAVITY, 0.0]))
        .build()
        .unwrap()
}

/// A torsion spring: omega^2 = k / J about the pin. A spring at work has the same stiffness.
#[test]
fn a_bar_swings_on_a_torsion_spring() {
    let expected = (7.0f64 / (0.4 + 2.0 * 0.25)).sqrt();
    for (along, rest) in [([1.0, 0.0, 0.0], None), ([0.6, 0.8, 0.0], Some(0.5))] {
        let body = pendulum(along, |joint| joint.with_spring(7.0, rest));
        let found = modes(&body, 1).unwrap();
        assert_close(&frequencies(&found), &[expected], 1e-13);
        // The momentum of the centre across the bar.
        let effective: f64 = found[0].effective_mass.iter().sum();
        assert!((effective - 2.0 * 2.0 * 0.25 / 0.9).abs() < 1e-13, "{effective}");
        assert!(matches!(modes(&body, 2), Err(Error::TooManyModes { count: 2, free: 1 })));
        let (mode, n_rigid) = lowest_elastic_mode(&body).unwrap().unwrap();
        assert_eq!((mode.angular_frequency, n_rigid), (found[0].angular_frequency, 0));
    }
}

/// A bar that hangs has omega^2 = m g l / J by the force of its pin, and one that stands grows. Without loads it is
/// free.
#[test]
fn a_bar_swings_under_its_weight() {
    let square = 2.0 * GRAVITY * 0.5 / 0.9;
    for (along, expected) in [([0.0, -1.0, 0.0], square.sqrt()), ([0.0, 1.0, 0.0], -square.sqrt())] {
        let body = pendulum(along, |joint| joint);
        let state = State::initial(&body, 0.0, &[]).unwrap();
        assert_close(&frequencies(&modes_about(&body, &state, 1).unwrap()), &[expected], 1e-13);
        assert_eq!(all_modes(&body), [0.0]);
        assert_eq!(lowest_elastic_mode(&body).unwrap(), None);
    }
}

/// A sledge on a slide with a spring, and a point mass on lines.
#[test]
fn springs_in_lines_and_slides_carry_masses() {
    let slide = Joint::new(
        "slide",
        JointKind::Prismatic { axis: [1.0, 2.0, 2.0] },
        [rigid("box"), JointEnd::Ground],
        [0.2, 0.0, 0.1],
    );
    let sledge = RigidBody::new("box", 3.0, [0.0; 3], [0.1, 0.2, 0.25]);
    let body = Body::builder(Mesh::without_cells()).rigid(sledge).joint(slide.with_spring(12.0, None));
    assert_close(&all_modes(&body.build().unwrap()), &[2.0], 1e-13);
    // Three lines along the axes.
    let mut builder = Body::builder(Mesh::without_cells()).rigid(RigidBody::point("ball", 2.0, [0.0; 3]));
    for (axis, stiffness) in [(0, 8.0), (1, 18.0), (2, 50.0)] {
        let mut to = [0.0; 3];
        to[axis] = 2.0;
        let line = Joint::new(
            format!("line-{axis}"),
            JointKind::Line { to },
            [rigid("ball"), JointEnd::Ground],
            [0.0; 3],
        );
        builder = builder.joint(line.with_spring(stiffness, None));
    }
    assert_close(&all_modes(&builder.build().unwrap()), &[2.0, 3.0, 5.0], 1e-13);
}

/// Two bars in a row on hinges with torsion springs.
fn double_pendulum(along: [f64; 3], joints: [impl Fn(Joint) -> Joint; 2]) -> Body {
    let at = |s: f64| along.map(|x| s * x);
    let [ground, knee] = joints;
    Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("a", 2.0, at(0.4), [0.1, 0.25, 0.3]))
        .rigid(RigidBody::new("b", 1.5, at(1.6), [0.1, 0.15, 0.2]))
        .joint(ground(plane_hinge("ground", [rigid("a"), JointEnd::Ground], [0.0; 3])))
        .joint(knee(plane_hinge("knee", [rigid("b"), rigid("a")], at(1.0))))
        .load(Load::acceleration([0.0, -GRAVITY, 0.0]))
        .build()
        .unwrap()
}

type Change = fn(Joint) -> Joint;

/// The 2 x 2 eigenproblem in the angles.
#[test]
fn a_double_pendulum_has_two_modes() {
    let springs: [Change; 2] = [|joint| joint.with_spring(50.0, None), |joint| joint.with_spring(20.0, None)];
    let body = double_pendulum([1.0, 0.0, 0.0], springs);
    let expected = [2.838_838_310_797_445, 12.787_795_467_253_43];
    assert_close(&all_modes(&body), &expected, 1e-13);
    let free: [Change; 2] = [|joint| joint, |joint| joint];
    let body = double_pendulum([0.0, -1.0, 0.0], free);
    assert_eq!((all_modes(&body), body.mobility().degrees_of_freedom), (vec![0.0; 2], Some(2)));
    let state = State::initial(&body, 0.0, &[]).unwrap();
    let expected = [2.557_768_870_712_844_8, 6.334_746_226_865_21];
    assert_close(&frequencies(&modes_about(&body, &state, 2).unwrap()), &expected, 1e-13);
}

/// A given motion holds its joint, and so does a joint that is released later.
#[test]
fn driven_joints_are_held() {
    let driven: [Change; 2] = [
        |joint| joint.driven(TimeFunction::smooth("0.3 * t", |t| [0.3 * t, 0.3, 0.0])),
        |joint| joint.with_spring(20.0, None),
    ];
    let body = double_pendulum([1.0, 0.0, 0.0], driven);
    let expected = (20.0f64 / (0.2 + 1.5 * 0.36)).sqrt();
    assert_close(&all_modes(&body), &[expected], 1e-13);
    let released: [Change; 2] = [|joint| joint.until(1.0), |joint| joint.with_spring(20.0, None)];
    let body = double_pendulum([1.0, 0.0, 0.0], released);
    assert_eq!(n_modes(&body), 2);
}

/// Two bars on a hinge that fly: of seven ways to move six are rigid.
#[test]
fn free_hinged_bodies_have_six_rigid_modes() {
    let body = |stiffness: f64| {
        let knee = plane_hinge("knee", [rigid("b"), rigid("a")], [0.0; 3]);
        Body::builder(Mesh::without_cells())
            .rigid(RigidBody::new("a", 2.0, [-0.4, 0.0, 0.0], [0.1, 0.25, 0.3]))
            .rigid(RigidBody::new("b", 1.5, [0.6, 0.0, 0.0], [0.1, 0.15, 0.2]))
            .joint(knee.with_spring(stiffness, None))
            .build()
            .unwrap()
    };
    let found = modes(&body(20.0), 7).unwrap();
    assert_eq!(frequencies(&found)[..6], [0.0; 6]);
    assert_close(&frequencies(&found)[6..], &[12.279_806_626_883_454], 1e-13);
    for (axis, mode) in found[..3].iter().enumerate() {
        assert!((mode.effective_mass[axis] - 3.5).abs() < 1e-12, "{mode:?}");
    }
    assert_eq!(all_modes(&body(0.0)), [0.0; 7]);
}

/// Three equal cranks and two couplers between their tops, of rods with a moment about themselves. They move in
/// parallel, and six constraints follow from the others.
fn parallel_cranks(about: f64) -> Body {
    let rod = |name: &str, centre: [f64; 3], along: usize| {
        let mut moments = [1.0 / 12.0; 3];
        moments[along] = about;
        RigidBody::new(name, 1.0, centre, moments)
    };
    let mut builder = Body::builder(Mesh::without_cells());
    for i in 0..3 {
        let (x, name) = (i as f64, format!("crank-{i}"));
        let foot = plane_hinge(&format!("foot-{i}"), [rigid(&name), JointEnd::Ground], [x, 0.0, 0.0]);
        let foot = if i == 1 { foot.with_spring(6.0, Some(0.3)) } else { foot };
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
    builder.build().unwrap()
}

/// T = (3 J / 2 + m) omega^2 with J = 1/3 and m = 1. Without a moment about themselves rods have two directions without
/// mass.
#[test]
fn constraints_that_follow_from_others_do_no_harm() {
    for about in [1e-3, 0.0] {
        let body = parallel_cranks(about);
        assert_eq!(body.mobility().n_redundant, 6);
        assert_close(&all_modes(&body), &[2.0f64.sqrt()], 1e-12);
    }
}

/// A chain of equal masses on equal rods swings with omega^2 = x g / l, x the zeros of Laguerre's polynomial (Bernoulli
/// 1738), in two directions alike. The stiffness is that of the forces of the rods alone.
#[test]
fn a_hanging_chain_has_the_zeros_of_laguerres_polynomial() {
    let chain = |n: usize| {
        let ball = |i: usize| format!("ball-{i}");
        let mut builder = Body::builder(Mesh::without_cells()).load(Load::acceleration([0.0, -GRAVITY, 0.0]));
        for i in 1..=n {
            let at = [0.0, -0.5 * i as f64, 0.0];
            let (to, other) = match i {
                1 => ([0.0; 3], JointEnd::Ground),
                _ => ([0.0, at[1] + 0.5, 0.0], rigid(&ball(i - 1))),
            };
            builder = builder.rigid(RigidBody::point(ball(i), 0.2, at));
            let rod =
                Joint::new(format!("rod-{i}"), JointKind::Distance { to }, [rigid(&ball(i)), other], at);
            builder = builder.joint(rod);
        }
        builder.build().unwrap()
    };
    let zeros =
        [(3, [0.415_774_556_783_479, 2.294_280_360_279_042, 6.289_945_082_937_479]), (80, SMALLEST_OF_80)];
    for (n, zeros) in zeros {
        let body = chain(n);
        assert_eq!(n_modes(&body), 2 * n);
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let found = frequencies(&modes_about(&body, &state, 6).unwrap());
        let expected = zeros.iter().flat_map(|x| [(x * GRAVITY / 0.5).sqrt(); 2]);
        assert_close(&found, &expected.collect::<Vec<f64>>(), 1e-10);
    }
}

/// The three smallest zeros of the polynomial of degree 80.
const SMALLEST_OF_80: [f64; 3] =
    [0.017_960_423_300_698_91, 0.094_639_912_994_355_65, 0.232_622_868_125_865_5];

fn steel() -> Region {
    Region::new(NeoHooke::from_engineering(3e4, 0.3).unwrap(), 2.0)
}

fn nodes(mesh: &Mesh, is_chosen: impl Fn([f64; 3]) -> bool) -> Vec<u32> {
    (0..).zip(mesh.points()).filter(|(_, X)| is_chosen(**X)).map(|(node, _)| node).collect()
}

fn beam(cells: [usize; 3]) -> Mesh {
    mesh::block([4.0, 1.0, 0.5], cells).unwrap()
}

/// A face that is rigid, and fixed to the ground by a joint, is a support. Off its plane the face has no mass.
#[test]
fn a_rigid_face_on_a_fixed_joint_is_a_support() {
    for (cells, count) in [([2, 1, 1], 12), ([8, 2, 2], 8)] {
        for formulation in [None, Some(Formulation::IncompatibleModes)] {
            let region = || formulation.iter().fold(steel(), |region, own| region.with_formulation(*own));
            let face = Joint::new("wall", JointKind::Fixed, [rigid("plate"), JointEnd::Ground], [0.0; 3]);
            let joined =
                Body::builder(beam(cells)).region(region()).rigid(RigidBody::group("plate", "x-min"));
            let joined = joined.joint(face).build().unwrap();
            let held = Body::builder(beam(cells)).region(region()).support(Support::fixed("x-min"));
            let held = held.build().unwrap();
            assert_eq!(n_modes(&joined), n_modes(&held));
            let [found, expected] = [&joined, &held].map(|body| modes(body, count).unwrap());
            assert_close(&frequencies(&found), &frequencies(&expected), 1e-9);
            for (own, other) in found.iter().zip(&expected) {
                let masses = own.effective_mass.iter().zip(&other.effective_mass);
                assert!(masses.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) < 1e-6);
            }
        }
    }
}

/// Ball joints between all nodes of two faces join them as one mesh does; one to the ground holds a node.
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
    let seam = nodes(&apart, |X| X[0] == 2.0);
    let corner = [0.0; 3];
    let mut builder = Body::builder(apart.clone()).region(steel());
    for (i, &node) in seam.iter().enumerate() {
        let X = apart.points()[node as usize];
        let Some(&other) = seam[i + 1..].iter().find(|&&other| apart.points()[other as usize] == X) else {
            continue;
        };
        let ends = [JointEnd::Node(node), JointEnd::Node(other)];
        builder = builder.joint(Joint::new(format!("seam-{i}"), JointKind::Spherical, ends, X));
    }
    let ends = [JointEnd::Node(apart.nearest_node(corner) as u32), JointEnd::Ground];
    let joined = builder.joint(Joint::new("corner", JointKind::Spherical, ends, corner)).build().unwrap();
    let merged = beam([6, 1, 1]);
    let held = merged.nearest_node(corner) as u32;
    let merged = merged.with_node_group("corner", [held]).unwrap();
    let merged = Body::builder(merged).region(steel()).support(Support::fixed("corner")).build().unwrap();
    assert_eq!(n_modes(&joined), n_modes(&merged));
    let [found, expected] = [&joined, &merged].map(|body| frequencies(&modes(body, 9).unwrap()));
    assert_eq!(found[..3], [0.0; 3]);
    assert_close(&found, &expected, 1e-9);
}

/// A heavy tip on a light clamped beam has omega^2 = 3 E I / (m L^3) in both directions.
#[test]
fn a_light_beam_carries_a_heavy_rigid_tip() {
    let light = Region::new(SaintVenantKirchhoff::from_engineering(1e6, 0.0).unwrap(), 1e-6);
    let mesh = mesh::block([8.0, 0.5, 0.5], [40, 2, 2]).unwrap();
    let tip = RigidBody {
        group: Some("x-max".into()),
        ..RigidBody::new("tip", 10.0, [8.0, 0.25, 0.25], [1e-4; 3])
    };
    let body = Body::builder(mesh)
        .region(light.with_formulation(Formulation::IncompatibleModes))
        .rigid(tip)
        .support(Support::fixed("x-min"))
        .build()
        .unwrap();
    let found = modes(&body, 2).unwrap();
    let rigidity = 1e6 * 0.5f64.powi(4) / 12.0;
    let expected = (3.0 * rigidity / (10.0 * 8.0f64.powi(3))).sqrt();
    for mode in found {
        // Shear lowers it by 3 E I / (k G A L^2) / 2 = 0.3 %.
        assert!(
            (mode.angular_frequency / expected - 1.0).abs() < 0.01,
            "{mode:?}",
            mode = mode.angular_frequency
        );
        assert!((mode.effective_mass.iter().sum::<f64>() - 10.0).abs() < 0.01);
    }
}
