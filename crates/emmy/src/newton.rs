//! Newton's iteration, on a trait; it knows no mechanics.

use crate::error::Result;

/// A system of non-linear equations `R(x) = 0`.
pub trait System {
    /// Residual at a point, and the sizes it is to be judged by.
    ///
    /// # Errors
    /// Any error that says that the residual cannot be evaluated there.
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<Sizes>;

    /// Correction `dx` with `K(x) dx = -R`, to a relative tolerance. `rebuild`: the tangent is to be taken at x; otherwise
    /// the last one will do. Returns the number of iterations of the linear solver.
    ///
    /// # Errors
    /// Any error that says that the linear system cannot be solved.
    fn correction(
        &mut self,
        x: &[f64],
        residual: &[f64],
        tolerance: f64,
        rebuild: bool,
        dx: &mut [f64],
    ) -> Result<usize>;
}

/// Norm of a residual and what it is judged by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// Norm of the residual.
    pub residual: f64,
    /// Largest norm of the parts that the residual is the sum of.
    pub scale: f64,
    /// What rounding alone makes of the residual; 0 while unknown.
    pub floor: f64,
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonSettings {
    /// Tolerance on the residual, relative to [`Sizes::scale`].
    pub tolerance: f64,
    /// Number of iterations before giving up.
    pub max_iterations: usize,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        NewtonSettings { tolerance: 1e-10, max_iterations: 20 }
    }
}

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outcome {
    /// Linear systems solved.
    pub iterations: usize,
    /// Iterations of the linear solver.
    pub linear_iterations: usize,
    /// Norm of the last residual that was evaluated.
    pub residual: f64,
    /// What it had to fall below.
    pub target: f64,
    /// Whether it converged.
    pub converged: bool,
    /// Whether it stagnated within [`STAGNATION`] times the rounding floor, which counts as converged.
    pub at_rounding_floor: bool,
}

/// Stagnation within this factor of the rounding floor is accepted.
pub const STAGNATION: f64 = 100.0;

/// Relative tolerance of the last correction, after convergence: it takes the residual to its rounding floor.
const POLISH: f64 = 1e-6;

/// Newton's iteration with its memory.
#[derive(Debug, Clone, Default)]
pub struct Newton {
    residual: Vec<f64>,
    correction: Vec<f64>,
    trial: Vec<f64>,
    /// Norms of the residuals of the last solution, one for each evaluation.
    history: Vec<f64>,
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

    /// Solves `R(x) = 0` from x.
    ///
    /// Converged is a residual of at most `max(tolerance scale, floor)` after at least one iteration; then one more
    /// correction follows, so that what the solution conserves is kept to round-off. A system whose parts and
    /// residual are all zero is solved at once. With `line_search` a correction is halved until the residual falls.
    ///
    /// # Errors
    /// Those of the system at the start; later ones end the iteration without convergence if halving does not help.
    pub fn solve(
        &mut self,
        system: &mut impl System,
        x: &mut [f64],
        settings: &NewtonSettings,
        line_search: bool,
    ) -> Result<Outcome> {
        self.residual.resize(x.len(), 0.0);
        self.correction.resize(x.len(), 0.0);
        self.trial.resize(x.len(), 0.0);
        self.history.clear();
        let mut outcome = Outcome::default();
        let mut sizes = system.residual(x, &mut self.residual)?;
        let mut forcing = FIRST_FORCING;
        loop {
            self.history.push(sizes.residual);
            outcome.residual = sizes.residual;
            outcome.target = (settings.tolerance * sizes.scale).max(sizes.floor);
            // The scale does not see every part: a body that moves has a residual at rest although no force acts.
            if sizes.scale == 0.0 && sizes.residual == 0.0 {
                outcome.converged = true;
                return Ok(outcome);
            }
            let stagnates = self.stagnates(sizes);
            if outcome.iterations > 0 && (sizes.residual <= outcome.target || stagnates) {
                outcome.converged = true;
                outcome.at_rounding_floor = stagnates || sizes.residual > settings.tolerance * sizes.scale;
                outcome.linear_iterations += self.correct(system, x, POLISH, false)?;
                x.copy_from_slice(&self.trial);
                outcome.iterations += 1;
                return Ok(outcome);
            }
            if outcome.iterations >= settings.max_iterations || !sizes.residual.is_finite() {
                return Ok(outcome);
            }
            // No more digits than the iteration can use: a part of what is left to the target.
            let tolerance = forcing.max(0.1 * outcome.target / sizes.residual).min(FIRST_FORCING);
            outcome.linear_iterations += self.correct(system, x, tolerance, true)?;
            outcome.iterations += 1;
            let before = sizes.residual;
            sizes = self.advance(system, x, before, line_search)?;
            forcing = (0.9 * (sizes.residual / before).powi(2)).clamp(LAST_FORCING, FIRST_FORCING);
        }
    }

