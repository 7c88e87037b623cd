//! Record of a step.

use serde::{Deserialize, Serialize};

use super::StepLimit;
use crate::body::{Body, JointState, RigidMotion};
use crate::force::StrainState;
use crate::sparse::SolverChoice;
use crate::time::{State, StepOutcome};

/// Energies, momenta and balances after a step. At the start, step size and residuals are zero.
///
/// Checkpoints and [`super::RunStatistics`] use the names of the fields.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let flight = InitialVelocity { velocity: [3.0, 0.0, 0.0], ..InitialVelocity::default() };
/// let state = State::initial(&body, 0.0, &[flight])?;
/// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.from(state)?;
/// let record = motion.step(0.1)?;
/// assert!((record.total_energy - 9.0).abs() < 1e-13); // 1/2 m v^2
/// assert!((record.linear_momentum[0] - 6.0).abs() < 1e-13);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
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
    /// Energy dissipated by viscosity, drag and the scheme since the start \[energy\].
    pub dissipated_energy: f64,
    /// Energy of the layers of contact V_c \[energy\].
    #[serde(default)]
    pub contact_energy: f64,
    /// Smallest gap of a contact over the thickness of its layer; `None` where nothing is near.
    #[serde(default)]
    pub smallest_gap: Option<f64>,
    /// Number of contact points whose layer stores energy.
    #[serde(default)]
    pub contact_points: usize,
    /// Total energy E = T + V + V_c \[energy\].
    pub total_energy: f64,
    /// Residual of the energy balance of the step \[energy\].
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
    /// Norm of the residual of the linear momentum balance of the step.
    pub linear_momentum_residual: f64,
    /// Norm of the residual of the angular momentum balance of the step; in plane strain of its z component, because
    /// the planes that hold the cells exert couples about x and y.
    pub angular_momentum_residual: f64,
    /// Smallest det F at the quadrature points; a cell is inverted at 0. Infinite for links.
    pub smallest_determinant: f64,
    /// Number of Newton iterations (linear systems solved).
    pub newton_iterations: usize,
    /// Tolerance for the norm of the Newton residual.
    pub newton_target: f64,
    /// Number of iterations of the linear solver.
    pub linear_iterations: usize,
    /// Number of refactorizations of the linear solver.
    pub refactorizations: usize,
    /// Whether the step needed the exact tangent.
    pub took_exact_tangent: bool,
    /// The linear solver; `None` at the start and for explicit steppers.
    pub solver: Option<SolverChoice>,
    /// Whether the iteration ended at the rounding floor instead of the tolerance.
    pub at_rounding_floor: bool,
    /// Relative effect of rounding on energy and momenta since the start: the sum over the steps that ended at the
    /// rounding floor.
    pub rounding: f64,
    /// Number of halvings of the step before it succeeded.
    pub cuts: usize,
    /// Number of releases of supports and joints at the start of the step.
    pub releases: usize,
    /// Estimated error of the step, relative to the scales of [`super::Adaptivity`]; 0 without adaptive steps.
    pub local_error: f64,
    /// The limit that set the size of the step; `None` without adaptive steps.
    #[serde(default)]
    pub step_limit: Option<StepLimit>,
    /// Number of repetitions of the step because of its error.
    pub rejections: usize,
    /// Whether the step did not resolve a load or a given motion ([`super::Resolution`]).
    pub is_unresolved: bool,
    /// Whether a rigid body turned further in the step than it can follow.
    #[serde(default)]
    pub is_turned_over: bool,
    /// Degree of the time element; 1 for other methods.
    pub degree: usize,
    /// The joints, in the order of [`Body::joints`].
    #[serde(default)]
    pub joints: Vec<JointState>,
    /// Whether their forces are known: those of a step, or of a start from an equilibrium.
    #[serde(default)]
    pub has_joint_forces: bool,
    /// The rigid bodies, in the order of [`Body::rigid_bodies`], with velocities that the joints allow.
    #[serde(default)]
    pub rigid_bodies: Vec<RigidMotion>,
    /// Largest opening of a joint or change of a rigid body's shape, over the size of the whole.
    #[serde(default)]
    pub constraint_residual: f64,
    /// Largest rate of these \[length/time\]. Momenta carry it, positions do not: it does not grow.
    #[serde(default)]
    pub hidden_constraint: f64,
}

impl Record {
    /// The record with the energies and momenta of a state.
    pub(super) fn at(self, body: &Body, state: &State) -> Record {
        self.with_invariants(body, state, body.strain_state_near(&state.displacement, &state.coordinates))
    }

    /// The same, from a given strain energy and det F.
    fn with_invariants(mut self, body: &Body, state: &State, strain_state: StrainState) -> Record {
        self.kinetic_energy = 0.5 * body.space.dot(&state.momentum, &state.velocity);
        self.strain_energy = strain_state.strain_energy;
        self.smallest_determinant = strain_state.smallest_determinant;
        self.contact_energy = strain_state.contact.energy;
        self.smallest_gap = Some(strain_state.contact.smallest_gap).filter(|gap| gap.is_finite());
        self.contact_points = strain_state.contact.n_points;
        self.total_energy = self.kinetic_energy + self.strain_energy + self.contact_energy;
        self.linear_momentum = body.space.sum(&state.momentum);
        self.angular_momentum = state.angular_momentum(body);
        self
    }

    /// The record of a step that ended in a state; `self` is the record of the previous step.
    pub(super) fn after(&self, body: &Body, state: &State, step_size: f64, outcome: &StepOutcome) -> Record {
        let impulses = &outcome.impulses;
        let record = Record {
            step: state.step,
            time: state.time,
            step_size,
            has_joint_forces: true,
            external_work: self.external_work + impulses.work,
            dissipated_energy: self.dissipated_energy + impulses.dissipated,
            newton_iterations: outcome.newton.iterations,
            newton_target: outcome.newton.target,
            linear_iterations: outcome.newton.linear_iterations,
            refactorizations: outcome.newton.refactorizations,
            took_exact_tangent: outcome.newton.took_exact_tangent,
            solver: outcome.solver,
            at_rounding_floor: outcome.newton.at_rounding_floor,
            rounding: self.rounding + outcome.newton.rounding,
            ..Record::default()
        };
        let record = record.with_invariants(body, state, outcome.strain_state);
        // Each energy by itself: they may be large and cancel in the change of their sum.
        let kinetic = record.kinetic_energy - self.kinetic_energy;
        let strain = record.strain_energy - self.strain_energy;
        let contact = record.contact_energy - self.contact_energy;
        let angular = residual(record.angular_momentum, self.angular_momentum, impulses.angular);
        Record {
            energy_residual: kinetic + strain + contact - impulses.work + impulses.dissipated,
            linear_momentum_residual: norm(residual(
                record.linear_momentum,
                self.linear_momentum,
                impulses.linear,
            )),
            angular_momentum_residual: if body.space.has_plane_cells() {
                angular[2].abs()
            } else {
                norm(angular)
            },
            ..record
        }
    }
}

/// `now - before - impulse`
fn residual(now: [f64; 3], before: [f64; 3], impulse: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| now[i] - before[i] - impulse[i])
}

fn norm(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x.powi(2)).sum::<f64>().sqrt()
}
