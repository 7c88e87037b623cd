//! Chain rules, work and rounding of the volume along a step.

mod derivatives;

use proptest::prelude::*;
use pulp::{Arch, Simd, WithSimd};

use super::*;
use derivatives::{largest, whole_tangent};

use crate::average::Average;
use crate::average::tests::{IDENTITY, Step, product, rotation, step};
use crate::material::{VolumeLaw, Volumetric};
use crate::quadrature::{gauss, lobatto};
use crate::tensor::{Batch, LANES, Packed, Register, det, double_dot, mat3, sym_cofactor, sym_det};

/// An inner rule that is exact to rounding for the step sizes used here.
const MANY: usize = 16;

const MEASURES: [VolumeMeasure; 2] = [VolumeMeasure::Ratio, VolumeMeasure::Trace];

fn law(measure: VolumeMeasure, law: Volumetric) -> VolumeLaw {
    VolumeLaw::new(measure, law, 700.0).unwrap()
}

/// Laws of all kinds, in J and in tr E.
fn laws() -> impl Iterator<Item = VolumeLaw> {
    MEASURES.into_iter().flat_map(|measure| Volumetric::ALL.map(|name| law(measure, name)))
}

fn energy_momentum_rules(k: usize) -> [Rule; 4] {
    let assumed = |more| Rule::assumed_strain(k, k + more);
    [assumed(0), assumed(1), assumed(4), Rule::discrete_gradient(k)]
}

/// Every rule of a degree that has exact derivatives.
fn rules(k: usize) -> Vec<Rule> {
    let mut rules = energy_momentum_rules(k).to_vec();
    rules.extend([gauss(k), gauss(k + 2), lobatto(k + 1)].map(|quadrature| Rule::standard(k, &quadrature)));
    rules
}

/// The volume of a point whose projection is its own volume, its mean pressures, and their stress.
struct Point<L> {
    volume: VolumeAverage<L>,
    pressure: Vec<L>,
    stiffness: Vec<L>,
    average: Average<L>,
}

fn at_point<L: Lane>(
    rule: &Rule,
    law: &VolumeLaw,
    start: &Mat3<L>,
    rates: &[Mat3<L>],
    request: Request,
) -> Point<L> {
    let zero = start[0][0].splat(0.0);
    let n = rule.n_pressures();
    let mut volume = VolumeAverage::new(rule, zero);
    let mut pressure = vec![zero; n];
    let mut stiffness = vec![zero; n * n];
    let mut average = Average::new(rule.degree(), zero);
    rule.set_volume(law.measure(), start, rates, request, &mut volume);
    rule.mean_pressure(law, volume.start, &volume.change, request, &mut pressure, &mut stiffness);
    rule.add_pressure(&pressure, &volume, rates, request, &mut average);
    Point { volume, pressure, stiffness, average }
}

/// Displacement gradient at the end.
fn end(rule: &Rule, step: &Step) -> Mat3<f64> {
    Rule::gradient_at(&step.start, rule.weights(), &step.rates)
}

fn cauchy_green(G: &Mat3<f64>) -> Sym<f64> {
    path::right_cauchy_green(&green_lagrange(G))
}

/// `sum_i b_i x_i`.
fn integral(rule: &Rule, x: &[f64]) -> f64 {
    rule.weights().iter().zip(x).map(|(b, x)| b * x).sum()
}

