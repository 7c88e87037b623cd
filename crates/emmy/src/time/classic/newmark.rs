//! Newmark's family: Newmark, Hilber-Hughes-Taylor and generalized-alpha are one method with four parameters.

use super::forces::{Forces, Start, TimePoint};
use super::{configurations, stage_form};
use crate::body::Body;
use crate::error::Result;
use crate::newton::NewtonSettings;
use crate::time::iteration::Iteration;
use crate::time::stage_system::StageSystem;
use crate::time::{Impulses, Memory, Scheme, State, StepOutcome, Stepper};

/// Parameters of the family.
///
/// ```math
/// M ((1 - alpha_m) a_2 + alpha_m a_1) + (1 - alpha_f) (f - F)_2 + alpha_f (f - F)_1 = 0
/// u_2 = u_1 + h v_1 + h^2 ((1/2 - beta) a_1 + beta a_2),     v_2 = v_1 + h ((1 - gamma) a_1 + gamma a_2)
/// ```
///
/// (Chung and Hulbert 1993; the internal force is averaged, not evaluated at an averaged displacement.)
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewmarkParameters {
    /// Part of the old inertia.
    pub alpha_m: f64,
    /// Part of the old forces.
    pub alpha_f: f64,
    /// Weight of the new acceleration in the displacement.
    pub beta: f64,
    /// Weight of the new acceleration in the velocity.
    pub gamma: f64,
}

impl NewmarkParameters {
    /// Parameters of a scheme; `None` if it is not of the family.
    ///
    /// `HHT(alpha)`: alpha_f = alpha, gamma = 1/2 + alpha, beta = (1 + alpha)^2/4 (Hilber, Hughes and Taylor 1977).
    /// `generalized-alpha(rho)`: alpha_m = (2 rho - 1)/(rho + 1), alpha_f = rho/(rho + 1) (Chung and Hulbert (1993),
    /// equation (25)), gamma and beta as in equations (17) and (20).
    ///
    /// ```
    /// use emmy::time::{NewmarkParameters, Scheme};
    /// let parameters = NewmarkParameters::of(Scheme::GeneralizedAlpha { spectral_radius: 1.0 }).unwrap();
    /// assert_eq!((parameters.alpha_m, parameters.alpha_f), (0.5, 0.5));
    /// assert_eq!((parameters.beta, parameters.gamma), (0.25, 0.5));
    /// ```
    pub fn of(scheme: Scheme) -> Option<Self> {
        let second_order = |alpha_m: f64, alpha_f: f64| {
            let sum = 1.0 - alpha_m + alpha_f;
            NewmarkParameters { alpha_m, alpha_f, beta: 0.25 * sum * sum, gamma: sum - 0.5 }
        };
        match scheme {
            Scheme::Newmark { beta, gamma } => {
                Some(NewmarkParameters { alpha_m: 0.0, alpha_f: 0.0, beta, gamma })
            }
            Scheme::HilberHughesTaylor { alpha } => Some(second_order(0.0, alpha)),
            Scheme::GeneralizedAlpha { spectral_radius: rho } => {
                Some(second_order((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)))
            }
            _ => None,
        }
    }
}

/// Stepper of Newmark's family. For the increment `x = u_2 - u_1`, with `c = (1 - alpha_m)/beta`,
///
/// ```math
/// c M x - c h p_1 - h^2 (c (1/2 - beta) - alpha_m) M a_1 + h^2 (f - F)_(2 - alpha_f) = 0
/// ```
///
/// The acceleration is the stepper's memory. At the start it is that of the equation of motion, `M a = F - f(u)`, with the
/// consistent mass.
#[derive(Debug)]
pub struct NewmarkStepper<'a> {
    parameters: NewmarkParameters,
    system: StageSystem<'a>,
    iteration: Iteration,
    forces: Forces<'a>,
    acceleration: Vec<f64>,
    /// M a.
    inertia: Vec<f64>,
    /// Dead loads at the start of the step.
    old_load: Vec<f64>,
    start: TimePoint,
    end: TimePoint,
}

impl<'a> NewmarkStepper<'a> {
    /// The stepper of a state.
    ///
    /// # Errors
    /// [`crate::Error::Linear`], [`crate::Error::Inverted`].
    pub fn new(
        body: &'a Body,
        parameters: NewmarkParameters,
        settings: NewtonSettings,
        state: &State,
    ) -> Result<Self> {
        let NewmarkParameters { alpha_m, alpha_f, beta, .. } = parameters;
        let rule = match alpha_f {
            0.0 => configurations(&[(1.0, 1.0)]),
            _ => configurations(&[(1.0, 1.0 - alpha_f), (0.0, alpha_f)]),
        };
        let mut forces = Forces::new(body);
        let Start { acceleration, inertia, point } = Start::new(&mut forces, state)?;
        let n = body.n_dofs();
        let system =
            StageSystem::new(body, stage_form(rule, (1.0 - alpha_m) / beta, 1.0 - alpha_f), settings.solver)?;
        Ok(NewmarkStepper {
            parameters,
            iteration: Iteration::new(&system.form, n, settings),
            system,
            forces,
            acceleration,
            inertia,
            old_load: vec![0.0; n],
            start: point,
            end: TimePoint::new(n),
        })
    }

