//! Newton's iteration, on a trait; it is independent of mechanics.

mod approximate;
#[cfg(test)]
mod tests;

pub use approximate::NewtonMemory;

use crate::error::Result;
use crate::sparse::Solver;

/// A system of non-linear equations `R(x) = 0`.
pub trait System {
    /// Residual at a point, and the sizes that judge it.
    ///
    /// # Errors
    /// Any error if the residual cannot be evaluated there.
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<Sizes>;

    /// Correction `dx` with `K dx = -R`, to a relative tolerance. Returns the number of iterations of the linear
    /// solver.
    ///
    /// # Errors
    /// Any error if the linear system cannot be solved.
    fn correction(
        &mut self,
        x: &[f64],
        residual: &[f64],
        tolerance: f64,
        tangent: Tangent,
        dx: &mut [f64],
    ) -> Result<usize>;

    /// Cost of a new approximate tangent, in corrections with the present one.
    fn refactorization_cost(&self) -> f64;

    /// Largest part, up to 1, of a correction from a point that the system admits.
    fn largest_part(&mut self, _x: &[f64], _dx: &[f64]) -> f64 {
        1.0
    }

    /// Whether some part of the derivative changes so suddenly from a point on that it must be taken there.
    fn is_sudden(&mut self, _x: &[f64]) -> bool {
        false
    }

    /// Whether the approximate tangent has such parts, too, as they are at the point of a correction.
    fn approximates_sudden_parts(&self) -> bool {
        false
    }

    /// Part of the scale of the residual that the solution may leave, as rounding does.
    fn rounding(&self) -> f64 {
        ROUND_OFF
    }

    /// How far the iteration goes beyond its tolerance.
    fn ending(&self) -> Ending {
        Ending::Rounding
    }

    /// Part of the residual that a correction with a new approximate tangent may leave, after a number of slow ones in
    /// the solution. Beyond it, the exact tangent follows; slow corrections below it let the approximate one follow
    /// again.
    fn largest_contraction(&self, _slow_corrections: usize) -> f64 {
        0.0
    }
}

/// How far an iteration with the approximate tangent goes beyond its tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// Until nothing but rounding is left in the residual.
    Rounding,
    /// By one correction. The caller closes the balances that it leaves open: see [`Newton::open_end`].
    Balanced,
    /// Not at all.
    Tolerance,
}

/// The last correction of a solution, which no residual follows.
#[derive(Debug)]
pub struct OpenEnd<'a> {
    /// Residual before the correction.
    pub residual: &'a mut [f64],
    /// The correction.
    pub correction: &'a mut [f64],
    /// Memory for a vector.
    pub memory: &'a mut [f64],
}

/// Choice of K for a correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tangent {
    /// An approximation that is cheap to solve with, reused from an earlier iteration, with the parts that change
    /// suddenly at x.
    Reused,
    /// The approximation as the last correction had it.
    Unchanged,
    /// The approximation, computed and factorised again near x.
    Refactorized,
    /// The derivative of R at x.
    Exact,
    /// The last derivative of R that was computed, with the parts that change suddenly at x.
    Renewed,
    /// The last derivative of R that was computed.
    LastExact,
}

/// Norm of a residual with its scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// Norm of the residual.
    pub residual: f64,
    /// Largest norm of the terms whose sum is the residual.
    pub scale: f64,
    /// Rounding floor of the residual; 0 while unknown.
    pub floor: f64,
}

/// When to stop.
///
/// ```
/// use emmy::motion::{NewtonSettings, Solver};
/// let strict = NewtonSettings { tolerance: 1e-12, ..NewtonSettings::default() };
/// assert_eq!((strict.max_iterations, strict.solver), (20, Solver::Auto));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonSettings {
    /// Tolerance on the residual, relative to [`Sizes::scale`].
    pub tolerance: f64,
    /// Number of iterations before giving up.
    pub max_iterations: usize,
    /// Linear solver.
    pub solver: Solver,
    /// Whether every correction takes the exact tangent: quadratic convergence, for studies or extreme steps.
    pub exact_tangent: bool,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        NewtonSettings { tolerance: 1e-10, max_iterations: 20, solver: Solver::Auto, exact_tangent: false }
    }
}

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outcome {
    /// Linear systems solved.
    pub iterations: usize,
    /// Iterations of the linear solver.
    pub linear_iterations: usize,
    /// Norm of the last residual that was evaluated, or of the one expected after a last correction.
    pub residual: f64,
    /// Bound on the norm.
    pub target: f64,
    /// Whether it converged.
    pub converged: bool,
    /// How often the approximate tangent was refactorised.
    pub refactorizations: usize,
    /// Whether the exact tangent was needed.
    pub took_exact_tangent: bool,
    /// Whether it stagnated within [`STAGNATION`] times the rounding floor, which counts as converged.
    pub at_rounding_floor: bool,
    /// Relative change of energy and momenta of the step due to a residual at the rounding floor; 0 above the floor.
    pub rounding: f64,
}

