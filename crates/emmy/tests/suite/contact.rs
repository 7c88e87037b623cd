//! Contact of bodies with obstacles, against an independent implementation and closed forms.

#![allow(non_snake_case)]

use emmy::body::{Contact, Obstacle};
use emmy::equilibrium::Equilibrium;
use emmy::mesh::MeshBuilder;
use emmy::motion::NewtonSettings;
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

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0)
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
            corner: [0.876_827_869_980_543_9, 1.144_281_848_785_773_1, 1.183_193_730_509_266],
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
