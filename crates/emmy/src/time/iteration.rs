//! Newton's iteration over the equations of a step: where it starts, and what is tried when it fails.

use super::State;
use super::stage_system::StageSystem;
use crate::error::{Error, Result};
use crate::newton::{Newton, NewtonSettings, Outcome};

/// The iteration of a step with its memory: the rates it solves for, and those of the step before.
#[derive(Debug)]
pub struct Iteration {
    settings: NewtonSettings,
    newton: Newton,
    /// The unknowns x_i, `[k][n_nodes][3]`.
    pub rates: Vec<f64>,
    /// Rates and step size of the last step.
    last: Option<(Vec<f64>, f64)>,
    coefficients: Vec<f64>,
}

/// Starting points of the iteration, in the order in which they are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Guess {
    /// The last step's polynomial, continued.
    Continued,
    /// h v.
    Velocity,
    /// No motion.
    Rest,
}

/// Every attempt at a step: starting point, and whether a line search guards it.
const ATTEMPTS: [(Guess, bool); 5] = [
    (Guess::Continued, false),
    (Guess::Velocity, false),
    (Guess::Rest, false),
    (Guess::Velocity, true),
    (Guess::Rest, true),
];

impl Iteration {
    /// Memory for k stages of n degrees of freedom.
    pub fn new(k: usize, n: usize, settings: NewtonSettings) -> Self {
        Iteration {
            settings,
            newton: Newton::default(),
            rates: vec![0.0; k * n],
            last: None,
            coefficients: vec![0.0; k * k],
        }
    }

    /// Norms of Newton's residuals in the last step.
    pub fn history(&self) -> &[f64] {
        self.newton.history()
    }

    /// Solves the equations of a step from the first starting point that leads to a solution.
    ///
    /// # Errors
    /// [`Error::NoConvergence`].
    pub fn solve(&mut self, system: &mut StageSystem<'_>, state: &State, step_size: f64) -> Result<Outcome> {
        let (mut failure, mut cause) = (None, None);
        for (guess, line_search) in ATTEMPTS {
            if !self.predict(guess, system, state, step_size) {
                continue;
            }
            match self.newton.solve(system, &mut self.rates, &self.settings, line_search) {
                Ok(outcome) if outcome.converged => return Ok(outcome),
                Ok(outcome) => failure = Some(self.no_convergence(outcome, system, state, step_size)),
                Err(error) => cause = Some(Box::new(error)),
            }
        }
        // An iteration that ran says more than one that could not start.
        let (step, time) = (state.step + 1, state.time + step_size);
        Err(failure
            .or(cause.map(|cause| Error::StepFailed { step, time, cause }))
            .unwrap_or(Error::Linear { reason: format!("no starting point for step {step}") }))
    }

    /// The error of an iteration that did not converge, at the node with the largest residual.
    fn no_convergence(
        &self,
        failed: Outcome,
        system: &StageSystem<'_>,
        state: &State,
        step_size: f64,
    ) -> Error {
        let size = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
        let nodes = self.newton.residual()[..state.displacement.len()].chunks_exact(3).map(size).enumerate();
        let node = nodes.max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(node, _)| node);
        Error::NoConvergence {
            step: state.step + 1,
            time: state.time + step_size,
            iterations: failed.iterations,
            residual: failed.residual,
            target: failed.target,
            node,
            position: state.position(system.body, node),
        }
    }

    /// Keeps the rates of a step for the prediction of the next one.
    pub fn remember(&mut self, step_size: f64) {
        let (last, last_size) = self.last.get_or_insert_with(|| (self.rates.clone(), step_size));
        last.copy_from_slice(&self.rates);
        *last_size = step_size;
    }

    /// Sets the rates to a starting point; false if there is none of this kind.
    fn predict(&mut self, guess: Guess, system: &StageSystem<'_>, state: &State, step_size: f64) -> bool {
        let n = state.displacement.len();
        match (guess, &self.last) {
            (Guess::Continued, None) => return false,
            (Guess::Continued, Some((last, last_size))) => {
                let rule = &system.form.rule;
                rule.continuation(step_size / last_size, &mut self.coefficients);
                let k = rule.degree();
                for (i, rates) in self.rates.chunks_exact_mut(n).enumerate() {
                    rates.fill(0.0);
                    for j in 0..k {
                        let e = self.coefficients[i * k + j];
                        rates.iter_mut().zip(&last[j * n..]).for_each(|(x, old)| *x += e * old);
                    }
                }
            }
            (Guess::Velocity, _) => {
                for rates in self.rates.chunks_exact_mut(n) {
                    rates.iter_mut().zip(&state.velocity).for_each(|(x, v)| *x = step_size * v);
                }
            }
            (Guess::Rest, _) => self.rates.fill(0.0),
        }
        system.drive(&mut self.rates);
        true
    }
}
