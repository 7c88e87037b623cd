//! What every material must fulfil, checked for each in one line.

use dashu_float::{FBig, round::mode::HalfEven};
use num_dual::Dual64;
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestCaseError, TestRng, TestRunner};

use super::Material;
use crate::tensor::{Lane, Mat3, SYM, SYM_INDEX, Sym, det_of_identity_plus, double_dot, green_lagrange};

/// A number with 400 bits, 120 decimal digits.
pub type Big = FBig<HalfEven, 2>;

/// Extended-precision number of a double, exactly.
pub fn big(x: f64) -> Big {
    Big::try_from(x).unwrap().with_precision(400).value()
}

/// Trace, for the reference energies.
pub fn big_trace(C: &Mat3<Big>) -> Big {
    &C[0][0] + &C[1][1] + &C[2][2]
}

/// Determinant, for the reference energies.
pub fn big_det(C: &Mat3<Big>) -> Big {
    let minor = |i: usize, j: usize| &C[1][i] * &C[2][j] - &C[1][j] * &C[2][i];
    &C[0][0] * minor(1, 2) - &C[0][1] * minor(0, 2) + &C[0][2] * minor(0, 1)
}

/// Checks an isotropic material against its energy in a textbook form W(C) and its small-strain Lame parameters.
pub fn conforms(material: &impl Material, lame: [f64; 2], energy: impl Fn(&Mat3<Big>) -> Big) {
    rests_in_its_reference(material);
    for_all(large_gradient(), |G| {
        let strain = green_lagrange(&G);
        stress_is_the_derivative_of_the_energy(material, &strain)?;
        elasticity_is_the_derivative_of_the_stress(material, &strain)?;
        elasticity_is_symmetric(material, &strain)
    });
    for_all((large_gradient(), rotation()), |(G, Q)| {
        is_objective(material, &G, &Q)?;
        is_isotropic(material, &G, &Q)
    });
    for_all(direction(), |direction| agrees_with_linear_elasticity(material, lame, &direction));
    for_all(direction(), |direction| keeps_its_digits(material, &energy, &direction));
    for direction in SPECIAL_DIRECTIONS {
        keeps_its_digits(material, &energy, &direction).unwrap();
    }
}

type Check = Result<(), TestCaseError>;

fn for_all<S: Strategy>(strategy: S, check: impl Fn(S::Value) -> Check) {
    // The same draws every time: the bounds on round-off are a few units in the last place above what is observed.
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
        .run(&strategy, check)
        .unwrap_or_else(|failure| panic!("{failure}"));
}

/// Displacement gradients up to large strain, compression to 1/20 of the volume included.
fn large_gradient() -> impl Strategy<Value = Mat3<f64>> {
    let gradient = prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64));
    gradient.prop_filter("det F > 0.05", |G| det_of_identity_plus(G) > 0.05)
}

/// Strains of norm one in every direction.
fn direction() -> impl Strategy<Value = Sym<f64>> {
    let components = prop::array::uniform6(-1.0..1.0f64);
    let nonzero = components.prop_filter("not zero", |E| norm(E) > 0.1);
    nonzero.prop_map(|E| E.map(|e| e / norm(&E)))
}

/// Where terms cancel: change of volume only, shear only (two kinds), stretch, stretch at constant volume.
const SPECIAL_DIRECTIONS: [Sym<f64>; 7] = [
    [0.5, 0.5, 0.5, 0.0, 0.0, 0.0],
    [-0.4, -0.4, -0.4, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.4, 0.0, 0.0],
    [0.45, -0.45, 0.0, 0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.8, -0.4, -0.4, 0.0, 0.0, 0.0],
    [1.0, -0.25, -0.25, 0.0, 0.0, 0.0],
];

/// Rotations, from unit quaternions.
fn rotation() -> impl Strategy<Value = Mat3<f64>> {
    let quaternion = prop::array::uniform4(-1.0..1.0f64);
    let square = |q: &[f64; 4]| q.iter().map(|c| c * c).sum::<f64>();
    quaternion.prop_filter("not zero", move |q| square(q) > 0.01).prop_map(move |q| {
        let [a, b, c, d] = q.map(|component| component / square(&q).sqrt());
        [
            [1.0 - 2.0 * (c * c + d * d), 2.0 * (b * c - a * d), 2.0 * (b * d + a * c)],
            [2.0 * (b * c + a * d), 1.0 - 2.0 * (b * b + d * d), 2.0 * (c * d - a * b)],
            [2.0 * (b * d - a * c), 2.0 * (c * d + a * b), 1.0 - 2.0 * (b * b + c * c)],
        ]
    })
}

