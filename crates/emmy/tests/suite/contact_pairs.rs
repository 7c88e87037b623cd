//! Contact between bodies, against an independent implementation and closed forms.

#![allow(non_snake_case)]

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_4;

use crate::shared::contact::{conserving, contact, joined, others, rubber, spinning, two_blocks};
use crate::shared::schemes::{DGM, at};
use emmy::body::{Contact, Joint, JointEnd, JointKind, LayerLaw, RigidBody, Tie};
use emmy::equilibrium::Equilibrium;
use emmy::mesh::{CellKind, Facet, MeshBuilder, Placement};
use emmy::motion::{Adaptivity, NewtonSettings};
use emmy::prelude::*;

/// Two cubes that meet edge on edge.
fn two_edges() -> (Mesh, [InitialVelocity; 2]) {
    let cube = || mesh::block([1.0; 3], [1; 3]).unwrap();
    let middle = [0.5; 3];
    let a = Placement::default().turned([1.0, 0.0, 0.0], FRAC_PI_4, middle).unwrap();
    let b = Placement::default().turned([0.0, 0.0, 1.0], FRAC_PI_4, middle).unwrap();
    let height = 2.0f64.sqrt() + 0.1;
    let mesh = joined(&[(cube(), a), (cube(), b.shifted([0.13, height, 0.07]))]);
    let velocities = [
        spinning("a", [0.0, 1.0, 0.0], [0.0; 3], [0.0; 3]),
        spinning("b", [0.0, -1.0, 0.0], [0.0; 3], [0.0; 3]),
    ];
    (mesh, velocities)
}

/// The results of another implementation.
struct Impact {
    steps: usize,
    h: f64,
    energies: [f64; 2],
    probe: [[f64; 3]; 2],
    largest: f64,
    gap: f64,
}

fn assert_impact((mesh, velocities): (Mesh, [InitialVelocity; 2]), k: usize, expected: &Impact) {
    let near_probe = |X: &[f64; 3]| (0..3).all(|d| (X[d] - expected.probe[0][d]).abs() < 1e-12);
    let probe = mesh.points().iter().position(near_probe).unwrap();
    let body = Body::builder(mesh).region(rubber()).contact(contact()).build().unwrap();
    let start = State::initial(&body, 0.0, &velocities).unwrap();
    let scheme = TimeElement::discrete_gradient(k).unwrap();
    let mut motion = Motion::new(&body, scheme).unwrap().from(start).unwrap();
    let first = motion.record().clone();
    let (mut largest, mut gap, mut corrections) = (0.0f64, 1.0f64, 0);
    for _ in 0..expected.steps {
        let record = motion.step(expected.h).unwrap();
        largest = largest.max(record.contact_energy);
        gap = gap.min(record.smallest_gap.unwrap_or(1.0));
        corrections += record.newton_iterations;
        assert!(record.energy_residual.abs() < 1e-11 * record.total_energy, "{}", record.energy_residual);
        assert_eq!(record.cuts, 0);
    }
    // Two of these are polish.
    assert!(corrections < 10 * expected.steps, "{corrections} corrections");
    let record = motion.record();
    let near = |own: f64, expected: f64, scale: f64| {
        assert!((own - expected).abs() < 1e-7 * scale, "{own} {expected}");
    };
    let place = motion.state().position(&body, probe);
    for d in 0..3 {
        assert!((record.linear_momentum[d] - first.linear_momentum[d]).abs() < 1e-11);
        assert!((record.angular_momentum[d] - first.angular_momentum[d]).abs() < 1e-11);
        near(place[d], expected.probe[1][d], 1.0);
    }
    near(record.kinetic_energy, expected.energies[0], record.total_energy);
    near(record.strain_energy, expected.energies[1], record.total_energy);
    near(record.contact_energy, 0.0, record.total_energy);
    near(largest, expected.largest, record.total_energy);
    near(gap, expected.gap / 0.05, 1.0);
}

