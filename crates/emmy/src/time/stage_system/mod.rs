//! The non-linear equations of a step.

mod at_rates;
mod newton;

use rayon::prelude::*;

use super::Memory;
use super::dissipation::RigidProjection;
use super::linear::{ApproximateTangent, Border};
use super::rigid_step::RigidStep;
use super::stage_coefficients::StageCoefficients;
use crate::average::Request;
use crate::body::{Assembly, Body, Reaction};
use crate::error::{Error, Result};
use crate::force::{Span, StepDamping, StepInput};
use crate::sparse::{Gmres, Solver, SolverChoice};
use crate::unknowns::BorderStep;

/// The stage equations of a body and their memory; a step is set with [`StageSystem::start`].
#[derive(Debug)]
pub(super) struct StageSystem<'a> {
    pub body: &'a Body,
    pub coefficients: StageCoefficients,
    pub assembly: Assembly,
    /// The time s: the step size of a time element.
    pub time_scale: f64,
    /// Displacement at the start of the step, relative to [`super::State::origin`].
    pub displacement: Vec<f64>,
    /// Known part g_i of the inertia.
    pub known: Vec<f64>,
    /// m_ij with the drag, for the time s.
    dragged_mass: Vec<f64>,
    /// The same in [`StageCoefficients::parts`].
    mass_parts: Vec<[f64; 2]>,
    /// In a dissipative scheme: the rigid motions without dissipation, and the momentum at the start of the step.
    projection: Option<RigidProjection>,
    momentum: Vec<f64>,
    /// Rates of the driven degrees of freedom; empty if there are none.
    driven_rates: Vec<f64>,
    force: Vec<f64>,
    /// M x_j of the last residual.
    mass_rates: Vec<f64>,
    /// Squares of its terms, of each chunk of each stage.
    squares: Vec<[f64; 3]>,
    approximate_tangent: ApproximateTangent,
    border: Border,
    /// Forces of constraints in a stage; empty without constraints.
    constraint_force: Vec<f64>,
    gmres: Gmres,
    /// Right side of a correction: of the rates, then of the multipliers.
    negative: Vec<f64>,
    /// Residual with the local unknowns eliminated.
    condensed: Vec<f64>,
    floor: f64,
}

/// Name of the numbers that forces keep.
const FORCES: &str = "forces";

/// Degrees of freedom of one task.
const CHUNK: usize = 4096;

impl<'a> StageSystem<'a> {
    /// The equations with their memory.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`]; on a team [`Error::NotOnTeam`] for a factorisation without engine.
    pub(super) fn new(body: &'a Body, coefficients: StageCoefficients, solver: Solver) -> Result<Self> {
        let n = body.n_dofs();
        let k = coefficients.rule.degree();
        Ok(StageSystem {
            body,
            assembly: body.assembly_of(&coefficients.rule),
            time_scale: 0.0,
            displacement: vec![0.0; n],
            known: vec![0.0; k * n],
            dragged_mass: coefficients.mass.clone(),
            mass_parts: mass_parts(&coefficients, &coefficients.mass).collect(),
            momentum: vec![0.0; if coefficients.dissipation.is_some() { n } else { 0 }],
            projection: coefficients
                .dissipation
                .clone()
                .map(|dissipation| RigidProjection::new(body, dissipation)),
            driven_rates: vec![0.0; if body.is_driven() { k * n } else { 0 }],
            force: vec![0.0; k * n],
            mass_rates: vec![0.0; k * n],
            squares: vec![[0.0; 3]; k * n.div_ceil(CHUNK)],
            approximate_tangent: ApproximateTangent::new(body, &coefficients, solver)?,
            border: Border::new(body, k),
            constraint_force: vec![0.0; if body.constraints().is_empty() { 0 } else { n }],
            gmres: Gmres::default(),
            negative: vec![0.0; k * (n + body.constraints().len())],
            condensed: vec![0.0; if body.n_local() > 0 { k * n } else { 0 }],
            floor: 0.0,
            coefficients,
        })
    }

    /// Sets displacement and time scale of the step. The stepper fills `known` and calls [`StageSystem::begin`].
    pub(super) fn start(&mut self, displacement: &[f64], time_scale: f64) {
        self.displacement.copy_from_slice(displacement);
        self.floor = 0.0;
        if self.time_scale != time_scale && self.body.drag() > 0.0 {
            self.drag(time_scale);
        }
        self.time_scale = time_scale;
    }

