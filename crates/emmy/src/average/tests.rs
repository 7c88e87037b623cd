//! The paper's Table III as properties at a point, and the derivatives of every rule.

use num_dual::Dual64;
use proptest::prelude::*;

use super::{Average, Request, Rule, StartTangent};
use crate::material::{Link, Material, NeoHooke, SaintVenantKirchhoff, Volumetric, Yeoh};
use crate::quadrature::{gauss, lobatto};
use crate::tensor::{Mat3, add_scaled, green_lagrange};

/// A step at a point: displacement gradient at the start and rates of the deformation gradient.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub start: Mat3<f64>,
    pub rates: Vec<Mat3<f64>>,
}

fn tensor(size: f64) -> impl Strategy<Value = Mat3<f64>> {
    prop::array::uniform3(prop::array::uniform3(-size..size))
}

/// A rotated, strained start, and rates that rotate and strain the point further.
pub(super) fn step(k: usize, size: f64) -> impl Strategy<Value = Step> {
    let rates = prop::collection::vec(tensor(size), k);
    (tensor(1.0), tensor(0.15), rates).prop_map(|(axis, strain, rates)| {
        let R = rotation([axis[0][1], axis[1][2], axis[2][0]].map(|w| 2.0 * w));
        let U = add_scaled(&IDENTITY, 1.0, &strain);
        Step { start: add_scaled(&product(&R, &U), -1.0, &IDENTITY), rates }
    })
}

pub(super) const IDENTITY: Mat3<f64> = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

pub(super) fn product(A: &Mat3<f64>, B: &Mat3<f64>) -> Mat3<f64> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| A[i][k] * B[k][j]).sum()))
}

/// Rodrigues' rotation by a rotation vector.
pub(super) fn rotation(w: [f64; 3]) -> Mat3<f64> {
    let angle = (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt().max(1e-30);
    let n = w.map(|x| x / angle);
    let N = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]];
    add_scaled(&add_scaled(&IDENTITY, angle.sin(), &N), 1.0 - angle.cos(), &product(&N, &N))
}

fn averaged<M: Material>(rule: &Rule, material: &M, step: &Step, request: Request) -> Average<f64> {
    let mut average = Average::new(rule.degree(), 0.0);
    rule.average(material, &step.start, &step.rates, request, &mut average);
    average
}

/// Energy defect `sum_i b_i P_i : F'_i - (W_2 - W_1)`, and the norm of the skew part of `sum_i b_i P_i F(c_i)^T`;
/// both relative to the sizes of their terms.
fn defects<M: Material>(rule: &Rule, material: &M, step: &Step) -> (f64, f64) {
    let k = rule.degree();
    let average = averaged(rule, material, step, Request::Stress);
    let mut work = 0.0;
    let mut size = 0.0;
    let mut moment = [[0.0; 3]; 3];
    for i in 0..k {
        let b = rule.weights()[i];
        let F = add_scaled(
            &Rule::gradient_at(&step.start, &rule.a[i * k..(i + 1) * k], &step.rates),
            1.0,
            &IDENTITY,
        );
        for r in 0..3 {
            for c in 0..3 {
                work += b * average.stress[i][r][c] * step.rates[i][r][c];
                size += b * (average.stress[i][r][c] * step.rates[i][r][c]).abs();
                moment[r][c] += (0..3).map(|J| b * average.stress[i][r][J] * F[c][J]).sum::<f64>();
            }
        }
    }
    let end = Rule::gradient_at(&step.start, &rule.b, &step.rates);
    let energy = |G| material.strain_energy(&green_lagrange(G));
    let skew: f64 =
        [(0, 1), (1, 2), (2, 0)].iter().map(|&(r, c)| (moment[r][c] - moment[c][r]).powi(2)).sum();
    let norm: f64 = moment.iter().flatten().map(|m| m * m).sum();
    ((work - energy(&end) + energy(&step.start)) / (size + 1e-300), (skew / norm.max(1e-300)).sqrt())
}