/// `sum_i b_i P_i : F'_i`, the sum of its terms' sizes, and the skew part of `sum_i b_i P_i F(c_i)^T` over its size.
fn work_and_moment(rule: &Rule, stress: &[Mat3<f64>], step: &Step) -> [f64; 3] {
    let k = rule.degree();
    let (mut work, mut size) = (0.0, 0.0);
    let mut moment = [[0.0; 3]; 3];
    for i in 0..k {
        let b = rule.weights()[i];
        let G = Rule::gradient_at(&step.start, &rule.coefficients()[i * k..(i + 1) * k], &step.rates);
        let F = add_scaled(&G, 1.0, &IDENTITY);
        for (r, c) in (0..9).map(|at| (at / 3, at % 3)) {
            work += b * stress[i][r][c] * step.rates[i][r][c];
            size += b * (stress[i][r][c] * step.rates[i][r][c]).abs();
            moment[r][c] += (0..3).map(|J| b * stress[i][r][J] * F[c][J]).sum::<f64>();
        }
    }
    let skew: f64 = [(0, 1), (1, 2), (2, 0)].iter().map(|&(r, c)| (moment[r][c] - moment[c][r]).abs()).sum();
    let norm: f64 = moment.iter().flatten().map(|m| m.abs()).sum();
    [work, size, skew / norm]
}