    /// Evaluates what is given over time in the step. Returns whether some force does work from outside.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(super) fn begin(&mut self, span: Span) -> Result<bool> {
        let StageCoefficients { rule, sampling, .. } = &self.coefficients;
        self.body.begin(rule, (span, *sampling), &mut self.assembly)
    }

    /// Sets the coefficients of the inertia for a body with drag.
    fn drag(&mut self, time_scale: f64) {
        let k = self.coefficients.rule.degree();
        self.dragged_mass.copy_from_slice(&self.coefficients.mass);
        (0..k).for_each(|i| self.dragged_mass[i * k + i] += time_scale * self.body.drag());
        let parts = mass_parts(&self.coefficients, &self.dragged_mass);
        self.mass_parts.iter_mut().zip(parts).for_each(|(own, parts)| *own = parts);
    }

    /// Sets the momentum at the start of the step, for a dissipative scheme.
    pub(super) fn set_momentum(&mut self, momentum: &[f64]) {
        if self.projection.is_some() {
            self.momentum.copy_from_slice(momentum);
        }
    }

    /// Sets the rates of the driven degrees of freedom in the step.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(super) fn set_driven_rates(&mut self, time: f64, step_size: f64) -> Result<()> {
        let rule = &self.coefficients.rule;
        self.body.space.driven_rates(rule, time, step_size, &self.displacement, &mut self.driven_rates)
    }

    /// Inserts the rates of the driven degrees of freedom into a starting point of the iteration.
    pub(super) fn drive(&self, rates: &mut [f64]) {
        let n = self.body.n_dofs();
        for (rates, driven) in rates.chunks_exact_mut(n).zip(self.driven_rates.chunks_exact(n)) {
            self.body.space.driven_dofs().for_each(|dof| rates[dof] = driven[dof]);
        }
    }

    /// Number of local unknowns of a step.
    pub(super) fn n_local(&self) -> usize {
        self.body.n_local() * self.coefficients.rule.n_pressures()
    }

    /// Number of rates.
    pub(super) fn n_rates(&self) -> usize {
        self.force.len()
    }

    /// Number of all unknowns.
    pub(super) fn n_unknowns(&self) -> usize {
        self.n_rates() + self.n_multipliers() + self.n_local()
    }

    /// Number of multipliers of constraints in a step.
    pub(super) fn n_multipliers(&self) -> usize {
        self.coefficients.rule.degree() * self.body.constraints().len()
    }

    /// The rates among the unknowns, the multipliers after them, `[k][n]`, then the local unknowns, `[function][n]`.
    pub(super) fn split<'x>(&self, unknowns: &'x [f64]) -> [&'x [f64]; 3] {
        let (rates, others) = unknowns.split_at(self.force.len());
        let (multipliers, local) = others.split_at(self.n_multipliers());
        [rates, multipliers, local]
    }

    /// The same of a vector that changes.
    fn split_mut<'x>(&self, unknowns: &'x mut [f64]) -> [&'x mut [f64]; 3] {
        let (rates, others) = unknowns.split_at_mut(self.force.len());
        let (multipliers, local) = others.split_at_mut(self.n_multipliers());
        [rates, multipliers, local]
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

    /// Residual on all degrees of freedom, fixed ones included (there it is s^2 times the reaction), then the local unknowns of
    /// the step less those of its rates; and the squares of the three parts of the first over the free ones of this rank.
    pub(super) fn full_residual(&mut self, unknowns: &[f64], residual: &mut [f64]) -> Result<[f64; 3]> {
        self.assemble(unknowns, Request::Stress)?;
        let [x, multipliers, local] = self.split(unknowns);
        let [residual, of_constraints, of_local] = self.split_mut(residual);
        self.body.copy_local(&self.assembly, of_local);
        of_local.iter_mut().zip(local).for_each(|(r, value)| *r = value - *r);
        self.assembly.matrix.copy_force(&mut self.force);
        self.evaluate_external(x)?;
        let n = self.body.n_dofs();
        let k = self.coefficients.rule.degree();
        let s = self.time_scale;
        self.set_mass_rates(x);
        let StageSystem { body, force, mass_rates, known, assembly, squares, .. } = self;
        let mass_parts = &self.mass_parts;
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
        if let Some(projection) = &mut self.projection {
            projection.set(body, x, &self.mass_rates, &self.momentum, s);
            projection.add_to_residual(s, residual);
        }
        let [inertia, internal, external] =
            [0, 1, 2].map(|part| squares.iter().map(|squares| squares[part]).sum::<f64>());
        let of_joints = self.add_constraints(x, multipliers, residual, of_constraints);
        Ok([inertia, internal + of_joints, external])
    }

    /// Adds the forces of constraints to the residual of the rates, and sets their own. Returns the square of the forces.
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
        let mut force = std::mem::take(&mut self.constraint_force);
        let step = self.border_step(x);
        constraints.set_residual(step, of_constraints);
        let n = self.body.n_dofs();
        let mut square = 0.0;
        for (i, residual) in residual.chunks_exact_mut(n).enumerate() {
            force.fill(0.0);
            constraints.add_force(step, i, (1.0, multipliers), &mut force);
            residual.iter_mut().zip(&force).for_each(|(r, f)| *r += f);
            let free = force.iter().zip(self.body.fixed()).filter(|(_, fixed)| !**fixed);
            square += free.map(|(f, _)| f * f).sum::<f64>();
        }
        self.constraint_force = force;
        square
    }

    /// The step at some rates, as constraints see it.
    fn border_step<'s>(&'s self, rates: &'s [f64]) -> BorderStep<'s> {
        BorderStep { rule: &self.coefficients.rule, displacement: &self.displacement, rates }
    }

    /// Adds the force of the constraints on the body in a stage, `force: [n_nodes][3]`.
    pub(super) fn add_constraint_force(&self, unknowns: &[f64], stage: usize, force: &mut [f64]) {
        let [x, multipliers, _] = self.split(unknowns);
        let factor = -1.0 / (self.time_scale * self.time_scale);
        self.body.constraints().add_force(self.border_step(x), stage, (factor, multipliers), force);
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
        self.set_mass_rates(x);
        let n = self.body.n_dofs();
        let k = self.coefficients.rule.degree();
        let s = self.time_scale;
        for (i, residual) in residual.chunks_exact_mut(n).enumerate() {
            let mass = &self.dragged_mass[i * k..(i + 1) * k];
            for (dof, residual) in residual.iter_mut().enumerate() {
                let inertia: f64 = (0..k).map(|j| mass[j] * self.mass_rates[j * n + dof]).sum();
                *residual = inertia - self.known[i * n + dof] - s * s * self.external_force(i * n + dof);
            }
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

    /// Strain energy caused by rounding of the displacements in the step.
    pub(super) fn rounding_energy(&self, x: &[f64]) -> f64 {
        self.approximate_tangent.rounding_energy(self.body, &self.displacement, &x[..self.body.n_dofs()])
    }

    /// Whether the internal forces have neither a resultant nor a moment in any stage, so that inertia and loads alone
    /// determine the rigid motion of the body.
    pub(super) fn is_self_balanced(&self) -> bool {
        self.coefficients.rule.is_energy_momentum()
            && self.coefficients.dissipation.is_none()
            && !self.body.has_ground()
            && !self.body.constraints().is_grounded()
    }

    /// Stage averages of the force on the ground, on all degrees of freedom.
    pub(super) fn ground_force(&mut self, x: &[f64], force: &mut [f64]) -> Result<()> {
        let step = StepInput::undamped(&self.coefficients.rule, &self.displacement, x);
        self.body.ground_force(&step, &mut self.assembly, force)
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
        self.body.add_spring_reactions(&step, stage, weight, displacement, reactions);
    }

    /// Stage average of the forces that do work from outside, at the rates evaluated last; `at`: position in
    /// `[k][n_nodes][3]`.
    pub(super) fn external_force(&self, at: usize) -> f64 {
        self.assembly.external(at)
    }

    /// Evaluates these forces at the rates x.
    ///
    /// # Errors
    /// The reason of a force that refuses the step.
    pub(super) fn evaluate_external(&mut self, x: &[f64]) -> Result<()> {
        let step = step_input(&self.coefficients, self.time_scale, &self.displacement, x);
        self.body.evaluate_external(&step, &mut self.assembly)
    }

    /// Whether the body dissipates energy, by drag, viscosity or the scheme.
    pub(super) fn is_braked(&self) -> bool {
        self.body.dissipates() || self.coefficients.dissipation.is_some()
    }

    /// Energy dissipated by drag, viscosity and the strain part of the scheme in a solved step.
    ///
    /// ```math
    /// sum_i b_i (integral S_i : E'_i dV + alpha/s x_i . M x_i)
    /// ```
    pub(super) fn dissipated(&mut self, x: &[f64]) -> f64 {
        let s = self.time_scale;
        let drag = self.body.drag();
        let step = step_input(&self.coefficients, s, &self.displacement, x);
        let mut sum = self.body.dissipated(&step, &mut self.assembly);
        if drag > 0.0 {
            sum += drag / s * self.mean_square(x);
        }
        sum
    }

    /// Force of the drag in a stage, on all degrees of freedom, after [`StageSystem::dissipated`].
    pub(super) fn drag_force(&self, at: usize) -> f64 {
        match self.body.drag() {
            0.0 => 0.0,
            drag => -drag / self.time_scale * self.mass_rates[at],
        }
    }

    /// Completes the end velocity of a dissipative scheme and returns the energy dissipated through velocities;
    /// `velocity`: at the start of the step.
    pub(super) fn complete_end_velocity(&mut self, x: &[f64], velocity: &[f64], new: &mut [f64]) -> f64 {
        if self.projection.is_none() {
            return 0.0;
        }
        self.set_mass_rates(x);
        self.projection.as_mut().map_or(0.0, |projection| {
            projection.set(self.body, x, &self.mass_rates, &self.momentum, self.time_scale);
            projection.complete_end_velocity(self.body, x, velocity, self.time_scale, new)
        })
    }

    /// The step at some rates.
    fn step_at<'s>(&'s self, rates: &'s [f64]) -> StepInput<'s> {
        step_input(&self.coefficients, self.time_scale, &self.displacement, rates)
    }

    /// Tells the forces that the step with some rates counts.
    pub(super) fn accept(&mut self, rates: &[f64]) {
        let step = step_input(&self.coefficients, self.time_scale, &self.displacement, rates);
        self.body.accept(&step, &mut self.assembly);
    }

    fn set_mass_rates(&mut self, x: &[f64]) {
        let n = self.body.n_dofs();
        for (x, mass_rate) in x.chunks_exact(n).zip(self.mass_rates.chunks_exact_mut(n)) {
            self.body.mass_product(x, mass_rate);
        }
    }

    fn assemble(&mut self, unknowns: &[f64], request: Request) -> Result<()> {
        let [x, _, local] = self.split(unknowns);
        let step = step_input(&self.coefficients, self.time_scale, &self.displacement, x);
        let step = StepInput { local: (!local.is_empty()).then_some(local), ..step };
        self.body.assemble(&step, request, &self.dragged_mass, &mut self.assembly)?;
        if request == Request::Tangent {
            self.body.add_external_tangent(&step, &mut self.assembly)?;
        }
        Ok(())
    }

    /// Rotates the approximate tangent with the body in the present step.
    pub(super) fn turn(&mut self, rotation: &RigidStep) {
        self.approximate_tangent.turn(rotation, &self.coefficients.rule);
        self.border.forget();
    }

    /// Keeps the memory that the next steps depend on.
    pub(super) fn keep(&self, memory: &mut Memory) {
        self.approximate_tangent.keep(memory);
        let of_forces = self.body.saved_by_forces(&self.assembly);
        if !of_forces.is_empty() {
            memory.keep(FORCES, &of_forces);
        }
    }

    /// Restores the data of [`StageSystem::keep`].
    ///
    /// # Errors
    /// [`Error::Memory`], [`Error::Inverted`], [`Error::Linear`].
    pub(super) fn restore(&mut self, memory: &Memory) -> Result<()> {
        let of_forces = memory.list(FORCES).unwrap_or_default();
        if !self.body.restore_forces(&self.coefficients.rule, &mut self.assembly, of_forces) {
            let reason = format!("has {} numbers, which do not fit the forces", of_forces.len());
            return Err(Error::Memory { name: FORCES.to_string(), reason });
        }
        self.approximate_tangent.restore(self.body, memory)
    }

    /// The linear solver, once there is one.
    pub(super) fn solver(&self) -> Option<SolverChoice> {
        self.approximate_tangent.choice()
    }
}

/// The coefficients of the inertia in two parts, `[i k + j]`.
fn mass_parts<'a>(
    coefficients: &'a StageCoefficients,
    mass: &'a [f64],
) -> impl Iterator<Item = [f64; 2]> + 'a {
    mass.iter().zip(&coefficients.mass_low).map(|(m, low)| coefficients.parts([*m, *low]))
}

fn step_input<'a>(
    coefficients: &'a StageCoefficients,
    s: f64,
    displacement: &'a [f64],
    rates: &'a [f64],
) -> StepInput<'a> {
    let dissipation = coefficients.dissipation.as_ref().map_or(0.0, |dissipation| dissipation.excess);
    let damping = StepDamping { inverse_step_size: 1.0 / s, dissipation };
    StepInput {
        tangent_factor: s * s,
        damping,
        ..StepInput::undamped(&coefficients.rule, displacement, rates)
    }
}