const ROUNDING: f64 = 1e-12;

/// An inner rule that is exact to rounding for the step sizes used here.
const MANY: usize = 16;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn table_iii_energy_momentum_rules((k, step) in (1usize..=3).prop_flat_map(|k| (Just(k), step(k, 0.1)))) {
        let svk = SaintVenantKirchhoff::new(1000.0, 500.0).unwrap();
        let rubber = NeoHooke::new(1000.0, 500.0).unwrap();
        // AS(k) for St. Venant-Kirchhoff, AS(n) and DGM in general: energy and angular momentum.
        for rule in [Rule::assumed_strain(k, k), Rule::assumed_strain(k, MANY), Rule::discrete_gradient(k)] {
            let (energy, momentum) = defects(&rule, &svk, &step);
            prop_assert!(energy.abs() < ROUNDING && momentum < ROUNDING, "{energy:e} {momentum:e}");
        }
        for rule in [Rule::assumed_strain(k, MANY), Rule::discrete_gradient(k)] {
            let (energy, momentum) = defects(&rule, &rubber, &step);
            prop_assert!(energy.abs() < ROUNDING && momentum < ROUNDING, "{energy:e} {momentum:e}");
        }
        // The inner rule does not matter for angular momentum.
        prop_assert!(defects(&Rule::assumed_strain(k, k), &rubber, &step).1 < ROUNDING);
        prop_assert!(defects(&Rule::assumed_strain(k, k + 1), &rubber, &step).1 < ROUNDING);
    }

    #[test]
    fn table_iii_standard_rules((k, step) in (1usize..=3).prop_flat_map(|k| (Just(k), step(k, 0.1)))) {
        let svk = SaintVenantKirchhoff::new(1000.0, 500.0).unwrap();
        let rubber = NeoHooke::new(1000.0, 500.0).unwrap();
        // FE(k) conserves angular momentum, FE(n) with many points energy. W of St. Venant-Kirchhoff is of degree 4 in
        // F, so 2k points are exact for it.
        prop_assert!(defects(&Rule::standard(k, &gauss(k)), &rubber, &step).1 < ROUNDING);
        prop_assert!(defects(&Rule::standard(k, &gauss(2 * k)), &svk, &step).0.abs() < ROUNDING);
        prop_assert!(defects(&Rule::standard(k, &gauss(24)), &rubber, &step).0.abs() < ROUNDING);
    }

    #[test]
    fn tangents_are_derivatives((k, step) in (1usize..=4).prop_flat_map(|k| (Just(k), step(k, 0.05)))) {
        let svk = SaintVenantKirchhoff::new(1.0, 0.7).unwrap();
        let rubber = NeoHooke::new(1.0, 0.7).unwrap();
        let spring = Link::spring(1.0, Some(0.7)).unwrap().with_length(1.0);
        let mut rules = vec![
            Rule::standard(k, &gauss(k)), Rule::standard(k, &gauss(k + 2)), Rule::standard(k, &lobatto(k + 1)),
            Rule::assumed_strain(k, k), Rule::assumed_strain(k, k + 2), Rule::discrete_gradient(k),
        ];
        if k == 1 {
            rules.push(Rule::standard(1, &lobatto(2)));
        }
        for rule in rules {
            for error in [tangent_error(&rule, &svk, &step), tangent_error(&rule, &rubber, &step)] {
                prop_assert!(error < rounding(&rule, &step), "{:?} {k} {error:e}", rule.kind);
            }
            let error = tangent_error(&rule, &spring, &step);
            prop_assert!(error < rounding_of_link(&rule, &step), "{:?} {k} {error:e}", rule.kind);
        }
    }

    #[test]
    fn start_tangents_match_dual_numbers((k, step) in (1usize..=4).prop_flat_map(|k| (Just(k), step(k, 0.05)))) {
        let svk = SaintVenantKirchhoff::new(1.0, 0.7).unwrap();
        let rubber = NeoHooke::new(1.0, 0.7).unwrap();
        let yeoh = Yeoh::new([0.4, 0.1, 0.05], 1.0, Volumetric::Logarithmic).unwrap();
        let spring = Link::spring(1.0, Some(0.7)).unwrap().with_length(1.0);
        for rule in [
            Rule::standard(k, &gauss(k)), Rule::standard(k, &gauss(k + 2)), Rule::standard(k, &lobatto(k + 1)),
            Rule::assumed_strain(k, k), Rule::assumed_strain(k, k + 2), Rule::discrete_gradient(k),
        ] {
            for error in [
                start_tangent_error(&rule, &svk, &step), start_tangent_error(&rule, &rubber, &step),
                start_tangent_error(&rule, &yeoh, &step),
            ] {
                prop_assert!(error < rounding(&rule, &step), "{:?} {k} {error:e}", rule.kind);
            }
            let error = start_tangent_error(&rule, &spring, &step);
            prop_assert!(error < rounding_of_link(&rule, &step), "{:?} {k} {error:e}", rule.kind);
        }
    }

    #[test]
    fn tiny_steps_keep_their_energy((k, step) in (1usize..=3).prop_flat_map(|k| (Just(k), step(k, 1.0))), exponent in 2i32..13) {
        // A strained point that hardly moves, and a nearly unstrained one: the energy changes little, and the defect
        // stays at the rounding of the *work*, or of W itself if that is larger.
        let rubber = NeoHooke::new(1000.0, 500.0).unwrap();
        let size = 10f64.powi(-exponent);
        let rates: Vec<_> = step.rates.iter().map(|rate| rate.map(|row| row.map(|x| x * size))).collect();
        let tiny = Step { start: step.start, rates: rates.clone() };
        let average = averaged(&Rule::discrete_gradient(k), &rubber, &tiny, Request::Stress);
        let reference = averaged(&Rule::assumed_strain(k, MANY), &rubber, &tiny, Request::Stress);
        for (P, Q) in average.stress.iter().zip(&reference.stress) {
            for (p, q) in P.iter().flatten().zip(Q.iter().flatten()) {
                // Both are consistent averages: they differ by the square of the step, without noise.
                prop_assert!((p - q).abs() < 1e5 * size * size + 1e-9, "{:e}", p - q);
            }
        }
        // Tiny vibration about the unstrained state: the balance holds relative to the energy itself.
        let start = step.start.map(|row| row.map(|x| x * size));
        let (energy, _) = defects(&Rule::discrete_gradient(k), &rubber, &Step { start, rates });
        prop_assert!(energy.abs() < 1e-11, "{energy:e}");
    }
}