#[test]
fn two_blocks_fly_against_each_other() {
    assert_impact(
        two_blocks([2, 2]),
        1,
        &Impact {
            steps: 15,
            h: 0.01,
            energies: [1.014_137_910_007_959_5, 0.112_545_423_330_122_8],
            probe: [[1.0; 3], [1.026_128_929_972_627_3, 0.858_544_502_011_379, 1.051_456_160_011_240_9]],
            largest: 0.163_652_113_278_199_8,
            gap: 0.027_381_725_385_777_964,
        },
    );
    assert_impact(
        two_blocks([2, 2]),
        2,
        &Impact {
            steps: 8,
            h: 0.02,
            energies: [1.038_056_951_907_090_6, 0.088_626_381_426_509_53],
            probe: [[1.0; 3], [1.029_402_716_825_031, 0.839_125_049_758_407_1, 1.052_442_962_629_938]],
            largest: 0.145_784_903_174_744_63,
            gap: 0.024_526_104_715_590_618,
        },
    );
    assert_impact(
        two_blocks([2, 3]),
        1,
        &Impact {
            steps: 15,
            h: 0.01,
            energies: [0.995_463_405_612_130_2, 0.131_219_927_720_912_3],
            probe: [[1.0; 3], [1.028_273_675_121_231_8, 0.858_521_086_692_031_9, 1.052_494_890_817_912]],
            largest: 0.146_619_003_684_103_52,
            gap: 0.032_798_664_072_127_656,
        },
    );
}

#[test]
fn cubes_that_meet_edge_on_edge_do_not_pass() {
    assert_impact(
        two_edges(),
        1,
        &Impact {
            steps: 30,
            h: 0.01,
            energies: [0.965_693_193_157_907_6, 0.034_306_806_840_253_466],
            probe: [
                [0.0, 0.499_999_999_999_999_94, -0.207_106_781_186_547_46],
                [-0.004_454_466_201_544_033, 0.498_537_946_245_507_06, -0.215_300_983_574_712_45],
            ],
            largest: 0.140_902_140_629_156_4,
            gap: 0.018_126_450_961_444_673,
        },
    );
    assert_impact(
        two_edges(),
        2,
        &Impact {
            steps: 15,
            h: 0.02,
            energies: [0.966_393_125_843_887_5, 0.033_606_874_160_846_08],
            probe: [
                [0.0, 0.499_999_999_999_999_94, -0.207_106_781_186_547_46],
                [-0.002_598_600_654_505_183, 0.503_424_904_467_958_8, -0.216_995_636_619_912_34],
            ],
            largest: 0.027_627_819_268_849_708,
            gap: 0.020_875_514_776_719_718,
        },
    );
}

/// A small block that flies against a larger one, with a formulation.
fn thrown(region: Region) -> (Body, State) {
    let (mesh, velocities) = two_blocks([2, 2]);
    let body = Body::builder(mesh).region(region).contact(contact()).build().unwrap();
    let start = State::initial(&body, 0.0, &velocities).unwrap();
    (body, start)
}

#[test]
fn time_elements_of_every_degree_keep_energy_and_momenta() {
    for (region, scheme, h) in conserving(0.01) {
        let name = format!("{scheme:?} {h}");
        let (body, start) = thrown(region);
        let mut motion = Motion::new(&body, scheme).unwrap().from(start).unwrap();
        let first = motion.record().clone();
        let mut largest = 0.0f64;
        for _ in 0..(0.2 / h).ceil() as usize {
            largest =
                largest.max(motion.step(h).unwrap_or_else(|error| panic!("{name}: {error}")).contact_energy);
        }
        let record = motion.record();
        assert!(
            largest > 0.05 && record.smallest_gap.is_none_or(|gap| gap > 1.0),
            "{name}: {largest} {record:?}"
        );
        assert!((record.total_energy - first.total_energy).abs() < 1e-10, "{name}: {record:?}");
        for d in 0..3 {
            assert!((record.linear_momentum[d] - first.linear_momentum[d]).abs() < 1e-12, "{name}");
            assert!((record.angular_momentum[d] - first.angular_momentum[d]).abs() < 1e-11, "{name}");
        }
    }
}

