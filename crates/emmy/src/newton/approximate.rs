//! Corrections with an approximate tangent that is reused from one solution to the next.

use super::{Ending, FIRST_FORCING, Newton, ROUND_OFF, Run, System, Tangent};
use crate::error::Result;

/// State of the approximate tangent between two solutions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NewtonMemory {
    /// Corrections in the solution for which the tangent was factored; `None`: there is no tangent.
    pub fresh: Option<usize>,
    /// Corrections since then beyond that number.
    pub excess: usize,
    /// Relative tolerance of the next correction.
    pub forcing: f64,
    /// Mean contraction by the last tangent that was renewed before convergence; `None`: there was none, or the excess
    /// of another reached its cost since.
    pub renewed: Option<f64>,
}

impl Newton {
    /// State of the approximate tangent, for [`Newton::restore`].
    pub fn memory(&self) -> NewtonMemory {
        self.approximation
    }

    /// Sets the state of the approximate tangent.
    pub fn restore(&mut self, memory: NewtonMemory) {
        self.approximation = memory;
    }

    /// Requests a refactorisation of the approximate tangent for the next solution: the tangent of a failed solution is
    /// useless.
    pub fn forget(&mut self) {
        self.approximation = NewtonMemory { fresh: None, renewed: None, ..self.approximation };
    }