#[test]
fn schemes_lack_the_properties_that_table_iii_denies() {
    let rubber = NeoHooke::new(1000.0, 500.0).unwrap();
    let rates = vec![[[0.1, 0.4, -0.2], [-0.3, 0.2, 0.1], [0.3, 0.0, -0.1]]];
    let step = Step { start: [[0.1, 0.2, 0.0], [0.0, -0.1, 0.3], [0.1, 0.0, 0.2]], rates };
    assert!(defects(&Rule::standard(1, &gauss(1)), &rubber, &step).0.abs() > 1e-3);
    assert!(defects(&Rule::standard(1, &gauss(5)), &rubber, &step).1 > 1e-4);
    assert!(defects(&Rule::standard(1, &lobatto(2)), &rubber, &step).1 > 1e-4);
    assert!(defects(&Rule::assumed_strain(1, 1), &rubber, &step).0.abs() > 1e-4);
}

#[test]
fn rest_and_rigid_motion_are_free_of_stress() {
    let rubber = NeoHooke::new(1000.0, 500.0).unwrap();
    let turned = |angle| add_scaled(&rotation([0.0, 0.6 * angle, 0.8 * angle]), -1.0, &IDENTITY);
    for k in 1..=3 {
        let rule = Rule::discrete_gradient(k);
        let rest = Step { start: turned(1.0), rates: vec![[[0.0; 3]; 3]; k] };
        let average = averaged(&rule, &rubber, &rest, Request::Tangent);
        assert!(average.stress.iter().flatten().flatten().all(|p| p.abs() < 1e-11));
        assert!(average.tangent.iter().flatten().flatten().all(|t| t.is_finite()));
    }
    // k = 1: the end point is the rotated start; the mid-point is strained, the strain rate is rounding only.
    let rate = add_scaled(&turned(1.3), -1.0, &turned(1.0));
    let average = averaged(
        &Rule::discrete_gradient(1),
        &rubber,
        &Step { start: turned(1.0), rates: vec![rate] },
        Request::Tangent,
    );
    assert!(average.stress[0].iter().flatten().all(|p| p.abs() < 1e-11));
    assert!(average.tangent[0].iter().flatten().all(|t| t.abs() < 1e4));
}