/// The momentum of the first block after the impact in fine steps of the DGM; the others approach it.
#[test]
fn other_schemes_rebound_alike() {
    let rebound = |scheme: Scheme, h: f64| {
        let (body, start) = thrown(rubber());
        let mut motion = Motion::new(&body, scheme).unwrap().from(start).unwrap();
        let first = motion.record().clone();
        let mut impulse = 0.0;
        for _ in 0..(0.2 / h).round() as usize {
            motion.step(h).unwrap_or_else(|error| panic!("{scheme:?}: {error}"));
            impulse += h * motion.reactions()[0].force[1];
        }
        let record = motion.record().clone();
        for d in 0..3 {
            assert!((record.linear_momentum[d] - first.linear_momentum[d]).abs() < 1e-10, "{scheme:?}");
        }
        impulse
    };
    let exact = rebound(at(DGM, 3), 0.002);
    assert!((-1.8..-1.4).contains(&exact), "{exact}");
    for (scheme, h) in others(0.001) {
        let own = rebound(scheme, h);
        // The lumped mass of central differences strikes with another part of the whole.
        let tolerance = if scheme == Scheme::CentralDifferences { 0.04 } else { 0.02 };
        assert!((own - exact).abs() < tolerance * exact.abs(), "{scheme:?}: {own} {exact}");
    }
}

#[test]
fn a_motion_resumed_in_an_impact_has_the_same_bits() {
    for scheme in [at(DGM, 1), at(DGM, 2), Scheme::from_name("HHT(0)").unwrap()] {
        let (body, start) = thrown(rubber());
        let mut motion = Motion::new(&body, scheme).unwrap().from(start).unwrap();
        (0..5).for_each(|_| _ = motion.step(0.01).unwrap());
        assert!(motion.record().contact_energy > 0.0);
        let snapshot = motion.snapshot();
        let mut resumed = Motion::resumed(&body, scheme, NewtonSettings::default(), snapshot).unwrap();
        for _ in 0..12 {
            assert_eq!(motion.step(0.01).unwrap(), resumed.step(0.01).unwrap());
        }
    }
}

#[test]
fn results_do_not_depend_on_threads() {
    let record = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let block = || mesh::block([1.0; 3], [8; 3]).unwrap();
            let above = Placement::default().shifted([0.2, 1.05, 0.1]);
            let mesh = joined(&[(block(), Placement::default()), (block(), above)]);
            let body =
                Body::builder(mesh).region(rubber()).contact(Contact::of_all_bodies()).build().unwrap();
            let falls = spinning("b", [0.0, -2.0, 0.0], [1.0, 0.0, 0.0], [0.7, 1.55, 0.6]);
            let start = State::initial(&body, 0.0, &[falls]).unwrap();
            let mut motion = Motion::new(&body, at(DGM, 1)).unwrap().from(start).unwrap();
            let most = (0..12).map(|_| motion.step(0.005).unwrap().contact_energy).fold(0.0, f64::max);
            assert!(most > 0.0);
            motion.record().clone()
        })
    };
    assert_eq!(record(1), record(4));
}

/// A block pressed on another with the same cells: the pressure of the layer at its gap g, with y = (g/d)^2 and
/// e = 1 - y, is that on top, and the energy of the area 1 is psi:
///
/// ```math
/// p = kappa/4 g/d (3 e^2 y + e^3)/y^2,    psi = kappa d/8 e^3/y
/// ```
#[test]
fn a_block_is_pressed_on_another() {
    let block = || mesh::block([1.0; 3], [2; 3]).unwrap();
    let (gap, d, kappa) = (0.041f64, 0.05, 1000.0);
    let y = (gap / d).powi(2);
    let e = 1.0 - y;
    let pressure = kappa / 4.0 * gap / d * (3.0 * e * e * y + e.powi(3)) / (y * y);
    let mut builder = MeshBuilder::new();
    builder.part("lower", &block()).unwrap();
    let upper = Placement::default().shifted([0.0, 0.0, 1.049]);
    builder.part("upper", &block().placed(&upper).unwrap()).unwrap();
    let region = Region::new(SaintVenantKirchhoff::from_engineering(1000.0, 0.0).unwrap(), 1.0);
    let sides = ["x-min", "y-min"].into_iter().flat_map(|side| ["lower", "upper"].map(|part| (part, side)));
    let body = Body::builder(builder.build().unwrap())
        .region(region)
        .contact(Contact::between("lower", "upper").with_stiffness(kappa).with_distance(d))
        .supports(sides.map(|(part, side)| Support::symmetry(format!("{part}-{side}"))))
        .support(Support::symmetry("lower-z-min"))
        .load(Load::traction("upper-z-max", [0.0, 0.0, -pressure]))
        .build()
        .unwrap();
    let found = Equilibrium::new(&body, 0.0, 1).unwrap().start(NewtonSettings::default(), &[], &mut []);
    let state = found.unwrap_or_else(|error| panic!("{error}"));
    let motion = Motion::new(&body, TimeElement::discrete_gradient(1).unwrap()).unwrap().from(state).unwrap();
    let record = motion.record();
    assert!((record.smallest_gap.unwrap() - gap / d).abs() < 1e-10, "{record:?}");
    assert!((record.contact_energy - kappa * d / 8.0 * e.powi(3) / y).abs() < 1e-10);
    assert_eq!(record.contact_points, 32);
}

