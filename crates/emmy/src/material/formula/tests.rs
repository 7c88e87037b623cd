//! Formulas against textbook forms in extended precision, and against the built-in materials.

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use super::expression::{Function, Tree};
use super::*;
use crate::error::Error;
use crate::material::conformance::{
    Big, big, big_det, big_isochoric, big_trace, conforms, conforms_with_symmetry, half_turn,
};
use crate::material::{HolzapfelGasserOgden, MooneyRivlin, NeoHooke, NeoHookeIsochoric, Yeoh};
use crate::tensor::Mat3;

fn of(invariant: Invariant) -> Expression {
    invariant.into()
}

fn ln_J() -> Expression {
    of(Invariant::J).ln()
}

fn neo_hooke([lambda, mu]: [f64; 2]) -> Expression {
    mu / 2.0 * (of(Invariant::I1) - 3.0) - mu * ln_J() + lambda / 2.0 * ln_J().power(2.0)
}

/// The value of an expression in 400-bit numbers; `a`: the fibre.
fn big_value(tree: &Tree, C: &Mat3<Big>, a: [f64; 3]) -> Big {
    let value = |tree: &Tree| big_value(tree, C, a);
    match tree {
        Tree::Number(number) => big(*number),
        Tree::Invariant(invariant) => big_invariant(*invariant, C, a),
        Tree::Sum(parts) => value(&parts[0]) + value(&parts[1]),
        Tree::Product(parts) => value(&parts[0]) * value(&parts[1]),
        Tree::Power(parts) => match &parts[1] {
            Tree::Number(-1.0) => big(1.0) / value(&parts[0]),
            Tree::Number(2.0) => value(&parts[0]) * value(&parts[0]),
            exponent => (value(exponent) * value(&parts[0]).ln()).exp(),
        },
        Tree::Function(function, argument) => {
            let x = value(argument);
            let (up, down) = (x.clone().exp(), (-x.clone()).exp());
            match function {
                Function::Ln => x.ln(),
                Function::Exp => up,
                Function::Sinh => (up - down) / big(2.0),
                Function::Cosh => (up + down) / big(2.0),
                Function::Tanh => (up.clone() - &down) / (up + down),
            }
        }
    }
}

fn big_invariant(invariant: Invariant, C: &Mat3<Big>, a: [f64; 3]) -> Big {
    let det = big_det(C);
    let scale = || (det.ln() / big(-3.0)).exp();
    let I4 = || (0..9).fold(big(0.0), |sum, n| sum + &C[n / 3][n % 3] * big(a[n / 3]) * big(a[n % 3]));
    match invariant {
        Invariant::I1 => big_trace(C),
        Invariant::I2 => {
            let I1 = big_trace(C);
            let squares = C.iter().flatten().fold(big(0.0), |sum, c| sum + c * c);
            (&I1 * &I1 - squares) / big(2.0)
        }
        Invariant::I3 => det,
        Invariant::J => det.sqrt(),
        Invariant::I1Bar => big_isochoric(C)[0].clone(),
        Invariant::I2Bar => big_isochoric(C)[1].clone(),
        Invariant::I4 => I4(),
        Invariant::I4Bar => I4() * scale(),
    }
}

#[test]
fn neo_hooke_conforms_to_its_textbook_form() {
    let [lambda, mu] = [1000.0, 500.0];
    let material = EnergyFormula::new(&neo_hooke([lambda, mu]), None).unwrap();
    conforms(&material, [lambda, mu], |C| {
        let ln_J = big_det(C).ln() / big(2.0);
        big(mu / 2.0) * (big_trace(C) - big(3.0)) + big(lambda / 2.0) * &ln_J * &ln_J - big(mu) * ln_J
    });
}

