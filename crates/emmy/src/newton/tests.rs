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

/// Two equations whose approximate tangent contracts the error of one, and leaves a multiple of the error of the other.
struct TwoModes {
    growth: f64,
    has_exact: bool,
}

impl System for TwoModes {
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<Sizes> {
        (residual[0], residual[1]) = (x[0] - 1.0, x[1] - 2.0);
        Ok(Sizes { residual: residual[0].hypot(residual[1]), scale: 1.0, floor: 0.0 })
    }
    fn correction(
        &mut self,
        _: &[f64],
        residual: &[f64],
        _: f64,
        tangent: Tangent,
        dx: &mut [f64],
    ) -> Result<usize> {
        let approximate = [0.99 * residual[0], (1.0 - self.growth) * residual[1]];
        match (tangent, self.has_exact) {
            (Tangent::Exact | Tangent::LastExact, false) => {
                return Err(Error::Linear { reason: "no solution".to_string() });
            }
            (Tangent::Exact | Tangent::LastExact, true) => (dx[0], dx[1]) = (-residual[0], -residual[1]),
            _ => (dx[0], dx[1]) = (-approximate[0], -approximate[1]),
        }
        Ok(1)
    }
    fn refactorization_cost(&self) -> f64 {
        4.0
    }
    fn largest_contraction(&self, _: usize) -> f64 {
        0.9
    }
}

/// The error of the first equation hides that of the second until convergence; this one then grows fivefold, or falls
/// by a tenth, in each correction.
#[test]
fn corrections_after_convergence_keep_the_best_iterate() {
    for (growth, hidden) in [(5.0, f64::EPSILON), (-5.0, f64::EPSILON), (0.9, 5e-12)] {
        for has_exact in [true, false] {
            let mut x = [1.5, 2.0 * (1.0 + hidden)];
            let mut newton = Newton::default();
            let mut system = TwoModes { growth, has_exact };
            let outcome = newton.solve(&mut system, &mut x, &NewtonSettings::default(), false).unwrap();
            let error = (x[0] - 1.0).hypot(x[1] - 2.0);
            assert!(outcome.converged && outcome.took_exact_tangent == has_exact, "{growth} {outcome:?}");
            // Rounding with the exact tangent; without it, below the tolerance.
            let bound = if has_exact { 1e-15 } else { 1e-10 };
            assert!(error <= bound, "{growth}, exact: {has_exact}: {error:e} {:?}", newton.history());
        }
    }
}

/// As [`TwoModes`]; the tangent of the start leaves 1/100 and 0.9 of the two errors, any later one a quarter of the
/// second.
struct Renewed {
    factorizations: usize,
}

impl System for Renewed {
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<Sizes> {
        (residual[0], residual[1]) = (x[0] - 1.0, x[1]);
        Ok(Sizes { residual: residual[0].hypot(residual[1]), scale: 1.0, floor: 0.0 })
    }
    fn correction(
        &mut self,
        _: &[f64],
        residual: &[f64],
        _: f64,
        tangent: Tangent,
        dx: &mut [f64],
    ) -> Result<usize> {
        self.factorizations += usize::from(tangent == Tangent::Refactorized);
        let left = if self.factorizations > 1 { 0.25 } else { 0.9 };
        (dx[0], dx[1]) = (-0.99 * residual[0], -(1.0 - left) * residual[1]);
        Ok(1)
    }
    fn refactorization_cost(&self) -> f64 {
        4.0
    }
}

/// After convergence the contraction of the first error promises rounding in two corrections; the second error is then
/// left.
#[test]
fn slow_corrections_after_convergence_renew_the_tangent() {
    let mut x = [1.5, 5e-12];
    let mut system = Renewed { factorizations: 0 };
    let outcome = Newton::default().solve(&mut system, &mut x, &NewtonSettings::default(), false).unwrap();
    assert!(outcome.converged && !outcome.took_exact_tangent && outcome.refactorizations == 2, "{outcome:?}");
    assert!(x[1].abs() <= ROUND_OFF && (x[0] - 1.0).abs() <= ROUND_OFF, "{x:?}");
}

/// x = 0 by corrections that leave `A x` with any tangent but the exact one.
struct Contracting {
    /// A.
    left: [[f64; 2]; 2],
    /// Of a new tangent, in corrections.
    cost: f64,
    ending: Ending,
}

/// Leaves 0.2 and 0.001 of the error in turn.
const IN_TURN: [[f64; 2]; 2] = [[0.0, 0.2], [0.001, 0.0]];

/// Leaves one part.
fn every(part: f64) -> [[f64; 2]; 2] {
    [[part, 0.0], [0.0, part]]
}