/// A rigid block on another one, which is held, bobs with `omega^2 = A psi''(g)/m`, where `A psi'(g)` is its weight.
#[test]
fn modes_have_the_stiffness_of_the_layer() {
    let block = || mesh::block([1.0; 3], [2; 3]).unwrap();
    let above = Placement::default().shifted([0.0, 1.045, 0.0]);
    let slide = Joint::new(
        "slide",
        JointKind::Prismatic { axis: [0.0, 1.0, 0.0] },
        [JointEnd::Rigid("stone".into()), JointEnd::Ground],
        [0.5, 1.0, 0.5],
    );
    let body = Body::builder(joined(&[(block(), Placement::default()), (block(), above)]))
        .region(rubber())
        .support(Support::fixed("a"))
        .rigid(RigidBody::group("stone", "b"))
        .joint(slide)
        .contact(contact().with_law(LayerLaw::Linear))
        .load(Load::acceleration([0.0, -60.0, 0.0]))
        .build()
        .unwrap();
    let found = Equilibrium::new(&body, 0.0, 1).unwrap().start(NewtonSettings::default(), &[], &mut []);
    let state = found.unwrap_or_else(|error| panic!("{error}"));
    let gap = state.position(&body, 27)[1] - 1.0;
    let (c, d) = (1333.0 * 0.05 / 8.0, 0.05f64);
    let (y, by_gap) = (gap * gap / (d * d), 2.0 * gap / (d * d));
    let slope = -c * (1.0 / (y * y) - 1.0) * by_gap;
    assert!((slope + 60.0).abs() < 1e-8 * 60.0, "{slope}");
    let stiffness = 2.0 * c / (y * y * y) * by_gap * by_gap + slope / gap;
    let modes = emmy::modes::modes_about(&body, &state, 1).unwrap();
    let omega = 2.0 * std::f64::consts::PI * modes[0].frequency();
    assert!((omega * omega / stiffness - 1.0).abs() < 1e-8, "{} {stiffness}", omega * omega);
    // At rest it stays there.
    let mut motion = Motion::new(&body, at(DGM, 2)).unwrap().from(state).unwrap();
    (0..10).for_each(|_| _ = motion.step(0.01).unwrap());
    assert!(motion.record().kinetic_energy < 1e-16);
}

/// A block of two tied layers that is hit on a side, where nodes follow others.
#[test]
fn a_tied_block_is_hit_without_loss() {
    assert_no_loss(2, &[1, 2], 0.1);
    // Conjugate gradients take the derivatives of the layer.
    assert_no_loss(6, &[1], 0.05);
}