fn norm(A: &Sym<f64>) -> f64 {
    double_dot(A, A).sqrt()
}

fn rests_in_its_reference(material: &impl Material) {
    assert_eq!(material.strain_energy(&[0.0; 6]), 0.0);
    assert_eq!(material.stress(&[0.0; 6]), [0.0; 6]);
}

/// The strain with a unit dual part in one component.
fn seeded(strain: &Sym<f64>, component: usize) -> Sym<Dual64> {
    let mut dual = strain.map(Dual64::from_re);
    dual[component].eps = 1.0;
    dual
}

/// Number of tensor components for which a component of [`Sym`] stands.
fn multiplicity(component: usize) -> f64 {
    if component < 3 { 1.0 } else { 2.0 }
}

fn stress_is_the_derivative_of_the_energy(material: &impl Material, strain: &Sym<f64>) -> Check {
    let (stress, together) = (material.stress(strain), material.stress_and_elasticity(strain).0);
    for b in 0..6 {
        let derivative = material.strain_energy(&seeded(strain, b)).eps / multiplicity(b);
        // W sums terms as large as those at full strain even where S is small.
        let tolerance = 1e-13 * (norm(&stress) + elasticity_norm(material, strain) * norm(strain));
        prop_assert!((derivative - stress[b]).abs() <= tolerance, "S_{b}: {} is not {derivative}", stress[b]);
        prop_assert!((together[b] - stress[b]).abs() <= tolerance);
    }
    Ok(())
}

fn elasticity_norm(material: &impl Material, strain: &Sym<f64>) -> f64 {
    let D = material.stress_and_elasticity(strain).1;
    D.iter().flatten().map(|d| d.abs()).fold(0.0, f64::max)
}

fn elasticity_is_the_derivative_of_the_stress(material: &impl Material, strain: &Sym<f64>) -> Check {
    let (D, tolerance) =
        (material.stress_and_elasticity(strain).1, 1e-13 * elasticity_norm(material, strain));
    for b in 0..6 {
        let derivative = material.stress(&seeded(strain, b)).map(|s| s.eps / multiplicity(b));
        for a in 0..6 {
            prop_assert!((D[a][b] - derivative[a]).abs() < tolerance, "D_{a}{b}: {}", D[a][b]);
        }
    }
    Ok(())
}

/// Major symmetry; the minor ones are those of the storage.
fn elasticity_is_symmetric(material: &impl Material, strain: &Sym<f64>) -> Check {
    let (D, tolerance) =
        (material.stress_and_elasticity(strain).1, 1e-15 * elasticity_norm(material, strain));
    for a in 0..6 {
        for b in 0..a {
            prop_assert!((D[a][b] - D[b][a]).abs() <= tolerance);
        }
    }
    Ok(())
}

/// The energies agree up to the rounding of two strains, that is, of the work they do.
fn same_energy(material: &impl Material, first: &Sym<f64>, second: &Sym<f64>) -> Check {
    let (a, b) = (material.strain_energy(first), material.strain_energy(second));
    let work = norm(&material.stress(first)) * (1.0 + norm(first));
    prop_assert!((a - b).abs() < 1e-13 * (a.abs() + work), "{a} is not {b}");
    Ok(())
}

/// W(F) = W(Q F).
fn is_objective(material: &impl Material, G: &Mat3<f64>, Q: &Mat3<f64>) -> Check {
    let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
    let F = |i: usize, j: usize| G[i][j] + unit(i, j);
    let QF = |i: usize, j: usize| (0..3).map(|k| Q[i][k] * F(k, j)).sum::<f64>();
    let rotated = [0, 1, 2].map(|i| [0, 1, 2].map(|j| QF(i, j) - unit(i, j)));
    same_energy(material, &green_lagrange(G), &green_lagrange(&rotated))
}

