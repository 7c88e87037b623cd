//! Laws of the volume against their textbook forms, and the division of every material.

use num_dual::Dual64;

use super::super::conformance::big;
use super::super::volumetric::tests::energy;
use super::super::{
    ArrudaBoyce, CiarletGeymonat, EngineeringConstants, Gent, Hencky, HolzapfelGasserOgden, Material,
    MooneyRivlin, NeoHooke, NeoHookeIsochoric, Ogden, Orthotropic, SaintVenantKirchhoff, Yeoh,
};
use super::*;
use crate::tensor::{double_dot, sym_add_scaled};

const SIZES: [f64; 12] = [-0.9, -0.5, -0.1, -1e-4, -1e-8, -1e-12, 1e-12, 1e-8, 1e-4, 0.1, 0.5, 3.0];

fn law(law: Volumetric) -> VolumeLaw {
    VolumeLaw::new(VolumeMeasure::Ratio, law, 3.0).unwrap()
}

fn is_close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 2e-15 * b.abs()
}

#[test]
fn energies_are_those_of_the_textbook() {
    for name in Volumetric::ALL {
        for theta in SIZES {
            let J = big(1.0) + big(theta);
            let exact = energy(name, 3.0, &(J.clone() * J)).to_f64().value();
            assert!(is_close(law(name).energy(theta), exact), "{name:?} at {theta}");
        }
    }
}

#[test]
fn pressure_and_stiffness_are_derivatives() {
    for name in Volumetric::ALL {
        for theta in SIZES {
            let dual = Dual64::new(theta, 1.0);
            let law = law(name);
            assert!(is_close(law.energy(dual).eps, law.pressure(theta)), "{name:?} at {theta}");
            assert!(is_close(law.pressure(dual).eps, law.stiffness(theta)), "{name:?} at {theta}");
        }
    }
}

#[test]
fn energy_changes_keep_their_digits() {
    for name in Volumetric::ALL {
        for theta in SIZES {
            for change in [-0.4, -1e-3, -1e-9, 1e-12, 1e-6, 0.3].map(|part| part * (1.0 + theta)) {
                let at = |x: &super::super::conformance::Big| energy(name, 3.0, &(x.clone() * x));
                let J_1 = big(1.0) + big(theta);
                let J_2 = J_1.clone() + big(change);
                let exact = (at(&J_2) - at(&J_1)).to_f64().value();
                // Relative to the work of the pressures at both ends, which may cancel.
                let law = law(name);
                let pressures = law.pressure(theta).abs() + law.pressure(theta + change).abs();
                let error = (law.energy_change(theta, change) - exact).abs();
                assert!(error < 4e-15 * (pressures * change).abs(), "{name:?} {theta} {change}: {error:e}");
            }
        }
    }
}

/// A strain in general position, of size one.
const STRAIN: Sym<f64> = [0.5, -0.3, 0.4, 0.25, -0.35, 0.2];

#[test]
fn measures_have_their_derivatives_and_keep_their_digits() {
    for measure in [VolumeMeasure::Ratio, VolumeMeasure::Trace] {
        for size in [1e-12, 1e-8, 1e-4, 0.1, 0.3] {
            let E = STRAIN.map(|e| e * size);
            let curvature = measure.curvature(&E);
            for b in 0..6 {
                let mut dual = E.map(Dual64::from_re);
                dual[b].eps = 1.0;
                let doubled = if b < 3 { 1.0 } else { 2.0 };
                let slope = measure.change(&dual).eps;
                assert!((slope - doubled * measure.direction(&E)[b]).abs() < 2e-15);
                for (a, B) in measure.direction(&dual).into_iter().enumerate() {
                    assert!((B.eps - doubled * curvature[a][b]).abs() < 1e-14);
                }
            }
        }
    }
    // det C - 1 of a dilatation by s: (1 + s)^3 - 1 in extended precision.
    for s in [1e-12, -1e-9, 1e-6, 1e-3, 0.3] {
        let e = s + 0.5 * s * s;
        let exact = big(1.0) + big(2.0) * big(e);
        let exact = (exact.clone() * exact.clone() * exact).ln() / big(2.0);
        let dilatation = [e, e, e, 0.0, 0.0, 0.0];
        let exact = (exact.exp() - big(1.0)).to_f64().value();
        assert!(is_close(VolumeMeasure::Ratio.change(&dilatation), exact), "{s}");
        assert!(is_close(VolumeMeasure::Ratio.change_and_direction(&dilatation).0, exact), "{s}");
    }
}