/// Layers of n and n + 1 cells along an edge, hit by a block of n; degrees of the time elements, and a bound on the
/// largest energy of the contact.
fn assert_no_loss(n: usize, degrees: &[usize], least: f64) {
    let layer = |n: usize| mesh::block([1.0, 0.5, 1.0], [n, 1, n]).unwrap();
    let at = |place: [f64; 3]| Placement::default().shifted(place);
    let other = mesh::block([1.0; 3], [n; 3]).unwrap();
    let mesh = joined(&[
        (layer(n), at([0.0; 3])),
        (layer(n + 1), at([0.0, 0.5, 0.0])),
        (other, at([1.06, 0.1, 0.15])),
    ]);
    let followers = (0..mesh.n_nodes() as u32).filter(|node| {
        let X = mesh.points()[*node as usize];
        X[1] == 0.5 && X[0] <= 1.0 && *node as usize >= 2 * (n + 1).pow(2)
    });
    let followers: Vec<u32> = followers.collect();
    assert_eq!(followers.len(), (n + 2).pow(2));
    let mesh = mesh.with_node_group("upper", followers).unwrap();
    let contact = Contact::of_all_bodies().with_stiffness(1333.0).with_distance(0.05);
    let body = Body::builder(mesh).region(rubber()).tie(Tie::nodes("upper", "a")).contact(contact);
    let body = body.build().unwrap();
    let thrown = spinning("c", [-2.0, 0.1, 0.0], [0.0, 0.5, 0.0], [1.56, 0.6, 0.65]);
    for &k in degrees {
        let start = State::initial(&body, 0.0, std::slice::from_ref(&thrown)).unwrap();
        let mut motion = Motion::new(&body, TimeElement::discrete_gradient(k).unwrap()).unwrap();
        motion = motion.from(start).unwrap();
        let first = motion.record().clone();
        let (mut largest, mut corrections) = (0.0f64, 0);
        for _ in 0..40 {
            let record = motion.step(0.005).unwrap();
            largest = largest.max(record.contact_energy);
            corrections += record.newton_iterations;
        }
        let record = motion.record();
        assert!(largest > least && corrections < 40 * 10, "{largest} {corrections}");
        assert!((record.total_energy - first.total_energy).abs() < 1e-11 * first.total_energy, "{record:?}");
        for d in 0..3 {
            assert!((record.linear_momentum[d] - first.linear_momentum[d]).abs() < 1e-12);
            assert!((record.angular_momentum[d] - first.angular_momentum[d]).abs() < 1e-11);
        }
    }
}

/// Adaptive steps through an impact keep energy and momenta, and approach the motion in fine steps.
#[test]
fn adaptive_steps_find_the_impact() {
    let (body, start) = thrown(rubber());
    let exact = {
        let mut motion = Motion::new(&body, at(DGM, 3)).unwrap().from(start.clone()).unwrap();
        (0..60).for_each(|_| _ = motion.step(0.001).unwrap());
        motion.state().displacement.clone()
    };
    let errors = [1e-3, 1e-5].map(|tolerance| {
        let mut motion = Motion::new(&body, at(DGM, 2)).unwrap().from(start.clone()).unwrap();
        let plan = StepPlan::adaptive(0.0, 0.06, Adaptivity::new(tolerance)).unwrap();
        let first = motion.record().clone();
        motion.march(&plan, &mut []).unwrap();
        let record = motion.record();
        assert!((record.total_energy - first.total_energy).abs() < 1e-10 && record.contact_energy > 0.01);
        assert!((record.angular_momentum[0] - first.angular_momentum[0]).abs() < 1e-11);
        let difference = motion.state().displacement.iter().zip(&exact).map(|(u, exact)| (u - exact).abs());
        difference.fold(0.0, f64::max)
    });
    assert!(errors[1] < 0.3 * errors[0] && errors[0] < 0.02, "{errors:?}");
}

/// Cubes that pass edge over edge: the smallest gap is that of the edges, although no point of a facet is near, and
/// does not depend on the list of a motion that was resumed.
#[test]
fn gaps_of_edges_count() {
    let (mesh, mut velocities) = two_edges();
    velocities[0].velocity = [0.0; 3];
    velocities[1].velocity = [-0.4, -0.5, 0.0];
    let body = Body::builder(mesh).region(rubber()).contact(contact().with_distance(0.04)).build().unwrap();
    let start = State::initial(&body, 0.0, &velocities).unwrap();
    let mut motion = Motion::new(&body, at(DGM, 1)).unwrap().from(start).unwrap();
    let mut seen = 0;
    for step in 0..12 {
        let settings = NewtonSettings::default();
        let mut resumed = Motion::resumed(&body, at(DGM, 1), settings, motion.snapshot()).unwrap();
        let record = motion.step(0.01).unwrap();
        assert_eq!(record, resumed.step(0.01).unwrap());
        // The edges of the cubes approach along y: 0.1 apart at first.
        let gap = 0.1 - 0.005 * (step + 1) as f64;
        if gap < 2.0 * 0.04 - 1e-9 && gap > 0.04 {
            assert!((record.smallest_gap.unwrap() * 0.04 - gap).abs() < 1e-10, "{record:?}");
            seen += 1;
        }
    }
    assert!(seen > 4, "{seen}");
}

