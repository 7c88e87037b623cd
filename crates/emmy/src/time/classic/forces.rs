//! Forces at one configuration and time: internal, external, reactions.

mod point;

pub use point::PointForces;

use crate::average::{Request, Rule};
use crate::body::{Assembly, Body, JointState, MassSolver, Reaction};
use crate::error::Result;
use crate::force::{Sampling, StepDamping, StepInput};
use crate::input::Span;
use crate::quadrature::gauss;
use crate::time::equations::Equations;
use crate::time::{Impulses, Memory, State};
use crate::unknowns::LinearConstraints;

/// Evaluates forces at single configurations, with the memory for it.
#[derive(Debug)]
pub(crate) struct Forces<'a> {
    pub body: &'a Body,
    rule: Rule,
    pub assembly: Assembly,
    /// History variables of the forces; empty for zeros.
    history: Vec<f64>,
    /// Coordinates of the joints to half a turn.
    coordinates: Vec<f64>,
    rest: Vec<f64>,
    internal: Vec<f64>,
}

impl<'a> Forces<'a> {
    pub(crate) fn new(body: &'a Body) -> Self {
        let zero = vec![0.0; body.n_dofs()];
        let rule = Rule::at_end();
        let assembly = body.assembly(&rule);
        let (history, coordinates) = Default::default();
        Forces { body, assembly, rule, history, coordinates, rest: zero.clone(), internal: zero }
    }

    /// Takes what the forces of a state depend on beside its displacement.
    pub(crate) fn take_history(&mut self, state: &State) {
        self.history.clone_from(&state.history);
        self.coordinates.clone_from(&state.coordinates);
    }

    /// The internal force evaluated last, `[n_nodes][3]`.
    pub(crate) fn internal(&self) -> &[f64] {
        &self.internal
    }

    /// Assembles the internal force of a displacement; with [`Request::Tangent`] also its derivative K.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`].
    pub(crate) fn assemble(&mut self, displacement: &[f64], request: Request) -> Result<()> {
        let Forces { body, assembly, rule, rest, coordinates, .. } = self;
        let step =
            StepInput { tangent_factor: 1.0, coordinates, ..StepInput::undamped(rule, displacement, rest) };
        body.assemble(&step, request, &[0.0], assembly)
    }

    /// Subtracts the derivative of the loads of a time from the K assembled last.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`], and the reason of a force that refuses the displacement.
    pub(crate) fn add_external_tangent(&mut self, displacement: &[f64], time: f64) -> Result<()> {
        let step =
            StepInput { tangent_factor: 1.0, ..StepInput::undamped(&self.rule, displacement, &self.rest) };
        self.body.begin(&self.rule, (Span::at(time), Sampling::Points), &self.history, &mut self.assembly)?;
        self.body.add_external_tangent(&step, &mut self.assembly)
    }

    /// Force of the body on the ground at a displacement, zero without ground; the springs of supports are added to the
    /// reactions.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`].
    fn outside(
        &mut self,
        displacement: &[f64],
        outside: &mut [f64],
        reactions: &mut [Reaction],
    ) -> Result<()> {
        reactions.fill(Reaction::default());
        let Forces { body, assembly, rule, rest, coordinates, .. } = self;
        let step = StepInput { coordinates, ..StepInput::undamped(rule, displacement, rest) };
        if body.has_reactions_of_forces() {
            body.prepare_reactions(&step, assembly)?;
            body.add_spring_reactions((&step, assembly), 0, 1.0, displacement, reactions);
        }
        if body.has_ground() { body.ground_force(&step, assembly, outside) } else { Ok(()) }
    }

    /// All loads at a displacement and time.
    ///
    /// # Errors
    /// As [`Forces::add_external_tangent`].
    pub(crate) fn external(&mut self, displacement: &[f64], time: f64, external: &mut [f64]) -> Result<()> {
        let step = StepInput::undamped(&self.rule, displacement, &self.rest);
        self.body.begin(&self.rule, (Span::at(time), Sampling::Points), &self.history, &mut self.assembly)?;
        self.body.evaluate_external(&step, &mut self.assembly)?;
        external.iter_mut().enumerate().for_each(|(at, force)| *force = self.assembly.external(at));
        Ok(())
    }

