//! Follower loads in the equations of a step.

use crate::average::{FollowerRule, Rule};
use crate::body::{Assembly, Body};
use crate::error::Result;
use crate::force::StepInput;

/// Stage averages of the follower loads, with their memory.
#[derive(Debug)]
pub(super) struct Followers {
    rule: FollowerRule,
    /// Factors over time at the points of the rule, `[n_followers][n_points]`.
    factors: Vec<f64>,
    averages: Vec<f64>,
    /// Stage averages at the rates evaluated last, `[k][n_nodes][3]`.
    pub force: Vec<f64>,
}

impl Followers {
    pub(super) fn new(body: &Body, rule: &Rule) -> Self {
        let follower = FollowerRule::new(rule);
        Followers {
            factors: vec![0.0; body.n_followers() * follower.n_points()],
            averages: vec![0.0; follower.n_points()],
            rule: follower,
            force: vec![0.0; rule.degree() * body.n_dofs()],
        }
    }

    /// Sets the factors of a step from the averages of the time functions.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(super) fn average(&mut self, body: &Body, time: f64, step_size: f64) -> Result<()> {
        body.follower_averages(&self.rule, time, step_size, &mut self.averages, &mut self.factors)
    }

    /// Sets the factors of a step from the time functions at the points of the rule.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(super) fn sample(&mut self, body: &Body, time: f64, step_size: f64) -> Result<()> {
        body.follower_values(&self.rule, time, step_size, &mut self.factors)
    }

    /// Whether any follower load acts in this step.
    pub(super) fn are_active(&self) -> bool {
        self.factors.iter().any(|&factor| factor != 0.0)
    }

    /// Evaluates the stage averages.
    pub(super) fn evaluate(&mut self, body: &Body, step: &StepInput<'_>) {
        if !self.factors.is_empty() {
            body.stage_followers(step, &self.rule, &self.factors, &mut self.force);
        }
    }

    /// Adds their derivatives to the tangent of the stage equations.
    pub(super) fn add_tangent(&self, body: &Body, step: &StepInput<'_>, assembly: &mut Assembly) {
        body.add_follower_tangent(step, &self.rule, &self.factors, assembly);
    }
}