impl System for Contracting {
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<Sizes> {
        residual.copy_from_slice(x);
        Ok(Sizes { residual: x[0].hypot(x[1]), scale: 1.0, floor: 0.0 })
    }
    fn correction(
        &mut self,
        _: &[f64],
        residual: &[f64],
        _: f64,
        tangent: Tangent,
        dx: &mut [f64],
    ) -> Result<usize> {
        let is_exact = matches!(tangent, Tangent::Exact | Tangent::Renewed | Tangent::LastExact);
        for (a, dx) in dx.iter_mut().enumerate() {
            let left = self.left[a][0] * residual[0] + self.left[a][1] * residual[1];
            *dx = if is_exact { -residual[a] } else { left - residual[a] };
        }
        Ok(1)
    }
    fn refactorization_cost(&self) -> f64 {
        self.cost
    }
    fn ending(&self) -> Ending {
        self.ending
    }
    fn largest_contraction(&self, _: usize) -> f64 {
        0.9
    }
}

#[test]
fn endings_leave_what_they_promise() {
    // After n corrections the error is 20^-n: 7.8e-10, 3.9e-11, 2.0e-12 for n = 7, 8, 9.
    let settings = NewtonSettings { tolerance: 5e-10, ..Default::default() };
    for (ending, corrections, error) in [
        (Ending::Tolerance, 8, 20f64.powi(-8)),
        (Ending::Balanced, 9, 20f64.powi(-9)),
        (Ending::Rounding, 12, 0.0),
    ] {
        let mut newton = Newton::default();
        let mut x = [1.0, 0.0];
        let mut system = Contracting { left: every(0.05), cost: 20.0, ending };
        let outcome = newton.solve(&mut system, &mut x, &settings, false).unwrap();
        assert!(outcome.converged && outcome.iterations == corrections, "{ending:?}: {outcome:?}");
        assert!((x[0] - error).abs() < 1e-15, "{ending:?}: {x:?}");
        // No residual follows the last correction.
        assert_eq!(newton.history().len(), corrections, "{ending:?}");
        match newton.open_end() {
            Some(end) => {
                assert!((end.residual[0] - 20.0 * error).abs() < 1e-15 && ending == Ending::Balanced)
            }
            None => assert!(ending != Ending::Balanced),
        }
    }
}

/// Errors after n corrections: 0.2, 2e-4, 4e-5, 4e-8, 8e-9, 8e-12; three more leave 3.2e-16. One contraction of 0.2
/// would need 22 corrections, more than a tangent of cost 13 and those with it; one of 0.001 promises rounding after
/// two.
#[test]
fn a_dear_tangent_is_judged_by_two_corrections() {
    for (cost, refactorizations) in [(4.0, 1), (13.0, 0)] {
        let mut newton = Newton::default();
        let mut system = Contracting { left: IN_TURN, cost, ending: Ending::Rounding };
        let settings = NewtonSettings::default();
        newton.solve(&mut system, &mut [0.0, 1.0], &settings, false).unwrap();
        let mut x = [0.0, 1.0];
        let outcome = newton.solve(&mut system, &mut x, &settings, false).unwrap();
        assert!(outcome.converged && outcome.refactorizations == refactorizations, "{cost}: {outcome:?}");
        if refactorizations == 0 {
            let error = x[0].hypot(x[1]);
            assert!(outcome.iterations == 9 && error <= ROUND_OFF, "{outcome:?}, {error:e}");
        }
    }
}

/// From 0.1 the errors are 0.02, 2e-5, 4e-6, 4e-9, 8e-10, 8e-13. After the fourth, the last contraction, 0.001, would
/// promise the tolerance after one more.
#[test]
fn a_contraction_of_two_in_turn_does_not_promise_the_tolerance() {
    let mut system = Contracting { left: IN_TURN, cost: 13.0, ending: Ending::Tolerance };
    let mut x = [0.0, 0.1];
    let outcome = Newton::default().solve(&mut system, &mut x, &NewtonSettings::default(), false).unwrap();
    assert!(outcome.converged && outcome.iterations == 6, "{outcome:?}");
    assert!((x[0].hypot(x[1]) / 8e-13 - 1.0).abs() < 1e-3, "{x:?}");
}

/// Solves `x = 0` to rounding from the distance `start`, by corrections of one contraction; its outcome and error.
fn solve_from(start: f64, newton: &mut Newton, contraction: f64, cost: f64) -> (Outcome, f64) {
    let mut x = [start, 0.0];
    let mut system = Contracting { left: every(contraction), cost, ending: Ending::Rounding };
    let outcome = newton.solve(&mut system, &mut x, &NewtonSettings::default(), false).unwrap();
    assert!(outcome.converged && x[0] <= ROUND_OFF, "{outcome:?}, {x:?}");
    (outcome, x[0])
}