    /// Force that remains for inertia and supports, `F(t) - f(u)`; the external force goes to `external`.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`].
    pub(crate) fn net(
        &mut self,
        displacement: &[f64],
        time: f64,
        external: &mut [f64],
        net: &mut [f64],
    ) -> Result<()> {
        self.external(displacement, time, external)?;
        self.assemble(displacement, Request::Stress)?;
        self.assembly.matrix.copy_force(&mut self.internal);
        let forces = external.iter().zip(&self.internal);
        net.iter_mut().zip(forces).for_each(|(net, (external, internal))| *net = external - internal);
        Ok(())
    }
}

impl Forces<'_> {
    /// Internal force at a displacement, less the loads of a time if there is one, `[n_nodes][3]`.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`], [`crate::Error::NotFiniteAt`].
    pub(crate) fn unbalanced(&mut self, displacement: &[f64], time: Option<f64>) -> Result<Vec<f64>> {
        let (mut external, mut net) = (self.rest.clone(), self.rest.clone());
        match time {
            Some(time) => self.net(displacement, time, &mut external, &mut net)?,
            None => {
                self.assemble(displacement, Request::Stress)?;
                self.assembly.matrix.copy_force(&mut net);
                return Ok(net);
            }
        }
        net.iter_mut().for_each(|force| *force = -*force);
        Ok(net)
    }

    /// Force of viscosity, drag and dampers in a state, which is linear in its velocity, `[n_nodes][3]`.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`].
    pub(crate) fn damping(&mut self, state: &State) -> Result<Vec<f64>> {
        if !self.body.dissipates() {
            return Ok(self.rest.clone());
        }
        self.assemble(&state.displacement, Request::Stress)?;
        let mut at_rest = self.rest.clone();
        self.assembly.matrix.copy_force(&mut at_rest);
        let mut damped: Vec<f64> = at_rest.iter().map(|force| -force).collect();
        self.add_damping(state, &self.rest.clone(), &mut damped)?;
        damped.iter_mut().zip(&at_rest).for_each(|(net, internal)| *net += internal);
        Ok(damped)
    }

    /// Adds viscosity, drag and other forces whose work is lost to the force that remains for inertia.
    ///
    /// A mid-point rule on the path `u + (alpha - 1/2) v` sees the displacement u and the rate v.
    fn add_damping(&mut self, state: &State, external: &[f64], net: &mut [f64]) -> Result<()> {
        if !self.body.dissipates() {
            return Ok(());
        }
        let before = state.displacement.iter().zip(&state.velocity).map(|(u, v)| u - 0.5 * v);
        let before: Vec<f64> = before.collect();
        let rule: Rule = Rule::standard(1, &gauss(1));
        let damping = StepDamping { inverse_step_size: 1.0, dissipation: 0.0 };
        let step = StepInput {
            damping,
            coordinates: &state.coordinates,
            ..StepInput::undamped(&rule, &before, &state.velocity)
        };
        if self.body.is_viscous() {
            self.body.assemble(&step, Request::Stress, &[0.0], &mut self.assembly)?;
            self.assembly.matrix.copy_force(&mut self.internal);
            let forces = external.iter().zip(&self.internal);
            net.iter_mut().zip(forces).for_each(|(net, (external, internal))| *net = external - internal);
        }
        if self.body.loss_force(&step, &mut self.assembly, &mut self.internal)? {
            net.iter_mut().zip(&self.internal).for_each(|(net, lost)| *net += lost);
        }
        let rate = self.body.drag();
        net.iter_mut().zip(&state.momentum).for_each(|(net, p)| *net -= rate * p);
        Ok(())
    }
}

/// Forces at a time of the step.
#[derive(Debug)]
pub(crate) struct TimePoint {
    /// Displacement, `[n_nodes][3]`.
    pub displacement: Vec<f64>,
    /// External force F.
    pub external: Vec<f64>,
    /// The net force F - f(u) once it is evaluated; F + lambda, less the force on the ground, once the reactions are
    /// set.
    pub force: Vec<f64>,
    /// Force on the ground.
    outside: Vec<f64>,
    /// Force of each supported group: the springs first, then with the fixed degrees of freedom.
    reactions: Vec<Reaction>,
}