/// Checks a formula without a fibre against its own value in 400-bit numbers, and its elasticity against dual numbers.
fn matches_itself(energy: &Expression) {
    let material = EnergyFormula::new(energy, None).unwrap();
    let C = |E: &Sym<f64>, component: usize, increment: f64| -> Mat3<Big> {
        [0, 1, 2].map(|i| {
            [0, 1, 2].map(|j| {
                let a = SYM_INDEX[i][j];
                let own = big(2.0 * E[a]) + big(if i == j { 1.0 } else { 0.0 });
                if a == component { own + big(2.0 * increment) } else { own }
            })
        })
    };
    let value = |C: &Mat3<Big>| big_value(&energy.0, C, [0.0; 3]);
    let start = value(&C(&[0.0; 6], 0, 0.0));
    let h = 2f64.powi(-110);
    // Each size and each direction, not all of their pairs.
    for E in strains().into_iter().step_by(3) {
        let exact = value(&C(&E, 0, 0.0)) - &start;
        let error = ((big(material.strain_energy(&E)) - &exact) / &exact).to_f64().value();
        assert!(error.abs() < 1e-13, "W: relative error {error:e} at {E:?} of {energy:?}");
        let (S, D) = material.stress_and_elasticity(&E);
        let size = double_dot(&S, &S).sqrt();
        let largest = D.iter().flatten().fold(0.0, |largest: f64, d| largest.max(d.abs()));
        for part in [0.1, 1e-4, 1e-8] {
            let dE = [0.2, -0.3, 0.1, 0.15, -0.05, 0.25].map(|e| e * part * double_dot(&E, &E).sqrt());
            let end = |i: usize, j: usize| {
                let own = big(E[SYM_INDEX[i][j]]) + big(dE[SYM_INDEX[i][j]]);
                big(2.0) * own + big(if i == j { 1.0 } else { 0.0 })
            };
            let end = [0, 1, 2].map(|i| [0, 1, 2].map(|j| end(i, j)));
            let exact = value(&end) - value(&C(&E, 0, 0.0));
            let change = material.energy_change(&E, &dE).unwrap();
            let error = (big(change) - exact).to_f64().value();
            let length = double_dot(&dE, &dE).sqrt();
            let scale = (size + largest * length) * length;
            assert!(error.abs() < 1e-13 * scale, "change of W: {error:e} of {scale:e} at {E:?}, {dE:?}");
        }
        for b in 0..6 {
            let number = if b < 3 { 1.0 } else { 2.0 };
            let exact = (value(&C(&E, b, h)) - value(&C(&E, b, -h))) / big(2.0 * h * number);
            let error = (big(S[b]) - exact).to_f64().value();
            assert!(error.abs() < 1e-13 * size, "S_{b}: error {error:e} of {size:e} at {E:?}");
            let mut seeded = E.map(num_dual::Dual64::from_re);
            seeded[b].eps = 1.0 / number;
            let derivatives = material.stress(&seeded).map(|s| s.eps);
            for a in 0..6 {
                assert!((D[a][b] - derivatives[a]).abs() < 1e-12 * largest, "D_{a}{b} at {E:?}");
            }
        }
    }
}

/// Strains from 1e-8 to 0.6.
fn strains() -> Vec<Sym<f64>> {
    let directions = [
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.3, -0.5, 0.4, 0.2, -0.35, 0.1],
        [-0.2, -0.3, -0.4, 0.05, 0.0, 0.1],
        [0.0, 0.0, 0.0, 0.5, 0.2, 0.0],
    ];
    let sizes = [1e-8, 1e-4, 0.01, 0.3, 0.6];
    sizes.iter().flat_map(|size| directions.map(|E| E.map(|e| e * size))).collect()
}

/// Energy, stress and elasticity agree with a built-in material to 1e-12.
fn agrees(formula: &EnergyFormula, builtin: &impl Material) {
    let close = |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-12 * scale;
    for E in strains() {
        let (own, exact) = (formula.strain_energy(&E), builtin.strain_energy(&E));
        assert!(close(own, exact, exact.abs()), "W: {own} is not {exact} at {E:?}");
        let (own, exact) = (formula.stress_and_elasticity(&E), builtin.stress_and_elasticity(&E));
        let size = double_dot(&exact.0, &exact.0).sqrt();
        let stress = formula.stress(&E);
        let largest = exact.1.iter().flatten().fold(0.0, |largest: f64, d| largest.max(d.abs()));
        for a in 0..6 {
            assert!(close(own.0[a], exact.0[a], size), "S_{a}: {} is not {} at {E:?}", own.0[a], exact.0[a]);
            assert!(close(stress[a], exact.0[a], size));
            for b in 0..6 {
                let (own, exact) = (own.1[a][b], exact.1[a][b]);
                assert!(close(own, exact, largest), "D_{a}{b}: {own} is not {exact} at {E:?}");
            }
        }
    }
}

