//! Static equilibrium: the internal force balances the loads at the end of each step.

mod inverse;
mod joints;
mod system;

use super::forces::TimePoint;
use crate::body::{Body, JointState, Reaction};
use crate::error::{Error, Result};
use crate::newton::{Newton, NewtonSettings, Outcome};
use crate::sparse::StageMatrix;
use crate::time::{Impulses, Memory, State, StepOutcome, Stepper};
use inverse::Inverse;
use system::{StaticSystem, largest_node};

/// An equilibrium farther away than this multiple of the step linearised at its start belongs to another path: near a
/// limit of the loads, where the path is a parabola, the multiple is at most 2.
const MAX_STEPS_FROM_START: f64 = 3.0;

/// The same multiple of the step linearised at its end; a path that stiffens with the power n has n.
const MAX_STEPS_FROM_END: f64 = 10.0;

/// Distances below this part of the size of the body are rounding.
const NO_DISTANCE: f64 = 1e-9;

/// Relative residual of a linear system at which refinement ends, and above which it counts as unsolved.
const REFINED: f64 = 1e-14;
const UNSOLVED: f64 = 1e-9;

/// Solution of `K x = b` at the free degrees of freedom with a symmetric stiffness, refined; x is zero at the fixed
/// ones.
///
/// # Errors
/// [`Error::Linear`] for a stiffness that is singular but for rounding, [`Error::OutOfMemory`].
pub(crate) fn solve_stiffness(body: &Body, stiffness: &mut StageMatrix, b: &[f64]) -> Result<Vec<f64>> {
    let mut inverse = Inverse::new(body)?;
    inverse.set(body, stiffness)?;
    let mut x = vec![0.0; b.len()];
    let mut residual = b.to_vec();
    body.space.clear_inactive(&mut residual);
    let size = body.space.norm(&residual);
    let mut left = size;
    while left > REFINED * size {
        inverse.apply(body, &mut residual);
        x.iter_mut().zip(&residual).for_each(|(x, change)| *x += change);
        stiffness.multiply(body.pattern(), &x, &mut residual);
        residual.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
        body.space.clear_inactive(&mut residual);
        let last = std::mem::replace(&mut left, body.space.norm(&residual));
        if left.is_nan() || left > 0.5 * last {
            break;
        }
    }
    if left <= UNSOLVED * size {
        return Ok(x);
    }
    let left = left / size;
    let reason = format!("the stiffness at an equilibrium is singular: {left:.1e} of the right side is left");
    Err(Error::Linear { reason })
}

/// Stepper of static equilibria, for a body under loads that grow with the time ([`Body::in_proportion`]). A step leads
/// from one equilibrium to the next; there is no inertia, and no damping.
///
/// ```math
/// f(u_2) + G(u_2)^T lambda = F(u_2, t_2),    Phi(u_2, t_2) = 0
/// ```
///
/// Newton's iteration takes the exact tangent with its follower loads, first with full corrections as long as the
/// stiffness is positive definite, then with a line search. On a team, which does not factorise, it counts as positive
/// definite until conjugate gradients find a direction in which it is not, and always under follower loads. An
/// equilibrium whose stiffness is not positive definite under the centrifugal force for an observer is refused, but on
/// a team, or beside follower loads without a symmetric stiffness. In a record, the work of loads and supports is the
/// change of the strain energy, as it is along a path of equilibria, and the residuals of the momentum balances are the
/// resultant and the moment of loads, reactions and ground.
#[derive(Debug)]
pub struct StaticStepper<'a> {
    newton: Newton,
    settings: NewtonSettings,
    system: StaticSystem<'a>,
    unknowns: Vec<f64>,
    end: TimePoint,
    energy: f64,
    joints: Vec<JointState>,
}

impl<'a> StaticStepper<'a> {
    /// The stepper of a state, which it brings to rest.
    ///
    /// # Errors
    /// [`Error::NotHeld`], [`Error::Linear`], [`Error::OutOfMemory`].
    pub fn new(body: &'a Body, settings: NewtonSettings, state: &mut State) -> Result<Self> {
        body.check_held()?;
        state.velocity.fill(0.0);
        state.momentum.fill(0.0);
        let system = StaticSystem::new(body)?;
        Ok(StaticStepper {
            newton: Newton::default(),
            settings: NewtonSettings { exact_tangent: true, ..settings },
            unknowns: vec![0.0; system.equations.blocks.len()],
            system,
            end: TimePoint::new(body),
            energy: body.strain_state_near(&state.displacement, &state.coordinates).stored(),
            joints: vec![JointState::default(); body.joints().len()],
        })
    }

    /// Solves for the equilibrium at the end of a step.
    fn solve(&mut self, state: &State, step_size: f64) -> Result<Outcome> {
        self.system.start(state, step_size)?;
        match self.attempt(state, false) {
            // Smaller corrections do not help a singular stiffness.
            Err(error) if !matches!(error, Error::Singular { .. }) => self.attempt(state, true),
            outcome => outcome,
        }
    }

    fn attempt(&mut self, state: &State, line_search: bool) -> Result<Outcome> {
        self.system.must_be_definite = !line_search;
        self.system.predict(&mut self.unknowns)?;
        let outcome = self.newton.solve(&mut self.system, &mut self.unknowns, &self.settings, line_search)?;
        if !outcome.converged {
            return Err(self.failure(state, outcome));
        }
        self.check_path(state)?;
        self.check_angles(state)?;
        self.check_softening()?;
        Ok(outcome)
    }

