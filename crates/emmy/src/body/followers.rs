//! Follower loads of a body.

use super::system::{Assembly, Body};
use crate::average::FollowerRule;
use crate::error::Result;
use crate::force::StepInput;

impl Body {
    /// Number of follower loads.
    pub(crate) fn n_followers(&self) -> usize {
        self.pressures.len()
    }

    /// Factors p_m of the follower loads over a step, exact for every kink of the time functions (see
    /// [`FollowerRule`]).
    ///
    /// `factors: [n_followers][n_points]`; `averages`: memory for n_points numbers.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(crate) fn follower_averages(
        &self,
        rule: &FollowerRule,
        time: f64,
        step_size: f64,
        averages: &mut [f64],
        factors: &mut [f64],
    ) -> Result<()> {
        for (pressure, factors) in self.pressures.iter().zip(factors.chunks_exact_mut(rule.n_points())) {
            let found = pressure.time_function.averages(time, step_size, rule.fine(), averages);
            found.map_err(|found| pressure.not_finite(found))?;
            rule.factors(averages, factors);
        }
        Ok(())
    }

    /// Factors of the follower loads at the points of a step: `p_m = p(t + alpha_m h)`.
    ///
    /// `factors: [n_followers][n_points]`.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(crate) fn follower_values(
        &self,
        rule: &FollowerRule,
        time: f64,
        step_size: f64,
        factors: &mut [f64],
    ) -> Result<()> {
        for (pressure, factors) in self.pressures.iter().zip(factors.chunks_exact_mut(rule.n_points())) {
            for (factor, alpha) in factors.iter_mut().zip(rule.alphas()) {
                *factor = pressure.factor(time + alpha * step_size)?;
            }
        }
        Ok(())
    }

    /// Stage averages of the follower loads, `force: [k][n_nodes][3]`.
    #[doc(hidden)]
    pub fn stage_followers(
        &self,
        step: &StepInput<'_>,
        rule: &FollowerRule,
        factors: &[f64],
        force: &mut [f64],
    ) {
        force.fill(0.0);
        for (pressure, factors) in self.pressures.iter().zip(factors.chunks_exact(rule.n_points())) {
            pressure.add_stage_forces(&self.mesh, step, rule, factors, force);
        }
    }

    /// Adds the derivatives of the stage averages to a stage matrix, times `-tangent_factor`: external forces have the
    /// opposite sign in the equations.
    #[doc(hidden)]
    pub fn add_follower_tangent(
        &self,
        step: &StepInput<'_>,
        rule: &FollowerRule,
        factors: &[f64],
        assembly: &mut Assembly,
    ) {
        for (pressure, factors) in self.pressures.iter().zip(factors.chunks_exact(rule.n_points())) {
            pressure.add_stage_tangent(&self.mesh, step, rule, factors, &mut assembly.matrix);
        }
    }

    /// Adds the follower loads at a displacement and time, both `[n_nodes][3]`.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(crate) fn add_followers_at(&self, displacement: &[f64], time: f64, force: &mut [f64]) -> Result<()> {
        for pressure in self.pressures.iter() {
            pressure.add_force(&self.mesh, displacement, pressure.factor(time)?, force);
        }
        Ok(())
    }
}
