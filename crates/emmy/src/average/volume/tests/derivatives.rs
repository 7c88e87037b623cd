//! Derivatives of the volume and of its pressures by rates and start.

use num_dual::Dual64;
use proptest::prelude::*;

use super::super::VolumeStart;
use super::{at_point, law, laws, rules, steps};
use crate::average::tests::Step;
use crate::average::{Request, Rule, StartTangent};
use crate::material::{VolumeLaw, VolumeMeasure, Volumetric};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    #[test]
    fn tangents_match_dual_numbers((k, step) in steps(0.02..0.08)) {
        for law in laws() {
            for rule in rules(k) {
                let error = tangent_error(&rule, &law, &step);
                prop_assert!(error < 1e-11, "{law:?} {k} {} {error:e}", rule.n_pressures());
            }
        }
    }

    #[test]
    fn tangents_match_central_differences((k, step) in steps(0.02..0.08)) {
        let law = law(VolumeMeasure::Ratio, Volumetric::SimoTaylor);
        for rule in rules(k) {
            let exact = whole_tangent(&rule, &law, &step);
            for (j, column) in (0..9 * k).map(|at| (at / 9, at % 9)) {
                let shifted = |shift: f64| {
                    let mut step = step.clone();
                    step.rates[j][column / 3][column % 3] += shift;
                    at_point(&rule, &law, &step.start, &step.rates, Request::Stress).average.stress
                };
                let (plus, minus) = (shifted(1e-5), shifted(-1e-5));
                for (i, row) in (0..9 * k).map(|at| (at / 9, at % 9)) {
                    let slope = (plus[i][row / 3][row % 3] - minus[i][row / 3][row % 3]) / 2e-5;
                    prop_assert!((exact[i * k + j][row][column] - slope).abs() < 1e-7 * law.modulus());
                }
            }
        }
    }

    #[test]
    fn derivatives_by_the_start_match_dual_numbers((k, step) in steps(0.02..0.08)) {
        for law in laws() {
            for rule in rules(k) {
                let error = start_tangent_error(&rule, &law, &step);
                prop_assert!(error < 1e-11, "{law:?} {k} {} {error:e}", rule.n_pressures());
            }
        }
    }
}

/// Derivatives of the stress by the rates, with the part through the pressures.
pub(super) fn whole_tangent(rule: &Rule, law: &VolumeLaw, step: &Step) -> Vec<[[f64; 9]; 9]> {
    let k = rule.degree();
    let n = rule.n_pressures();
    let point = at_point(rule, law, &step.start, &step.rates, Request::Tangent);
    let mut left = vec![[[0.0; 3]; 3]; n];
    let mut right = vec![[[0.0; 3]; 3]; n * k];
    rule.pressure_force(&point.volume, &mut left);
    rule.volume_response(&point.volume, &step.rates, &mut right);
    let mut tangent = point.average.tangent;
    for (i, j) in (0..k * k).map(|at| (at / k, at % k)) {
        for (l, m) in (0..n * n).map(|at| (at / n, at % n)) {
            let factor = rule.pressure_weight(i, l) * point.stiffness[l * n + m];
            for (r, c) in (0..81).map(|at| (at / 9, at % 9)) {
                let force = left[l].as_flattened()[r];
                tangent[i * k + j][r][c] += factor * force * right[m * k + j].as_flattened()[c];
            }
        }
    }
    tangent
}

pub(super) fn largest(tangents: &[[[f64; 9]; 9]]) -> f64 {
    tangents.as_flattened().as_flattened().iter().fold(0f64, |size, t| size.max(t.abs()))
}

/// Largest difference between the derivatives of stress and changes by the rates and dual numbers, relative to the
/// largest entry.
fn tangent_error(rule: &Rule, law: &VolumeLaw, step: &Step) -> f64 {
    let k = rule.degree();
    let tangent = whole_tangent(rule, law, step);
    let point = at_point(rule, law, &step.start, &step.rates, Request::Tangent);
    let stress = at_point(rule, law, &step.start, &step.rates, Request::Stress).average.stress;
    assert_eq!(point.average.stress, stress, "the stress must not depend on the request");
    let mut right = vec![[[0.0; 3]; 3]; rule.n_pressures() * k];
    rule.volume_response(&point.volume, &step.rates, &mut right);
    let start = step.start.map(|row| row.map(Dual64::from_re));
    let mut error = 0f64;
    for (j, column) in (0..9 * k).map(|at| (at / 9, at % 9)) {
        let mut rates: Vec<_> =
            step.rates.iter().map(|rate| rate.map(|row| row.map(Dual64::from_re))).collect();
        rates[j][column / 3][column % 3].eps = 1.0;
        let dual = at_point(rule, law, &start, &rates, Request::Stress);
        for (i, row) in (0..9 * k).map(|at| (at / 9, at % 9)) {
            let exact = dual.average.stress[i][row / 3][row % 3].eps;
            error = error.max((tangent[i * k + j][row][column] - exact).abs() / largest(&tangent));
        }
        for (l, change) in dual.volume.change.iter().enumerate() {
            error = error.max((right[l * k + j].as_flattened()[column] - change.eps).abs());
        }
    }
    error
}

/// The same of the derivatives by the start.
fn start_tangent_error(rule: &Rule, law: &VolumeLaw, step: &Step) -> f64 {
    let k = rule.degree();
    let n = rule.n_pressures();
    let point = at_point(rule, law, &step.start, &step.rates, Request::Tangent);
    let mut by_start = VolumeStart::new(rule);
    rule.set_volume_start(law.measure(), &step.start, &step.rates, &point.volume, &mut by_start);
    let mut slope = vec![0.0; n];
    rule.mean_pressure_start(law, point.volume.start, &point.volume.change, &mut slope);
    let mut result = StartTangent::new(k);
    let arguments = (&step.start, &step.rates[..]);
    rule.add_pressure_start(&point.pressure, &point.volume, &by_start, arguments, &mut result);
    let mut left = vec![[[0.0; 3]; 3]; n];
    rule.pressure_force(&point.volume, &mut left);
    let rates: Vec<_> = step.rates.iter().map(|rate| rate.map(|row| row.map(Dual64::from_re))).collect();
    let mut error = 0f64;
    for column in 0..9 {
        let mut start = step.start.map(|row| row.map(Dual64::from_re));
        start[column / 3][column % 3].eps = 1.0;
        let dual = at_point(rule, law, &start, &rates, Request::Stress);
        error = error.max((by_start.start.as_flattened()[column] - dual.volume.start.eps).abs());
        let change: Vec<f64> = by_start.change.iter().map(|change| change.as_flattened()[column]).collect();
        for (l, exact) in dual.volume.change.iter().enumerate() {
            error = error.max((change[l] - exact.eps).abs());
        }
        for (i, row) in (0..9 * k).map(|at| (at / 9, at % 9)) {
            let mut value = result.tangent[i][row][column];
            for l in 0..n {
                let through_rates: f64 = (0..n).map(|m| point.stiffness[l * n + m] * change[m]).sum();
                let dp = through_rates + slope[l] * by_start.start.as_flattened()[column];
                value += rule.pressure_weight(i, l) * left[l].as_flattened()[row] * dp;
            }
            let exact = dual.average.stress[i][row / 3][row % 3].eps;
            error = error.max((value - exact).abs() / law.modulus());
        }
    }
    error
}
