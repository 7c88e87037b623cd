//! What every stepper does: it advances a state by one step and says what loads and reactions did meanwhile.

use std::fmt;

use super::classic::{BatheStepper, CentralDifferences, NewmarkParameters, NewmarkStepper};
use super::{Memory, Scheme, State, TimeElement, TimeElementStepper};
use crate::body::{Body, Strained, sum};
use crate::error::{Error, Result};
use crate::newton::{NewtonSettings, Outcome};
use crate::sparse::SolverChoice;

/// Advances the state of a body, step by step.
///
/// A stepper owns its memory (the last increment, an acceleration), which belongs to the one state that it advances.
pub trait Stepper: fmt::Debug + Send {
    /// Advances displacement, momentum and velocity by one step; `time` and `step` of the state are left to the caller.
    ///
    /// # Errors
    /// [`crate::Error::NoConvergence`], [`crate::Error::StepTooLarge`], [`crate::Error::Inverted`]; the state is then
    /// unchanged.
    fn advance(&mut self, state: &mut State, step_size: f64) -> Result<StepOutcome>;

    /// Norms of Newton's residuals in the last step; empty for an explicit stepper.
    fn newton_history(&self) -> &[f64];

    /// What the steps to come depend on beside the state.
    fn memory(&self) -> Memory;

    /// Takes over the memory of a stepper of the same scheme, degree and body. The steps that follow are then those that the other
    /// would have done, in every bit.
    ///
    /// # Errors
    /// [`crate::Error::Memory`] if the memory does not fit, [`crate::Error::Inverted`], [`crate::Error::Linear`].
    fn restore(&mut self, memory: &Memory) -> Result<()>;
}

/// How a step went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepOutcome {
    /// Newton's iteration.
    pub newton: Outcome,
    /// Impulses of loads and reactions.
    pub impulses: Impulses,
    /// What the displacement at the end does to the body.
    pub strained: Strained,
    /// The linear solver; `None` for an explicit stepper.
    pub solver: Option<SolverChoice>,
}

/// What loads and reactions did to the body in a step, by the scheme's own quadrature in time. What a balance then leaves
/// over is what the scheme itself fails to conserve.
///
/// For a time element these are its stage averages, with the reactions `lambda_i = R_i / h^2` at fixed and driven degrees of
/// freedom:
///
/// ```math
/// W = sum_i b_i (f_i^ext + lambda_i) . x_i,   I = h sum_i b_i (f_i^ext + lambda_i),   J = h sum_i b_i q^h(c_i) x (f_i^ext + lambda_i)
/// ```
///
/// At the end of a step driven degrees of freedom take their given velocity over from the polynomial of the step; the impulse
/// that this needs is one of the reactions, with its work.
///
/// For the others, the forces at the times t_s of the step that they use, with the weights w_s that these have in the new
/// velocity, and the reactions `lambda = M a + f(u) - F` at fixed degrees of freedom:
///
/// ```math
/// W = sum_s w_s F_s . (u_2 - u_1),    I = h sum_s w_s (F_s + lambda_s),    J = h sum_s w_s q_s x (F_s + lambda_s)
/// ```
///
/// The weights are 1 - gamma and gamma at start and end for Newmark's family, 1/2 and 1/2 for central differences, and
/// `1/(2 (2 - gamma))` twice and `(1 - gamma)/(2 - gamma)` at start, split and end for Bathe's method. Loads between the t_s
/// are not seen; a jump of a history belongs on none of them, since rounding of the time decides on which side it falls.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Impulses {
    /// Work of loads and reactions W \[energy\]; reactions do work where supports move.
    pub work: f64,
    /// What viscosity, drag and the scheme took out of the body \[energy\].
    pub dissipated: f64,
    /// Linear impulse I \[mass length/time\].
    pub linear: [f64; 3],
    /// Angular impulse about the origin J \[mass length^2/time\].
    pub angular: [f64; 3],
}

impl Impulses {
    /// Adds the impulses of a nodal force that acts for a time at a displacement, both `[n_nodes][3]`.
    pub fn add_force(&mut self, body: &Body, duration: f64, displacement: &[f64], force: &[f64]) {
        let (total, moment) = (sum(force), body.moment(displacement, force));
        (0..3).for_each(|d| self.linear[d] += duration * total[d]);
        (0..3).for_each(|d| self.angular[d] += duration * moment[d]);
    }
}

impl Scheme {
    /// The stepper of the scheme, for a state. A scheme with a mass matrix of its own sets the state's momentum by it.
    ///
    /// # Errors
    /// [`crate::Error::Scheme`] if the scheme cannot go with the degree, [`crate::Error::Linear`],
    /// [`crate::Error::Inverted`].
    pub fn stepper<'a>(
        self,
        body: &'a Body,
        degree: usize,
        settings: NewtonSettings,
        state: &mut State,
    ) -> Result<Box<dyn Stepper + 'a>> {
        self.check(degree)?;
        if body.is_driven() && !self.is_time_element() {
            let reason = "a prescribed motion goes with time elements only".to_string();
            return Err(Error::Scheme { scheme: self.to_string(), reason });
        }
        if !self.is_time_element() && (body.is_viscous() || body.drag() > 0.0) {
            let reason = "viscosity and drag go with time elements only".to_string();
            return Err(Error::Scheme { scheme: self.to_string(), reason });
        }
        if body.is_driven() && self.dissipation().is_some() {
            let reason = "a prescribed motion goes with schemes that do not dissipate".to_string();
            return Err(Error::Scheme { scheme: self.to_string(), reason });
        }
        if let Some(parameters) = NewmarkParameters::of(self) {
            return Ok(Box::new(NewmarkStepper::new(body, parameters, settings, state)?));
        }
        Ok(match self {
            Scheme::Bathe => Box::new(BatheStepper::new(body, settings, state)?),
            Scheme::CentralDifferences => Box::new(CentralDifferences::new(body, state)?),
            _ => Box::new(TimeElementStepper::new(body, TimeElement::new(self, degree)?, settings)?),
        })
    }
}
