//! Newmark's family: Newmark, Hilber-Hughes-Taylor and generalized-alpha are one method with four parameters.

use super::forces::{Forces, Start, TimePoint, sum_reactions};
use super::{configurations, stage_coefficients};
use crate::body::{Body, Reaction};
use crate::error::{Error, Result};
use crate::input::Span;
use crate::newton::NewtonSettings;
use crate::time::implicit::ImplicitStep;
use crate::time::time_element::{check_spectral_radius, named};
use crate::time::{Impulses, Memory, State, StepOutcome, Stepper};

/// A method of Newmark's family.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NewmarkFamily {
    /// `Newmark(beta, gamma)` (Newmark 1959): 0 < beta <= 1, 1/2 <= gamma <= 1. Second order for gamma = 1/2;
    /// unconditionally stable for a linear body if 2 beta >= gamma.
    Newmark {
        /// Weight of the new acceleration in the displacement.
        beta: f64,
        /// Weight of the new acceleration in the velocity.
        gamma: f64,
    },
    /// `HHT(alpha)` (Hilber, Hughes and Taylor 1977), 0 <= alpha <= 1/3: the forces are evaluated at `1 - alpha` of the
    /// step. The authors' alpha has the opposite sign.
    HilberHughesTaylor {
        /// Dissipation of the high modes; 0 is the average acceleration method.
        alpha: f64,
    },
    /// `generalized-alpha(rho)` (Chung and Hulbert 1993), 0 <= rho <= 1.
    GeneralizedAlpha {
        /// Spectral radius at infinite frequency: 1 for no dissipation, 0 for the strongest.
        spectral_radius: f64,
    },
}

impl NewmarkFamily {
    /// Its scheme as written in an input: `HHT(0.05)`.
    pub fn name(self) -> String {
        match self {
            NewmarkFamily::Newmark { beta, gamma } => named("Newmark", [beta, gamma]),
            NewmarkFamily::HilberHughesTaylor { alpha } => named("HHT", [alpha]),
            NewmarkFamily::GeneralizedAlpha { spectral_radius } => {
                named("generalized-alpha", [spectral_radius])
            }
        }
    }

    /// Checks the range of the numbers.
    ///
    /// # Errors
    /// [`Error::Scheme`].
    pub fn check(self) -> Result<()> {
        let fail = |reason: &str| Err(reason.to_string());
        let checked = match self {
            NewmarkFamily::Newmark { beta: 0.0, .. } => {
                fail("beta must be in (0, 1]; beta = 0 is explicit: central-differences")
            }
            NewmarkFamily::Newmark { beta, .. } if !(beta > 0.0 && beta <= 1.0) => {
                fail("beta must be in (0, 1]")
            }
            NewmarkFamily::Newmark { gamma, .. } if !(0.5..=1.0).contains(&gamma) => {
                fail("gamma must be in [0.5, 1]: below 0.5 every motion grows")
            }
            NewmarkFamily::HilberHughesTaylor { alpha } if !(0.0..=1.0 / 3.0).contains(&alpha) => fail(
                "alpha must be in [0, 1/3]; it is counted positive: HHT(0.05) is alpha = -0.05 of the authors",
            ),
            NewmarkFamily::GeneralizedAlpha { spectral_radius } => check_spectral_radius(spectral_radius),
            NewmarkFamily::Newmark { .. } | NewmarkFamily::HilberHughesTaylor { .. } => Ok(()),
        };
        checked.map_err(|reason| Error::Scheme { scheme: self.name(), reason })
    }

    /// Its parameters.
    ///
    /// `HHT(alpha)`: alpha_f = alpha, gamma = 1/2 + alpha, beta = (1 + alpha)^2/4 (Hilber, Hughes and Taylor 1977).
    /// `generalized-alpha(rho)`: alpha_m = (2 rho - 1)/(rho + 1), alpha_f = rho/(rho + 1) (Chung and Hulbert (1993),
    /// equation (25)), gamma and beta as in equations (17) and (20).
    ///
    /// ```
    /// use emmy::time::NewmarkFamily;
    /// let parameters = NewmarkFamily::GeneralizedAlpha { spectral_radius: 1.0 }.parameters();
    /// assert_eq!((parameters.alpha_m, parameters.alpha_f), (0.5, 0.5));
    /// assert_eq!((parameters.beta, parameters.gamma), (0.25, 0.5));
    /// ```
    pub fn parameters(self) -> NewmarkParameters {
        let second_order = |alpha_m: f64, alpha_f: f64| {
            let sum = 1.0 - alpha_m + alpha_f;
            NewmarkParameters { alpha_m, alpha_f, beta: 0.25 * sum * sum, gamma: sum - 0.5 }
        };
        match self {
            NewmarkFamily::Newmark { beta, gamma } => {
                NewmarkParameters { alpha_m: 0.0, alpha_f: 0.0, beta, gamma }
            }
            NewmarkFamily::HilberHughesTaylor { alpha } => second_order(0.0, alpha),
            NewmarkFamily::GeneralizedAlpha { spectral_radius: rho } => {
                second_order((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0))
            }
        }
    }
}