    /// Corrections with the approximate tangent, which is refactorised if they become slow; false if that does not help
    /// either.
    ///
    /// The iteration converges linearly, so its contraction predicts when it ends: the last residual need not be
    /// evaluated. In bodies that bend, corrections contract by 0.2 and by 0.001 in turn, so a tangent that is dear is
    /// judged by two.
    pub(super) fn solve_approximately(
        &mut self,
        system: &mut impl System,
        x: &mut [f64],
        run: &mut Run<'_>,
    ) -> Result<bool> {
        let old = &mut self.approximation;
        let is_old = old.fresh.is_none() || old.excess as f64 >= system.refactorization_cost();
        let mut tangent = if is_old { Tangent::Refactorized } else { Tangent::Reused };
        let mut forcing = if old.fresh.is_none() { FIRST_FORCING } else { old.forcing };
        let mut is_fresh = is_old;
        if is_old && old.fresh.is_some() {
            old.renewed = None;
        }
        // A correction tighter than the contraction by the tangent gains nothing.
        let mut tightest = TIGHTEST;
        let mut contraction = 1.0;
        // Of tangents that were new.
        let mut slow_renewals = 0;
        // Contraction by the last correction with this tangent.
        let mut previous = None;
        // Place in the history at which the tangent was renewed.
        let mut renewal = None;
        loop {
            let is_converged = self.judge(run);
            let residual = run.sizes.residual;
            let is_done = if is_converged && (run.sizes.scale == 0.0 || run.ending == Ending::Tolerance) {
                true
            } else if let Some(last) = self.last_correction(run, contraction) {
                let kept = if tangent == Tangent::Unchanged { tangent } else { Tangent::Reused };
                self.finish(system, x, run, (last, kept))
            } else if run.outcome.at_rounding_floor && run.ending == Ending::Rounding {
                self.polish(system, x, run)?;
                true
            } else if is_converged {
                // Rounding hides the last contraction.
                let n = n_to_judge(system.refactorization_cost());
                let visible = self.last_visible_contraction(run, n).unwrap_or(contraction);
                is_fresh |= self.polish_approximately(system, x, run, visible)?;
                true
            } else {
                false
            };
            if is_done {
                self.note_corrections(run.outcome.iterations, is_fresh, forcing);
                return Ok(true);
            }
            if run.outcome.iterations >= run.settings.max_iterations || !residual.is_finite() {
                self.approximation.fresh = None;
                return Ok(false);
            }
            let tolerance = forcing.max(0.3 * run.goal() / residual).min(LOOSEST);
            run.outcome.refactorizations += usize::from(tangent == Tangent::Refactorized);
            let Ok(iterations) = self.correct(system, x, tolerance, tangent) else {
                self.approximation.fresh = None;
                return Ok(false);
            };
            run.outcome.linear_iterations += iterations;
            run.outcome.iterations += 1;
            let sizes = system.residual(&self.trial, &mut self.trial_residual);
            let ratio = sizes.as_ref().map_or(f64::INFINITY, |sizes| sizes.residual / residual);
            tangent = if ratio < STEADY { Tangent::Unchanged } else { Tangent::Reused };
            if ratio < 1.0 {
                x.copy_from_slice(&self.trial);
                std::mem::swap(&mut self.residual, &mut self.trial_residual);
                run.sizes = sizes?;
            }
            contraction = ratio;
            if ratio >= 2.0 * tolerance {
                tightest = 0.5 * ratio;
            }
            let next = match run.is_sudden {
                true => (0.1 * ratio).max(TIGHTEST_OF_SUDDEN),
                false => (0.1 * tolerance).max(tightest),
            };
            forcing = next.clamp(TIGHTEST, LOOSEST);
            // A part of a correction leaves the rest of the residual, however good the tangent is.
            let of_tangent = ((ratio - (1.0 - self.part)) / self.part).max(0.0);
            let cost = system.refactorization_cost();
            let pace = match previous.replace(of_tangent) {
                _ if n_to_judge(cost) == 1 && !run.is_sudden => Some(of_tangent),
                previous => previous.map(|previous: f64| (previous * of_tangent).sqrt()),
            };
            let is_useless = ratio.is_nan() || of_tangent >= 1.0;
            let is_early = run.is_sudden && run.outcome.iterations <= EARLY;
            let slow = if is_early { SLOW_AT_FIRST } else { SLOW };
            let is_slow = is_useless || pace.is_some_and(|pace| pace > slow);
            if self.part < 1.0 {
                renewal = None;
            }
            self.note_contraction(run, renewal);
            if is_slow && run.is_sudden {
                // Bodies that meet may spin apart, so that no single K serves them for long.
                return Ok(false);
            }
            if is_slow
                && is_fresh
                && (ratio.is_nan() || pace.unwrap_or(of_tangent) > system.largest_contraction(slow_renewals))
            {
                self.approximation.fresh = None;
                return Ok(false);
            }
            let renews = if is_slow {
                let left = run.settings.max_iterations - run.outcome.iterations;
                let keeps = |pace| self.keeps(run, (pace, cost), (run.outcome.target, left));
                is_useless || !pace.is_some_and(keeps)
            } else {
                // Far from the solution, the tangent of the present iterate is better than that of the previous one.
                let left = pace.map_or(0.0, |pace| run.corrections_to(run.goal(), pace));
                let with_new = self.corrections_with_new(run, cost).unwrap_or(FRESH);
                !is_fresh && !run.is_sudden && self.part == 1.0 && left > cost + with_new
            };
            if renews {
                slow_renewals += usize::from(is_slow && is_fresh);
                (tangent, is_fresh) = (Tangent::Refactorized, true);
                previous = None;
                renewal = Some(self.history.len());
            }
        }
    }

    /// The correction that ends the iteration without another residual; `None` if the contraction does not promise that
    /// it suffices, or the system is to be solved to rounding.
    pub(super) fn last_correction(&self, run: &Run<'_>, contraction: f64) -> Option<LastCorrection> {
        let residual = run.sizes.residual;
        let has_begun = (1..run.settings.max_iterations).contains(&run.outcome.iterations);
        if run.ending == Ending::Rounding || !(has_begun || run.outcome.converged) {
            return None;
        }
        let contraction = match run.ending {
            // Nothing is evaluated after it, and a small contraction may have been one of two in turn.
            Ending::Tolerance => {
                let last = self.history.windows(2).rev().take(2).map(|pair| pair[1] / pair[0]);
                last.fold(contraction, f64::max)
            }
            Ending::Balanced | Ending::Rounding => contraction,
        };
        let tolerance = (run.goal() / residual).clamp(TIGHTEST, LOOSEST);
        (residual * contraction <= run.goal()).then_some(LastCorrection { tolerance, contraction })
    }