fn steps(sizes: std::ops::Range<f64>) -> impl Strategy<Value = (usize, Step)> {
    (1usize..=4, sizes).prop_flat_map(|(k, size)| (Just(k), step(k, size)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn rates_add_up_to_the_change((k, step) in steps(0.0..0.15)) {
        let rule = Rule::discrete_gradient(k);
        let (G_1, G_2) = (step.start, end(&rule, &step));
        for measure in MEASURES {
            let mut volume = VolumeAverage::new(&rule, 0.0);
            rule.set_volume(measure, &step.start, &step.rates, Request::Stress, &mut volume);
            let change = measure.change(&green_lagrange(&G_2)) - measure.change(&green_lagrange(&G_1));
            prop_assert!((integral(&rule, &volume.change) - change).abs() < 2e-15, "{measure:?} {k}");
            let work: Vec<f64> = (0..k).map(|i| double_dot(&volume.direction[i], &volume.strain_rates[i])).collect();
            prop_assert!((integral(&rule, &work) - change).abs() < 2e-15, "{measure:?} {k}");
            prop_assert!((volume.start - measure.change(&green_lagrange(&G_1))).abs() < 1e-15);
            if measure == VolumeMeasure::Ratio {
                let F = |G: &Mat3<f64>| det(&add_scaled(G, 1.0, &IDENTITY));
                prop_assert!((volume.start + 1.0 - F(&G_1)).abs() < 2e-15);
                prop_assert!((integral(&rule, &volume.change) - (F(&G_2) - F(&G_1))).abs() < 3e-15);
                let change = sym_det(&cauchy_green(&G_2)) - sym_det(&cauchy_green(&G_1));
                prop_assert!((integral(&rule, &volume.path.det_rates) - change).abs() < 5e-15);
            }
        }
    }

    #[test]
    fn pressures_do_the_work_of_the_energy((k, step) in steps(0.01..0.1)) {
        for law in laws() {
            let theta = |G: &Mat3<f64>| law.measure().change(&green_lagrange(G));
            for rule in [Rule::assumed_strain(k, MANY), Rule::discrete_gradient(k), Rule::standard(k, &gauss(24))] {
                let point = at_point(&rule, &law, &step.start, &step.rates, Request::Stress);
                let change = law.energy(theta(&end(&rule, &step))) - law.energy(theta(&step.start));
                let [work, size, skew] = work_and_moment(&rule, &point.average.stress, &step);
                prop_assert!((work - change).abs() < 1e-12 * size + 1e-13, "{law:?} {k} {work} {change}");
                prop_assert!(skew < 1e-13 || !rule.is_energy_momentum(), "{law:?} {k} {skew:e}");
            }
        }
    }

    #[test]
    fn a_cell_of_two_points_conserves_its_energy((k, first) in steps(0.01..0.1), angle in 0.0..2.0f64) {
        // Constant functions: theta is the mean over the points. The second point has a turned, transposed motion.
        let Q = rotation([angle, -0.3, 0.2]);
        let turned = |A: &Mat3<f64>| product(&Q, &[0, 1, 2].map(|r| [0, 1, 2].map(|c| A[c][r])));
        let second = Step {
            start: add_scaled(&turned(&add_scaled(&first.start, 1.0, &IDENTITY)), -1.0, &IDENTITY),
            rates: first.rates.iter().rev().map(turned).collect(),
        };
        let rule = Rule::discrete_gradient(k);
        let law = law(VolumeMeasure::Ratio, Volumetric::SimoTaylor);
        let weights = [0.3, 0.7];
        let steps = [first, second];
        let mut volumes = [VolumeAverage::new(&rule, 0.0), VolumeAverage::new(&rule, 0.0)];
        for (volume, step) in volumes.iter_mut().zip(&steps) {
            rule.set_volume(law.measure(), &step.start, &step.rates, Request::Stress, volume);
        }
        let mean = |of: &dyn Fn(usize) -> f64| weights[0] * of(0) + weights[1] * of(1);
        let start = mean(&|q| volumes[q].start);
        let change: Vec<f64> = (0..k).map(|i| mean(&|q| volumes[q].change[i])).collect();
        let mut pressure = vec![0.0; k];
        rule.mean_pressure(&law, start, &change, Request::Stress, &mut pressure, &mut []);
        let work = mean(&|q| {
            let mut average = Average::new(k, 0.0);
            rule.add_pressure(&pressure, &volumes[q], &steps[q].rates, Request::Stress, &mut average);
            work_and_moment(&rule, &average.stress, &steps[q])[0]
        });
        let theta = mean(&|q| law.measure().change(&green_lagrange(&end(&rule, &steps[q]))));
        let size = law.modulus() * (start.abs() + theta.abs());
        prop_assert!((work - (law.energy(theta) - law.energy(start))).abs() < 1e-13 * size);
    }

    #[test]
    fn discrete_gradients_agree_with_quadratures_in_small_motions((k, step) in steps(0.5..1.0), exponent in 2..9i32) {
        // Two consistent averages of U' differ by a part of U''' theta'^2; |theta'| <= 3 size and |U'''| <= 3 K.
        let size = 10f64.powi(-exponent);
        let small = |A: &Mat3<f64>| A.map(|row| row.map(|a| a * size));
        let start = small(&step.start);
        let rates: Vec<_> = step.rates.iter().map(small).collect();
        for law in laws() {
            let of = |rule: &Rule| at_point(rule, &law, &start, &rates, Request::Stress).average.stress;
            let (discrete, assumed) = (of(&Rule::discrete_gradient(k)), of(&Rule::assumed_strain(k, MANY)));
            let entries = |stress: &[Mat3<f64>]| stress.iter().flatten().flatten().copied().collect::<Vec<_>>();
            let pairs = entries(&discrete).into_iter().zip(entries(&assumed));
            let error = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let scale = law.modulus() * size;
            prop_assert!(error < (3.0 * size + 1e-14) * scale, "{law:?} {k} {:e}", error / scale);
        }
    }
}

const STEP: ([[f64; 3]; 3], [[f64; 3]; 3]) = (
    [[0.1, 0.2, 0.0], [0.0, -0.1, 0.3], [0.1, 0.0, 0.2]],
    [[0.1, 0.4, -0.2], [-0.3, 0.2, 0.1], [0.3, 0.0, -0.1]],
);

#[test]
fn degree_one_has_the_closed_form() {
    // M = cof C_mid + cof(C')/12 and g = 1/(J_1 + J_2).
    let rule = Rule::assumed_strain(1, 5);
    let (start, rate) = STEP;
    let (C_1, C_2) = (cauchy_green(&start), cauchy_green(&add_scaled(&start, 1.0, &rate)));
    let mid: Sym<f64> = std::array::from_fn(|a| 0.5 * (C_1[a] + C_2[a]));
    let difference: Sym<f64> = std::array::from_fn(|a| C_2[a] - C_1[a]);
    let M = sym_add_scaled(&sym_cofactor(&mid), 1.0 / 12.0, &sym_cofactor(&difference));
    let g = 1.0 / (sym_det(&C_1).sqrt() + sym_det(&C_2).sqrt());
    let mut volume = VolumeAverage::new(&rule, 0.0);
    rule.set_volume(VolumeMeasure::Ratio, &start, &[rate], Request::Stress, &mut volume);
    assert!((0..6).all(|a| (volume.direction[0][a] - 2.0 * g * M[a]).abs() < 1e-15));
}

#[test]
fn standard_rules_have_the_stress_of_nanson() {
    // The force of a unit pressure is dJ/dF = cof F = J F^-T, so that cof F F^T = J I.
    let rule = Rule::standard(2, &gauss(3));
    let (start, rate) = STEP;
    let law = law(VolumeMeasure::Ratio, Volumetric::Miehe);
    let point = at_point(&rule, &law, &start, &[rate, start], Request::Stress);
    let mut left = vec![[[0.0; 3]; 3]; 3];
    rule.pressure_force(&point.volume, &mut left);
    for (l, force) in left.iter().enumerate() {
        let integrals = [rule.pressure_integral(l, 0), rule.pressure_integral(l, 1)];
        let F = add_scaled(&Rule::gradient_at(&start, &integrals, &[rate, start]), 1.0, &IDENTITY);
        let J = det(&F);
        assert!((point.volume.change[l] - (J - 1.0)).abs() < 1e-15);
        assert!((point.pressure[l] - law.pressure(J - 1.0)).abs() < 1e-12);
        for (r, c) in (0..9).map(|at| (at / 3, at % 3)) {
            let entry: f64 = (0..3).map(|m| force[r][m] * F[c][m]).sum();
            assert!((entry - if r == c { J } else { 0.0 }).abs() < 1e-15);
        }
    }
}

#[test]
fn rest_and_rigid_motion_have_no_pressure() {
    let turned = |angle| add_scaled(&rotation([0.0, 0.6 * angle, 0.8 * angle]), -1.0, &IDENTITY);
    for law in laws() {
        for k in 1..=4 {
            for rule in rules(k) {
                for start in [[[0.0; 3]; 3], turned(0.91)] {
                    let rest = Step { start, rates: vec![[[0.0; 3]; 3]; k] };
                    let point = at_point(&rule, &law, &rest.start, &rest.rates, Request::Stress);
                    let stress = point.average.stress.iter().flatten().flatten();
                    assert!(stress.fold(0.0, |size: f64, p| size.max(p.abs())) < 5e-16 * law.modulus());
                    // The bulk modulus, turned.
                    let tangent = whole_tangent(&rule, &law, &rest);
                    assert!((0.1..2.0).contains(&(largest(&tangent) / law.modulus())), "{law:?} {k}");
                }
            }
        }
        // From one turn to another: the strain rate is rounding alone.
        for rule in energy_momentum_rules(1) {
            let rate = add_scaled(&turned(1.82), -1.0, &turned(0.91));
            let step = Step { start: turned(0.91), rates: vec![rate] };
            let stress = at_point(&rule, &law, &step.start, &step.rates, Request::Stress).average.stress;
            assert!(stress[0].iter().flatten().all(|p| p.abs() < 1e-15 * law.modulus()));
            assert!(largest(&whole_tangent(&rule, &law, &step)) < 2.0 * law.modulus());
        }
    }
}

#[test]
fn quadratic_laws_have_no_correction() {
    let law = law(VolumeMeasure::Ratio, Volumetric::Quadratic);
    for k in 1..=4 {
        let change: Vec<f64> = (0..k).map(|i| 0.3 * (i as f64 + 1.0).sin()).collect();
        let of = |rule: &Rule| {
            let (mut p, mut u) = (vec![0.0; k], vec![0.0; k * k]);
            rule.mean_pressure(&law, 0.1, &change, Request::Tangent, &mut p, &mut u);
            (p, u)
        };
        assert_eq!(of(&Rule::discrete_gradient(k)).1, {
            let coefficients = Rule::discrete_gradient(k);
            coefficients.coefficients().iter().map(|a| law.modulus() * a).collect::<Vec<_>>()
        });
        let (discrete, assumed) = (of(&Rule::discrete_gradient(k)).0, of(&Rule::assumed_strain(k, k)).0);
        assert!(discrete.iter().zip(assumed).all(|(a, b)| (a - b).abs() < 1e-13 * law.modulus()));
    }
}

#[test]
fn straining_rates_are_symmetric_and_exact_without_motion() {
    let rule = Rule::straining_rates();
    let (start, rate) = STEP;
    for law in laws() {
        let moving = whole_tangent(&rule, &law, &Step { start, rates: vec![rate] });
        let resting = Step { start, rates: vec![[[0.0; 3]; 3]] };
        let (still, assumed) = (
            whole_tangent(&rule, &law, &resting),
            whole_tangent(&Rule::assumed_strain(1, 5), &law, &resting),
        );
        for (r, c) in (0..81).map(|at| (at / 9, at % 9)) {
            assert!((moving[0][r][c] - moving[0][c][r]).abs() < 1e-15 * largest(&moving));
            assert!((still[0][r][c] - assumed[0][r][c]).abs() < 3e-15 * largest(&still), "{law:?}");
        }
    }
    // theta at the mean strain, which a rotating body does not shrink.
    let turned = |angle| add_scaled(&rotation([0.0, 0.0, angle]), -1.0, &IDENTITY);
    let mut volume = VolumeAverage::new(&rule, 0.0);
    let rate = add_scaled(&turned(1.5), -1.0, &turned(0.2));
    rule.set_volume(VolumeMeasure::Ratio, &turned(0.2), &[rate], Request::Tangent, &mut volume);
    assert!(volume.change[0].abs() < 5e-16 && volume.start == 0.0);
}

/// The stress of pressures at a batch of points.
struct OfBatch<'a> {
    rule: &'a Rule,
    law: &'a VolumeLaw,
    steps: &'a [Step],
}

impl WithSimd for OfBatch<'_> {
    type Output = Vec<Mat3<Packed>>;
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let k = self.rule.degree();
        let mut stress = vec![[[Packed([0.0; LANES]); 3]; 3]; k];
        for part in 0..LANES / Batch::<S>::WIDTH {
            let load = |of: &dyn Fn(&Step) -> f64| {
                let packed = Packed(std::array::from_fn(|lane| of(&self.steps[lane])));
                Batch::new(simd, 0.0).load(&packed, part)
            };
            let start = mat3(|r, c| load(&|step| step.start[r][c]));
            let rates: Vec<_> = (0..k).map(|j| mat3(|r, c| load(&|step| step.rates[j][r][c]))).collect();
            let point = at_point(self.rule, self.law, &start, &rates, Request::Tangent);
            for i in 0..k {
                for (r, c) in (0..9).map(|at| (at / 3, at % 3)) {
                    point.average.stress[i][r][c].store(&mut stress[i][r][c], part);
                }
            }
        }
        stress
    }
}

#[test]
fn batches_are_their_points() {
    for k in 1..=3 {
        let steps: Vec<Step> = (0..LANES)
            .map(|lane| {
                let scale = |A: &Mat3<f64>, s: f64| A.map(|row| row.map(|a| a * s));
                let rate = |j: usize| scale(&STEP.1, 0.02 * (lane + 3 * j) as f64);
                Step { start: scale(&STEP.0, 0.1 * lane as f64), rates: (0..k).map(rate).collect() }
            })
            .collect();
        for law in laws() {
            for rule in rules(k) {
                let batch = Arch::new().dispatch(OfBatch { rule: &rule, law: &law, steps: &steps });
                for (lane, step) in steps.iter().enumerate() {
                    let one =
                        at_point(&rule, &law, &step.start, &step.rates, Request::Tangent).average.stress;
                    for (i, at) in (0..9 * k).map(|at| (at / 9, at % 9)) {
                        let entry = batch[i][at / 3][at % 3].0[lane];
                        assert!((entry - one[i][at / 3][at % 3]).abs() < 3e-15 * law.modulus());
                    }
                }
            }
        }
    }
}