/// Parameters of the family.
///
/// ```math
/// M ((1 - alpha_m) a_2 + alpha_m a_1) + (1 - alpha_f) (f - F)_2 + alpha_f (f - F)_1 = 0
/// u_2 = u_1 + h v_1 + h^2 ((1/2 - beta) a_1 + beta a_2),     v_2 = v_1 + h ((1 - gamma) a_1 + gamma a_2)
/// ```
///
/// (Chung and Hulbert 1993; the internal force is averaged, not evaluated at an averaged displacement.)
///
/// ```
/// use emmy::time::NewmarkParameters;
/// // The average acceleration method.
/// let newmark = NewmarkParameters { alpha_m: 0.0, alpha_f: 0.0, beta: 0.25, gamma: 0.5 };
/// assert_eq!(newmark.beta, 0.25 * (newmark.gamma + 0.5f64).powi(2));
/// ```
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

/// Stepper of Newmark's family. For the increment `x = u_2 - u_1`, with `c = (1 - alpha_m)/beta`,
///
/// ```math
/// c M x - c h p_1 - h^2 (c (1/2 - beta) - alpha_m) M a_1 + h^2 (f - F)_(2 - alpha_f) = 0
/// ```
///
/// The acceleration is the stepper's memory. At the start it follows from the equation of motion, `M a = F - f(u)`,
/// with the consistent mass.
#[derive(Debug)]
pub struct NewmarkStepper<'a> {
    parameters: NewmarkParameters,
    step: ImplicitStep<'a>,
    forces: Forces<'a>,
    /// Acceleration, M a and forces at the start of the step.
    start: Start,
    end: TimePoint,
    reactions: Vec<Reaction>,
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
        let start = Start::new(&mut forces, state)?;
        let coefficients = stage_coefficients(rule, (1.0 - alpha_m) / beta, 1.0 - alpha_f);
        Ok(NewmarkStepper {
            parameters,
            step: ImplicitStep::new(body, coefficients, settings)?,
            forces,
            start,
            end: TimePoint::new(body),
            reactions: body.space.no_reactions(),
        })
    }

    /// Sets the equations of the step.
    fn start(&mut self, state: &State, h: f64) -> Result<()> {
        let NewmarkParameters { alpha_m, beta, .. } = self.parameters;
        self.step.system.start(&state.displacement, h);
        let equations = self.step.equations();
        let c = (1.0 - alpha_m) / beta;
        let of_inertia = h * h * (c * (0.5 - beta) - alpha_m);
        let known = equations.known.iter_mut().zip(state.momentum.iter().zip(&self.start.inertia));
        known.for_each(|(g, (p, ma))| *g = c * h * p + of_inertia * ma);
        equations.begin(Span::new(state.time, h), state).map(|_| ())
    }

    /// Forces at the end of the step.
    fn evaluate_end(&mut self, state: &State, h: f64) -> Result<()> {
        let old = state.displacement.iter().zip(self.step.rates());
        self.end.displacement.iter_mut().zip(old).for_each(|(new, (u, x))| *new = u + x);
        self.end.evaluate_for_reactions(&mut self.forces, state.time + h)
    }

    /// The state at the end of the step; `u_2 = u_1 + x` gives a_2, a_2 gives v_2.
    fn update(&mut self, state: &mut State, h: f64) {
        let NewmarkParameters { beta, gamma, .. } = self.parameters;
        let body = self.forces.body;
        for (dof, x) in self.step.rates().iter().enumerate() {
            let v = state.velocity[dof];
            let a = self.start.acceleration[dof];
            let new = (x - h * v) / (beta * h * h) - (0.5 - beta) / beta * a;
            state.velocity[dof] = v + h * ((1.0 - gamma) * a + gamma * new);
            self.start.acceleration[dof] = new;
        }
        self.start.acceleration[body.space.internal_dofs()].fill(0.0);
        body.space.set_internal_velocity(&[1.0], self.step.rates(), h, &mut state.velocity);
        state.displacement.copy_from_slice(&self.end.displacement);
        body.mass_product(&state.velocity, &mut state.momentum);
        body.mass_product(&self.start.acceleration, &mut self.start.inertia);
    }

    /// Work and impulses with the weights 1 - gamma at the start and gamma at the end, the weights of the velocity.
    fn impulses(&mut self, h: f64) -> Impulses {
        let body = self.forces.body;
        let gamma = self.parameters.gamma;
        let x = self.step.rates();
        self.end.set_reactions(body, &self.start.inertia);
        let mut impulses = Impulses::default();
        self.start.point.add_to(&mut impulses, body, 1.0 - gamma, h, x);
        self.end.add_to(&mut impulses, body, gamma, h, x);
        sum_reactions([(&self.start.point, 1.0 - gamma), (&self.end, gamma)], &mut self.reactions);
        impulses
    }
}

impl Stepper for NewmarkStepper<'_> {
    fn advance(&mut self, state: &mut State, step_size: f64) -> Result<StepOutcome> {
        self.start(state, step_size)?;
        let newton = self.step.solve(state, step_size, None)?;
        self.evaluate_end(state, step_size)?;
        self.step.remember(step_size);
        self.update(state, step_size);
        let impulses = self.impulses(step_size);
        std::mem::swap(&mut self.start.point, &mut self.end);
        let strain_state = self.forces.body.strain_state(&state.displacement);
        Ok(StepOutcome { newton, impulses, strain_state, solver: self.step.solver() })
    }

    fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

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
