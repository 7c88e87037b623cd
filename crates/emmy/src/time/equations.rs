//! The non-linear equations of a step: their residual, and what balances and records take from them.

use rayon::prelude::*;

use super::State;
use super::scheme_force::SchemeForce;
use super::stage_coefficients::StageCoefficients;
use crate::average::Request;
use crate::body::{Assembly, Body, JointState, Reaction};
use crate::error::{Error, Result};
use crate::force::{StepDamping, StepInput};
use crate::input::Span;
use crate::newton::Ending;
use crate::space::DrivenRates;
use crate::unknowns::{Blocks, ConstraintStep, Held};

/// The stage equations of a body and their memory; a step is set with [`Equations::start`].
#[derive(Debug)]
pub(super) struct Equations<'a> {
    pub body: &'a Body,
    pub coefficients: StageCoefficients,
    /// Blocks of the unknowns.
    pub blocks: Blocks,
    pub assembly: Assembly,
    /// The time s: the step size of a time element.
    pub time_scale: f64,
    /// Displacement at the start of the step, relative to [`super::State::origin`].
    pub displacement: Vec<f64>,
    /// Coordinates of the joints at the start of the step.
    pub coordinates: Vec<f64>,
    /// Known part g_i of the inertia.
    pub known: Vec<f64>,
    /// Rate of the drag \[1/time\]; none without inertia.
    drag: f64,
    /// m_ij with the drag, for the time s.
    damped_mass: Vec<f64>,
    /// The same in [`StageCoefficients::parts`].
    mass_parts: Vec<[f64; 2]>,
    pub scheme_force: SchemeForce,
    driven: DrivenRates,
    /// Internal force of the last residual; memory for a right side otherwise.
    pub force: Vec<f64>,
    /// M x_j of the last residual.
    mass_rates: Vec<f64>,
    /// Squares of its terms, of each chunk of each stage.
    squares: Vec<[f64; 3]>,
    /// Times and range of the constraints.
    pub constraint_step: ConstraintStep,
    /// Forces of constraints in a stage; empty without constraints.
    constraint_force: Vec<f64>,
    /// Force on the ground through potentials in every stage; empty without such forces.
    on_ground: Vec<f64>,
}

/// Degrees of freedom of one task.
const CHUNK: usize = 4096;

impl<'a> Equations<'a> {
    /// The equations with their memory.
    pub(super) fn new(body: &'a Body, coefficients: StageCoefficients) -> Self {
        let n = body.n_dofs();
        let k = coefficients.rule.degree();
        Equations {
            body,
            blocks: Blocks {
                rates: k * n,
                multipliers: k * body.constraints().len(),
                local: body.n_local() * coefficients.rule.n_pressures(),
            },
            assembly: body.assembly(&coefficients.rule),
            time_scale: 0.0,
            displacement: vec![0.0; n],
            coordinates: Vec::with_capacity(body.joints().len()),
            known: vec![0.0; k * n],
            drag: if coefficients.is_static() { 0.0 } else { body.drag() },
            damped_mass: coefficients.mass.clone(),
            mass_parts: mass_parts(&coefficients, &coefficients.mass).collect(),
            scheme_force: SchemeForce::new(body, coefficients.damping.clone()),
            driven: DrivenRates::new(&body.space, k),
            force: vec![0.0; k * n],
            mass_rates: vec![0.0; k * n],
            squares: vec![[0.0; 3]; k * n.div_ceil(CHUNK)],
            constraint_step: ConstraintStep::new(body.constraints(), k),
            constraint_force: vec![0.0; if body.constraints().is_empty() { 0 } else { n }],
            on_ground: vec![0.0; if body.has_ground() { k * n } else { 0 }],
            coefficients,
        }
    }

    /// Sets displacement and time scale of the step. The stepper fills `known` and calls [`Equations::begin`].
    pub(super) fn start(&mut self, displacement: &[f64], time_scale: f64) {
        self.displacement.copy_from_slice(displacement);
        if self.time_scale != time_scale && self.drag > 0.0 {
            self.set_mass(time_scale * self.drag);
        }
        self.time_scale = time_scale;
    }

