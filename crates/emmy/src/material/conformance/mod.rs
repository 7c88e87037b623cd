//! Conditions on every material, checked for each in one line.

mod dual;
mod extended;

pub(super) use extended::{Big, big, big_det, big_isochoric, big_principal_stretches, big_trace};

use num_dual::Dual64;
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestCaseError, TestRng, TestRunner};

use super::Material;
use crate::tensor::{
    Mat3, SYM, SYM_INDEX, Sym, det_of_identity_plus, double_dot, green_lagrange, mat3, sym_add_scaled,
};

/// Checks an isotropic material against its energy in a textbook form W(C) and its small-strain Lame parameters.
pub(super) fn conforms(material: &impl Material, [lambda, mu]: [f64; 2], energy: impl Fn(&Mat3<Big>) -> Big) {
    let hooke = |E: &Sym<f64>| {
        let pressure = lambda * (E[0] + E[1] + E[2]);
        [0, 1, 2, 3, 4, 5].map(|a| 2.0 * mu * E[a] + if a < 3 { pressure } else { 0.0 })
    };
    conforms_but_for_symmetry(material, hooke, &energy);
    for direction in SPECIAL_DIRECTIONS {
        keeps_the_digits_of_its_elasticity(material, &energy, &direction).unwrap();
    }
    for_all((large_gradient(), rotation()), |(G, Q)| is_symmetric_under(material, &G, &Q));
}

/// Checks an anisotropic material against its energy, its stress at small strain, and the rotations and reflections of
/// its symmetry group.
pub(super) fn conforms_with_symmetry(
    material: &impl Material,
    symmetry: &[Mat3<f64>],
    small_strain_stress: impl Fn(&Sym<f64>) -> Sym<f64>,
    energy: impl Fn(&Mat3<Big>) -> Big,
) {
    conforms_but_for_symmetry(material, small_strain_stress, &energy);
    for Q in symmetry {
        for_all(large_gradient(), |G| is_symmetric_under(material, &G, Q));
    }
}

fn conforms_but_for_symmetry(
    material: &impl Material,
    small_strain_stress: impl Fn(&Sym<f64>) -> Sym<f64>,
    energy: &impl Fn(&Mat3<Big>) -> Big,
) {
    rests_in_its_reference(material);
    for_all(rotation(), |Q| rests_in_rotation(material, &Q));
    for_all(large_gradient(), |G| {
        let strain = green_lagrange(&G);
        stress_is_the_derivative_of_the_energy(material, &strain)?;
        elasticity_is_the_derivative_of_the_stress(material, &strain)?;
        elasticity_is_symmetric(material, &strain)
    });
    for_all((large_gradient(), rotation()), |(G, Q)| is_objective(material, &G, &Q));
    for_all(direction(), |E| agrees_with_linear_elasticity(material, &small_strain_stress, &E));
    for_some(24, direction(), |direction| keeps_its_digits(material, energy, &direction));
    for direction in SPECIAL_DIRECTIONS {
        keeps_its_digits(material, energy, &direction).unwrap();
        keeps_the_digits_of_energy_changes(material, energy, &direction).unwrap();
        sums_its_stress_along_a_path(material, &direction).unwrap();
        // Not the direction itself: tension-only fibres have no elasticity where tension begins.
        let nearby = sym_add_scaled(&direction, 1e-7, &GENERAL_DIRECTION);
        keeps_the_digits_of_its_elasticity(material, energy, &nearby).unwrap();
    }
}

/// Rotation by half a turn about a unit vector.
pub(super) fn half_turn(a: [f64; 3]) -> Mat3<f64> {
    mat3(|i, j| 2.0 * a[i] * a[j] - if i == j { 1.0 } else { 0.0 })
}

type Check = Result<(), TestCaseError>;

fn for_all<S: Strategy>(strategy: S, check: impl Fn(S::Value) -> Check) {
    for_some(64, strategy, check);
}

fn for_some<S: Strategy>(cases: u32, strategy: S, check: impl Fn(S::Value) -> Check) {
    // The draws are always the same: the bounds on round-off are a few units in the last place above the observed
    // errors.
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases) };
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

/// A small perturbation that separates eigenvalues and eigenvectors.
const GENERAL_DIRECTION: Sym<f64> = [0.3, -0.5, 0.4, 0.2, -0.35, 0.1];

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

/// No stress in a rigid rotation, up to the rounding of the strain.
fn rests_in_rotation(material: &impl Material, Q: &Mat3<f64>) -> Check {
    let G = mat3(|i, j| Q[i][j] - if i == j { 1.0 } else { 0.0 });
    let stress = material.stress(&green_lagrange(&G));
    prop_assert!(norm(&stress) < 5e-15 * elasticity_norm(material, &[0.0; 6]), "{stress:?}");
    Ok(())
}