impl Outcome {
    /// The outcome of an iteration that a further one continued.
    #[must_use]
    pub fn followed_by(self, next: Outcome) -> Outcome {
        Outcome {
            iterations: self.iterations + next.iterations,
            linear_iterations: self.linear_iterations + next.linear_iterations,
            refactorizations: self.refactorizations + next.refactorizations,
            took_exact_tangent: self.took_exact_tangent || next.took_exact_tangent,
            ..next
        }
    }
}

/// Stagnation within this factor of the rounding floor is accepted.
pub const STAGNATION: f64 = 100.0;

/// Relative tolerance of the last correction with the exact tangent, after convergence: it takes the residual to its
/// rounding floor.
const POLISH: f64 = 1e-6;

/// Rounding of a residual over its scale.
pub const ROUND_OFF: f64 = 2.0 * f64::EPSILON;

/// Residuals up to this part of the scale do not tell whether a correction has helped.
const ROUNDING: f64 = 10.0 * ROUND_OFF;

/// Parts of the target that the last correction must promise to leave if no residual follows it, with
/// [`Ending::Balanced`] and with [`Ending::Tolerance`].
const BALANCED: f64 = 0.03;
const UNSEEN: f64 = 0.1;

/// Part of the rounding of a residual that may remain in it.
const NEGLIGIBLE: f64 = 0.1;

/// Newton's iteration with its memory.
#[derive(Debug, Clone, Default)]
pub struct Newton {
    residual: Vec<f64>,
    correction: Vec<f64>,
    trial: Vec<f64>,
    trial_residual: Vec<f64>,
    /// Norms of the residuals of the last solution, one for each evaluation.
    history: Vec<f64>,
    approximation: NewtonMemory,
    /// Part of the last correction that the system admitted.
    part: f64,
    /// Length of the history before the exact tangent: with an approximate one, slow convergence is not stagnation.
    exact_from: usize,
    /// Whether the last solution ended with [`Ending::Balanced`].
    has_open_end: bool,
}

impl Newton {
    /// Norms of the residuals of the last solution.
    pub fn history(&self) -> &[f64] {
        &self.history
    }