    /// Mean contraction by the last corrections, at most n, to residuals above the rounding floor.
    fn last_visible_contraction(&self, run: &Run<'_>, n: usize) -> Option<f64> {
        let pairs = self.history.windows(2).rev();
        let visible = pairs.filter(|pair| pair[1] > run.sizes.floor && pair[1] < pair[0]);
        let ratios = visible.take(n).map(|pair| pair[1] / pair[0]);
        let (n, product) = ratios.fold((0, 1.0), |(n, product), ratio| (n + 1, product * ratio));
        (n > 0).then(|| f64::powf(product, 1.0 / f64::from(n)))
    }

    /// Takes the last correction; false without a solution for it.
    pub(super) fn finish(
        &mut self,
        system: &mut impl System,
        x: &mut [f64],
        run: &mut Run<'_>,
        (LastCorrection { tolerance, contraction }, tangent): (LastCorrection, Tangent),
    ) -> bool {
        let Ok(iterations) = self.correct(system, x, tolerance, tangent) else { return false };
        x.copy_from_slice(&self.trial);
        run.outcome.linear_iterations += iterations;
        run.outcome.iterations += 1;
        run.outcome.converged = true;
        run.outcome.residual *= contraction.max(tolerance);
        run.outcome.at_rounding_floor = run.sizes.floor >= run.outcome.target;
        self.has_open_end = run.ending == Ending::Balanced;
        true
    }

    /// Corrections after convergence, until the observed contraction leaves nothing but rounding in the residual. The
    /// rounding of the internal forces hides the true residual: it is large, but has neither a resultant nor a moment.
    ///
    /// The contraction is that of the error which dominated so far. Where the residual falls less, or rises, the best
    /// iterate stays, and a new approximate tangent corrects it, or the exact one if that does not help either. Returns
    /// whether the approximate tangent is new.
    fn polish_approximately(
        &mut self,
        system: &mut impl System,
        x: &mut [f64],
        run: &mut Run<'_>,
        contraction: f64,
    ) -> Result<bool> {
        let (mut left, mut contraction) = (run.sizes.residual, contraction);
        let (mut tangent, mut is_fresh, mut has_exact) = (Tangent::Reused, false, true);
        for count in 1..=MAX_POLISHING {
            let tolerance = (0.3 * run.goal() / left).clamp(TIGHTEST, LOOSEST);
            run.outcome.refactorizations += usize::from(tangent == Tangent::Refactorized);
            is_fresh |= tangent == Tangent::Refactorized;
            let Ok(iterations) = self.correct(system, x, tolerance, tangent) else {
                self.polish_exactly(system, x, run);
                break;
            };
            run.outcome.linear_iterations += iterations;
            run.outcome.iterations += 1;
            tangent = Tangent::Unchanged;
            left *= tolerance.max(contraction);
            if left <= run.goal() {
                x.copy_from_slice(&self.trial);
                self.has_open_end = run.ending == Ending::Balanced;
                break;
            }
            // A trial without a residual is worse than any other.
            let sizes = system.residual(&self.trial, &mut self.trial_residual).ok();
            let ratio = sizes.map_or(f64::INFINITY, |sizes| sizes.residual / run.sizes.residual);
            let is_rounding = sizes.is_some_and(|sizes| run.is_rounding(sizes));
            self.history.extend(sizes.map(|sizes| sizes.residual));
            if let Some(sizes) = sizes.filter(|_| ratio < 1.0 || is_rounding) {
                x.copy_from_slice(&self.trial);
                std::mem::swap(&mut self.residual, &mut self.trial_residual);
                run.sizes = sizes;
            }
            if run.rounding < ROUND_OFF && (ratio < SLOW || !is_rounding) {
                // Not yet hidden by rounding.
                contraction = contraction.max(ratio);
                left = if is_rounding { left.max(run.sizes.residual) } else { run.sizes.residual };
            }
            if ratio < SLOW || is_rounding {
                continue;
            }
            left = run.sizes.residual;
            if !is_fresh {
                let cost = system.refactorization_cost();
                if self.keeps(run, (ratio, cost), (run.goal(), MAX_POLISHING - count)) {
                    contraction = contraction.max(ratio);
                } else {
                    (tangent, contraction) = (Tangent::Refactorized, SLOW);
                }
                continue;
            }
            if has_exact && self.polish_exactly(system, x, run) || ratio >= 1.0 || ratio.is_nan() {
                break;
            }
            has_exact = false;
        }
        Ok(is_fresh)
    }