/// Relative rounding of the derivatives of stresses. The correction of the discrete gradient is a difference of
/// energies over `|E'|^2 = sum_i b_i E'_i : E'_i`, and its derivative divides by `|E'|` once more.
fn rounding(rule: &Rule, step: &Step) -> f64 {
    let k = rule.degree();
    let square = |i: usize| {
        let gradient = Rule::gradient_at(&step.start, &rule.a[i * k..(i + 1) * k], &step.rates);
        let F = add_scaled(&gradient, 1.0, &IDENTITY);
        let transposed = [0, 1, 2].map(|r| [0, 1, 2].map(|c| F[c][r]));
        let rate = product(&transposed, &step.rates[i]);
        let symmetric = |at: usize| 0.5 * (rate[at / 3][at % 3] + rate[at % 3][at / 3]);
        (0..9).map(|at| symmetric(at).powi(2)).sum::<f64>()
    };
    let size = (0..k).map(|i| rule.weights()[i] * square(i)).sum::<f64>().sqrt();
    if size > 0.02 { 1e-10 } else { 1e-10 + 1000.0 * f64::EPSILON / size.powi(3) }
}

/// As [`rounding`] for a link, whose force is a difference of energies over that of the squares of its length.
fn rounding_of_link(rule: &Rule, step: &Step) -> f64 {
    let end = Rule::gradient_at(&step.start, &rule.b, &step.rates);
    let [start, end] = [&step.start, &end].map(|G| 1.0 + 2.0 * green_lagrange(G)[..3].iter().sum::<f64>());
    if (end - start).abs() > 0.05 && start.min(end) > 0.5 { 1e-10 } else { 2e-8 }
}

/// Derivatives of the stresses by entry `(r, c)` of the start, or of the rate j, by dual numbers.
fn stress_derivatives<M: Material>(
    rule: &Rule,
    material: &M,
    step: &Step,
    by_rate: Option<usize>,
    (r, c): (usize, usize),
) -> Vec<Mat3<f64>> {
    let dual = |tensor: &Mat3<f64>| tensor.map(|row| row.map(Dual64::from_re));
    let mut start = dual(&step.start);
    let mut rates: Vec<_> = step.rates.iter().map(dual).collect();
    let varied = by_rate.map_or(&mut start, |j| &mut rates[j]);
    varied[r][c].eps = 1.0;
    let mut average = Average::new(rule.degree(), Dual64::from_re(0.0));
    rule.average(material, &start, &rates, Request::Stress, &mut average);
    average.stress.iter().map(|stress| stress.map(|row| row.map(|entry| entry.eps))).collect()
}