impl TimePoint {
    pub(crate) fn new(body: &Body) -> Self {
        let n = body.n_dofs();
        TimePoint {
            reactions: body.space.no_reactions(),
            displacement: vec![0.0; n],
            external: vec![0.0; n],
            force: vec![0.0; n],
            outside: vec![0.0; n],
        }
    }

    /// Reactions at the point on all ranks, once they are set.
    pub(crate) fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

    /// Keeps the forces of the point for the start of the next step.
    pub(crate) fn save(&self, memory: &mut Memory) {
        memory.save_nodal("start.displacement", &self.displacement);
        memory.save_nodal("start.external", &self.external);
        memory.save_nodal("start.force", &self.force);
        let reactions = self.reactions.iter().flat_map(|own| [own.force, own.moment]);
        memory.save("start.reactions", &reactions.flatten().collect::<Vec<f64>>());
    }

    /// Restores the data of [`TimePoint::save`].
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub(crate) fn restore(&mut self, memory: &Memory) -> Result<()> {
        memory.fill("start.displacement", &mut self.displacement)?;
        memory.fill("start.external", &mut self.external)?;
        let mut numbers = vec![0.0; 6 * self.reactions.len()];
        memory.fill("start.reactions", &mut numbers)?;
        for (own, [force, moment]) in self.reactions.iter_mut().zip(numbers.as_chunks::<3>().0.as_chunks().0)
        {
            *own = Reaction { force: *force, moment: *moment };
        }
        memory.fill("start.force", &mut self.force)
    }

    /// Evaluates the forces at the displacement of the point.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`].
    pub(crate) fn evaluate(&mut self, forces: &mut Forces<'_>, time: f64) -> Result<()> {
        forces.outside(&self.displacement, &mut self.outside, &mut self.reactions)?;
        forces.net(&self.displacement, time, &mut self.external, &mut self.force)?;
        forces.body.space.share_internal_forces(&mut self.force);
        Ok(())
    }

    /// Evaluates the internal forces for the reactions; a body without supports has no reactions.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`].
    pub(crate) fn evaluate_for_reactions(&mut self, forces: &mut Forces<'_>, time: f64) -> Result<()> {
        if forces.body.space.is_supported() {
            return self.evaluate(forces, time);
        }
        forces.external(&self.displacement, time, &mut self.external)?;
        forces.outside(&self.displacement, &mut self.outside, &mut self.reactions)
    }

    /// Takes displacement and forces of an equilibrium at a time from its equations; `residual`: memory.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`].
    pub(crate) fn evaluate_static(
        &mut self,
        equations: &mut Equations<'_>,
        unknowns: &[f64],
        time: f64,
        residual: &mut [f64],
    ) -> Result<()> {
        let n = self.displacement.len();
        let x = &unknowns[..n];
        for (u, (start, x)) in self.displacement.iter_mut().zip(equations.displacement.iter().zip(x)) {
            *u = start + x;
        }
        // Exactly there, not but for rounding.
        equations.body.space.set_driven_displacement(time, &mut self.displacement);
        equations.full_residual(unknowns, residual)?;
        self.force.iter_mut().zip(&*residual).for_each(|(net, r)| *net = -r);
        self.external.iter_mut().enumerate().for_each(|(at, force)| *force = equations.load(at));
        self.reactions.fill(Reaction::default());
        equations.add_spring_reactions(x, 0, 1.0, &self.displacement, &mut self.reactions);
        equations.evaluate_outside(x)?;
        self.outside.fill(0.0);
        equations.add_outside(unknowns, 0, &mut self.outside);
        self.outside.iter_mut().for_each(|force| *force = -*force);
        Ok(())
    }

    /// Sets the reactions of all ranks, and the force to the sum of loads, reactions and ground,
    /// `lambda = M a + f(u) - F` at fixed degrees of freedom; `inertia`: M a.
    pub(crate) fn set_reactions(&mut self, body: &Body, inertia: &[f64]) {
        let reaction = |dof: usize| inertia[dof] - self.force[dof];
        body.space.add_reactions(&self.displacement, reaction, &mut self.reactions);
        for (dof, &fixed) in body.fixed().iter().enumerate() {
            let reaction = if fixed { inertia[dof] - self.force[dof] } else { 0.0 };
            self.force[dof] = self.external[dof] + reaction - self.outside[dof];
        }
        body.space.sum_reactions(&mut self.reactions);
    }