/// Triangles of a surface as the contact has them, at current positions, with their edges.
fn triangles(mesh: &Mesh, x: &[[f64; 3]], first_cells: std::ops::Range<usize>) -> Vec<[[f64; 3]; 3]> {
    let mut quads = mesh.boundary();
    // The cells of each body have nodes of their own, in their order.
    quads.retain(|quad| first_cells.contains(&(quad[0] as usize)));
    triangles_of(&quads, x)
}

/// Triangles of quadrilaterals about their middles, at current positions.
fn triangles_of(quads: &[Vec<u32>], x: &[[f64; 3]]) -> Vec<[[f64; 3]; 3]> {
    let of_quad = |quad: &Vec<u32>| {
        let corners = [0, 1, 2, 3].map(|i| x[quad[i] as usize]);
        let middle = [0, 1, 2].map(|d| corners.iter().map(|x| x[d]).sum::<f64>() / 4.0);
        [0, 1, 2, 3].map(|i| [corners[i], corners[(i + 1) % 4], middle])
    };
    quads.iter().flat_map(of_quad).collect()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|d| a[d] - b[d])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|d| a[d] * b[d]).sum()
}

/// Whether a segment cuts a triangle (Moeller and Trumbore).
fn cuts([from, to]: [[f64; 3]; 2], [a, b, c]: [[f64; 3]; 3]) -> bool {
    let (along, u, v) = (minus(to, from), minus(b, a), minus(c, a));
    let p = cross(along, v);
    let det = dot(u, p);
    if det == 0.0 {
        return false;
    }
    let s = minus(from, a);
    let (first, q) = (dot(s, p) / det, cross(s, u));
    let (second, t) = (dot(along, q) / det, dot(v, q) / det);
    first >= 0.0 && second >= 0.0 && first + second <= 1.0 && (0.0..=1.0).contains(&t)
}

fn cut_edges(one: &[[[f64; 3]; 3]], other: &[[[f64; 3]; 3]]) -> usize {
    let edges = one.iter().flat_map(|own| [0, 1, 2].map(|i| [own[i], own[(i + 1) % 3]]));
    edges.map(|edge| other.iter().filter(|triangle| cuts(edge, **triangle)).count()).sum()
}

/// Takes a step, in smaller parts where it fails; returns their number.
fn advance(motion: &mut Motion<'_>, h: f64) -> usize {
    match motion.step(h) {
        Ok(_) => 0,
        Err(error) => {
            assert!(h > 1e-5, "{error}");
            2 + advance(motion, 0.5 * h) + advance(motion, 0.5 * h)
        }
    }
}

/// Number of random drops.
const N_DROPS: usize = 200;

/// Two blocks that meet at random angles and speeds: nothing passes, and the balances close.
#[test]
fn nothing_passes_in_random_drops() {
    let mut seed = 7u64;
    let mut random = move || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let (mut n_contacts, mut n_cuts) = (0, 0);
    for trial in 0..N_DROPS {
        let middle = [0.5; 3];
        let placed = |random: &mut dyn FnMut() -> f64| {
            let axis = [random(), random(), random()];
            Placement::default().turned(axis, 6.0 * random(), middle).unwrap()
        };
        let (a, b) = (placed(&mut random), placed(&mut random));
        let n = 1 + trial % 2;
        let block = || mesh::block([1.0; 3], [n; 3]).unwrap();
        let b = b.shifted([0.9 * random(), 1.9, 0.9 * random()]);
        let mesh = joined(&[(block(), a), (block(), b)]);
        let half = mesh.n_nodes() / 2;
        let contact = Contact::between("a", "b").with_distance(0.05).with_stiffness(1000.0);
        let body = Body::builder(mesh).region(rubber()).contact(contact).build().unwrap();
        let speed = 1.0 + 3.0 * (random() + 0.5);
        let spin = [2.0 * random(), 2.0 * random(), 2.0 * random()];
        let velocities = [
            spinning("a", [0.0, 0.5 * speed, 0.0], spin, middle),
            spinning("b", [0.0, -0.5 * speed, 0.0], [0.0; 3], [0.0; 3]),
        ];
        let start = State::initial(&body, 0.0, &velocities).unwrap();
        let k = 1 + trial / 2 % 2;
        let mut motion =
            Motion::new(&body, TimeElement::discrete_gradient(k).unwrap()).unwrap().from(start).unwrap();
        let h = 0.005 * k as f64;
        let mut touched = false;
        for _ in 0..(1.2 / speed / h) as usize {
            n_cuts += advance(&mut motion, h);
            let record = motion.record().clone();
            touched |= record.contact_energy > 0.0;
            assert!(record.energy_residual.abs() < 1e-10 * record.total_energy, "trial {trial}: {record:?}");
            assert!(record.smallest_gap.is_none_or(|gap| gap > 0.0));
            let x: Vec<[f64; 3]> =
                (0..body.mesh().n_nodes()).map(|node| motion.state().position(&body, node)).collect();
            let of = |nodes: std::ops::Range<usize>| triangles(body.mesh(), &x, nodes);
            let (one, other) = (of(0..half), of(half..2 * half));
            assert_eq!(cut_edges(&one, &other) + cut_edges(&other, &one), 0, "trial {trial}");
        }
        n_contacts += usize::from(touched);
    }
    assert!(n_contacts > 120, "{n_contacts}");
    assert!(n_cuts < 100, "{n_cuts}");
}

