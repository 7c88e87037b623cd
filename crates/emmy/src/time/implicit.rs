//! The common part of all implicit steppers: the equations of a step, and the iteration over them.

use super::equations::Equations;
use super::iteration::Iteration;
use super::stage_coefficients::StageCoefficients;
use super::stage_system::StageSystem;
use super::{Memory, State};
use crate::body::Body;
use crate::error::Result;
use crate::newton::{NewtonSettings, Outcome};
use crate::sparse::SolverChoice;

/// The equations of a step with the iteration that solves them.
#[derive(Debug)]
pub(super) struct ImplicitStep<'a> {
    pub system: StageSystem<'a>,
    pub iteration: Iteration,
}

impl<'a> ImplicitStep<'a> {
    /// The step of some coefficients, with all its memory.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`]; on a team [`crate::Error::NotOnTeam`] for a solver that factorises.
    pub(super) fn new(
        body: &'a Body,
        coefficients: StageCoefficients,
        settings: NewtonSettings,
    ) -> Result<Self> {
        let system = StageSystem::new(body, coefficients, settings.solver)?;
        Ok(ImplicitStep { iteration: Iteration::new(&system, settings), system })
    }

    /// The equations.
    pub(super) fn equations(&mut self) -> &mut Equations<'a> {
        &mut self.system.equations
    }

    /// The rates of the last step, `[k][n_nodes][3]`.
    pub(super) fn rates(&self) -> &[f64] {
        self.iteration.rates()
    }

    /// Solves the equations of a step, which are set; given rates are the first starting point.
    ///
    /// # Errors
    /// As [`Iteration::solve`].
    pub(super) fn solve(&mut self, state: &State, step_size: f64, given: Option<&[f64]>) -> Result<Outcome> {
        self.iteration.solve(&mut self.system, state, step_size, given)
    }

    /// Keeps what the next step needs of this one.
    pub(super) fn remember(&mut self, step_size: f64) {
        self.iteration.remember(&self.system, step_size);
    }

    /// Norms of Newton's residuals in the last step.
    pub(super) fn history(&self) -> &[f64] {
        self.iteration.history()
    }

    /// The linear solver, once there is one.
    pub(super) fn solver(&self) -> Option<SolverChoice> {
        self.system.solver()
    }

    /// The memory that the next steps depend on.
    pub(super) fn memory(&self) -> Memory {
        let mut memory = Memory::default();
        self.iteration.save(&mut memory);
        self.system.save(&mut memory);
        memory
    }

    /// Restores the data of [`ImplicitStep::memory`].
    ///
    /// # Errors
    /// [`crate::Error::Memory`], [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub(super) fn restore(&mut self, memory: &Memory) -> Result<()> {
        self.iteration.restore(memory)?;
        self.system.restore(memory)
    }
}