    /// Adds the impulses of loads and reactions at this point, with a weight, in a step of increment x.
    pub(crate) fn add_to(
        &self,
        impulses: &mut Impulses,
        body: &Body,
        weight: f64,
        step_size: f64,
        x: &[f64],
    ) {
        impulses.work += weight * body.space.dot(&self.external, x);
        impulses.add_force(body, weight * step_size, &self.displacement, &self.force);
    }
}

/// Reactions and forces of joints of a state at rest in equilibrium.
///
/// # Errors
/// [`crate::Error::Inverted`].
pub(crate) fn static_reactions(body: &Body, state: &State) -> Result<(Vec<Reaction>, Vec<JointState>)> {
    let mut point = TimePoint::new(body);
    point.displacement.copy_from_slice(&state.displacement);
    let mut forces = Forces::new(body);
    forces.take_history(state);
    point.evaluate(&mut forces, state.time)?;
    let constraints = (body.constraints(), body.space.inactive());
    let mut constraints = LinearConstraints::new(constraints, &state.displacement, Some(state.time))?;
    point.force.iter_mut().for_each(|net| *net = -*net);
    let multipliers = constraints.balancing(&point.force);
    constraints.add_force((body.constraints(), &state.displacement), &multipliers, &mut point.force);
    point.force.iter_mut().for_each(|net| *net = -*net);
    point.set_reactions(body, &vec![0.0; body.n_dofs()]);
    let undamped = StepInput::undamped(&forces.rule, &state.displacement, &forces.rest);
    let step = StepInput { coordinates: &state.coordinates, ..undamped };
    let mut joints = vec![JointState::default(); body.joints().len()];
    let points = body.mesh().points();
    body.mechanism.set_states((&step, constraints.times()), (1.0, &multipliers), points, &mut joints);
    Ok((point.reactions, joints))
}

/// Sets the reactions of a step to the weighted sum over its points.
pub(crate) fn sum_reactions<'p>(
    points: impl IntoIterator<Item = (&'p TimePoint, f64)>,
    reactions: &mut [Reaction],
) {
    reactions.fill(Reaction::default());
    for (point, weight) in points {
        reactions.iter_mut().zip(&point.reactions).for_each(|(sum, own)| sum.add(weight, own));
    }
}

/// Acceleration and forces at a state, `M a = F(t) - f(u)` on the free degrees of freedom, and the product M a on all.
#[derive(Debug)]
pub(crate) struct Start {
    pub acceleration: Vec<f64>,
    pub inertia: Vec<f64>,
    pub point: TimePoint,
}

impl Start {
    /// The start from a state, with the consistent mass.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`], [`crate::Error::Linear`].
    pub(crate) fn new(forces: &mut Forces<'_>, state: &State) -> Result<Self> {
        let body = forces.body;
        let n = forces.body.n_dofs();
        let mut acceleration = vec![0.0; n];
        let mut inertia = vec![0.0; n];
        let mut point = TimePoint::new(body);
        point.displacement.copy_from_slice(&state.displacement);
        forces.take_history(state);
        point.evaluate(forces, state.time)?;
        forces.add_damping(state, &point.external, &mut point.force)?;
        MassSolver::new(body)?.velocity(body, &point.force, &mut acceleration)?;
        body.mass_product(&acceleration, &mut inertia);
        point.set_reactions(body, &inertia);
        Ok(Start { acceleration, inertia, point })
    }

    /// Keeps what the next step depends on.
    pub(crate) fn save(&self, memory: &mut Memory) {
        memory.save_nodal("acceleration", &self.acceleration);
        memory.save_nodal("inertia", &self.inertia);
        self.point.save(memory);
    }

    /// Restores the data of [`Start::save`].
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub(crate) fn restore(&mut self, memory: &Memory) -> Result<()> {
        memory.fill("acceleration", &mut self.acceleration)?;
        memory.fill("inertia", &mut self.inertia)?;
        self.point.restore(memory)
    }
}
