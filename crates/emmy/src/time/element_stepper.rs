//! One step of a time element: prediction, iteration, update, impulses.

use super::equations::Equations;
use super::implicit::ImplicitStep;
use super::stage_system::StageSystem;
use super::{Impulses, Memory, State, StepOutcome, Stepper, TimeElement};
use crate::body::{BlockRow, Body, ConstrainedVelocity, JointState, MassSolver, Reaction};
use crate::error::Result;
use crate::force::StrainState;
use crate::input::{SAME_TIME, Span};
use crate::newton::NewtonSettings;

/// Stepper of a time element.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::motion::NewtonSettings;
/// use emmy::internals::time::TimeElementStepper;
/// use emmy::time::Stepper;
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(Region::new(rubber, 1.0)).build()?;
/// let mut state = State::initial(&body, 0.0, &[InitialVelocity { velocity: [2.0, 0.0, 0.0], ..Default::default() }])?;
/// let element = TimeElement::discrete_gradient(1)?;
/// TimeElementStepper::new(&body, element, NewtonSettings::default())?.advance(&mut state, 0.5)?;
/// assert!((state.displacement[0] - 1.0).abs() < 1e-14);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct TimeElementStepper<'a> {
    step: ImplicitStep<'a>,
    /// Solver for the velocity beside driven degrees of freedom; `None` if there are none.
    mass_solver: Option<MassSolver>,
    /// Momentum at the start of the step.
    momentum: Vec<f64>,
    /// The basis of the rates at the end of the step.
    end_basis: Vec<f64>,
    residual: Vec<f64>,
    position: Vec<f64>,
    /// Velocity of the driven degrees of freedom at the end of the step's polynomial.
    end_velocity: Vec<f64>,
    is_loaded: bool,
    reactions: Vec<Reaction>,
    joints: Vec<JointState>,
    /// Coordinates of the joints at the end of the step.
    coordinates: Vec<f64>,
    /// Velocities after kinks of the given motions of joints and at releases; `None` if there are none.
    allowed: Option<ConstrainedVelocity>,
    /// Origin of the displacement in the stage system.
    origin: [f64; 3],
    /// Mass fractions of the nodes of a free body, `[n_nodes]`; empty otherwise.
    mass_shares: Vec<f64>,
}

impl<'a> TimeElementStepper<'a> {
    /// A stepper with all its memory; the symbolic factorisations are done here, once.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`]; on a team [`crate::Error::NotOnTeam`] for a solver that factorises.
    pub fn new(body: &'a Body, element: TimeElement, settings: NewtonSettings) -> Result<Self> {
        let n = body.n_dofs();
        let k = element.degree;
        let step = ImplicitStep::new(body, element.coefficients(), settings)?;
        let n_unknowns = step.system.equations.blocks.len();
        let rule = &step.system.equations.coefficients.rule;
        Ok(TimeElementStepper {
            end_basis: (0..k).map(|j| rule.basis(j, 1.0)).collect(),
            step,
            mass_solver: if body.is_driven() { Some(MassSolver::new(body)?) } else { None },
            momentum: vec![0.0; n],
            residual: vec![0.0; n_unknowns],
            position: vec![0.0; n],
            end_velocity: vec![0.0; if body.is_driven() { n } else { 0 }],
            is_loaded: false,
            reactions: body.space.no_reactions(),
            joints: vec![JointState::default(); body.joints().len()],
            coordinates: Vec::with_capacity(body.joints().len()),
            allowed: if body.constraints().have_kinks() {
                Some(ConstrainedVelocity::new(body)?)
            } else {
                None
            },
            origin: [0.0; 3],
            mass_shares: if body.is_free() { mass_shares(body) } else { Vec::new() },
        })
    }

    /// Rates x_j of the last step, `[k][n_nodes][3]` \[length\].
    pub fn rates(&self) -> &[f64] {
        self.step.rates()
    }

    /// Sets the equations of the step: `g_i = sum_j (a^-1)_ij h p_1`, and the loads.
    fn start(&mut self, state: &State, h: f64) -> Result<()> {
        self.momentum.copy_from_slice(&state.momentum);
        state.set_relative_displacement(self.step.system.equations.body, &mut self.position);
        self.origin = state.origin(self.step.system.equations.body);
        self.reactions.fill(Reaction::default());
        self.step.system.start(&self.position, h);
        let Equations { coefficients, known, .. } = &mut self.step.system.equations;
        let n = self.momentum.len();
        for (sum, known) in coefficients.mass_sums(h).zip(known.chunks_exact_mut(n)) {
            known.iter_mut().zip(&self.momentum).for_each(|(g, p)| *g = weighted(sum, *p));
            for (g, share) in known.as_chunks_mut::<3>().0.iter_mut().zip(&self.mass_shares) {
                (0..3).for_each(|d| g[d] -= h * share * state.momentum_error[d]);
            }
        }
        self.is_loaded = self.step.system.equations.begin(Span::new(state.time, h), state)?;
        Ok(())
    }

