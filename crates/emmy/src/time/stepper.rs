//! The interface of all steppers: advance a state by one step, and return the impulses of loads and reactions.

use std::fmt;

use super::{Memory, State};
use crate::body::{BlockRow, Body, JointState, Reaction};
use crate::error::{Error, Result};
use crate::force::StrainState;
use crate::newton::Outcome;
use crate::sparse::SolverChoice;

/// A property of a body that not every scheme can integrate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BodyFeature {
    /// Supports with a prescribed motion.
    PrescribedMotion,
    /// Viscosity or drag.
    Damping,
    /// Cells with incompatible modes, which have no mass.
    IncompatibleModes,
    /// Rigid bodies and joints, which need multipliers.
    Joints,
    /// Ties: nodes that follow others ([`Body::follow`]).
    Ties,
    /// Forces with history variables ([`State::history`]).
    ForcesWithHistory,
    /// The centrifugal force for an observer that turns ([`LoadKind::Rotation`](crate::body::LoadKind::Rotation)),
    /// which equilibria alone have.
    TurningObserver,
}

impl BodyFeature {
    /// The properties that a body has.
    pub(crate) fn of(body: &Body) -> impl Iterator<Item = BodyFeature> {
        let features = [
            (BodyFeature::PrescribedMotion, body.is_driven()),
            (BodyFeature::Damping, body.dissipates()),
            (BodyFeature::IncompatibleModes, body.space.has_internal_nodes()),
            (BodyFeature::Joints, !body.mechanism.is_empty()),
            (BodyFeature::Ties, body.has_ties()),
            (BodyFeature::ForcesWithHistory, body.n_history() > 0),
            (BodyFeature::TurningObserver, body.observer_spin().is_some()),
        ];
        features.into_iter().filter(|(_, has)| *has).map(|(feature, _)| feature)
    }

    /// Its name in messages.
    pub(crate) fn words(self) -> &'static str {
        match self {
            BodyFeature::PrescribedMotion => "supports with a given motion",
            BodyFeature::Damping => "viscosity or drag",
            BodyFeature::IncompatibleModes => "cells with incompatible modes",
            BodyFeature::Joints => "rigid bodies or joints",
            BodyFeature::Ties => "ties",
            BodyFeature::ForcesWithHistory => "forces with a history",
            BodyFeature::TurningObserver => "a load `rotation`",
        }
    }
}

/// Advances the state of a body, step by step: the interface of all schemes.
///
/// A scheme of one's own needs [`Stepper::advance`] alone, and runs by
/// [`Motion::with_stepper`](crate::motion::Motion::with_stepper); [`PointForces`](super::PointForces) evaluates the
/// forces and keeps the book of their work and impulses. `examples/own_scheme.rs` is a method of fourth order, and this
/// one is explicit Euler on a free body, with the lumped mass:
///
/// ```
/// use emmy::prelude::*;
/// use emmy::time::{PointForces, StepOutcome, Stepper};
///
/// #[derive(Debug)]
/// struct Euler<'a>(PointForces<'a>);
///
/// impl Stepper for Euler<'_> {
///     fn advance(&mut self, state: &mut State, h: f64) -> emmy::Result<StepOutcome> {
///         let body = self.0.body();
///         let old = state.velocity.clone();
///         let force = self.0.evaluate(&state.displacement, state.time)?;
///         for dof in 0..body.n_dofs() {
///             state.displacement[dof] += h * old[dof];
///             state.momentum[dof] = body.lumped_mass()[dof / 3] * old[dof] + h * force[dof];
///             state.velocity[dof] = state.momentum[dof] / body.lumped_mass()[dof / 3];
///         }
///         self.0.begin();
///         self.0.book(h, &old, None)?;
///         StepOutcome::new(body, state, self.0.end(h))
///     }
/// }
///
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let weight = Load::acceleration([0.0, 0.0, -10.0]);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).load(weight).build()?;
/// let mut motion = Motion::with_stepper(&body, Euler(PointForces::new(&body)?))?;
/// motion.march(&StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.1 }])?, &mut [])?;
/// assert!((motion.record().linear_momentum[2] + 2.0 * 10.0).abs() < 1e-13); // m g t
/// assert!(motion.record().linear_momentum_residual < 1e-13);
/// # Ok::<(), emmy::Error>(())
/// ```
///
/// A stepper owns its memory (the last increment, an acceleration), which belongs to the one state that it advances.
pub trait Stepper: fmt::Debug + Send {
    /// Advances displacement, momentum and velocity by one step; the caller sets `time` and `step` of the state.
    ///
    /// # Errors
    /// The reason why the step failed, such as [`Error::NoConvergence`], [`Error::StepTooLarge`] or
    /// [`Error::Inverted`]. The caller restores the state; the memory of the stepper must then be as before.
    fn advance(&mut self, state: &mut State, step_size: f64) -> Result<StepOutcome>;