    /// Sets the equations of the step.
    fn start(&mut self, state: &State, h: f64) {
        let NewmarkParameters { alpha_m, alpha_f, beta, .. } = self.parameters;
        let (system, body) = (&mut self.system, self.forces.body);
        system.start(&state.displacement, h);
        let c = (1.0 - alpha_m) / beta;
        let of_inertia = h * h * (c * (0.5 - beta) - alpha_m);
        let known = system.known.iter_mut().zip(state.momentum.iter().zip(&self.inertia));
        known.for_each(|(g, (p, ma))| *g = c * h * p + of_inertia * ma);
        system.followers.sample(body, state.time, h);
        body.loads_at(state.time, &mut self.old_load);
        body.loads_at(state.time + h, &mut system.dead_load);
        let loads = system.dead_load.iter_mut().zip(&self.old_load);
        loads.for_each(|(new, old)| *new = (1.0 - alpha_f) * *new + alpha_f * *old);
    }

    /// Forces at the end of the step.
    fn evaluate_end(&mut self, state: &State, h: f64) -> Result<()> {
        let old = state.displacement.iter().zip(&self.iteration.rates);
        self.end.displacement.iter_mut().zip(old).for_each(|(new, (u, x))| *new = u + x);
        self.end.evaluate_for_reactions(&mut self.forces, state.time + h)
    }

    /// The state at the end of the step; `u_2 = u_1 + x` gives a_2, a_2 gives v_2.
    fn update(&mut self, state: &mut State, h: f64) {
        let NewmarkParameters { beta, gamma, .. } = self.parameters;
        let body = self.forces.body;
        for (dof, x) in self.iteration.rates.iter().enumerate() {
            let (v, a) = (state.velocity[dof], self.acceleration[dof]);
            let new = (x - h * v) / (beta * h * h) - (0.5 - beta) / beta * a;
            state.velocity[dof] = v + h * ((1.0 - gamma) * a + gamma * new);
            self.acceleration[dof] = new;
        }
        state.displacement.copy_from_slice(&self.end.displacement);
        body.mass_product(&state.velocity, &mut state.momentum);
        body.mass_product(&self.acceleration, &mut self.inertia);
    }

    /// Work and impulses with the weights 1 - gamma at the start and gamma at the end: those of the velocity.
    fn impulses(&mut self, h: f64) -> Impulses {
        let (body, gamma, x) = (self.forces.body, self.parameters.gamma, &self.iteration.rates);
        self.end.set_reactions(body, &self.inertia);
        let mut impulses = Impulses::default();
        self.start.add_to(&mut impulses, body, 1.0 - gamma, h, x);
        self.end.add_to(&mut impulses, body, gamma, h, x);
        impulses
    }
}

impl Stepper for NewmarkStepper<'_> {
    fn advance(&mut self, state: &mut State, step_size: f64) -> Result<StepOutcome> {
        self.start(state, step_size);
        let newton = self.iteration.solve(&mut self.system, state, step_size, None)?;
        self.evaluate_end(state, step_size)?;
        self.iteration.remember(&self.system.form, step_size);
        self.update(state, step_size);
        let impulses = self.impulses(step_size);
        std::mem::swap(&mut self.start, &mut self.end);
        let strained = self.system.body.strained(&state.displacement);
        Ok(StepOutcome { newton, impulses, strained, solver: self.system.solver() })
    }

    fn newton_history(&self) -> &[f64] {
        self.iteration.history()
    }

    fn memory(&self) -> Memory {
        let mut memory = Memory::default();
        self.iteration.keep(&mut memory);
        self.system.keep(&mut memory);
        memory.keep("acceleration", &self.acceleration);
        memory.keep("inertia", &self.inertia);
        self.start.keep(&mut memory);
        memory
    }

    fn restore(&mut self, memory: &Memory) -> Result<()> {
        self.iteration.restore(memory)?;
        self.system.restore(memory)?;
        memory.fill("acceleration", &mut self.acceleration)?;
        memory.fill("inertia", &mut self.inertia)?;
        self.start.restore(memory)
    }
}