/// W(E) = W(Q^T E Q).
fn is_isotropic(material: &impl Material, G: &Mat3<f64>, Q: &Mat3<f64>) -> Check {
    let E = green_lagrange(G);
    let entry = |i: usize, j: usize| -> f64 {
        (0..9).map(|n| Q[n / 3][i] * E[SYM_INDEX[n / 3][n % 3]] * Q[n % 3][j]).sum()
    };
    same_energy(material, &E, &SYM.map(|(i, j)| entry(i, j)))
}

/// S = lambda tr(E) I + 2 mu E up to a term of second order.
fn agrees_with_linear_elasticity(material: &impl Material, lame: [f64; 2], direction: &Sym<f64>) -> Check {
    let ([lambda, mu], size) = (lame, 1e-7);
    let E = direction.map(|e| e * size);
    let pressure = lambda * (E[0] + E[1] + E[2]);
    let S = material.stress(&E);
    for a in 0..6 {
        let linear = 2.0 * mu * E[a] + if a < 3 { pressure } else { 0.0 };
        prop_assert!((S[a] - linear).abs() < 20.0 * size * size * (lambda.abs() + mu));
    }
    Ok(())
}

/// W and S against the textbook form in extended precision, for strains from 1e-8 to 1.
fn keeps_its_digits(
    material: &impl Material,
    energy: &impl Fn(&Mat3<Big>) -> Big,
    direction: &Sym<f64>,
) -> Check {
    for strain in (0..=8).map(|n| direction.map(|e| e * 10f64.powi(-n))) {
        if !is_deformation(&strain) {
            continue;
        }
        let exact = energy(&right_cauchy_green(&strain, 0, big(0.0)));
        let error = (big(material.strain_energy(&strain)) - &exact) / &exact;
        let error = error.to_f64().value().abs();
        prop_assert!(error < 1e-14, "W: relative error {error:e} at {strain:?}");
        let error = stress_error(material, energy, &strain);
        prop_assert!(error < 1e-14, "S: relative error {error:e} at {strain:?}");
    }
    Ok(())
}

/// Whether a strain of the largest size is one of a body: C is positive definite, with some distance.
fn is_deformation(E: &Sym<f64>) -> bool {
    let c = |i: usize, j: usize| 2.0 * E[SYM_INDEX[i][j]] + if i == j { 0.9 } else { 0.0 };
    let minor = c(0, 0) * c(1, 1) - c(0, 1) * c(0, 1);
    let C = [c(0, 0), c(1, 1), c(2, 2), c(0, 1), c(1, 2), c(0, 2)];
    c(0, 0) > 0.0 && minor > 0.0 && crate::tensor::sym_det(&C) > 0.0
}

/// C = I + 2 E, with an increment of one component of E.
fn right_cauchy_green(E: &Sym<f64>, component: usize, increment: Big) -> Mat3<Big> {
    [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let a = SYM_INDEX[i][j];
            let entry = big(2.0 * E[a]) + big(if i == j { 1.0 } else { 0.0 });
            if a == component { entry + big(2.0) * &increment } else { entry }
        })
    })
}

/// Norm of the error of S by the norm of S; the exact S is a central difference with 60 correct digits.
fn stress_error(material: &impl Material, energy: &impl Fn(&Mat3<Big>) -> Big, E: &Sym<f64>) -> f64 {
    let (S, h) = (material.stress(E), 2f64.powi(-110));
    let exact = [0, 1, 2, 3, 4, 5].map(|b| {
        let energy_at = |increment: f64| energy(&right_cauchy_green(E, b, big(increment)));
        (energy_at(h) - energy_at(-h)) / big(2.0 * h * multiplicity(b))
    });
    let error = [0, 1, 2, 3, 4, 5].map(|b| (big(S[b]) - &exact[b]).to_f64().value());
    norm(&error) / norm(&exact.map(|s| s.to_f64().value()))
}

impl Lane for Dual64 {
    fn splat(self, constant: f64) -> Self {
        Dual64::from_re(constant)
    }
    fn sqrt(self) -> Self {
        num_dual::DualNum::sqrt(&self)
    }
    fn ln_1p(self) -> Self {
        num_dual::DualNum::ln_1p(&self)
    }
    fn abs(self) -> Self {
        if self.re < 0.0 { -self } else { self }
    }
    fn min(self, other: Self) -> Self {
        if self.re < other.re || self.re.is_nan() { self } else { other }
    }
    fn select_below(self, bound: Self, below: Self, otherwise: Self) -> Self {
        if self.re < bound.re { below } else { otherwise }
    }
}