    /// The last residual evaluated.
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// The last correction, if the solution ended with [`Ending::Balanced`].
    pub fn open_end(&mut self) -> Option<OpenEnd<'_>> {
        let Newton { residual, correction, trial: memory, .. } = self;
        self.has_open_end.then_some(OpenEnd { residual, correction, memory })
    }

    /// Solves `R(x) = 0` from x.
    ///
    /// The iteration has converged if the residual is at most `max(tolerance scale, floor)` after at least one
    /// iteration; further corrections depend on [`System::ending`]. A system whose terms and residual are all zero is
    /// solved at once. With `line_search` a correction is halved until the residual falls.
    ///
    /// # Errors
    /// As the system at the start. Later errors end the iteration without convergence if halving does not help.
    pub fn solve(
        &mut self,
        system: &mut impl System,
        x: &mut [f64],
        settings: &NewtonSettings,
        line_search: bool,
    ) -> Result<Outcome> {
        self.history.clear();
        self.resume(system, x, settings, line_search)
    }

    /// Continues a solution from x, as [`Newton::solve`] does.
    ///
    /// # Errors
    /// As [`Newton::solve`].
    pub fn resume(
        &mut self,
        system: &mut impl System,
        x: &mut [f64],
        settings: &NewtonSettings,
        line_search: bool,
    ) -> Result<Outcome> {
        for memory in [&mut self.residual, &mut self.correction, &mut self.trial, &mut self.trial_residual] {
            memory.resize(x.len(), 0.0);
        }
        let sizes = system.residual(x, &mut self.residual)?;
        self.exact_from = usize::MAX - 3;
        self.has_open_end = false;
        let (rounding, ending) = (system.rounding(), system.ending());
        let is_exact = line_search || settings.exact_tangent;
        let mut is_sudden = !is_exact && system.is_sudden(x);
        let mut run = Run { outcome: Outcome::default(), sizes, settings, rounding, ending, is_sudden };
        if !is_exact && (!is_sudden || system.approximates_sudden_parts()) {
            if self.solve_approximately(system, x, &mut run)? {
                return Ok(run.outcome);
            }
            is_sudden = system.is_sudden(x);
        }
        self.solve_exactly(system, x, &mut run, (line_search, is_sudden))?;
        Ok(run.outcome)
    }

    /// Corrections with the exact tangent until convergence or failure. With `renews`, the parts of it that change
    /// suddenly are renewed alone while that is enough.
    fn solve_exactly(
        &mut self,
        system: &mut impl System,
        x: &mut [f64],
        run: &mut Run<'_>,
        (line_search, renews): (bool, bool),
    ) -> Result<()> {
        let (mut tangent, mut contraction) = (Tangent::Exact, 1.0);
        let mut forcing = FIRST_FORCING;
        self.exact_from = self.history.len();
        // At least half of them, if the approximate tangent used them up.
        let limit = run.settings.max_iterations.max(run.outcome.iterations + run.settings.max_iterations / 2);
        loop {
            let is_converged = self.judge(run);
            if renews
                && let Some(last) = self.last_correction(run, contraction)
                && self.finish(system, x, run, (last, Tangent::Renewed))
            {
                return Ok(());
            }
            if is_converged {
                if run.sizes.scale > 0.0 && run.ending != Ending::Tolerance {
                    self.polish(system, x, run)?;
                }
                return Ok(());
            }
            if run.outcome.iterations >= limit || !run.sizes.residual.is_finite() {
                return Ok(());
            }
            // No more digits than the iteration can use: a part of the distance to the target.
            let before = run.sizes.residual;
            let tolerance = forcing.max(0.1 * run.outcome.target / before).min(FIRST_FORCING);
            run.outcome.linear_iterations += self.correct(system, x, tolerance, tangent)?;
            run.outcome.took_exact_tangent = true;
            run.outcome.iterations += 1;
            run.sizes = self.advance(system, x, before, line_search)?;
            contraction = run.sizes.residual / before;
            let expected = if renews && contraction < LARGEST_RENEWED {
                tangent = Tangent::Renewed;
                0.1 * contraction
            } else {
                tangent = Tangent::Exact;
                0.9 * contraction.powi(2)
            };
            forcing = expected.clamp(LAST_FORCING, FIRST_FORCING);
        }
    }

    /// One more correction with the exact tangent, and a second one if the first leaves more than rounding. The
    /// remaining residual is rounding of the internal forces, which has neither a resultant nor a moment.
    fn polish(&mut self, system: &mut impl System, x: &mut [f64], run: &mut Run<'_>) -> Result<()> {
        let tangent = if run.outcome.took_exact_tangent { Tangent::LastExact } else { Tangent::Exact };
        run.outcome.linear_iterations += self.correct(system, x, POLISH, tangent)?;
        x.copy_from_slice(&self.trial);
        run.outcome.iterations += 1;
        if tangent == Tangent::LastExact && !run.outcome.at_rounding_floor && self.chord_leaves(run) {
            run.sizes = system.residual(x, &mut self.residual)?;
            self.history.push(run.sizes.residual);
            run.outcome.linear_iterations += self.correct(system, x, POLISH, tangent)?;
            x.copy_from_slice(&self.trial);
            run.outcome.iterations += 1;
        }
        Ok(())
    }

    /// Whether a correction with the tangent of the previous iterate leaves more than a part of the rounding. The work
    /// of this remainder always has the same sign, so it accumulates over the steps, unlike rounding.
    fn chord_leaves(&self, run: &Run<'_>) -> bool {
        let [.., before, last] = self.history[..] else { return false };
        // Newton's step leaves half of the change of its tangent, a step with the old tangent all of it.
        2.0 * last / before * last > NEGLIGIBLE * run.round_off()
    }

    /// Records a residual, and returns whether it counts as converged.
    fn judge(&mut self, run: &mut Run<'_>) -> bool {
        let Run { outcome, sizes, settings, .. } = run;
        self.history.push(sizes.residual);
        outcome.residual = sizes.residual;
        outcome.target = (settings.tolerance * sizes.scale).max(sizes.floor);
        // The scale does not include every term: a moving body without forces has a residual at rest.
        if sizes.scale == 0.0 && sizes.residual == 0.0 {
            outcome.converged = true;
            return true;
        }
        let stagnates = self.stagnates(*sizes);
        outcome.converged = outcome.iterations > 0 && (sizes.residual <= outcome.target || stagnates);
        outcome.at_rounding_floor =
            outcome.converged && (stagnates || sizes.residual > settings.tolerance * sizes.scale);
        outcome.converged
    }

    /// The trial point `x + dx`.
    fn correct(
        &mut self,
        system: &mut impl System,
        x: &[f64],
        tolerance: f64,
        tangent: Tangent,
    ) -> Result<usize> {
        let iterations = system.correction(x, &self.residual, tolerance, tangent, &mut self.correction)?;
        self.part = system.largest_part(x, &self.correction);
        if self.part < 1.0 {
            self.correction.iter_mut().for_each(|dx| *dx *= self.part);
        }
        self.set_trial(x, 1.0);
        Ok(iterations)
    }

    fn set_trial(&mut self, x: &[f64], length: f64) {
        let points = x.iter().zip(&self.correction);
        self.trial.iter_mut().zip(points).for_each(|(trial, (x, dx))| *trial = x + length * dx);
    }

    /// Goes to the trial point; back towards x if the residual cannot be evaluated there or, with `line_search`, rises.
    fn advance(
        &mut self,
        system: &mut impl System,
        x: &mut [f64],
        before: f64,
        line_search: bool,
    ) -> Result<Sizes> {
        let mut length = 1.0;
        loop {
            let sizes = system.residual(&self.trial, &mut self.residual);
            let acceptable = match &sizes {
                Ok(sizes) => sizes.residual.is_finite() && (!line_search || sizes.residual < before),
                Err(_) => false,
            };
            if acceptable || length < SHORTEST {
                x.copy_from_slice(&self.trial);
                return sizes;
            }
            length *= 0.5;
            self.set_trial(x, length);
        }
    }

    /// Whether the residual has stopped falling near the rounding floor.
    fn stagnates(&self, sizes: Sizes) -> bool {
        let n = self.history.len();
        n >= self.exact_from + 3
            && sizes.residual <= STAGNATION * sizes.floor
            && sizes.residual > 0.5 * self.history[n - 2]
    }
}