/// `W_p(E) + U(theta) = W(E)` and the same of the stress, and the bulk modulus that is left at the points.
fn divides(material: &impl Material, shares: &[f64], kept: impl Fn(f64) -> f64) {
    for &share in shares {
        let (points, law) = material.split(share).unwrap();
        let measure = law.measure();
        for size in [1e-6, 1e-4, 1e-2, 0.1, 0.3] {
            let E = STRAIN.map(|e| e * size);
            let theta = measure.change(&E);
            let energy = points.strain_energy(&E) + law.energy(theta);
            let W = material.strain_energy(&E);
            assert!((energy - W).abs() < 1e-13 * W, "{share} {size}: {energy} {W}");
            let stress = sym_add_scaled(&points.stress(&E), law.pressure(theta), &measure.direction(&E));
            let S = material.stress(&E);
            let difference = sym_add_scaled(&stress, -1.0, &S);
            assert!(double_dot(&difference, &difference) < 1e-26 * double_dot(&S, &S), "{share} {size}");
        }
        let (_, D) = points.stress_and_elasticity(&[0.0; 6]);
        let bulk = (0..9).map(|at| D[at / 3][at % 3]).sum::<f64>() / 9.0;
        assert!((bulk - kept(share)).abs() < 1e-12 * law.modulus(), "{share}: {bulk}");
    }
}

#[test]
fn every_material_is_the_sum_of_its_parts() {
    let K = 1500.0;
    let mu = 500.0;
    let shares = [0.0, 2.0 / 3.0];
    let kept = |share: f64| share * mu;
    for law in Volumetric::ALL {
        divides(&NeoHookeIsochoric::new(mu, K, law).unwrap(), &shares, kept);
        divides(&MooneyRivlin::new(150.0, 100.0, K, law).unwrap(), &shares, kept);
        divides(&Yeoh::new([250.0, -20.0, 40.0], K, law).unwrap(), &shares, kept);
        divides(&Gent::new(mu, 150.0, K, law).unwrap(), &shares, kept);
        divides(&ArrudaBoyce::new(mu, 2.5, K, law).unwrap(), &shares, kept);
        divides(&Ogden::new(&[(600.0, 1.5), (-50.0, -2.0)], K, law).unwrap(), &shares, kept);
        let fibres = [[1.0, 0.2, 0.0], [0.0, 0.3, 1.0]];
        let tissue = HolzapfelGasserOgden::new(mu, [20.0, 0.5], 0.1, &fibres, K, law).unwrap();
        divides(&tissue, &shares, kept);
    }
    divides(&Hencky::new(1000.0, mu).unwrap(), &shares, kept);
    let own = |_| 2.0 / 3.0 * mu;
    divides(&NeoHooke::new(1000.0, mu).unwrap(), &shares, own);
    divides(&CiarletGeymonat::new(1000.0, mu).unwrap(), &shares, own);
    divides(&SaintVenantKirchhoff::new(1000.0, mu).unwrap(), &shares, own);
}

#[test]
fn materials_without_a_volume_to_project_are_not_divided() {
    assert!(NeoHooke::new(0.0, 1.0).unwrap().split(0.0).is_none());
    assert!(SaintVenantKirchhoff::new(-0.1, 1.0).unwrap().split(0.0).is_none());
    assert!(CiarletGeymonat::new(-0.1, 1.0).unwrap().split(0.0).is_none());
    let soft = NeoHookeIsochoric::new(3.0, 2.0, Volumetric::default()).unwrap();
    assert!(soft.split(2.0 / 3.0).is_none() && soft.split(0.0).is_some());
    let constants = EngineeringConstants {
        youngs_moduli: [10.0, 1.0, 1.0],
        poissons_ratios: [0.2, 0.2, 0.2],
        shear_moduli: [1.0; 3],
    };
    let wood = Orthotropic::new(constants, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
    assert!(wood.split(0.0).is_none() && wood.compiled().split(0.0).is_none());
}

#[test]
fn tables_divide_as_their_materials_do() {
    let rubber = NeoHooke::new(1000.0, 500.0).unwrap();
    let (points, law) = rubber.compiled().split(0.0).unwrap();
    let (expected, expected_law) = rubber.split(0.0).unwrap();
    assert_eq!(law, expected_law);
    assert_eq!(points.response::<f64>().strain_energy(&STRAIN.map(|e| 0.1 * e)), {
        expected.strain_energy(&STRAIN.map(|e| 0.1 * e))
    });
}