    /// A correction after convergence with the exact tangent; false without a solution for it: the iterate stays, which
    /// is within the tolerance.
    fn polish_exactly(&mut self, system: &mut impl System, x: &mut [f64], run: &mut Run<'_>) -> bool {
        let is_solved = self.polish(system, x, run).is_ok();
        run.outcome.took_exact_tangent |= is_solved;
        is_solved
    }

    /// Whether a slow tangent of a contraction and cost stays: the last renewed one promises no saving beyond the cost,
    /// and the corrections that are left suffice for an aim.
    fn keeps(&self, run: &Run<'_>, (contraction, cost): (f64, f64), (aim, left): (f64, usize)) -> bool {
        let with_new = self.corrections_with_new(run, cost);
        with_new.is_some_and(|with_new| run.corrections_to(run.goal(), contraction) <= cost + with_new)
            && run.corrections_to(aim, contraction) <= left as f64
    }

    /// Expected number of corrections with a new tangent that is dear, by the last renewed one; `None` if the tangent
    /// is cheap or none was renewed.
    fn corrections_with_new(&self, run: &Run<'_>, cost: f64) -> Option<f64> {
        let renewed = self.approximation.renewed.filter(|_| n_to_judge(cost) > 1);
        renewed.map(|contraction| run.corrections_to(run.goal(), contraction))
    }

    /// Records the mean contraction since the tangent was renewed, as soon as two corrections show it.
    fn note_contraction(&mut self, run: &Run<'_>, renewal: Option<usize>) {
        let Some(since) = renewal.map(|at| &self.history[at..]) else { return };
        if let [first, _, ..] = *since
            && run.sizes.residual > run.sizes.floor
        {
            let mean = (run.sizes.residual / first).powf((since.len() as f64).recip());
            self.approximation.renewed = Some(mean);
        }
    }

    /// Records the number of corrections of a solution.
    fn note_corrections(&mut self, corrections: usize, is_fresh: bool, forcing: f64) {
        let noted = &mut self.approximation;
        noted.forcing = forcing;
        match noted.fresh {
            Some(fresh) if !is_fresh => noted.excess += corrections.saturating_sub(fresh),
            _ => (noted.fresh, noted.excess) = (Some(corrections), 0),
        }
    }
}

/// A correction that no residual follows.
pub(super) struct LastCorrection {
    /// Relative tolerance of its linear solver.
    tolerance: f64,
    /// Part of the residual that it is expected to leave.
    contraction: f64,
}

/// After a correction that leaves a smaller part of the residual, the parts of the tangent that change suddenly stay:
/// near the solution, their change is small beside the error of the rest.
const STEADY: f64 = 1e-2;

/// Corrections with the approximate tangent that leave a larger part of the residual are slow.
const SLOW: f64 = 0.3;

/// The same for the first corrections with parts that change suddenly: their change limits these, whatever the tangent.
const SLOW_AT_FIRST: f64 = 0.5;
const EARLY: usize = 3;

/// Number of corrections by which an approximate tangent is judged, from the cost of a new one in corrections.
fn n_to_judge(cost: f64) -> usize {
    if cost < DEAR { 1 } else { 2 }
}

/// Cost of a new approximate tangent, in corrections, from which one slow correction is not enough for it.
const DEAR: f64 = 5.0;

/// Largest number of corrections after convergence.
const MAX_POLISHING: usize = 20;

/// Expected number of corrections with a new approximate tangent.
const FRESH: f64 = 4.0;

/// Tightest and loosest relative tolerance of a correction with the approximate tangent.
const TIGHTEST: f64 = 1e-4;
const LOOSEST: f64 = 0.1;

/// Tightest tolerance with sudden parts: corrections contract more and more, but not beyond the rounding of K to 16
/// bits.
const TIGHTEST_OF_SUDDEN: f64 = 2e-3;