/// Largest difference between the tangent and dual numbers, relative to the largest entry.
fn tangent_error<M: Material>(rule: &Rule, material: &M, step: &Step) -> f64 {
    let k = rule.degree();
    let average = averaged(rule, material, step, Request::Tangent);
    let stress = averaged(rule, material, step, Request::Stress);
    assert_eq!(average.stress, stress.stress, "the stress must not depend on what is wanted");
    let (mut error, mut size) = (0f64, 0f64);
    for (j, column) in (0..9 * k).map(|at| (at / 9, at % 9)) {
        let exact = stress_derivatives(rule, material, step, Some(j), (column / 3, column % 3));
        for (i, row) in (0..9 * k).map(|at| (at / 9, at % 9)) {
            let value = average.tangent[i * k + j][row][column];
            error = error.max((exact[i][row / 3][row % 3] - value).abs());
            size = size.max(value.abs());
        }
    }
    error / size
}

/// Largest difference between the derivatives by the start and dual numbers, relative to the largest entry.
fn start_tangent_error<M: Material>(rule: &Rule, material: &M, step: &Step) -> f64 {
    let k = rule.degree();
    let mut result = StartTangent::new(k);
    rule.start_tangent(material, &step.start, &step.rates, &mut result);
    let size = result.tangent.as_flattened().as_flattened().iter().fold(0f64, |size, t| size.max(t.abs()));
    let mut error = 0f64;
    for column in 0..9 {
        let exact = stress_derivatives(rule, material, step, None, (column / 3, column % 3));
        for (i, row) in (0..9 * k).map(|at| (at / 9, at % 9)) {
            error = error.max((result.tangent[i][row][column] - exact[i][row / 3][row % 3]).abs());
        }
    }
    error / size
}

/// `sum_c A_rc X_c` with tensors as nine numbers.
fn applied(A: &[[f64; 9]; 9], X: &Mat3<f64>) -> [f64; 9] {
    std::array::from_fn(|row| (0..9).map(|c| A[row][c] * X[c / 3][c % 3]).sum())
}

#[test]
fn strain_rate_transform_matches_assumed_strain_in_a_rotating_body() {
    // A rigid rotation from an unstrained state: F' = [w] F(1/2), and by E' = sym(F^T F')
    // dE' = sym(F(1/2)^T (dF' - [w] dF'/2)) exactly, so that A_AS dF' = A (dF' - [w] dF'/2).
    let R = rotation([0.3, -0.5, 0.9]);
    let material = NeoHooke::new(1000.0, 500.0).unwrap();
    let rate = add_scaled(&R, -1.0, &IDENTITY);
    let step = Step { start: [[0.0; 3]; 3], rates: vec![rate] };
    // [w] = F' F^-1 = 2 (R - I) (R + I)^-1, Cayley's transform: tan(t/2)/(t/2) times the rotation vector.
    let angle = (0.3f64 * 0.3 + 0.5 * 0.5 + 0.9 * 0.9).sqrt();
    let w = [0.3, -0.5, 0.9].map(|x| x * (0.5 * angle).tan() / (0.5 * angle));
    let W = [[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]];
    let assumed = averaged(&Rule::assumed_strain(1, 1), &material, &step, Request::Tangent);
    let straining = averaged(&Rule::straining_rates(), &material, &step, Request::Tangent);
    let size = applied(&straining.tangent[0], &IDENTITY).iter().map(|x| x.abs()).fold(0.0, f64::max);
    for at in 0..9 {
        let mut dF = [[0.0; 3]; 3];
        dF[at / 3][at % 3] = 1.0;
        let strains = add_scaled(&dF, -0.5, &product(&W, &dF));
        let (left, right) = (applied(&assumed.tangent[0], &dF), applied(&straining.tangent[0], &strains));
        assert!(left.iter().zip(right).all(|(a, b)| (a - b).abs() < 1e-13 * size), "{left:?} {right:?}");
    }
    for (row, column) in (0..81).map(|at| (at / 9, at % 9)) {
        let (A, B) = (straining.tangent[0][row][column], straining.tangent[0][column][row]);
        assert!((A - B).abs() < 1e-13 * size);
    }
}