    /// Work and impulses of loads and reactions. Reactions are the residual at the fixed degrees of freedom. Forces
    /// from outside that have a potential contribute to the impulses; their work is a change of the body's own energy.
    fn impulses(&mut self, h: f64) -> Result<Impulses> {
        let unknowns = &self.step.iteration.unknowns;
        let rates = self.step.iteration.rates();
        let equations = &mut self.step.system.equations;
        let (body, n) = (equations.body, equations.body.n_dofs());
        let has_supports = body.space.is_supported();
        if has_supports {
            equations.full_residual(unknowns, &mut self.residual)?;
        } else {
            equations.evaluate_external(rates)?;
        }
        let [dissipated, lost] = equations.dissipated(rates)?;
        // Loads contain the forces whose work is lost.
        let mut impulses = Impulses { dissipated: dissipated + lost, work: lost, ..Impulses::default() };
        equations.evaluate_outside(rates)?;
        impulses.work += equations.set_joint_forces(unknowns, &mut self.joints);
        let has_reactions = body.has_reactions_of_forces();
        if !has_supports && !self.is_loaded && !equations.has_outside() && !has_reactions {
            return Ok(impulses);
        }
        if has_reactions {
            equations.prepare_reactions(rates)?;
        }
        let rule = &equations.coefficients.rule;
        let k = rule.degree();
        for i in 0..k {
            let b = rule.weights()[i];
            let relative = self.position.iter_mut().zip(&equations.displacement).enumerate();
            relative.for_each(|(dof, (u, relative))| *u = self.origin[dof % 3] + relative);
            for j in 0..k {
                let a = rule.coefficients()[i * k + j];
                self.position.iter_mut().zip(&rates[j * n..]).for_each(|(u, x)| *u += a * x);
            }
            let force = &mut self.residual[i * n..(i + 1) * n];
            let reactions = &mut self.reactions;
            body.space.add_reactions(&self.position, |dof| b * force[dof] / (h * h), reactions);
            equations.add_spring_reactions(rates, i, b, &self.position, reactions);
            for dof in 0..n {
                let lambda = if body.fixed()[dof] { force[dof] / (h * h) } else { 0.0 };
                force[dof] = lambda + equations.load(i * n + dof);
            }
            impulses.work += b * body.space.dot(force, &rates[i * n..(i + 1) * n]);
            equations.add_outside(unknowns, i, force);
            impulses.add_force(body, h * b, &self.position, force);
        }
        Ok(impulses)
    }

    /// Strain energy and smallest det F at the end of the step, whose displacement is then in `position`.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`]: a rule may not evaluate the end, and no step can start from an inverted state.
    fn strain_state_at_end(&mut self) -> Result<StrainState> {
        self.position.copy_from_slice(&self.step.system.equations.displacement);
        let n = self.position.len();
        for (rates, b) in
            self.step.rates().chunks_exact(n).zip(self.step.system.equations.coefficients.rule.weights())
        {
            self.position.iter_mut().zip(rates).for_each(|(u, x)| *u += b * x);
        }
        let equations = &self.step.system.equations;
        self.coordinates.clone_from(&equations.coordinates);
        equations.count_on(self.step.rates(), &mut self.coordinates);
        equations.body.strain_state_near(&self.position, &self.coordinates).check_not_inverted()
    }

    /// Adds the rates of the step to a displacement.
    fn displace(&self, state: &mut State) {
        let n = state.displacement.len();
        let weights = self.step.system.equations.coefficients.rule.weights();
        state.displacement_low.resize(n, 0.0);
        for dof in 0..n {
            let rates = self.step.rates()[dof..].iter().step_by(n);
            state.displace(dof, rates.zip(weights).map(|(x, b)| b * x).sum());
        }
    }

    /// Advances a state like [`Stepper::advance`], with given rates as the starting point.
    ///
    /// # Errors
    /// As [`Stepper::advance`].
    pub fn advance_from(
        &mut self,
        state: &mut State,
        step_size: f64,
        given: Option<&[f64]>,
    ) -> Result<StepOutcome> {
        self.start(state, step_size)?;
        let newton = self.step.solve(state, step_size, given)?;
        let mut impulses = self.impulses(step_size)?;
        let strain_state = self.strain_state_at_end()?;
        state.coordinates.clone_from(&self.coordinates);
        self.update(state, step_size, &mut impulses)?;
        self.step.system.equations.body.space.sum_reactions(&mut self.reactions);
        if !self.mass_shares.is_empty() {
            state.note_momentum_error(self.step.system.equations.body, &self.momentum, impulses.linear);
        }
        self.step.remember(step_size);
        Ok(StepOutcome { newton, impulses, strain_state, solver: self.step.solver() })
    }

