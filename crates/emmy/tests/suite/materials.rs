//! Every material in free flight: DGM keeps energy and angular momentum at round-off, in few Newton iterations.

use emmy::body::{Body, InitialVelocity, Region};
use emmy::material::{
    ArrudaBoyce, CiarletGeymonat, EngineeringConstants, Gent, Hencky, HolzapfelGasserOgden, Material,
    MooneyRivlin, NeoHooke, NeoHookeIsochoric, Ogden, Orthotropic, SaintVenantKirchhoff, Volumetric, Yeoh,
};
use emmy::motion::{Motion, NewtonSettings, State};

use crate::shared::schemes::{DGM, at};

/// A block of 2 x 2 x 2 cells that rotates about all axes; its velocities stretch and shear it.
fn block(material: impl Material) -> Body {
    let mesh = emmy::mesh::block([1.0, 1.5, 1.0], [2; 3]).unwrap();
    Body::builder(mesh).region(Region::new(material, 0.7)).build().unwrap()
}

fn start(body: &Body) -> State {
    let field = InitialVelocity {
        angular_velocity: [3.0, 5.0, -4.0],
        about: [0.5, 0.75, 0.5],
        gradient: [[4.0, 1.5, 0.0], [0.0, -3.0, 1.0], [2.0, 0.0, 1.0]],
        velocity: [1.0, -2.0, 0.5],
        ..Default::default()
    };
    State::initial(body, 0.0, &[field]).unwrap()
}

/// Flies 50 steps with time elements of degree 1 and 2; returns the worst number of Newton iterations.
fn assert_balanced(material: &(impl Material + std::fmt::Debug)) -> usize {
    let (body, mut worst) = (block(material.clone()), 0);
    for degree in 1..=2 {
        let settings = NewtonSettings { exact_tangent: true, ..Default::default() };
        let mut motion = Motion::starting(&body, at(DGM, degree), settings, start(&body)).unwrap();
        let mut strained = 0f64;
        for _ in 1..=50 {
            let record = motion.step(0.01).unwrap();
            let total = record.total_energy;
            let momentum = record.angular_momentum.iter().map(|l| l * l).sum::<f64>().sqrt();
            assert!(record.energy_residual.abs() < 1e-12 * total, "{material:?} {degree}: {record:?}");
            assert!(record.angular_momentum_residual < 1e-12 * momentum, "{material:?} {degree}: {record:?}");
            strained = strained.max(record.strain_energy / total);
            worst = worst.max(record.newton_iterations);
        }
        assert!(strained > 0.05, "{material:?}: too little strain energy to tell: {strained}");
    }
    worst
}

/// Newton converges quadratically: three iterations reduce the error of a prediction to 1e-10, and one or two
/// corrections follow.
const QUADRATIC: usize = 5;

#[test]
fn isotropic_materials_keep_their_balances() {
    let (lambda, mu, bulk_modulus) = (1000.0, 500.0, 1500.0);
    let all = [
        assert_balanced(&SaintVenantKirchhoff::new(lambda, mu).unwrap()),
        assert_balanced(&NeoHooke::new(lambda, mu).unwrap()),
        assert_balanced(&CiarletGeymonat::new(lambda, mu).unwrap()),
        assert_balanced(&Hencky::new(lambda, mu).unwrap()),
        assert_balanced(&NeoHookeIsochoric::new(mu, bulk_modulus, Volumetric::default()).unwrap()),
        assert_balanced(&Yeoh::new([250.0, -20.0, 40.0], bulk_modulus, Volumetric::SimoTaylor).unwrap()),
        assert_balanced(&Gent::new(mu, 5.0, bulk_modulus, Volumetric::Miehe).unwrap()),
        assert_balanced(&ArrudaBoyce::new(mu, 2.5, bulk_modulus, Volumetric::Liu).unwrap()),
    ];
    assert!(all.into_iter().all(|iterations| iterations <= QUADRATIC), "{all:?}");
}

#[test]
fn mooney_rivlin_and_ogden_keep_their_balances_with_every_law_of_volume() {
    for law in Volumetric::ALL {
        let mooney = MooneyRivlin::new(200.0, 50.0, 1500.0, law).unwrap();
        let ogden = Ogden::new(&[(630.0, 1.3), (1.2, 5.0), (-10.0, -2.0)], 1500.0, law).unwrap();
        assert!(assert_balanced(&mooney) <= QUADRATIC && assert_balanced(&ogden) <= QUADRATIC);
    }
}

#[test]
fn anisotropic_materials_keep_their_balances() {
    let ply = EngineeringConstants {
        youngs_moduli: [10e3, 800.0, 450.0],
        poissons_ratios: [0.37, 0.43, 0.47],
        shear_moduli: [640.0, 300.0, 580.0],
    };
    assert!(
        assert_balanced(&Orthotropic::new(ply, [[1.0, 2.0, -0.5], [0.0, 1.0, 1.0]]).unwrap()) <= QUADRATIC
    );
    let fibres = [[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    for (kappa, fibres) in [(0.0, &fibres[..1]), (0.226, &fibres)] {
        let law = Volumetric::default();
        let tissue = HolzapfelGasserOgden::new(300.0, [400.0, 0.8], kappa, fibres, 1000.0, law).unwrap();
        // Where fibres slacken or tighten in a step, D jumps and an additional iteration may be needed.
        assert!(assert_balanced(&tissue) <= QUADRATIC + 1);
    }
}

/// Ogden with exponents 2 and -2 is Mooney-Rivlin, along the whole motion.
#[test]
fn ogden_with_exponents_2_and_minus_2_moves_as_mooney_rivlin() {
    let fly = |body: &Body| {
        let settings = NewtonSettings { tolerance: 1e-12, ..Default::default() };
        let mut motion = Motion::starting(body, at(DGM, 2), settings, start(body)).unwrap();
        for _ in 1..=20 {
            motion.step(0.01).unwrap();
        }
        motion.state().displacement.clone()
    };
    let law = Volumetric::SimoTaylor;
    let mooney = fly(&block(MooneyRivlin::new(200.0, 50.0, 1500.0, law).unwrap()));
    let ogden = fly(&block(Ogden::new(&[(400.0, 2.0), (-100.0, -2.0)], 1500.0, law).unwrap()));
    // Both are solved to 1e-12, twenty times.
    assert!(mooney.iter().zip(&ogden).all(|(a, b)| (a - b).abs() < 1e-10), "{mooney:?} {ogden:?}");
}