/// The strain with a unit dual part in one component.
fn seeded(strain: &Sym<f64>, component: usize) -> Sym<Dual64> {
    let mut dual = strain.map(Dual64::from_re);
    dual[component].eps = 1.0;
    dual
}

/// Number of tensor components that a component of [`Sym`] represents.
fn multiplicity(component: usize) -> f64 {
    if component < 3 { 1.0 } else { 2.0 }
}

fn stress_is_the_derivative_of_the_energy(material: &impl Material, strain: &Sym<f64>) -> Check {
    let stress = material.stress(strain);
    let together = material.stress_and_elasticity(strain).0;
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
    let D = material.stress_and_elasticity(strain).1;
    let tolerance = 1e-13 * elasticity_norm(material, strain);
    for b in 0..6 {
        let derivative = material.stress(&seeded(strain, b)).map(|s| s.eps / multiplicity(b));
        for a in 0..6 {
            prop_assert!((D[a][b] - derivative[a]).abs() < tolerance, "D_{a}{b}: {}", D[a][b]);
        }
    }
    Ok(())
}

/// Major symmetry; the storage implies the minor ones.
fn elasticity_is_symmetric(material: &impl Material, strain: &Sym<f64>) -> Check {
    let D = material.stress_and_elasticity(strain).1;
    let tolerance = 1e-15 * elasticity_norm(material, strain);
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
fn is_symmetric_under(material: &impl Material, G: &Mat3<f64>, Q: &Mat3<f64>) -> Check {
    let E = green_lagrange(G);
    let entry = |i: usize, j: usize| -> f64 {
        (0..9).map(|n| Q[n / 3][i] * E[SYM_INDEX[n / 3][n % 3]] * Q[n % 3][j]).sum()
    };
    same_energy(material, &E, &SYM.map(|(i, j)| entry(i, j)))
}

/// S is the stress of linear elasticity up to a term of second order.
fn agrees_with_linear_elasticity(
    material: &impl Material,
    small_strain_stress: &impl Fn(&Sym<f64>) -> Sym<f64>,
    direction: &Sym<f64>,
) -> Check {
    let size = 1e-7;
    let scale = elasticity_norm(material, &[0.0; 6]);
    let E = direction.map(|e| e * size);
    let S = material.stress(&E);
    let linear = small_strain_stress(&E);
    for a in 0..6 {
        prop_assert!((S[a] - linear[a]).abs() < 20.0 * size * size * scale, "{S:?} is not {linear:?}");
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
        let exact = energy(&right_cauchy_green(&strain, &[]));
        let error = (big(material.strain_energy(&strain)) - &exact) / &exact;
        let error = error.to_f64().value().abs();
        prop_assert!(error < 1e-14, "W: relative error {error:e} at {strain:?}");
        let error = stress_error(material, energy, &strain);
        prop_assert!(error < 1e-14, "S: relative error {error:e} at {strain:?}");
    }
    Ok(())
}

/// Whether a strain of the largest size belongs to a body: C is positive definite, by a margin.
fn is_deformation(E: &Sym<f64>) -> bool {
    let c = |i: usize, j: usize| 2.0 * E[SYM_INDEX[i][j]] + if i == j { 0.9 } else { 0.0 };
    let minor = c(0, 0) * c(1, 1) - c(0, 1) * c(0, 1);
    let C = [c(0, 0), c(1, 1), c(2, 2), c(0, 1), c(1, 2), c(0, 2)];
    c(0, 0) > 0.0 && minor > 0.0 && crate::tensor::sym_det(&C) > 0.0
}

/// Changes of the energy, if the material has a closed form, against differences of the textbook form with 100 digits.
fn keeps_the_digits_of_energy_changes(
    material: &impl Material,
    energy: &impl Fn(&Mat3<Big>) -> Big,
    direction: &Sym<f64>,
) -> Check {
    for (size, part) in
        [1.0, 1e-3, 1e-8].into_iter().flat_map(|size| [0.3, 1e-4, 1e-9].map(|part| (size, part)))
    {
        let E = direction.map(|e| e * size);
        let dE = GENERAL_DIRECTION.map(|e| e * size * part);
        let end = sym_add_scaled(&E, 1.0, &dE);
        let Some(change) =
            material.energy_change(&E, &dE).filter(|_| is_deformation(&E) && is_deformation(&end))
        else {
            continue;
        };
        let increments = [0, 1, 2, 3, 4, 5].map(|a| (a, big(dE[a])));
        let exact = energy(&right_cauchy_green(&E, &increments)) - energy(&right_cauchy_green(&E, &[]));
        let error = (big(change) - exact).to_f64().value();
        let scale = (norm(&material.stress(&E)) + elasticity_norm(material, &E) * norm(&dE)) * norm(&dE);
        prop_assert!(
            error.abs() < 4e-15 * scale,
            "change of energy: error {error:e} of {scale:e} at {E:?}, {dE:?}"
        );
    }
    Ok(())
}

/// Quadrature of the stress along a path against the sum over its points, with weights of both signs.
fn sums_its_stress_along_a_path(material: &impl Material, direction: &Sym<f64>) -> Check {
    let points = [[0.0, 0.3], [0.25, -0.2], [0.7, 0.8], [1.0, 0.1]];
    for (size, part) in
        [1.0, 1e-3, 1e-8].into_iter().flat_map(|size| [0.3, 1e-4, 1e-9].map(|part| (size, part)))
    {
        let E = direction.map(|e| e * size);
        let dE = GENERAL_DIRECTION.map(|e| e * size * part);
        let strains = points.map(|[alpha, _]| sym_add_scaled(&E, alpha, &dE));
        if !strains.iter().all(is_deformation) {
            continue;
        }
        let mut sum = [0.0; 6];
        let mut scale = 0.0;
        for (strain, [_, weight]) in strains.iter().zip(points) {
            let stress = material.stress(strain);
            sum = sym_add_scaled(&sum, weight, &stress);
            scale += norm(&stress);
        }
        let along = material.stress_along(&E, &dE, &points);
        let error = norm(&sym_add_scaled(&sum, -1.0, &along));
        prop_assert!(
            error < 1e-14 * scale,
            "stress along a path: error {error:e} of {scale:e} at {E:?}, {dE:?}"
        );
    }
    Ok(())
}

/// D against second differences of the textbook form, at a large strain and a small one.
fn keeps_the_digits_of_its_elasticity(
    material: &impl Material,
    energy: &impl Fn(&Mat3<Big>) -> Big,
    direction: &Sym<f64>,
) -> Check {
    for strain in [1.0, 1e-5].map(|size| direction.map(|e| e * size)) {
        if !is_deformation(&strain) {
            continue;
        }
        let D = material.stress_and_elasticity(&strain).1;
        let scale = elasticity_norm(material, &strain);
        for (a, b) in (0..6).flat_map(|a| (0..=a).map(move |b| (a, b))) {
            let error = (big(D[a][b]) - second_derivative(energy, &strain, a, b)).to_f64().value();
            // A component is a sum of a dozen products of rounded factors.
            prop_assert!(error.abs() < 3e-14 * scale, "D_{a}{b}: error {error:e} of {scale:e} at {strain:?}");
        }
    }
    Ok(())
}

/// C = I + 2 E, with increments of components of E.
fn right_cauchy_green(E: &Sym<f64>, increments: &[(usize, Big)]) -> Mat3<Big> {
    [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let a = SYM_INDEX[i][j];
            let entry = big(2.0 * E[a]) + big(if i == j { 1.0 } else { 0.0 });
            let of_this = increments.iter().filter(|(component, _)| *component == a);
            of_this.fold(entry, |entry, (_, increment)| entry + big(2.0) * increment)
        })
    })
}