/// A solution in progress.
struct Run<'a> {
    outcome: Outcome,
    sizes: Sizes,
    settings: &'a NewtonSettings,
    /// [`System::rounding`].
    rounding: f64,
    /// [`System::ending`].
    ending: Ending,
    /// Whether the approximate tangent has parts that change suddenly, as they are at each point.
    is_sudden: bool,
}

impl Run<'_> {
    /// Residual that the solution may leave.
    fn round_off(&self) -> f64 {
        self.rounding * self.sizes.scale
    }

    /// Whether a residual is so small that its changes are rounding.
    fn is_rounding(&self, sizes: Sizes) -> bool {
        sizes.residual <= (ROUNDING * sizes.scale).max(sizes.floor)
    }

    /// Expected number of corrections to a residual at a contraction; negative below it.
    fn corrections_to(&self, residual: f64, contraction: f64) -> f64 {
        if contraction >= 1.0 {
            return f64::INFINITY;
        }
        (residual / self.sizes.residual).ln() / contraction.ln()
    }

    /// Residual at which corrections with the approximate tangent end.
    fn goal(&self) -> f64 {
        match self.ending {
            Ending::Rounding => self.round_off(),
            Ending::Balanced => BALANCED * self.outcome.target,
            Ending::Tolerance => UNSEEN * self.outcome.target,
        }
    }
}

/// Largest relative tolerance of a correction (Eisenstat and Walker 1996, choice 2 with gamma = 0.9).
const FIRST_FORCING: f64 = 1e-3;

/// After a correction that leaves a smaller part of the residual, the next one renews the sudden parts of the tangent
/// alone.
const LARGEST_RENEWED: f64 = 0.1;

/// Smallest relative tolerance of a correction.
const LAST_FORCING: f64 = 1e-8;

/// Shortest part of a correction that is tried.
const SHORTEST: f64 = 1.0 / 64.0;