    /// Checks that the equilibrium belongs to the path that leads to it.
    fn check_path(&mut self, state: &State) -> Result<()> {
        let moved = &self.unknowns[..self.end.displacement.len()];
        let body = self.system.equations.body;
        let distance = body.space.norm(moved);
        if distance <= NO_DISTANCE * self.system.size {
            return Ok(());
        }
        // At a limit of the loads the stiffness is singular.
        let back = self.system.linear_step(moved).map_or(f64::INFINITY, |step| body.space.norm(&step));
        let forth = self.system.predicted.unwrap_or(0.0);
        if distance <= (MAX_STEPS_FROM_START * forth).min(MAX_STEPS_FROM_END * back) {
            return Ok(());
        }
        let node = largest_node(body, moved);
        let position = body.space.at_node(node, |node| state.position(body, node));
        Err(Error::OtherPath { fraction: self.system.time, node, position })
    }

    /// Checks that the body is stiffer than the centrifugal force softens it: near its limit a large increment may leap
    /// over all other checks, because the force is linear.
    fn check_softening(&mut self) -> Result<()> {
        let body = self.system.equations.body;
        if body.observer_spin().is_none() || !body.is_symmetric() {
            return Ok(());
        }
        match self.system.is_definite_under_loads(&self.unknowns)? {
            true => Ok(()),
            false => Err(Error::Softened { fraction: self.system.time }),
        }
    }

    /// Checks that given angles are not half a turn off, as after a large increment.
    fn check_angles(&self, state: &State) -> Result<()> {
        let equations = &self.system.equations;
        let body = equations.body;
        let [x, ..] = equations.blocks.split(&self.unknowns);
        let opposed = equations.constraint_step.opposed(body.constraints(), &equations.step_at(x));
        let Some(node) = opposed.and_then(|row| row.nodes().next()) else { return Ok(()) };
        let position = state.position(body, node as usize);
        Err(Error::OtherPath { fraction: self.system.time, node: node as usize, position })
    }

    /// The error of an iteration that did not converge.
    fn failure(&self, state: &State, failed: Outcome) -> Error {
        let body = self.system.equations.body;
        let node = largest_node(body, &self.newton.residual()[..self.end.displacement.len()]);
        Error::NotBalanced {
            fraction: self.system.time,
            iterations: failed.iterations,
            residual: failed.residual,
            target: failed.target,
            node,
            position: body.space.at_node(node, |node| state.position(body, node)),
            contact: None,
        }
    }
}

impl Stepper for StaticStepper<'_> {
    fn advance(&mut self, state: &mut State, step_size: f64) -> Result<StepOutcome> {
        let newton = self.solve(state, step_size)?;
        let StaticSystem { equations, first, time, .. } = &mut self.system;
        self.end.evaluate_static(equations, &self.unknowns, *time, first)?;
        self.keep_joints();
        let equations = &self.system.equations;
        let [rates, ..] = equations.blocks.split(&self.unknowns);
        equations.count_on(rates, &mut state.coordinates);
        let body = equations.body;
        let strain_state = body.strain_state_near(&self.end.displacement, &state.coordinates);
        // The fixed degrees of freedom have no inertia.
        self.end.set_reactions(body, &self.system.rest);
        state.displacement.copy_from_slice(&self.end.displacement);
        state.displacement_low.fill(0.0);
        let energy = strain_state.stored();
        let mut impulses = Impulses { work: energy - self.energy, ..Impulses::default() };
        self.energy = energy;
        self.add_resultants(&mut impulses);
        Ok(StepOutcome { newton, impulses, strain_state, solver: None })
    }

    fn reactions(&self) -> &[Reaction] {
        self.end.reactions()
    }

    fn joints(&self) -> &[JointState] {
        &self.joints
    }

    fn newton_history(&self) -> &[f64] {
        self.newton.history()
    }

    fn memory(&self) -> Memory {
        let mut memory = Memory::default();
        memory.save_number("energy", self.energy);
        if let Some(joints) = &self.system.joints {
            memory.save("multipliers", &joints.multipliers);
        }
        memory
    }

    fn restore(&mut self, memory: &Memory) -> Result<()> {
        self.energy = memory.number("energy")?;
        match &mut self.system.joints {
            Some(joints) => memory.fill("multipliers", &mut joints.multipliers),
            None => Ok(()),
        }
    }
}

impl StaticStepper<'_> {
    /// Keeps the multipliers of the equilibrium at the end of a step, and sets the forces of the joints.
    fn keep_joints(&mut self) {
        let equations = &self.system.equations;
        let [x, multipliers, _] = equations.blocks.split(&self.unknowns);
        let step = (&equations.step_at(x), &equations.constraint_step);
        let (mechanism, points) = (&equations.body.mechanism, equations.body.mesh().points());
        mechanism.set_states(step, (1.0, multipliers), points, &mut self.joints);
        if let Some(joints) = &mut self.system.joints {
            joints.multipliers.copy_from_slice(multipliers);
        }
    }

    /// Adds resultant and moment of loads, reactions and ground; on free degrees of freedom loads and internal forces
    /// cancel but for the residual.
    fn add_resultants(&self, impulses: &mut Impulses) {
        impulses.add_force(self.system.equations.body, 1.0, &self.end.displacement, &self.end.force);
    }
}
