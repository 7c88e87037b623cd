//! Bathe's composite method: trapezoidal rule, then the three-point backward Euler method.

use super::forces::{Forces, Start, TimePoint, sum_reactions};
use super::{configurations, stage_coefficients};
use crate::body::{Body, Reaction};
use crate::error::Result;
use crate::input::Span;
use crate::newton::{NewtonSettings, Outcome};
use crate::time::implicit::ImplicitStep;
use crate::time::{Impulses, Memory, State, StepOutcome, Stepper};

/// Fraction of the step at which it is split: 2 - sqrt 2.
const SPLIT: f64 = 2.0 - std::f64::consts::SQRT_2;

/// Weights of the forces at the start, at the split and at the end in the new velocity.
///
/// From `v_s = v_1 + (gamma h/2) (a_1 + a_s)` and `a_2 = c_1 v_1 + c_2 v_s + c_3 v_2` with `c_1 + c_2 + c_3 = 0`.
const WEIGHTS: [f64; 3] = [0.5 / (2.0 - SPLIT), 0.5 / (2.0 - SPLIT), (1.0 - SPLIT) / (2.0 - SPLIT)];

/// Stepper of Bathe's method, for the step split at `gamma = 2 - sqrt 2`. With x the increment of each part,
///
/// ```math
/// M x - gamma h M v_1 - s^2 M a_1 + s^2 (f - F)_s = 0,                       s = gamma h/2
/// M x - s^2 M (c_1 c_3 (u_s - u_1) - c_1 v_1 - c_2 v_s) + s^2 (f - F)_2 = 0
/// c_1 = (1 - gamma)/(gamma h),    c_2 = -1/((1 - gamma) gamma h),    c_3 = (2 - gamma)/((1 - gamma) h) = 1/s
/// ```
///
/// (Bathe and Baig (2005), who take gamma = 1/2; as here, one matrix `M + s^2 K` serves both parts: Bank and others
/// (1985).) The second part starts from the displacement u_s.
#[derive(Debug)]
pub struct BatheStepper<'a> {
    step: ImplicitStep<'a>,
    forces: Forces<'a>,
    /// Acceleration, M a and forces at the start of the step.
    start: Start,
    /// Increment of the whole step.
    increment: Vec<f64>,
    work: Vec<f64>,
    /// State at the split; its momentum is not used.
    split: State,
    /// At the split and at the end.
    points: [TimePoint; 2],
    reactions: Vec<Reaction>,
}

impl<'a> BatheStepper<'a> {
    /// The stepper of a state.
    ///
    /// # Errors
    /// [`crate::Error::Linear`], [`crate::Error::Inverted`].
    pub fn new(body: &'a Body, settings: NewtonSettings, state: &State) -> Result<Self> {
        let mut forces = Forces::new(body);
        let start = Start::new(&mut forces, state)?;
        let n = body.n_dofs();
        let coefficients = stage_coefficients(configurations(&[(1.0, 1.0)]), 1.0, 1.0);
        Ok(BatheStepper {
            step: ImplicitStep::new(body, coefficients, settings)?,
            forces,
            start,
            increment: vec![0.0; n],
            work: vec![0.0; n],
            split: state.clone(),
            points: [(); 2].map(|()| TimePoint::new(body)),
            reactions: body.space.no_reactions(),
        })
    }

    /// Trapezoidal rule up to the split.
    fn first_part(&mut self, state: &State, h: f64) -> Result<Outcome> {
        let s = 0.5 * SPLIT * h;
        let part = SPLIT * h;
        self.step.system.start(&state.displacement, s);
        let known =
            self.step.system.equations.known.iter_mut().zip(state.momentum.iter().zip(&self.start.inertia));
        known.for_each(|(g, (p, ma))| *g = part * p + s * s * ma);
        self.step.equations().begin(Span::new(state.time, part), state)?;
        let outcome = self.step.solve(state, part, None)?;
        self.step.remember(part);
        self.split.time = state.time + part;
        self.split.step = state.step;
        for (dof, x) in self.step.rates().iter().enumerate() {
            self.increment[dof] = *x;
            self.split.displacement[dof] = state.displacement[dof] + x;
            self.split.velocity[dof] = x / s - state.velocity[dof];
        }
        let body = self.forces.body;
        body.space.set_internal_velocity(&[1.0], self.step.rates(), part, &mut self.split.velocity);
        self.points[0].displacement.copy_from_slice(&self.split.displacement);
        self.points[0].evaluate_for_reactions(&mut self.forces, self.split.time)?;
        Ok(outcome)
    }