    /// Advances a state by a step with given rates, corrected by a function of the equations and the rates; false if
    /// that function reports failure.
    ///
    /// # Errors
    /// As the function.
    pub(super) fn correct_from(
        &mut self,
        state: &mut State,
        step_size: f64,
        given: &[f64],
        correct: impl FnOnce(&mut StageSystem<'_>, &mut [f64]) -> Result<bool>,
    ) -> Result<bool> {
        self.start(state, step_size)?;
        let ImplicitStep { system, iteration } = &mut self.step;
        iteration.begin(system, state, step_size)?;
        iteration.set_rates(given, system)?;
        if !correct(system, &mut iteration.unknowns)? {
            return Ok(false);
        }
        self.step.system.equations.count_on(self.step.rates(), &mut state.coordinates);
        self.update(state, step_size, &mut Impulses::default())?;
        Ok(true)
    }

    /// The state at the end of the step, but for the coordinates of the joints.
    ///
    /// Velocity and momentum follow from the inertia terms of the stage equations, with `h f_i` replaced by `R_i = 0`.
    /// Then an error of the iteration enters the energy balance through `R_i . x_i` only, and the velocity belongs to
    /// the momentum without a solution with M.
    fn update(&mut self, state: &mut State, h: f64, impulses: &mut Impulses) -> Result<()> {
        self.displace(state);
        self.step.system.equations.update_history(self.step.rates(), &mut state.history);
        if self.step.system.equations.body.is_driven() {
            self.update_momentum(state, h);
            self.set_driven_end(state, h, impulses)?;
        } else {
            impulses.dissipated += self.update_velocity(state, h);
        }
        self.add_kink(state, h, impulses)?;
        let body = self.step.system.equations.body;
        body.space.set_internal_velocity(&self.end_basis, self.step.rates(), h, &mut state.velocity);
        Ok(())
    }

    /// `v_2 = v_1 + sum_j beta_j (x_j/h - v_1)`, `p_2 = M v_2`, and the correction of a dissipative scheme.
    fn update_velocity(&mut self, state: &mut State, h: f64) -> f64 {
        let n = state.velocity.len();
        self.position.copy_from_slice(&state.velocity);
        for (j, rates) in self.step.rates().chunks_exact(n).enumerate() {
            let beta = self.end_weight(j);
            let terms = rates.iter().zip(&self.position);
            state.velocity.iter_mut().zip(terms).for_each(|(v, (x, v_1))| *v += weighted(beta, x / h - v_1));
        }
        let ImplicitStep { system, iteration } = &mut self.step;
        let (equations, new) = (&mut system.equations, &mut state.velocity);
        let dissipated = equations.complete_end_velocity(iteration.rates(), &self.position, new);
        equations.body.mass_product(new, &mut state.momentum);
        dissipated
    }

    /// `p_2 = p_1 + sum_j beta_j (M x_j/h - p_1)`.
    fn update_momentum(&mut self, state: &mut State, h: f64) {
        let n = state.momentum.len();
        for (j, rates) in self.step.rates().chunks_exact(n).enumerate() {
            let beta = self.end_weight(j);
            self.step.system.equations.body.mass_product(rates, &mut self.position);
            let terms = self.position.iter().zip(&self.momentum);
            state
                .momentum
                .iter_mut()
                .zip(terms)
                .for_each(|(p, (mx, p_1))| *p += weighted(beta, mx / h - p_1));
        }
    }

    /// Weight of rate j in the new velocity and momentum, `sum_i b_i (a^-1)_ij`, in two parts.
    fn end_weight(&self, j: usize) -> [f64; 2] {
        self.step.system.equations.coefficients.velocity_weight(j)
    }

    /// Sets the velocity of the driven degrees of freedom after the step, the velocity of the free ones from their
    /// momentum, and the momentum of the driven ones: p = M v with the complete M.
    fn set_driven_end(&mut self, state: &mut State, h: f64, impulses: &mut Impulses) -> Result<()> {
        let body = self.step.system.equations.body;
        self.set_end_velocity(&state.velocity, h);
        body.space.set_given_velocity(state.time + h, h, &mut state.velocity)?;
        if let Some(mass_solver) = &mut self.mass_solver {
            mass_solver.velocity_beside(body, &state.momentum, &mut state.velocity)?;
        }
        body.mass_product(&state.velocity, &mut self.position);
        self.momentum.copy_from_slice(&state.momentum);
        take_fixed(body, &self.position, &mut state.momentum);
        self.add_jump(state, h, impulses);
        Ok(())
    }

    /// Sets the velocity `v_c` at the end of the step's polynomial at the driven degrees of freedom; `velocity`: at the
    /// start.
    fn set_end_velocity(&mut self, velocity: &[f64], h: f64) {
        let body = self.step.system.equations.body;
        let n = velocity.len();
        self.end_velocity.copy_from_slice(velocity);
        for j in 0..self.end_basis.len() {
            let beta = self.end_weight(j);
            let rates = &self.step.rates()[j * n..(j + 1) * n];
            body.space
                .driven_dofs()
                .for_each(|dof| self.end_velocity[dof] += weighted(beta, rates[dof] / h - velocity[dof]));
        }
    }

    /// Sets the velocity after a kink of the given motion of a joint in the step, at its end: the joints exert the
    /// impulse `p^+ - p` with the work `(v + v^+)/2 . (p^+ - p)`. Without it, momenta would ring ever after. At a
    /// release, the same makes the velocity one that the joints allow: with the free motion, the part that they do not
    /// allow would move the positions.
    fn add_kink(&mut self, state: &mut State, h: f64, impulses: &mut Impulses) -> Result<()> {
        let Some(allowed) = &mut self.allowed else { return Ok(()) };
        let equations = &self.step.system.equations;
        if !equations.constraint_step.has_kink(equations.body.constraints()) {
            return Ok(());
        }
        let (body, end) = (equations.body, equations.constraint_step.span().end);
        self.position.copy_from_slice(&state.velocity);
        allowed.project(body, [end, SAME_TIME * h], &state.displacement, &mut state.velocity)?;
        let jump = &mut self.residual[..state.momentum.len()];
        jump.copy_from_slice(&state.momentum);
        body.mass_product(&state.velocity, &mut state.momentum);
        jump.iter_mut().zip(&state.momentum).for_each(|(jump, p)| *jump = p - *jump);
        self.position.iter_mut().zip(&state.velocity).for_each(|(mean, v)| *mean = 0.5 * (*mean + v));
        impulses.work += body.space.dot(&self.position, jump);
        impulses.add_force(body, 1.0, &state.displacement, jump);
        Ok(())
    }

    /// Adds the impulse of the reactions at the end of the step, where the given velocity `v_c^+` replaces the velocity
    /// of the polynomial: the impulse `p_c^+ - p_c` with the work `(v_c + v_c^+)/2 . (p_c^+ - p_c)`.
    fn add_jump(&mut self, state: &State, h: f64, impulses: &mut Impulses) {
        let body = self.step.system.equations.body;
        self.momentum.iter_mut().zip(&state.momentum).for_each(|(jump, p)| *jump = p - *jump);
        let mean = |dof: usize| 0.5 * (self.end_velocity[dof] + state.velocity[dof]);
        // The momentum of guests is zero.
        let mut work = [body.space.driven_dofs().map(|dof| mean(dof) * self.momentum[dof]).sum::<f64>()];
        body.space.sum_ranks("work of the jump", &mut work);
        impulses.work += work[0];
        impulses.add_force(body, 1.0, &state.displacement, &self.momentum);
        body.space.add_reactions(&state.displacement, |dof| self.momentum[dof] / h, &mut self.reactions);
    }
}

/// Product with a weight in two parts.
fn weighted([high, low]: [f64; 2], value: f64) -> f64 {
    high * value + low * value
}

/// The part of a body's mass at each node.
fn mass_shares(body: &Body) -> Vec<f64> {
    let total = body.total_lumped_mass();
    body.lumped_mass().iter().map(|mass| mass / total).collect()
}

/// Copies the entries of the fixed degrees of freedom.
fn take_fixed(body: &Body, from: &[f64], to: &mut [f64]) {
    let fixed = body.fixed().iter().zip(from).zip(to);
    fixed.filter(|((fixed, _), _)| **fixed).for_each(|((_, from), to)| *to = *from);
}

impl Stepper for TimeElementStepper<'_> {
    fn advance(&mut self, state: &mut State, step_size: f64) -> Result<StepOutcome> {
        self.advance_from(state, step_size, None)
    }

    fn residual(&mut self, state: &State, rates: &[f64], step_size: f64) -> Result<Vec<f64>> {
        self.start(state, step_size)?;
        self.step.system.residual_at(rates)
    }

    fn tangent(&mut self, state: &State, rates: &[f64], step_size: f64) -> Result<Vec<BlockRow>> {
        self.start(state, step_size)?;
        self.step.system.tangent_at(rates)
    }

    fn rates(&self) -> &[f64] {
        self.step.rates()
    }

    fn joints(&self) -> &[JointState] {
        &self.joints
    }

    fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

    fn newton_history(&self) -> &[f64] {
        self.step.history()
    }

    fn memory(&self) -> Memory {
        self.step.memory()
    }

    fn restore(&mut self, memory: &Memory) -> Result<()> {
        self.step.restore(memory)
    }
}