/// Place of a cube in a grid, and its nodes.
type Cube = ([usize; 3], [u32; 8]);

/// Bricks between planes along each axis, those that are meant by their numbers along the axes, with the nodes of each.
fn bricks(planes: [&[f64]; 3], is_there: impl Fn([usize; 3]) -> bool) -> (MeshBuilder, Vec<Cube>) {
    let (mut builder, mut known, mut cells) = (MeshBuilder::new(), BTreeMap::new(), Vec::new());
    let n = planes.map(|planes| planes.len() - 1);
    let all = (0..n[0] * n[1] * n[2]).map(|at| [at % n[0], at / n[0] % n[1], at / n[0] / n[1]]);
    for place in all.filter(|place| is_there(*place)) {
        let corners =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let nodes = corners.map(|corner: [usize; 3]| {
            let at = [0, 1, 2].map(|d| place[d] + corner[d]);
            *known.entry(at).or_insert_with(|| builder.point([0, 1, 2].map(|d| planes[d][at[d]])))
        });
        builder.cell(CellKind::Hex8, &nodes).unwrap();
        cells.push((place, nodes));
    }
    (builder, cells)
}

/// The arms of a body in the shape of a C meet: two surfaces of one body that share no node.
#[test]
fn two_surfaces_of_one_body_meet() {
    let [x, y, z] = [vec![0.0, 0.5, 1.0, 1.5, 2.0], vec![0.0, 0.5, 1.0], vec![0.0, 0.5, 0.6, 1.1]];
    let (mut builder, cells) = bricks([&x, &y, &z], |[i, _, k]| i == 0 || k != 1);
    let arm =
        |layer: usize| (0..).zip(&cells).filter(move |(_, (place, _))| place[0] > 0 && place[2] == layer);
    let quads = |layer: usize, corners: [usize; 4]| -> Vec<Vec<u32>> {
        arm(layer).map(|(_, (_, nodes))| corners.map(|corner| nodes[corner]).to_vec()).collect()
    };
    let (lower, upper) = (quads(0, [4, 5, 6, 7]), quads(2, [0, 3, 2, 1]));
    builder.facet_group_by_nodes("below", lower.clone());
    builder.facet_group_by_nodes("above", upper.clone());
    builder.cell_group("lower", arm(0).map(|(number, _)| number));
    builder.cell_group("upper", arm(2).map(|(number, _)| number));
    let contact = Contact::between("below", "above").with_stiffness(1333.0).with_distance(0.05);
    let body = Body::builder(builder.build().unwrap()).region(rubber()).contact(contact).build().unwrap();
    let close = [
        spinning("lower", [0.0; 3], [0.0, -2.0, 0.1], [0.5, 0.5, 0.25]),
        spinning("upper", [0.0; 3], [0.0, 1.2, 0.3], [0.5, 0.5, 0.85]),
    ];
    for (k, h) in [(1, 0.0025), (2, 0.005)] {
        let start = State::initial(&body, 0.0, &close).unwrap();
        let mut motion = Motion::new(&body, TimeElement::discrete_gradient(k).unwrap()).unwrap();
        motion = motion.from(start).unwrap();
        let (first, mut largest) = (motion.record().clone(), 0.0f64);
        let norm = |v: [f64; 3]| dot(v, v).sqrt();
        assert!(norm(first.linear_momentum) > 0.1 && norm(first.angular_momentum) > 0.1, "{first:?}");
        for _ in 0..(0.15 / h) as usize {
            advance(&mut motion, h);
            let record = motion.record();
            largest = largest.max(record.contact_energy);
            let drift = |own: [f64; 3], first: [f64; 3]| norm(minus(own, first)) / norm(first);
            assert!((record.total_energy / first.total_energy - 1.0).abs() < 1e-10, "{record:?}");
            assert!(drift(record.linear_momentum, first.linear_momentum) < 1e-12, "{record:?}");
            assert!(drift(record.angular_momentum, first.angular_momentum) < 1e-11, "{record:?}");
            let x: Vec<[f64; 3]> =
                (0..body.mesh().n_nodes()).map(|node| motion.state().position(&body, node)).collect();
            let (lower, upper) = (triangles_of(&lower, &x), triangles_of(&upper, &x));
            assert_eq!(cut_edges(&lower, &upper) + cut_edges(&upper, &lower), 0);
        }
        assert!(largest > 0.01 * first.total_energy, "{largest}");
    }
}

