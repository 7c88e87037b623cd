//! Approximate solution of the stage equations from a starting point near the solution.

use crate::body::Body;
use crate::error::Result;
use crate::newton::{STAGNATION, System, Tangent};
use crate::time::stage_coefficients::StageCoefficients;
use crate::time::stage_system::StageSystem;
use crate::time::{MAX_DEGREE, Memory};

/// A few corrections with a reused stiffness.
///
/// Each leaves a part of order h^2 of the defect, or of order h^3 with a new stiffness, since the tangent contains M
/// exactly (except for the 16-bit matrix of conjugate gradients, which leaves less than a hundredth). The end of the
/// step depends on a part of the rates that is small by orthogonality; the last change there estimates the remainder.
/// Where one stiffness represents the stages poorly, as in a long step that bends the body, the exact tangent follows.
#[derive(Debug, Default)]
pub(super) struct DefectCorrection {
    residual: Vec<f64>,
    correction: Vec<f64>,
    /// Sum of all changes of displacement and velocity at the end of the step, `[2][n_nodes][3]`.
    at_end: Vec<f64>,
    /// Corrections beyond the minimum since the last refactorisation; `None`: there is no stiffness, or a useless one.
    excess: Option<usize>,
}

/// Tolerance of the linear solver: the end of the step is less sensitive to the defect than its size suggests.
const TOLERANCE: f64 = 1e-4;

/// The same with the exact tangent: its corrections converge to the solution, and the change at the end is watched.
const EXACT_TOLERANCE: f64 = 1e-3;

/// Largest remaining change at the end of the step over the change so far. Where each correction is the part q of the
/// one before, the remaining ones sum to q/(1 - q) of the last. Half of the 5 % that may be left, because q grows where
/// K is outdated.
const MAX_END_CHANGE: f64 = 0.025;

/// A correction that leaves a larger part of the residual has an outdated stiffness.
const SLOW_CONTRACTION: f64 = 0.3;

/// Largest number of corrections beyond the minimum.
const MAX_EXTRA_CORRECTIONS: usize = 4;

impl DefectCorrection {
    /// Corrects the unknowns at least `least` times, and more often if a large residual remains; false if it does not
    /// converge.
    ///
    /// # Errors
    /// As the system.
    pub(super) fn solve(
        &mut self,
        system: &mut StageSystem<'_>,
        unknowns: &mut [f64],
        least: usize,
    ) -> Result<bool> {
        self.residual.resize(unknowns.len(), 0.0);
        self.correction.resize(unknowns.len(), 0.0);
        self.at_end.clear();
        self.at_end.resize(2 * system.equations.body.n_dofs(), 0.0);
        let is_old = self.excess.is_none_or(|excess| excess as f64 >= system.refactorization_cost());
        let mut tangent = if is_old { Tangent::Refactorized } else { Tangent::Reused };
        let mut is_fresh = is_old;
        let mut last_change = f64::INFINITY;
        let mut size = system.residual(unknowns, &mut self.residual)?.residual;
        for count in 1..=least + MAX_EXTRA_CORRECTIONS {
            if size == 0.0 {
                return Ok(true);
            }
            let is_exact = matches!(tangent, Tangent::Exact | Tangent::Renewed | Tangent::LastExact);
            let tolerance = if is_exact { EXACT_TOLERANCE } else { TOLERANCE };
            match system.correction(unknowns, &self.residual, tolerance, tangent, &mut self.correction) {
                Err(_) if is_exact => break,
                done => done?,
            };
            unknowns.iter_mut().zip(&self.correction).for_each(|(x, dx)| *x += dx);
            let change = self.change_at_end(system.equations.body, &system.equations.coefficients);
            let sizes = system.residual(unknowns, &mut self.residual)?;
            let left = sizes.residual / size;
            let floor = STAGNATION * sizes.floor.max(f64::EPSILON * sizes.scale);
            let is_rounding = sizes.residual <= floor;
            // The change at the end may fall more slowly than the residual.
            let rate = left.max(change / last_change);
            last_change = change;
            let is_enough = change * rate <= MAX_END_CHANGE * (1.0 - rate);
            if count >= least && (is_enough || is_rounding) {
                let before = if is_fresh { 0 } else { self.excess.unwrap_or(0) };
                self.excess = (!is_exact).then_some(before + count - least);
                return Ok(true);
            }
            let is_slow = !(left <= SLOW_CONTRACTION || is_rounding);
            tangent = match (is_slow, is_fresh) {
                (true, _) if is_exact => break,
                (false, _) if is_exact => Tangent::LastExact,
                (true, true) => Tangent::Exact,
                (true, false) => Tangent::Refactorized,
                (false, _) => Tangent::Reused,
            };
            is_fresh |= is_slow;
            size = sizes.residual;
        }
        self.excess = None;
        Ok(false)
    }

    /// Adds the last correction to the changes at the end of the step; returns its part of the sum of all corrections,
    /// in displacement or velocity.
    fn change_at_end(&mut self, body: &Body, coefficients: &StageCoefficients) -> f64 {
        let n = self.at_end.len() / 2;
        let mut weights = [[0.0; 2]; MAX_DEGREE];
        let k = coefficients.rule.degree();
        (0..k).for_each(|j| weights[j] = coefficients.end_weights(j));
        let mut part: f64 = 0.0;
        for (which, at_end) in self.at_end.chunks_exact_mut(n).enumerate() {
            let (mut change, mut all) = (0.0, 0.0);
            for dof in body.space.counted_dofs() {
                let terms = self.correction[dof..k * n].iter().step_by(n).zip(&weights);
                let own: f64 = terms.map(|(dx, weights)| weights[which] * dx).sum();
                at_end[dof] += own;
                (change, all) = (change + own * own, all + at_end[dof] * at_end[dof]);
            }
            let mut squares = [change, all];
            body.space.sum_ranks("squares of the change at the end", &mut squares);
            let [change, all] = squares;
            if change > 0.0 {
                part = part.max((change / all).sqrt());
            }
        }
        part
    }

    /// Keeps the memory that the next corrections depend on.
    pub(super) fn save(&self, memory: &mut Memory) {
        memory.save_option("defect.excess", self.excess.map(|excess| excess as f64));
    }

    /// Restores the data of [`DefectCorrection::save`].
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub(super) fn restore(&mut self, memory: &Memory) -> Result<()> {
        self.excess = memory.option("defect.excess")?.map(|excess| excess as usize);
        Ok(())
    }
}