/// From 1e-5, 0.35 needs 11 corrections to the tolerance of 1e-10 and 23 to rounding. A new tangent is tried twice,
/// before the first correction and after the second; a cheap one after each, and once after convergence.
#[test]
fn a_dear_tangent_is_not_renewed_where_that_has_not_helped() {
    let mut newton = Newton::default();
    for refactorizations in [2, 0, 0] {
        let (outcome, _) = solve_from(1e-5, &mut newton, 0.35, 13.0);
        assert!(outcome.refactorizations == refactorizations, "{outcome:?}");
        assert!(outcome.iterations == 23 && !outcome.took_exact_tangent, "{outcome:?}");
    }
    // The memory of a motion that is resumed.
    for (memory, refactorizations) in
        [(newton.memory(), 0), (NewtonMemory { renewed: None, ..newton.memory() }, 1)]
    {
        let mut resumed = Newton::default();
        resumed.restore(memory);
        let (outcome, _) = solve_from(1e-5, &mut resumed, 0.35, 13.0);
        assert!(outcome.refactorizations == refactorizations, "{outcome:?}");
    }
    let (outcome, _) = solve_from(1e-5, &mut Newton::default(), 0.35, 4.0);
    assert!(outcome.refactorizations == 12, "{outcome:?}");
}

/// A tangent that became worse is renewed, and so is one that cannot end in time: from 1, 0.35 needs 22 corrections to
/// the tolerance, where 20 are allowed; from 1e-9, 0.8 needs 55 to rounding.
#[test]
fn a_dear_tangent_is_renewed_where_it_does_not_suffice() {
    let mut newton = Newton::default();
    solve_from(1e-5, &mut newton, 0.35, 13.0);
    let (outcome, _) = solve_from(1e-5, &mut newton, 0.95, 13.0);
    assert!(outcome.refactorizations == 1 && outcome.took_exact_tangent, "{outcome:?}");
    for (start, contraction) in [(1.0, 0.35), (1e-9, 0.8)] {
        let mut newton = Newton::default();
        for _ in 0..2 {
            let (outcome, error) = solve_from(start, &mut newton, contraction, 13.0);
            assert!(outcome.took_exact_tangent && error == 0.0, "{outcome:?}, {error:e}");
        }
    }
}

/// x = 0 by corrections that leave given parts of x one after the other; parts of the tangent change suddenly.
struct Sudden<'a> {
    left: std::slice::Iter<'a, f64>,
    tangents: Vec<Tangent>,
}

impl System for Sudden<'_> {
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<Sizes> {
        residual[0] = x[0];
        Ok(Sizes { residual: x[0].abs(), scale: 1.0, floor: 0.0 })
    }
    fn correction(
        &mut self,
        _: &[f64],
        residual: &[f64],
        _: f64,
        tangent: Tangent,
        dx: &mut [f64],
    ) -> Result<usize> {
        self.tangents.push(tangent);
        dx[0] = (self.left.next().unwrap_or(&0.0) - 1.0) * residual[0];
        Ok(1)
    }
    fn refactorization_cost(&self) -> f64 {
        4.0
    }
    fn is_sudden(&mut self, _: &[f64]) -> bool {
        true
    }
    fn approximates_sudden_parts(&self) -> bool {
        true
    }
    fn ending(&self) -> Ending {
        Ending::Tolerance
    }
}

/// Parts that change suddenly are renewed until corrections contract much, and again where they do not. At first,
/// corrections may be slow without an exact tangent; later they may not.
#[test]
fn sudden_parts_are_renewed_while_they_change() {
    use Tangent::{Exact, Refactorized, Reused, Unchanged};
    let solve = |left: &[f64]| {
        let mut system = Sudden { left: left.iter(), tangents: Vec::new() };
        let outcome = Newton::default().solve(&mut system, &mut [1.0], &NewtonSettings::default(), false);
        (outcome.unwrap(), system.tangents)
    };
    let (outcome, tangents) = solve(&[0.45, 0.4, 0.1, 0.005, 0.1, 0.005, 0.005]);
    assert!(outcome.converged && !outcome.took_exact_tangent, "{outcome:?}");
    assert_eq!(tangents[..7], [Refactorized, Reused, Reused, Reused, Unchanged, Reused, Unchanged]);
    for slow in [&[0.6, 0.6][..], &[0.1, 0.1, 0.1, 0.4, 0.4]] {
        let (outcome, tangents) = solve(slow);
        assert!(outcome.converged && outcome.took_exact_tangent, "{outcome:?}");
        assert_eq!(tangents[slow.len()], Exact);
    }
}
