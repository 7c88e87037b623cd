//! Record of a step.

use crate::body::{Body, Strained, sum};
use crate::sparse::SolverChoice;
use crate::sparse::reduce::dot;
use crate::time::{State, StepOutcome};

/// Energies, momenta and balances after a step (or at the start, with zero step size and residuals).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// Number of the step; 0 at the start.
    pub step: usize,
    /// Time \[time\].
    pub time: f64,
    /// Step size \[time\].
    pub step_size: f64,
    /// Kinetic energy T \[energy\].
    pub kinetic_energy: f64,
    /// Strain energy V \[energy\].
    pub strain_energy: f64,
    /// Work of loads, and of reactions where supports move, since the start \[energy\].
    pub external_work: f64,
    /// What viscosity, drag and a scheme that dissipates took out of the body since the start \[energy\].
    pub dissipated_energy: f64,
    /// Total energy E = T + V \[energy\].
    pub total_energy: f64,
    /// Defect of the step's energy balance \[energy\].
    ///
    /// ```math
    /// E_n - E_(n-1) - W + D
    /// ```
    ///
    /// with the work W and the dissipated energy D of [`crate::time::Impulses`].
    pub energy_residual: f64,
    /// Linear momentum \[mass length/time\].
    pub linear_momentum: [f64; 3],
    /// Angular momentum about the origin \[mass length^2/time\].
    pub angular_momentum: [f64; 3],
    /// Norm of the defect of the step's linear momentum balance.
    pub linear_momentum_residual: f64,
    /// Norm of the defect of the step's angular momentum balance.
    pub angular_momentum_residual: f64,
    /// Smallest det F at the quadrature points: how far the body is from being turned inside out. Infinite for links.
    pub smallest_determinant: f64,
    /// Number of Newton iterations (linear systems solved).
    pub newton_iterations: usize,
    /// What the norm of Newton's residual had to fall below.
    pub newton_target: f64,
    /// Number of iterations of the linear solver.
    pub linear_iterations: usize,
    /// How often the stiffness that the linear solver works with was made anew.
    pub renewals: usize,
    /// Whether the step needed the exact tangent.
    pub took_exact_tangent: bool,
    /// The linear solver; `None` at the start and for explicit steppers.
    pub solver: Option<SolverChoice>,
    /// Whether the iteration ended at the rounding floor instead of the tolerance.
    pub at_rounding_floor: bool,
    /// What rounding did to energy and momenta since the start, relative to them: the sum over all steps that ended at the rounding
    /// floor.
    pub rounding: f64,
    /// How often the step was cut by two before it succeeded.
    pub cuts: usize,
    /// Number of releases of supports at the start of the step.
    pub releases: usize,
    /// Estimated error of the step, relative to the scales of [`super::Adaptivity`]; 0 where sizes are not chosen by it.
    pub local_error: f64,
    /// How often the step was done again because of its error.
    pub refusals: usize,
    /// Whether the step missed a part of a load or a given motion ([`super::Resolution`]).
    pub is_unresolved: bool,
    /// Degree of the step's element; 1 for methods that are none.
    pub degree: usize,
}

impl Record {
    /// The record with energies and momenta of a state.
    pub(super) fn at(self, body: &Body, state: &State) -> Record {
        self.with_invariants(body, state, body.strained(&state.displacement))
    }

    /// The same, with what the displacement does to the body.
    fn with_invariants(mut self, body: &Body, state: &State, strained: Strained) -> Record {
        self.kinetic_energy = 0.5 * dot(&state.momentum, &state.velocity);
        self.strain_energy = strained.strain_energy;
        self.smallest_determinant = strained.smallest_determinant;
        self.total_energy = self.kinetic_energy + self.strain_energy;
        self.linear_momentum = sum(&state.momentum);
        self.angular_momentum = state.angular_momentum(body);
        self
    }

    /// The record of a step that ended in a state; `self` is that of the step before.
    pub(super) fn after(&self, body: &Body, state: &State, step_size: f64, outcome: &StepOutcome) -> Record {
        let impulses = &outcome.impulses;
        let record = Record {
            step: state.step,
            time: state.time,
            step_size,
            external_work: self.external_work + impulses.work,
            dissipated_energy: self.dissipated_energy + impulses.dissipated,
            newton_iterations: outcome.newton.iterations,
            newton_target: outcome.newton.target,
            linear_iterations: outcome.newton.linear_iterations,
            renewals: outcome.newton.renewals,
            took_exact_tangent: outcome.newton.took_exact_tangent,
            solver: outcome.solver,
            at_rounding_floor: outcome.newton.at_rounding_floor,
            rounding: self.rounding + outcome.newton.rounding,
            ..Record::default()
        };
        let record = record.with_invariants(body, state, outcome.strained);
        // Differences part by part: T and V may be large and cancel in their change.
        let kinetic = record.kinetic_energy - self.kinetic_energy;
        let strain = record.strain_energy - self.strain_energy;
        Record {
            energy_residual: kinetic + strain - impulses.work + impulses.dissipated,
            linear_momentum_residual: defect(record.linear_momentum, self.linear_momentum, impulses.linear),
            angular_momentum_residual: defect(
                record.angular_momentum,
                self.angular_momentum,
                impulses.angular,
            ),
            ..record
        }
    }
}

/// Norm of `now - before - impulse`.
fn defect(now: [f64; 3], before: [f64; 3], impulse: [f64; 3]) -> f64 {
    (0..3).map(|i| (now[i] - before[i] - impulse[i]).powi(2)).sum::<f64>().sqrt()
}