    /// Name of the scheme in summaries and messages.
    fn name(&self) -> &'static str {
        "own scheme"
    }

    /// Prepares for the state from which the motion starts: sets its momentum, if the scheme has another mass matrix
    /// than [`Body::mass`], and memory that depends on it.
    ///
    /// # Errors
    /// As [`Stepper::advance`].
    fn start(&mut self, _state: &mut State) -> Result<()> {
        Ok(())
    }

    /// Whether the scheme can integrate a body with this property. A motion of one that it cannot is refused.
    fn integrates(&self, _feature: BodyFeature) -> bool {
        false
    }

    /// Residual of its equations for the step from a state, at any rates; see [`crate::motion::Motion::residual`].
    ///
    /// # Errors
    /// [`Error::Scheme`] if the scheme has none.
    fn residual(&mut self, _state: &State, _rates: &[f64], _step_size: f64) -> Result<Vec<f64>> {
        Err(without_equations(self.name()))
    }

    /// Derivative of the residual by the rates; see [`crate::motion::Motion::tangent`].
    ///
    /// # Errors
    /// [`Error::Scheme`] if the scheme has none.
    fn tangent(&mut self, _state: &State, _rates: &[f64], _step_size: f64) -> Result<Vec<BlockRow>> {
        Err(without_equations(self.name()))
    }

    /// Rates `x_j = du^h/dalpha` of the last step at the k Gauss points, `[k][n_nodes][3]` \[length\]; empty for other
    /// steppers than time elements.
    fn rates(&self) -> &[f64] {
        &[]
    }

    /// Reactions in the last step, in the order of [`Body::supported_groups`]. Reactions and loads,
    /// springs included, add up to [`Impulses`]. Empty if the stepper does not compute them.
    fn reactions(&self) -> &[Reaction] {
        &[]
    }

    /// Forces of the joints in the last step, in the order of [`Body::joints`]; their coordinates are zero.
    fn joints(&self) -> &[JointState] {
        &[]
    }

    /// Norms of Newton's residuals in the last step; empty for an explicit stepper.
    fn newton_history(&self) -> &[f64] {
        &[]
    }

    /// Memory that later steps depend on, besides the state.
    fn memory(&self) -> Memory {
        Memory::default()
    }

    /// Restores the memory of a stepper of the same scheme and body. Later steps are then bit-identical to the steps of
    /// that stepper.
    ///
    /// # Errors
    /// [`Error::Memory`] if the memory does not fit, [`Error::Inverted`], [`Error::Linear`].
    fn restore(&mut self, _memory: &Memory) -> Result<()> {
        Ok(())
    }
}

fn without_equations(scheme: &str) -> Error {
    let reason = "residual and tangent need a time element".to_string();
    Error::Scheme { scheme: scheme.to_string(), reason }
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

impl StepOutcome {
    /// The outcome of an explicit step to a state. An implicit stepper adds its iteration in `newton`.
    ///
    /// # Errors
    /// [`Error::Inverted`] if a cell is inverted at the end: no step can start there.
    pub fn new(body: &Body, end: &State, impulses: Impulses) -> Result<Self> {
        let strain_state = body.strain_state(&end.displacement).check_not_inverted()?;
        let newton = Outcome { converged: true, ..Outcome::default() };
        Ok(StepOutcome { newton, impulses, strain_state, solver: None })
    }
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