    /// Evaluates what is given over time in the step from a state. Returns whether some force on the right acts.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(super) fn begin(&mut self, span: Span, state: &State) -> Result<bool> {
        let StageCoefficients { rule, sampling, .. } = &self.coefficients;
        self.scheme_force.begin(&state.momentum);
        self.coordinates.clone_from(&state.coordinates);
        let is_loaded = self.body.begin(rule, (span, *sampling), &state.history, &mut self.assembly)?;
        self.driven.set(&self.body.space, rule, span, &self.displacement)?;
        if !self.body.mechanism.is_empty() {
            let body = (self.body.constraints(), self.body.space.inactive());
            self.constraint_step.begin(body, rule, span, &self.displacement)?;
        }
        Ok(is_loaded)
    }

    /// Projects multipliers on the range of the constraints.
    pub(super) fn project(&mut self, multipliers: &mut [f64]) {
        let n = self.body.constraints().len().max(1);
        multipliers.chunks_exact_mut(n).for_each(|of_stage| self.constraint_step.project(of_stage));
    }

    /// Whether the constraints hold at the end of the step with some rates; if not, their range becomes that at the
    /// end, for a repetition.
    pub(super) fn constraints_hold(&mut self, rates: &[f64]) -> Held {
        if self.body.constraints().is_empty() {
            return Held::Yes;
        }
        let body = (self.body.constraints(), self.body.space.inactive());
        let step =
            step_input(&self.coefficients, self.time_scale, (&self.displacement, &self.coordinates), rates);
        self.constraint_step.hold(body, &step)
    }

    /// The error of a step with some number and end whose constraints do not hold with some rates.
    pub(super) fn constraints_lost(&self, (step, time): (usize, f64), residual: f64, rates: &[f64]) -> Error {
        let at_rates = self.step_at(rates);
        let residuals = self.constraint_step.residuals_at_end(self.body.constraints(), &at_rates);
        let [joints, driven] = self.body.mechanism.open(&residuals);
        Error::ConstraintsLost { step, time, residual, joints, driven }
    }

    /// Inserts the rates of the degrees of freedom whose motion is given into a starting point of the iteration.
    pub(super) fn drive(&self, rates: &mut [f64]) {
        self.driven.insert(&self.body.space, rates);
        self.body.space.follow(rates);
    }

    /// Sets the coefficients of the inertia, with a further part of the diagonal ones.
    fn set_mass(&mut self, further: f64) {
        let k = self.coefficients.rule.degree();
        self.damped_mass.copy_from_slice(&self.coefficients.mass);
        (0..k).for_each(|i| self.damped_mass[i * k + i] += further);
        let parts = mass_parts(&self.coefficients, &self.damped_mass);
        self.mass_parts.iter_mut().zip(parts).for_each(|(own, parts)| *own = parts);
    }

    /// Sets the local unknowns to those of the configuration at the start of the step.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`].
    pub(super) fn set_local_at_start(&mut self, local: &mut [f64]) -> Result<()> {
        if !self.body.has_local() {
            return Ok(());
        }
        self.force.fill(0.0);
        let step = StepInput::undamped(&self.coefficients.rule, &self.displacement, &self.force);
        self.body.assemble(&step, Request::Stress, &[], &mut self.assembly)?;
        self.body.copy_local(&self.assembly, local);
        Ok(())
    }

    /// Residual on all degrees of freedom (on fixed ones it is s^2 times the reaction), then the residuals of the local
    /// unknowns. Returns this rank's squared norms of inertia, internal and external force on free degrees of freedom.
    pub(super) fn full_residual(&mut self, unknowns: &[f64], residual: &mut [f64]) -> Result<[f64; 3]> {
        self.assemble(unknowns, Request::Stress)?;
        let [x, multipliers, local] = self.blocks.split(unknowns);
        let [residual, of_constraints, of_local] = self.blocks.split_mut(residual);
        self.body.copy_local(&self.assembly, of_local);
        of_local.iter_mut().zip(local).for_each(|(r, value)| *r = value - *r);
        self.assembly.matrix.copy_force(&mut self.force);
        self.evaluate_external(x)?;
        let n = self.body.n_dofs();
        let k = self.coefficients.rule.degree();
        let s = self.time_scale;
        self.set_mass_rates(x);
        let Equations { body, force, mass_rates, mass_parts, known, assembly, squares, .. } = self;
        let inactive = body.space.inactive();
        let counted = 3 * body.space.counted_ranges()[1].end;
        let [steady, varying] = assembly.external_parts();
        for (i, residual) in residual.chunks_exact_mut(n).enumerate() {
            let mass = &mass_parts[i * k..(i + 1) * k];
            let chunks =
                residual.par_chunks_mut(CHUNK).zip(&mut squares[i * n.div_ceil(CHUNK)..]).enumerate();
            chunks.for_each(|(chunk, (residual, squares))| {
                *squares = [0.0; 3];
                for (dof, residual) in (CHUNK * chunk..).zip(residual) {
                    let at = i * n + dof;
                    let sum =
                        |part: usize| (0..k).map(|j| mass[j][part] * mass_rates[j * n + dof]).sum::<f64>();
                    let inertia = sum(0) + sum(1);
                    let internal = s * s * force[at];
                    let external = s * s * (steady[at] + varying[at]);
                    *residual = inertia - known[at] + (internal - external);
                    if dof < counted && !inactive[dof] {
                        squares[0] += inertia * inertia;
                        squares[1] += internal * internal;
                        squares[2] += external * external;
                    }
                }
            });
        }
        self.scheme_force.add_to_residual(body, (x, &self.mass_rates), s, residual);
        let [inertia, internal, external] =
            [0, 1, 2].map(|part| squares.iter().map(|squares| squares[part]).sum::<f64>());
        let of_joints = self.add_constraints(x, multipliers, residual, of_constraints);
        Ok([inertia, internal + of_joints, external])
    }

    /// Adds the forces of constraints to the residual of the rates, and sets their own. Returns the square of the
    /// forces.
    fn add_constraints(
        &mut self,
        x: &[f64],
        multipliers: &[f64],
        residual: &mut [f64],
        of_constraints: &mut [f64],
    ) -> f64 {
        let constraints = self.body.constraints();
        if constraints.is_empty() {
            return 0.0;
        }
        let Equations { constraint_step: times, constraint_force: force, .. } = self;
        let step =
            step_input(&self.coefficients, self.time_scale, (&self.displacement, &self.coordinates), x);
        constraints.set_residual(&step, times, of_constraints);
        let n = self.body.n_dofs();
        let mut square = 0.0;
        for (i, residual) in residual.chunks_exact_mut(n).enumerate() {
            force.fill(0.0);
            constraints.add_force((&step, times), i, (1.0, multipliers), force);
            residual.iter_mut().zip(&*force).for_each(|(r, f)| *r += f);
            let free = force.iter().zip(self.body.fixed()).filter(|(_, fixed)| !**fixed);
            square += free.map(|(f, _)| f * f).sum::<f64>();
        }
        square
    }

    /// Residual without the internal forces in every stage, on all degrees of freedom: inertia less known part and
    /// loads at the rates x.
    ///
    /// ```math
    /// sum_j m_ij M x_j - g_i - s^2 f_i^ext
    /// ```
    ///
    /// # Errors
    /// The reason of a force that refuses the step.
    pub(super) fn unbalanced(&mut self, x: &[f64], residual: &mut [f64]) -> Result<()> {
        self.evaluate_external(x)?;
        self.inertia(x, residual);
        let s = self.time_scale;
        for (at, residual) in residual.iter_mut().enumerate() {
            *residual = *residual - self.known[at] - s * s * self.load(at);
        }
        Ok(())
    }

    /// Mean kinetic energy of the step `sum_i b_i x_i . M x_i / (2 s^2)`.
    pub(super) fn mean_kinetic_energy(&mut self, x: &[f64]) -> f64 {
        self.mean_square(x) / (2.0 * self.time_scale * self.time_scale)
    }

    /// `sum_i b_i x_i . M x_i`.
    fn mean_square(&mut self, x: &[f64]) -> f64 {
        self.set_mass_rates(x);
        let n = self.body.n_dofs();
        let stages = x.chunks_exact(n).zip(self.mass_rates.chunks_exact(n));
        stages
            .zip(self.coefficients.rule.weights())
            .map(|((x, mass_x), b)| b * self.body.space.dot(x, mass_x))
            .sum()
    }

    /// Whether the internal forces have no resultant in any stage, so that inertia and loads alone determine the
    /// translation of the body; with [`Rule::has_no_moment`] its rotation, too.
    pub(super) fn is_self_balanced(&self) -> bool {
        self.coefficients.damping.is_none()
            && !self.body.has_ground()
            && !self.body.constraints().is_grounded()
    }

    /// How far the iteration goes beyond its tolerance.
    ///
    /// The balances of a body that nothing holds close without a solution to rounding, if only rates and fixed loads do
    /// work. Pressures, constraints and loads that depend on the motion do more work than that of the residual.
    pub(super) fn ending(&self) -> Ending {
        let Equations { body, coefficients, blocks, assembly, .. } = self;
        let is_free = body.space.held_axes() == [false, false, body.space.has_plane_cells()];
        let is_closed = is_free && self.is_self_balanced();
        if !is_closed || coefficients.is_static() || blocks.len() > blocks.rates || assembly.varies() {
            Ending::Rounding
        } else if coefficients.rule.is_energy_momentum() {
            Ending::Balanced
        } else {
            Ending::Tolerance
        }
    }

    /// `sum_j m_ij M x_j` in every stage.
    pub(super) fn inertia(&mut self, x: &[f64], inertia: &mut [f64]) {
        self.set_mass_rates(x);
        let n = self.body.n_dofs();
        let k = self.coefficients.rule.degree();
        for (i, inertia) in inertia.chunks_exact_mut(n).enumerate() {
            let mass = &self.mass_parts[i * k..(i + 1) * k];
            for (dof, inertia) in inertia.iter_mut().enumerate() {
                let sum =
                    |part: usize| (0..k).map(|j| mass[j][part] * self.mass_rates[j * n + dof]).sum::<f64>();
                *inertia = sum(0) + sum(1);
            }
        }
    }

    /// Evaluates the forces of the ground at the rates x, after [`Equations::dissipated`].
    ///
    /// # Errors
    /// As the residual.
    pub(super) fn evaluate_outside(&mut self, x: &[f64]) -> Result<()> {
        if self.on_ground.is_empty() {
            return Ok(());
        }
        // With the dampers of joints to the ground.
        let step =
            step_input(&self.coefficients, self.time_scale, (&self.displacement, &self.coordinates), x);
        self.body.ground_force(&step, &mut self.assembly, &mut self.on_ground)
    }

    /// Whether some force from outside has an impulse, but no work in the energy balance: of a potential, of
    /// constraints, of the surrounding medium.
    pub(super) fn has_outside(&self) -> bool {
        !self.on_ground.is_empty() || self.body.constraints().is_grounded() || self.drag > 0.0
    }

    /// Adds these forces in a stage, `force: [n_nodes][3]`, as they were evaluated last.
    pub(super) fn add_outside(&self, unknowns: &[f64], stage: usize, force: &mut [f64]) {
        let n = force.len();
        let on_ground = self.on_ground.chunks_exact(n).nth(stage).into_iter().flatten();
        force.iter_mut().zip(on_ground).for_each(|(force, on_ground)| *force -= on_ground);
        if self.body.constraints().is_grounded() {
            let [x, multipliers, _] = self.blocks.split(unknowns);
            let factor = -1.0 / (self.time_scale * self.time_scale);
            let step = (&self.step_at(x), &self.constraint_step);
            self.body.constraints().add_force(step, stage, (factor, multipliers), force);
        }
        if self.drag > 0.0 {
            let mass_rates = &self.mass_rates[stage * n..(stage + 1) * n];
            let forces = force.iter_mut().zip(mass_rates);
            forces.for_each(|(force, mass_rate)| *force += -self.drag / self.time_scale * mass_rate);
        }
    }

    /// Evaluates what the forces among the reactions need at the rates x.
    ///
    /// # Errors
    /// The reason of a force that refuses the step.
    pub(super) fn prepare_reactions(&mut self, x: &[f64]) -> Result<()> {
        let step = StepInput::undamped(&self.coefficients.rule, &self.displacement, x);
        self.body.prepare_reactions(&step, &mut self.assembly)
    }

    /// Adds the forces of the springs of supports in a stage at the rates x, times a weight; `displacement`: in the
    /// stage.
    pub(super) fn add_spring_reactions(
        &self,
        x: &[f64],
        stage: usize,
        weight: f64,
        displacement: &[f64],
        reactions: &mut [Reaction],
    ) {
        let step = StepInput::undamped(&self.coefficients.rule, &self.displacement, x);
        self.body.add_spring_reactions((&step, &self.assembly), stage, weight, displacement, reactions);
    }

    /// Sets the forces of the joints in a solved step. Returns the work of the given
    /// motions.
    pub(super) fn set_joint_forces(&self, unknowns: &[f64], joints: &mut [JointState]) -> f64 {
        let Equations { body, constraint_step: times, .. } = self;
        if body.mechanism.is_empty() {
            return 0.0;
        }
        let [x, multipliers, _] = self.blocks.split(unknowns);
        let step =
            step_input(&self.coefficients, self.time_scale, (&self.displacement, &self.coordinates), x);
        let factor = times.step_size().powi(-2);
        body.mechanism.set_states((&step, times), (factor, multipliers), body.mesh().points(), joints);
        body.constraints().work(&step, times, multipliers)
    }

    /// Stage average of the forces on the right, at the rates evaluated last; `at`: position in
    /// `[k][n_nodes][3]`.
    pub(super) fn load(&self, at: usize) -> f64 {
        self.assembly.external(at)
    }

    /// Evaluates these forces at the rates x.
    ///
    /// # Errors
    /// The reason of a force that refuses the step.
    pub(super) fn evaluate_external(&mut self, x: &[f64]) -> Result<()> {
        let step =
            step_input(&self.coefficients, self.time_scale, (&self.displacement, &self.coordinates), x);
        self.body.evaluate_external(&step, &mut self.assembly)
    }

    /// Energy dissipated in a solved step: by drag, viscosity and the strain part of the scheme; and by the forces on
    /// the right whose work is lost.
    ///
    /// ```math
    /// sum_i b_i (integral S_i : E'_i dV + alpha/s x_i . M x_i),    -sum_i b_i f_i . x_i
    /// ```
    ///
    /// # Errors
    /// The reason of a force that refuses the step.
    pub(super) fn dissipated(&mut self, x: &[f64]) -> Result<[f64; 2]> {
        if !self.body.dissipates() && self.scheme_force.is_zero() {
            return Ok([0.0; 2]);
        }
        let s = self.time_scale;
        let step = step_input(&self.coefficients, s, (&self.displacement, &self.coordinates), x);
        let mut lost = 0.0;
        if self.body.loss_force(&step, &mut self.assembly, &mut self.force)? {
            let n = self.body.n_dofs();
            let stages = x.chunks_exact(n).zip(self.force.chunks_exact(n));
            let works = stages.map(|(x, force)| self.body.space.dot(force, x));
            lost = -works.zip(self.coefficients.rule.weights()).map(|(work, b)| b * work).sum::<f64>();
        }
        let mut sum = self.body.dissipated(&step, &mut self.assembly);
        if self.drag > 0.0 {
            sum += self.drag / s * self.mean_square(x);
        }
        Ok([sum, lost])
    }

    /// Completes the end velocity by the force of the scheme, and returns the energy dissipated through velocities;
    /// `velocity`: at the start of the step.
    pub(super) fn complete_end_velocity(&mut self, x: &[f64], velocity: &[f64], new: &mut [f64]) -> f64 {
        if self.scheme_force.is_zero() {
            return 0.0;
        }
        self.set_mass_rates(x);
        let s = self.time_scale;
        self.scheme_force.complete_end_velocity(self.body, (x, &self.mass_rates), velocity, s, new)
    }

    /// The step at some rates.
    pub(super) fn step_at<'s>(&'s self, rates: &'s [f64]) -> StepInput<'s> {
        step_input(&self.coefficients, self.time_scale, (&self.displacement, &self.coordinates), rates)
    }

    /// Takes the history variables of forces to the end of the step with some rates.
    pub(super) fn update_history(&self, rates: &[f64], history: &mut [f64]) {
        self.body.update_history(&self.step_at(rates), &self.assembly, history);
    }

    /// Takes the coordinates of the joints to the end of the step with some rates.
    pub(super) fn count_on(&self, rates: &[f64], coordinates: &mut [f64]) {
        self.body.mechanism.count_on((&self.step_at(rates), &self.constraint_step), coordinates);
    }

    /// Strain energy at the start of the step \[energy\].
    pub(super) fn strain_energy_at_start(&self) -> f64 {
        self.body.strain_state_near(&self.displacement, &self.coordinates).strain_energy
    }

    fn set_mass_rates(&mut self, x: &[f64]) {
        if self.coefficients.is_static() {
            return;
        }
        let n = self.body.n_dofs();
        for (x, mass_rate) in x.chunks_exact(n).zip(self.mass_rates.chunks_exact_mut(n)) {
            self.body.mass_product(x, mass_rate);
        }
    }

    /// Assembles the stored forces, and with [`Request::Tangent`] their derivatives and the inertia.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`], and the reasons of other forces.
    pub(super) fn assemble(&mut self, unknowns: &[f64], request: Request) -> Result<()> {
        let [x, _, local] = self.blocks.split(unknowns);
        let step =
            step_input(&self.coefficients, self.time_scale, (&self.displacement, &self.coordinates), x);
        let step = StepInput { local: (!local.is_empty()).then_some(local), ..step };
        self.body.assemble(&step, request, &self.damped_mass, &mut self.assembly)
    }

    /// Adds the derivatives of the forces on the right to the tangent assembled last.
    ///
    /// # Errors
    /// As [`Equations::evaluate_external`].
    pub(super) fn add_external_tangent(&mut self, rates: &[f64]) -> Result<()> {
        let step =
            step_input(&self.coefficients, self.time_scale, (&self.displacement, &self.coordinates), rates);
        self.body.add_external_tangent(&step, &mut self.assembly)
    }

    /// The exact tangent: [`Equations::assemble`], and the derivatives of the forces on the right.
    ///
    /// # Errors
    /// As there.
    pub(super) fn assemble_tangent(&mut self, unknowns: &[f64]) -> Result<()> {
        self.assemble(unknowns, Request::Tangent)?;
        self.add_external_tangent(self.blocks.split(unknowns)[0])
    }

    /// Sets the couplings of the stage matrix to those at other unknowns.
    ///
    /// # Errors
    /// The reason of a force that refuses the step.
    pub(super) fn renew_couplings(&mut self, unknowns: &[f64]) -> Result<()> {
        let rates = self.blocks.split(unknowns)[0];
        let step =
            step_input(&self.coefficients, self.time_scale, (&self.displacement, &self.coordinates), rates);
        self.body.renew_couplings(&step, &mut self.assembly)
    }
}

/// The coefficients of the inertia in two parts, `[i k + j]`.
fn mass_parts<'a>(
    coefficients: &'a StageCoefficients,
    mass: &'a [f64],
) -> impl Iterator<Item = [f64; 2]> + 'a {
    mass.iter().zip(&coefficients.mass_low).map(|(m, low)| coefficients.parts([*m, *low]))
}

pub(super) fn step_input<'a>(
    coefficients: &'a StageCoefficients,
    s: f64,
    (displacement, coordinates): (&'a [f64], &'a [f64]),
    rates: &'a [f64],
) -> StepInput<'a> {
    let dissipation = coefficients.scheme_excess();
    let inverse_step_size = if coefficients.is_static() { 0.0 } else { 1.0 / s };
    let damping = StepDamping { inverse_step_size, dissipation };
    StepInput {
        tangent_factor: s * s,
        coordinates,
        damping,
        ..StepInput::undamped(&coefficients.rule, displacement, rates)
    }
}
