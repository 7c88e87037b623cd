//! The interface of all steppers: advance a state by one step, and return the impulses of loads and reactions.

use std::fmt;

use super::{Memory, State};
use crate::body::{Body, Reaction};
use crate::error::Result;
use crate::force::StrainState;
use crate::newton::Outcome;
use crate::sparse::SolverChoice;

/// Advances the state of a body, step by step.
///
/// A stepper owns its memory (the last increment, an acceleration), which belongs to the one state that it advances.
pub trait Stepper: fmt::Debug + Send {
    /// Advances displacement, momentum and velocity by one step; the caller sets `time` and `step` of the state.
    ///
    /// # Errors
    /// [`crate::Error::NoConvergence`], [`crate::Error::StepTooLarge`], [`crate::Error::Inverted`]; the state is then
    /// unchanged.
    fn advance(&mut self, state: &mut State, step_size: f64) -> Result<StepOutcome>;

    /// Rates `x_j = du^h/dalpha` of the last step at the k Gauss points, `[k][n_nodes][3]` \[length\]; empty for other
    /// steppers than time elements.
    fn rates(&self) -> &[f64] {
        &[]
    }

    /// Reactions in the last step, in the order of [`Body::supported_groups`]. With the loads, the springs among them,
    /// their impulses are those of [`Impulses`].
    fn reactions(&self) -> &[Reaction];

    /// Norms of Newton's residuals in the last step; empty for an explicit stepper.
    fn newton_history(&self) -> &[f64];

    /// Memory that later steps depend on, besides the state.
    fn memory(&self) -> Memory;

    /// Restores the memory of a stepper of the same scheme and body. Later steps are then bit-identical to the steps of
    /// that stepper.
    ///
    /// # Errors
    /// [`crate::Error::Memory`] if the memory does not fit, [`crate::Error::Inverted`], [`crate::Error::Linear`].
    fn restore(&mut self, memory: &Memory) -> Result<()>;
}

/// Outcome of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepOutcome {
    /// Newton's iteration.
    pub newton: Outcome,
    /// Impulses of loads and reactions.
    pub impulses: Impulses,
    /// Strain energy and smallest det F at the end.
    pub strain_state: StrainState,
    /// The linear solver; `None` for an explicit stepper.
    pub solver: Option<SolverChoice>,
}

/// Work and impulses of loads and reactions in a step, by the scheme's own quadrature in time. The residual of a
/// balance is then the conservation error of the scheme itself.
///
/// For a time element these are its stage averages, with the reactions `lambda_i = R_i / h^2` at fixed and driven
/// degrees of freedom:
///
/// ```math
/// W = sum_i b_i (f_i^ext + lambda_i) . x_i,   I = h sum_i b_i (f_i^ext + lambda_i),   J = h sum_i b_i q^h(c_i) x (f_i^ext + lambda_i)
/// ```
///
/// At the end of a step, driven degrees of freedom change from the velocity of the polynomial to their given velocity;
/// the impulse for this counts as a reaction, with its work.
///
/// For other steppers, they are the forces at the times t_s of the step with the weights w_s of the forces in the new
/// velocity, and the reactions `lambda = M a + f(u) - F` at fixed degrees of freedom:
///
/// ```math
/// W = sum_s w_s F_s . (u_2 - u_1),    I = h sum_s w_s (F_s + lambda_s),    J = h sum_s w_s q_s x (F_s + lambda_s)
/// ```
///
/// The weights are 1 - gamma and gamma at start and end for Newmark's family, 1/2 and 1/2 for central differences, and
/// `1/(2 (2 - gamma))` twice and `(1 - gamma)/(2 - gamma)` at start, split and end for Bathe's method. Loads between
/// the t_s are not seen. A time function should not jump at any of them, because rounding of the time would decide the
/// side.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Impulses {
    /// Work of loads and reactions W \[energy\]; reactions do work if supports move.
    pub work: f64,
    /// Energy dissipated by viscosity, drag and the scheme \[energy\].
    pub dissipated: f64,
    /// Linear impulse I \[mass length/time\].
    pub linear: [f64; 3],
    /// Angular impulse about the origin J \[mass length^2/time\].
    pub angular: [f64; 3],
}

impl Impulses {
    /// Adds the impulses of a nodal force that acts for a time at a displacement, both `[n_nodes][3]`.
    pub fn add_force(&mut self, body: &Body, duration: f64, displacement: &[f64], force: &[f64]) {
        let total = body.space.sum(force);
        let moment = body.moment(displacement, force);
        (0..3).for_each(|d| self.linear[d] += duration * total[d]);
        (0..3).for_each(|d| self.angular[d] += duration * moment[d]);
    }
}