#[test]
fn formulas_agree_with_the_built_in_materials() {
    let x = || of(Invariant::I1Bar) - 3.0;
    let y = || of(Invariant::I2Bar) - 3.0;
    let law = Volumetric::SimoTaylor;
    let volume = |K: f64| K / 4.0 * (of(Invariant::J).power(2.0) - 1.0 - 2.0 * ln_J());
    let formula = |energy: Expression| EnergyFormula::new(&energy, None).unwrap();
    agrees(&formula(neo_hooke([1000.0, 500.0])), &NeoHooke::new(1000.0, 500.0).unwrap());
    agrees(&formula(150.0 * x() + volume(2000.0)), &NeoHookeIsochoric::new(300.0, 2000.0, law).unwrap());
    let mooney = MooneyRivlin::new(100.0, 40.0, 1500.0, law).unwrap();
    agrees(&formula(100.0 * x() + 40.0 * y() + volume(1500.0)), &mooney);
    let yeoh = Yeoh::new([100.0, -5.0, 2.0], 1500.0, law).unwrap();
    let energy = 100.0 * x() - 5.0 * x().power(2.0) + 2.0 * x().power(3.0) + volume(1500.0);
    agrees(&formula(energy), &yeoh);
}

#[test]
fn a_fibre_agrees_with_holzapfel_gasser_ogden_in_tension() {
    let fibre = [1.0, 2.0, -2.0];
    let [mu, k1, k2, K] = [300.0, 200.0, 0.8, 1000.0];
    let fibre_strain = || of(Invariant::I4Bar) - 1.0;
    let energy = mu / 2.0 * (of(Invariant::I1Bar) - 3.0)
        + k1 / (2.0 * k2) * ((k2 * fibre_strain().power(2.0)).exp() - 1.0)
        + K / 2.0 * ln_J().power(2.0);
    let formula = EnergyFormula::new(&energy, Some(fibre)).unwrap();
    let builtin = HolzapfelGasserOgden::new(mu, [k1, k2], 0.0, &[fibre], K, Volumetric::Logarithmic).unwrap();
    // Stretches of the fibre by a uniaxial strain along it, and shear.
    let a = fibre.map(|x| x / 3.0);
    let along = sym(|i, j| a[i] * a[j]);
    for size in [1e-8, 1e-4, 0.1, 0.6] {
        let E = [0, 1, 2, 3, 4, 5].map(|n| size * (along[n] + 0.05 * [0.3, -0.5, 0.4, 0.2, -0.35, 0.1][n]));
        let (own, exact) = (formula.strain_energy(&E), builtin.strain_energy(&E));
        assert!((own - exact).abs() < 1e-12 * exact, "W: {own} is not {exact} at {size}");
        let (own, exact) = (formula.stress_and_elasticity(&E), builtin.stress_and_elasticity(&E));
        for n in 0..6 {
            let scale = double_dot(&exact.0, &exact.0).sqrt();
            assert!((own.0[n] - exact.0[n]).abs() < 1e-12 * scale, "S: {:?} {:?}", own.0, exact.0);
            for m in 0..6 {
                assert!((own.1[n][m] - exact.1[n][m]).abs() < 1e-12 * exact.1[0][0], "D_{n}{m} at {size}");
            }
        }
    }
}