    /// Three-point backward Euler from the split to the end.
    fn second_part(&mut self, state: &State, h: f64) -> Result<Outcome> {
        let s = 0.5 * SPLIT * h;
        let [c_1, c_2, c_3] = backward_coefficients(h);
        self.step.system.start(&self.split.displacement, s);
        for (dof, work) in self.work.iter_mut().enumerate() {
            let old = c_1 * state.velocity[dof] + c_2 * self.split.velocity[dof];
            *work = s * s * (c_1 * c_3 * self.increment[dof] - old);
        }
        self.forces.body.mass_product(&self.work, &mut self.step.equations().known);
        let part = (1.0 - SPLIT) * h;
        let span = Span { start: self.split.time, size: part, end: state.time + h };
        self.step.equations().begin(span, state)?;
        let outcome = self.step.solve(&self.split, part, None)?;
        self.step.remember(part);
        let end = &mut self.points[1];
        let parts = self.split.displacement.iter().zip(self.step.rates());
        end.displacement.iter_mut().zip(parts).for_each(|(u, (split, x))| *u = split + x);
        end.evaluate_for_reactions(&mut self.forces, state.time + h)?;
        Ok(outcome)
    }

    /// Reactions at the split, which need `M a_s`; `a_s = (v_s - v_1)/s - a_1`.
    fn set_reactions_at_split(&mut self, state: &State, h: f64) {
        let s = 0.5 * SPLIT * h;
        for (dof, work) in self.work.iter_mut().enumerate() {
            let change = self.split.velocity[dof] - state.velocity[dof];
            *work = change / s - self.start.acceleration[dof];
        }
        self.forces.body.mass_product(&self.work, &mut self.start.inertia);
        self.points[0].set_reactions(self.forces.body, &self.start.inertia);
    }

    /// The state at the end of the step: `v_2 = c_3 x - c_1 (u_s - u_1)` and `a_2 = c_1 v_1 + c_2 v_s + c_3 v_2`.
    fn update(&mut self, state: &mut State, h: f64) {
        let body = self.forces.body;
        let [c_1, c_2, c_3] = backward_coefficients(h);
        for (dof, x) in self.step.rates().iter().enumerate() {
            let old = state.velocity[dof];
            let split = self.split.velocity[dof];
            let new = c_3 * x - c_1 * self.increment[dof];
            state.velocity[dof] = new;
            self.start.acceleration[dof] = c_1 * old + c_2 * split + c_3 * new;
            self.increment[dof] += x;
        }
        self.start.acceleration[body.space.internal_dofs()].fill(0.0);
        body.space.set_internal_velocity(&[1.0], &self.increment, h, &mut state.velocity);
        state.displacement.copy_from_slice(&self.points[1].displacement);
        body.mass_product(&state.velocity, &mut state.momentum);
        body.mass_product(&self.start.acceleration, &mut self.start.inertia);
        self.points[1].set_reactions(body, &self.start.inertia);
    }
}

/// Coefficients c_1, c_2, c_3 of the three-point backward difference at the end of the step.
fn backward_coefficients(h: f64) -> [f64; 3] {
    let rest = 1.0 - SPLIT;
    [rest / (SPLIT * h), -1.0 / (rest * SPLIT * h), (2.0 - SPLIT) / (rest * h)]
}

impl Stepper for BatheStepper<'_> {
    fn advance(&mut self, state: &mut State, step_size: f64) -> Result<StepOutcome> {
        let first = self.first_part(state, step_size)?;
        let second = self.second_part(state, step_size)?;
        self.set_reactions_at_split(state, step_size);
        self.update(state, step_size);
        let mut impulses = Impulses::default();
        let points = || std::iter::once(&self.start.point).chain(&self.points).zip(WEIGHTS);
        for (point, weight) in points() {
            point.add_to(&mut impulses, self.forces.body, weight, step_size, &self.increment);
        }
        sum_reactions(points(), &mut self.reactions);
        std::mem::swap(&mut self.start.point, &mut self.points[1]);
        let newton = Outcome {
            iterations: first.iterations + second.iterations,
            linear_iterations: first.linear_iterations + second.linear_iterations,
            refactorizations: first.refactorizations + second.refactorizations,
            took_exact_tangent: first.took_exact_tangent || second.took_exact_tangent,
            at_rounding_floor: first.at_rounding_floor || second.at_rounding_floor,
            rounding: first.rounding + second.rounding,
            ..second
        };
        let strain_state = self.forces.body.strain_state(&state.displacement);
        Ok(StepOutcome { newton, impulses, strain_state, solver: self.step.solver() })
    }

    fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

    /// Weights of the second part.
    fn newton_history(&self) -> &[f64] {
        self.step.history()
    }

    fn memory(&self) -> Memory {
        let mut memory = self.step.memory();
        self.start.save(&mut memory);
        memory
    }

    fn restore(&mut self, memory: &Memory) -> Result<()> {
        self.step.restore(memory)?;
        self.start.restore(memory)
    }
}
