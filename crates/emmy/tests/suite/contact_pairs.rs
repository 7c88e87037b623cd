//! Contact between bodies, against an independent implementation and closed forms.

#![allow(non_snake_case)]

use std::f64::consts::FRAC_PI_4;

use crate::shared::schemes::{DGM, assumed_strain, at};
use emmy::body::{Contact, Formulation};
use emmy::equilibrium::Equilibrium;
use emmy::mesh::{MeshBuilder, Placement};
use emmy::motion::NewtonSettings;
use emmy::prelude::*;

/// Meshes at their places as one, with groups of cells `a`, `b`, ...
fn joined(parts: &[(Mesh, Placement)]) -> Mesh {
    let mut builder = MeshBuilder::new();
    for ((mesh, placement), name) in parts.iter().zip(["a", "b", "c", "d", "e"]) {
        let nodes: Vec<u32> = mesh.points().iter().map(|X| builder.point(placement.point(*X))).collect();
        let cells: Vec<u32> = mesh
            .cells()
            .map(|cell| {
                let nodes: Vec<u32> = cell.nodes.iter().map(|node| nodes[*node as usize]).collect();
                builder.cell(cell.kind, &nodes).unwrap()
            })
            .collect();
        builder.cell_group(name, cells);
    }
    builder.build().unwrap()
}

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0)
}

fn contact() -> Contact {
    Contact::between("a", "b").with_stiffness(1333.0).with_distance(0.05)
}

fn spinning(group: &str, velocity: [f64; 3], spin: [f64; 3], about: [f64; 3]) -> InitialVelocity {
    InitialVelocity {
        group: Some(group.into()),
        velocity,
        angular_velocity: spin,
        about,
        ..InitialVelocity::default()
    }
}

/// Two blocks that fly against each other; the second has cells of the edge 1/n.
fn two_blocks(n: usize) -> (Mesh, [InitialVelocity; 2]) {
    let (a, b) = (mesh::block([1.0; 3], [2; 3]).unwrap(), mesh::block([1.0; 3], [n; 3]).unwrap());
    let corner = [0.23, 1.07, 0.17];
    let mesh = joined(&[(a, Placement::default()), (b, Placement::default().shifted(corner))]);
    let velocities = [
        spinning("a", [0.0, 1.0, 0.0], [0.5, -0.3, 0.8], [0.5; 3]),
        spinning("b", [0.1, -1.0, 0.0], [-0.35, 0.21, -0.56], corner.map(|x| x + 0.5)),
    ];
    (mesh, velocities)
}

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
    let mut motion =
        Motion::new(&body, TimeElement::discrete_gradient(k).unwrap()).unwrap().from(start).unwrap();
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
    println!("{corrections} corrections in {} steps", expected.steps);
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
        two_blocks(2),
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
        two_blocks(2),
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
        two_blocks(3),
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
}