#[test]
fn a_fibre_conforms_and_is_transversely_isotropic() {
    let fibre = [1.0, 0.0, 0.0];
    let energy = neo_hooke([300.0, 100.0])
        + 40.0 * (of(Invariant::I4) - 1.0).power(2.0)
        + 30.0 * (of(Invariant::I4Bar).power(3.0) + 3.0 / of(Invariant::I4Bar));
    let material = EnergyFormula::new(&energy, Some(fibre)).unwrap();
    let D = material.stress_and_elasticity(&[0.0; 6]).1;
    // lambda, mu and 4 d^2W/dI4^2 = 8 * 40, with 30 (x^3 + 3/x)'' = 360 at x = 1, where x = 1 + 2 dev E_11.
    let hooke = |E: &Sym<f64>| {
        let deviator = E[0] - trace(E) / 3.0;
        let (along, across) = (320.0 * E[0] + 1440.0 * deviator * 2.0 / 3.0, -1440.0 * deviator / 3.0);
        let fibre = [along, across, across, 0.0, 0.0, 0.0];
        [0, 1, 2, 3, 4, 5].map(|a| fibre[a] + 200.0 * E[a] + if a < 3 { 300.0 * trace(E) } else { 0.0 })
    };
    assert!((D[0][0] - hooke(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0])[0]).abs() < 1e-10);
    let symmetry = [half_turn([1.0, 0.0, 0.0]), half_turn([0.0, 0.8, 0.6])];
    conforms_with_symmetry(&material, &symmetry, hooke, |C| big_value(&energy.0, C, fibre) - big(120.0));
}

/// Functions f of x with f'(0) = 1 whose derivatives have no cancellation, for x > -0.9.
fn function() -> impl Strategy<Value = fn(Expression) -> Expression> {
    prop::sample::select(vec![
        (|x| x) as fn(Expression) -> Expression,
        |x| x.clone() + 0.05 * x.power(2.0),
        |x| 50.0 * (0.02 * x).exp(),
        |x| 4.0 * (1.0 + 0.25 * x).ln(),
        |x| 4.0 * (1.0 + 0.5 * x).sqrt(),
        |x| (1.0 + 0.4 * x).power(2.5),
        |x| (1.0 + 0.4 * x).power(1.3) / 0.52,
        |x| 40.0 * (0.025 * x).sinh(),
        |x| x.clone() * (0.01 * x).cosh(),
        |x| -9.0 / (1.0 + x / 9.0),
    ])
}

/// Stable energies without stress at rest.
fn energy() -> impl Strategy<Value = Expression> {
    let shear = prop::sample::select(vec![
        (|| of(Invariant::I1Bar) - 3.0) as fn() -> Expression,
        || of(Invariant::I2Bar) - 3.0,
        || of(Invariant::I1) - 3.0 - 2.0 * ln_J(),
        || of(Invariant::I2) - 3.0 - 2.0 * of(Invariant::I3).ln(),
    ]);
    let volume = prop::sample::select(Volumetric::ALL.to_vec());
    (prop::array::uniform2((shear, function(), 10.0..100.0f64)), volume, 100.0..1000.0f64).prop_map(
        |(terms, law, bulk_modulus)| {
            terms.into_iter().fold(expression_of(law, bulk_modulus), |sum, (of, function, modulus)| {
                sum + modulus * function(of())
            })
        },
    )
}

#[test]
fn random_formulas_match_extended_precision() {
    let mut runner = TestRunner::deterministic();
    for _ in 0..8 {
        let energy = energy().new_tree(&mut runner).unwrap().current();
        matches_itself(&energy);
    }
}

/// The reason for which a formula is rejected.
fn reason(energy: Expression, fibre: Option<[f64; 3]>) -> String {
    match EnergyFormula::new(&energy, fibre).unwrap_err() {
        Error::EnergyFormula { reason } => reason,
        other => panic!("{other}"),
    }
}

