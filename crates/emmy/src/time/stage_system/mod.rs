//! The equations of a step with the memory of their solution.

mod at_rates;
mod newton;

use super::Memory;
use super::equations::Equations;
use super::linear::{ApproximateTangent, Border};
use super::rigid_step::RigidStep;
use super::stage_coefficients::StageCoefficients;
use crate::body::Body;
use crate::error::Result;
use crate::newton::Ending;
use crate::sparse::{Gmres, Solver, SolverChoice};

/// The stage equations of a body as a system for Newton's iteration.
#[derive(Debug)]
pub(super) struct StageSystem<'a> {
    pub equations: Equations<'a>,
    approximate_tangent: ApproximateTangent,
    border: Border,
    /// Local unknowns under the forces of the constraints.
    local_of_border: Vec<f64>,
    gmres: Gmres,
    /// Right side of a correction: of the rates, then of the multipliers.
    negative: Vec<f64>,
    /// Residual with the local unknowns eliminated.
    condensed: Vec<f64>,
    /// Rounding floor of the residual; 0 while it is unknown in the step.
    floor: f64,
    /// How far the iteration goes beyond its tolerance.
    pub ending: Ending,
    /// Corrections since the iteration began.
    n_corrections: usize,
}

impl<'a> StageSystem<'a> {
    /// The system with its memory.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`]; on a team [`crate::Error::NotOnTeam`] for a factorisation without engine.
    pub(super) fn new(body: &'a Body, coefficients: StageCoefficients, solver: Solver) -> Result<Self> {
        let k = coefficients.rule.degree();
        let equations = Equations::new(body, coefficients);
        let blocks = equations.blocks;
        Ok(StageSystem {
            approximate_tangent: ApproximateTangent::new(body, &equations.coefficients, solver)?,
            border: Border::new(body, k),
            local_of_border: vec![0.0; if blocks.multipliers > 0 { blocks.local } else { 0 }],
            gmres: Gmres::default(),
            negative: vec![0.0; blocks.n_global()],
            condensed: vec![0.0; if blocks.local > 0 { blocks.rates } else { 0 }],
            floor: 0.0,
            ending: Ending::Rounding,
            n_corrections: 0,
            equations,
        })
    }

    /// Sets displacement and time scale of the step, as [`Equations::start`].
    pub(super) fn start(&mut self, displacement: &[f64], time_scale: f64) {
        self.floor = 0.0;
        self.equations.start(displacement, time_scale);
    }

    /// Strain energy caused by rounding of the displacements in the step.
    pub(super) fn rounding_energy(&self, x: &[f64]) -> f64 {
        self.approximate_tangent.rounding_energy(
            self.equations.body,
            &self.equations.displacement,
            &x[..self.equations.body.n_dofs()],
        )
    }

    /// Rotates the approximate tangent with a body without joints in the present step.
    pub(super) fn turn(&mut self, rotation: &RigidStep) {
        if self.approximate_tangent.turn(rotation, &self.equations.coefficients.rule) {
            self.border.turn();
        }
        // F contains the force of a dissipative scheme, which differs from step to step.
        if !self.equations.scheme_force.is_zero() {
            self.border.forget();
        }
    }

    /// Begins an iteration from some rates: turns the approximate tangent with the parts of a body with joints.
    pub(super) fn begin_iteration(&mut self, rates: &[f64]) {
        self.n_corrections = 0;
        self.turn_parts(rates);
    }

    fn turn_parts(&mut self, rates: &[f64]) {
        let Equations { body, coefficients, displacement, .. } = &self.equations;
        if self.approximate_tangent.turn_parts((body, &coefficients.rule), displacement, rates) {
            self.border.turn();
        }
    }

    /// Keeps the memory that the next steps depend on.
    pub(super) fn save(&self, memory: &mut Memory) {
        self.approximate_tangent.save(memory);
    }

    /// Restores the data of [`StageSystem::save`].
    ///
    /// # Errors
    /// [`crate::Error::Memory`], [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub(super) fn restore(&mut self, memory: &Memory) -> Result<()> {
        self.approximate_tangent.restore(self.equations.body, memory)
    }

    /// The linear solver, once there is one.
    pub(super) fn solver(&self) -> Option<SolverChoice> {
        self.approximate_tangent.choice()
    }
}