/// d^2W/dE_a dE_b on the components of the tensor: a second difference with 60 correct digits.
fn second_derivative(energy: &impl Fn(&Mat3<Big>) -> Big, E: &Sym<f64>, a: usize, b: usize) -> Big {
    let h = 2f64.powi(-100);
    let at = |i: f64, j: f64| energy(&right_cauchy_green(E, &[(a, big(i * h)), (b, big(j * h))]));
    let difference = at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0);
    difference / (big(4.0 * h * multiplicity(a) * multiplicity(b)) * big(h))
}

/// Norm of the error of S by the norm of S; the exact S is a central difference with 60 correct digits.
fn stress_error(material: &impl Material, energy: &impl Fn(&Mat3<Big>) -> Big, E: &Sym<f64>) -> f64 {
    let S = material.stress(E);
    let h = 2f64.powi(-110);
    let exact = [0, 1, 2, 3, 4, 5].map(|b| {
        let energy_at = |increment: f64| energy(&right_cauchy_green(E, &[(b, big(increment))]));
        (energy_at(h) - energy_at(-h)) / big(2.0 * h * multiplicity(b))
    });
    let error = [0, 1, 2, 3, 4, 5].map(|b| (big(S[b]) - &exact[b]).to_f64().value());
    norm(&error) / norm(&exact.map(|s| s.to_f64().value()))
}