/// A block in the cavity of another one is outside of it; one between its faces is not, unless only a part of the
/// boundary is known.
#[test]
fn bodies_do_not_begin_inside_others() {
    let planes = [0.0, 1.0, 2.0, 3.0];
    let built = |is_hollow: bool, corner: f64, contact: Contact| {
        let around = |place: [usize; 3]| !is_hollow || place != [1; 3];
        let box_around = bricks([&planes, &planes, &planes], around).0;
        let small = mesh::block([0.4; 3], [1; 3]).unwrap();
        let mut builder = MeshBuilder::new();
        builder.part("shell", &box_around.build().unwrap()).unwrap();
        let at = Placement::default().shifted([corner; 3]);
        builder.part("core", &small.placed(&at).unwrap()).unwrap();
        let side = (0..9).map(|cell| Facet { cell, local: 0 });
        builder.facet_group("side", side);
        Body::builder(builder.build().unwrap()).region(rubber()).contact(contact).build().map(drop)
    };
    let all =
        [Contact::of_all_bodies(), Contact::between("shell", "core"), Contact::between("core", "shell")];
    for contact in all {
        built(true, 1.3, contact.clone()).unwrap();
        built(false, 3.1, contact.clone()).unwrap();
        for is_hollow in [false, true] {
            let error = built(is_hollow, 0.3, contact.clone()).unwrap_err().to_string();
            let words = "\"core\" lies inside \"shell\", at [0.3, 0.3, 0.3]";
            assert!(error.contains(words), "{error}");
        }
    }
    built(false, 0.3, Contact::between("core", "side")).unwrap();
}

/// How deep bodies overlap, as far as the edges that cut surfaces say.
#[test]
fn overlaps_have_a_place_and_a_depth() {
    let reason = |at: [f64; 3]| {
        let block = || mesh::block([1.0; 3], [2; 3]).unwrap();
        let mesh = joined(&[(block(), Placement::default()), (block(), Placement::default().shifted(at))]);
        Body::builder(mesh).region(rubber()).contact(contact()).build().unwrap_err().to_string()
    };
    let deep = reason([0.2, 0.93, 0.3]);
    assert!(
        deep.contains("its surfaces intersect at [") && deep.contains(" lies 0.07 inside the other"),
        "{deep}"
    );
    let touching = reason([0.2, 1.0, 0.3]);
    assert!(
        touching.contains("its surfaces touch or intersect at [") && touching.contains("the layer, 0.05"),
        "{touching}"
    );
    let near = reason([0.2, 1.0 + 1e-8, 0.3]);
    assert!(near.contains("its smallest gap is 1e-8 at [") && near.contains("the layer, 0.05"), "{near}");
}
