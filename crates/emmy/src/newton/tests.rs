//! Newton's iteration on one equation.

use super::*;
use crate::error::Error;

/// x^2 = a, undefined for x <= 0.
struct SquareRoot(f64, f64, f64);

impl System for SquareRoot {
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<Sizes> {
        if x[0] <= 0.0 {
            return Err(Error::Inverted { cell: 0, det: x[0] });
        }
        residual[0] = x[0] * x[0] - self.0;
        Ok(Sizes { residual: residual[0].abs(), scale: self.0, floor: self.1 })
    }
    fn correction(
        &mut self,
        x: &[f64],
        residual: &[f64],
        _: f64,
        tangent: Tangent,
        dx: &mut [f64],
    ) -> Result<usize> {
        if matches!(tangent, Tangent::Refactorized | Tangent::Exact) {
            self.2 = 2.0 * x[0];
        }
        dx[0] = -residual[0] / self.2;
        Ok(1)
    }
    fn refactorization_cost(&self) -> f64 {
        4.0
    }
}

#[test]
fn converges_quadratically() {
    let mut newton = Newton::default();
    let mut x = [3.0];
    let outcome =
        newton.solve(&mut SquareRoot(4.0, 0.0, 0.0), &mut x, &NewtonSettings::default(), true).unwrap();
    assert!(outcome.converged && !outcome.at_rounding_floor && x[0] == 2.0);
    // R_(n+1) = (R_n / (2 x_n))^2 exactly for this equation.
    let history = newton.history();
    for pair in history.windows(2).take(3) {
        let x = (pair[0] + 4.0).sqrt();
        assert!((pair[1] - (pair[0] / (2.0 * x)).powi(2)).abs() < 1e-14);
    }
}

#[test]
fn steps_back_from_where_there_is_no_residual() {
    let mut newton = Newton::default();
    let mut x = [10.0];
    // From 10 the equation x^2 = 1e-4 asks for 5, 2.5, ...: the iteration stays on the positive side.
    let settings = NewtonSettings { tolerance: 1e-12, max_iterations: 40, ..Default::default() };
    let outcome = newton.solve(&mut SquareRoot(1e-4, 0.0, 0.0), &mut x, &settings, true).unwrap();
    assert!(outcome.converged && (x[0] - 0.01).abs() < 1e-15);
    assert!(newton.solve(&mut SquareRoot(1.0, 0.0, 0.0), &mut [-1.0], &settings, true).is_err());
}

#[test]
fn gives_up_and_says_so() {
    let settings = NewtonSettings { max_iterations: 2, ..Default::default() };
    let outcome =
        Newton::default().solve(&mut SquareRoot(4.0, 0.0, 0.0), &mut [300.0], &settings, true).unwrap();
    assert!(!outcome.converged && outcome.iterations == 2 && outcome.residual > outcome.target);
}

#[test]
fn a_reused_tangent_is_refactorized_when_it_has_cost_more_than_a_new_one() {
    let mut newton = Newton::default();
    let mut system = SquareRoot(4.0, 1e-12, 0.0);
    let settings = NewtonSettings::default();
    let mut refactorizations = Vec::new();
    for step in 0..12 {
        let mut x = [2.0 + 0.02 * f64::from(step)];
        let before = system.2;
        system.0 = (2.01 + 0.02 * f64::from(step)).powi(2);
        let outcome = newton.solve(&mut system, &mut x, &settings, false).unwrap();
        assert!(outcome.converged && (x[0] * x[0] - system.0).abs() < 1e-11);
        refactorizations.push(system.2 != before);
    }
    // Computed for the first step, reused for the next ones, refactorised before the last.
    assert!(refactorizations[0] && !refactorizations[1] && !refactorizations[2], "{refactorizations:?}");
    assert!(refactorizations[3..].contains(&true), "{refactorizations:?}");
}

#[test]
fn a_rounding_floor_is_accepted() {
    // The floor lies above the tolerance: no smaller residual is possible.
    let outcome = Newton::default()
        .solve(&mut SquareRoot(4.0, 1e-3, 0.0), &mut [3.0], &NewtonSettings::default(), false)
        .unwrap();
    assert!(outcome.converged && outcome.at_rounding_floor);
}