#[test]
fn formulas_that_are_no_energy_of_a_solid_are_rejected_with_the_reason() {
    let x = || of(Invariant::I1) - 3.0;
    let bulk = || 50.0 * ln_J().power(2.0);
    let fibre = Some([0.0, 0.0, 1.0]);
    for (energy, fibre, says) in [
        // S = 2 dW/dI1 = 10 in every direction.
        (5.0 * x() + bulk(), None, "and is 10 in every direction (subtract 10*ln(J))"),
        (
            5.0 * (of(Invariant::I1Bar) - 3.0) + bulk() + 3.0 * of(Invariant::I4),
            fibre,
            "and is 6 along the fibre (subtract 6*(I4 - 1)/2)",
        ),
        (bulk(), None, "the shear modulus at rest must be positive, and is 0"),
        (
            -5.0 * (of(Invariant::I1Bar) - 3.0) + bulk(),
            None,
            "the shear modulus at rest must be positive, and is -10",
        ),
        (
            5.0 * (of(Invariant::I1Bar) - 3.0) - bulk(),
            None,
            "the bulk modulus at rest must be positive, and is -100",
        ),
        (
            5.0 * (of(Invariant::I1Bar) - 3.0) + bulk() - 90.0 * (of(Invariant::I4) - 1.0).power(2.0),
            fibre,
            "D_1111 = -606.667",
        ),
        (x().ln(), None, "a logarithm of an expression that is 0 at rest"),
        (x().sqrt(), None, "the power 0.5 of an expression that is 0 at rest"),
        (5.0 / x(), None, "not finite at rest"),
        (of(Invariant::I4Bar), None, "I4_bar needs the direction of a fibre"),
        (neo_hooke([1.0, 1.0]), fibre, "neither I4 nor I4_bar"),
        ((0..300).fold(x(), |sum, _| sum + x()), None, "more than 500"),
    ] {
        let reason = reason(energy, fibre);
        assert!(reason.contains(says), "{reason}\n{says}");
    }
    let [zero, unbounded] = [[0.0; 3], [f64::NAN, 0.0, 0.0]];
    for fibre in [zero, unbounded] {
        let energy = neo_hooke([1.0, 1.0]) + (of(Invariant::I4) - 1.0).power(2.0);
        assert!(matches!(EnergyFormula::new(&energy, Some(fibre)), Err(Error::Direction { .. })));
    }
}

#[test]
fn rounding_of_the_parameters_is_no_stress_at_rest() {
    // 0.1 + 0.2 is not 0.3: a stress of 1e-16 mu, which is left out of the energy and of the stress alike.
    let energy = 0.1 * of(Invariant::I1) + 0.2 * of(Invariant::I1) - 0.6 * ln_J() + ln_J().power(2.0);
    let material = EnergyFormula::new(&energy, None).unwrap();
    assert_eq!(material.stress(&[0.0; 6]), [0.0; 6]);
}

#[test]
fn terms_of_the_volume_are_split_off() {
    let builtin = NeoHooke::new(1000.0, 500.0).unwrap();
    let formula = EnergyFormula::new(&neo_hooke([1000.0, 500.0]), None).unwrap();
    let ((rest, law), (exact_rest, exact_law)) = (formula.split(0.0).unwrap(), builtin.split(0.0).unwrap());
    assert!((law.modulus() - exact_law.modulus()).abs() < 1e-12 * law.modulus());
    assert!((law.energy(0.3) - exact_law.energy(0.3)).abs() < 1e-12 * law.energy(0.3));
    agrees(&rest, &exact_rest);
    for law in Volumetric::ALL {
        let energy = 150.0 * (of(Invariant::I1Bar) - 3.0) + expression_of(law, 2000.0);
        let formula = EnergyFormula::new(&energy, None).unwrap();
        let builtin = NeoHookeIsochoric::new(300.0, 2000.0, law).unwrap();
        for share in [0.0, 2.0 / 3.0] {
            let (own, exact) = (formula.split(share).unwrap(), builtin.split(share).unwrap());
            assert!((own.1.modulus() - exact.1.modulus()).abs() < 1e-12 * 2000.0, "{law:?}");
            assert!((own.1.energy(0.4) - exact.1.energy(0.4)).abs() < 1e-12 * exact.1.energy(0.4), "{law:?}");
            agrees(&own.0, &exact.0);
        }
    }
    // (J - 1)^4 is none of the laws, and cosh is no sum.
    let other =
        150.0 * (of(Invariant::I1Bar) - 3.0) + (of(Invariant::J) - 1.0).power(4.0) + ln_J().power(2.0);
    assert!(EnergyFormula::new(&other, None).unwrap().split(0.0).is_none());
    let mixed = ((of(Invariant::I1Bar) - 3.0) + ln_J().power(2.0)).exp();
    assert!(EnergyFormula::new(&mixed, None).unwrap().split(0.0).is_none());
}