    /// The trial point `x + dx`.
    fn correct(
        &mut self,
        system: &mut impl System,
        x: &[f64],
        tolerance: f64,
        rebuild: bool,
    ) -> Result<usize> {
        let iterations = system.correction(x, &self.residual, tolerance, rebuild, &mut self.correction)?;
        self.set_trial(x, 1.0);
        Ok(iterations)
    }

    fn set_trial(&mut self, x: &[f64], length: f64) {
        let points = x.iter().zip(&self.correction);
        self.trial.iter_mut().zip(points).for_each(|(trial, (x, dx))| *trial = x + length * dx);
    }

    /// Goes to the trial point; back towards x where the residual cannot be evaluated or, with `line_search`, rises.
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
        n >= 3 && sizes.residual <= STAGNATION * sizes.floor && sizes.residual > 0.5 * self.history[n - 2]
    }
}

/// Largest relative tolerance of a correction (Eisenstat and Walker 1996, choice 2 with gamma = 0.9).
const FIRST_FORCING: f64 = 1e-3;

/// Smallest relative tolerance of a correction.
const LAST_FORCING: f64 = 1e-8;

/// Shortest part of a correction that is tried.
const SHORTEST: f64 = 1.0 / 64.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    /// x^2 = a, undefined for x <= 0.
    struct SquareRoot(f64, f64);

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
            _: bool,
            dx: &mut [f64],
        ) -> Result<usize> {
            dx[0] = -residual[0] / (2.0 * x[0]);
            Ok(1)
        }
    }

    #[test]
    fn converges_quadratically() {
        let (mut newton, mut x) = (Newton::default(), [3.0]);
        let outcome =
            newton.solve(&mut SquareRoot(4.0, 0.0), &mut x, &NewtonSettings::default(), false).unwrap();
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
        let (mut newton, mut x) = (Newton::default(), [10.0]);
        // From 10 the equation x^2 = 1e-4 asks for 5, 2.5, ...: the iteration stays on the positive side.
        let settings = NewtonSettings { tolerance: 1e-12, max_iterations: 40 };
        let outcome = newton.solve(&mut SquareRoot(1e-4, 0.0), &mut x, &settings, true).unwrap();
        assert!(outcome.converged && (x[0] - 0.01).abs() < 1e-15);
        assert!(newton.solve(&mut SquareRoot(1.0, 0.0), &mut [-1.0], &settings, true).is_err());
    }

    #[test]
    fn gives_up_and_says_so() {
        let settings = NewtonSettings { tolerance: 1e-10, max_iterations: 2 };
        let outcome =
            Newton::default().solve(&mut SquareRoot(4.0, 0.0), &mut [300.0], &settings, false).unwrap();
        assert!(!outcome.converged && outcome.iterations == 2 && outcome.residual > outcome.target);
    }

    #[test]
    fn a_rounding_floor_is_accepted() {
        // The floor lies above the tolerance: what rounding allows is all that can be asked.
        let outcome = Newton::default()
            .solve(&mut SquareRoot(4.0, 1e-3), &mut [3.0], &NewtonSettings::default(), false)
            .unwrap();
        assert!(outcome.converged && outcome.at_rounding_floor);
    }
}
