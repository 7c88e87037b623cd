//! One step of a time element: prediction, iteration, update, impulses.

use super::stage_system::StageSystem;
use super::{State, TimeElement};
use crate::body::{Body, MassSolver, sum};
use crate::error::{Error, Result};
use crate::newton::{Newton, NewtonSettings, Outcome};
use crate::sparse::reduce::dot;

/// Advances the state of a body, step by step.
///
/// ```
/// use emmy::{body::{Body, InitialVelocity, Region}, material::NeoHooke, mesh};
/// use emmy::{newton::NewtonSettings, time::{Scheme, State, Stepper, TimeElement}};
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let body = Body::new(mesh::block([1.0; 3], [1; 3])?, vec![Region::new(None, 1.0, rubber)], &[], &[])?;
/// let mut state = State::initial(&body, 0.0, &[InitialVelocity { velocity: [2.0, 0.0, 0.0], ..Default::default() }])?;
/// let mut stepper = Stepper::new(&body, TimeElement::new(Scheme::DiscreteGradient, 1)?, NewtonSettings::default())?;
/// stepper.advance(&mut state, 0.5)?;
/// assert!((state.displacement[0] - 1.0).abs() < 1e-14);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct Stepper<'a> {
    system: StageSystem<'a>,
    settings: NewtonSettings,
    newton: Newton,
    mass_solver: MassSolver,
    rates: Vec<f64>,
    /// Rates and step size of the last step.
    last: Option<(Vec<f64>, f64)>,
    residual: Vec<f64>,
    averages: Vec<f64>,
    coefficients: Vec<f64>,
    position: Vec<f64>,
    is_loaded: bool,
}

/// What loads and reactions did to the body in a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Impulses {
    /// Work of the loads, `sum_i b_i f_i^ext . x_i` \[energy\].
    pub work: f64,
    /// Linear impulse, `h sum_i b_i (f_i^ext + lambda_i)`.
    pub linear: [f64; 3],
    /// Angular impulse about the origin, `h sum_i b_i q^h(c_i) x (f_i^ext + lambda_i)`.
    pub angular: [f64; 3],
}

/// How a step went.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StepOutcome {
    /// Newton's iteration.
    pub newton: Outcome,
    /// Impulses of loads and reactions.
    pub impulses: Impulses,
}

/// Starting points of the iteration, in the order in which they are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Guess {
    /// The last time element's polynomial, continued.
    Continued,
    /// h v.
    Velocity,
    /// No motion.
    Rest,
}

/// Every attempt at a step: starting point, and whether a line search guards it.
const ATTEMPTS: [(Guess, bool); 5] = [
    (Guess::Continued, false),
    (Guess::Velocity, false),
    (Guess::Rest, false),
    (Guess::Velocity, true),
    (Guess::Rest, true),
];

impl<'a> Stepper<'a> {
    /// A stepper with all its memory; symbolic work is done here, once.
    ///
    /// # Errors
    /// [`Error::Linear`] if there is not enough memory.
    pub fn new(body: &'a Body, element: TimeElement, settings: NewtonSettings) -> Result<Self> {
        let (n, k) = (body.n_dofs(), element.degree());
        Ok(Stepper {
            system: StageSystem::new(body, element)?,
            settings,
            newton: Newton::default(),
            mass_solver: MassSolver::new(body)?,
            rates: vec![0.0; k * n],
            last: None,
            residual: vec![0.0; k * n],
            averages: vec![0.0; k],
            coefficients: vec![0.0; k * k],
            position: vec![0.0; n],
            is_loaded: false,
        })
    }

    /// Norms of Newton's residuals in the last step.
    pub fn newton_history(&self) -> &[f64] {
        self.newton.history()
    }

    /// Advances the state by one step.
    ///
    /// # Errors
    /// [`Error::NoConvergence`]; the state is then unchanged.
    pub fn advance(&mut self, state: &mut State, step_size: f64) -> Result<StepOutcome> {
        self.system.start(state, step_size);
        let StageSystem { body, element, external_force, .. } = &mut self.system;
        self.is_loaded =
            body.stage_loads(element.rule(), state.time, step_size, &mut self.averages, external_force);
        let newton = self.solve(state, step_size)?;
        let impulses = self.impulses()?;
        self.update(state);
        let (last, last_size) = self.last.get_or_insert_with(|| (self.rates.clone(), step_size));
        last.copy_from_slice(&self.rates);
        *last_size = step_size;
        Ok(StepOutcome { newton, impulses })
    }

    /// Solves the stage equations from the first starting point that leads to a solution.
    fn solve(&mut self, state: &State, step_size: f64) -> Result<Outcome> {
        let (mut failed, mut cause) = (Outcome::default(), None);
        for (guess, line_search) in ATTEMPTS {
            if !self.predict(guess, state, step_size) {
                continue;
            }
            match self.newton.solve(&mut self.system, &mut self.rates, &self.settings, line_search) {
                Ok(outcome) if outcome.converged => return Ok(outcome),
                Ok(outcome) => (failed, cause) = (outcome, None),
                Err(error) => cause = Some(Box::new(error)),
            }
        }
        let size = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
        let nodes = self.newton.residual()[..state.displacement.len()].chunks_exact(3).map(size).enumerate();
        let node = nodes.max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(node, _)| node);
        Err(Error::NoConvergence {
            step: state.step + 1,
            time: state.time + step_size,
            iterations: failed.iterations,
            residual: failed.residual,
            target: failed.target,
            node,
            position: state.position(self.system.body, node),
            cause,
        })
    }

    /// Sets the rates to a starting point; false if there is none of this kind.
    fn predict(&mut self, guess: Guess, state: &State, step_size: f64) -> bool {
        let n = state.displacement.len();
        match (guess, &self.last) {
            (Guess::Continued, None) => return false,
            (Guess::Continued, Some((last, last_size))) => {
                let k = self.system.element.degree();
                self.system.element.continuation(step_size / last_size, &mut self.coefficients);
                for (i, rates) in self.rates.chunks_exact_mut(n).enumerate() {
                    rates.fill(0.0);
                    for j in 0..k {
                        let e = self.coefficients[i * k + j];
                        rates.iter_mut().zip(&last[j * n..]).for_each(|(x, old)| *x += e * old);
                    }
                }
            }
            (Guess::Velocity, _) => {
                for rates in self.rates.chunks_exact_mut(n) {
                    rates.iter_mut().zip(&state.velocity).for_each(|(x, v)| *x = step_size * v);
                }
            }
            (Guess::Rest, _) => self.rates.fill(0.0),
        }
        true
    }

    /// Work and impulses of loads and reactions. Reactions are the residual at the fixed degrees of freedom.
    fn impulses(&mut self) -> Result<Impulses> {
        let (body, n, h) = (self.system.body, self.system.body.n_dofs(), self.system.step_size);
        let has_supports = body.fixed().contains(&true);
        if has_supports {
            self.system.full_residual(&self.rates, &mut self.residual)?;
        }
        let mut impulses = Impulses::default();
        if !has_supports && !self.is_loaded {
            return Ok(impulses);
        }
        let rule = self.system.element.rule();
        let k = rule.degree();
        for i in 0..k {
            let b = rule.weights()[i];
            let external = &self.system.external_force[i * n..(i + 1) * n];
            impulses.work += b * dot(external, &self.rates[i * n..(i + 1) * n]);
            self.position.copy_from_slice(&self.system.displacement);
            for j in 0..k {
                let a = rule.coefficients()[i * k + j];
                self.position.iter_mut().zip(&self.rates[j * n..]).for_each(|(u, x)| *u += a * x);
            }
            let reaction = &mut self.residual[i * n..(i + 1) * n];
            for dof in 0..n {
                let lambda = if body.fixed()[dof] { reaction[dof] / (h * h) } else { 0.0 };
                reaction[dof] = lambda + external[dof];
            }
            let (force, moment) = (sum(reaction), body.moment(&self.position, reaction));
            (0..3).for_each(|d| impulses.linear[d] += h * b * force[d]);
            (0..3).for_each(|d| impulses.angular[d] += h * b * moment[d]);
        }
        Ok(impulses)
    }

    /// The state at the end of the step.
    ///
    /// The momentum is taken from the inertia side of the stage equations, `h f_i` being replaced through `R_i = 0`: then
    /// an error of the iteration enters the energy balance through `R_i . x_i` only.
    fn update(&mut self, state: &mut State) {
        let (body, h, n) = (self.system.body, self.system.step_size, state.displacement.len());
        let element = &self.system.element;
        let (k, b) = (element.degree(), element.rule().weights());
        state.momentum.fill(0.0);
        for j in 0..k {
            let beta: f64 = (0..k).map(|i| b[i] * element.inverse_coefficients()[i * k + j]).sum();
            let rates = &self.rates[j * n..(j + 1) * n];
            state.displacement.iter_mut().zip(rates).for_each(|(u, x)| *u += b[j] * x);
            body.mass_product(rates, &mut self.position);
            let old = self.position.iter().zip(&self.system.momentum);
            state.momentum.iter_mut().zip(old).for_each(|(p, (mx, p_1))| *p += beta * (mx / h - p_1));
        }
        state.momentum.iter_mut().zip(&self.system.momentum).for_each(|(p, p_1)| *p += p_1);
        self.mass_solver.velocity(&state.momentum, &mut state.velocity);
        // The momentum of fixed degrees of freedom is that of the velocity: p = M v with all of M.
        body.mass_product(&state.velocity, &mut self.position);
        let fixed = body.fixed().iter().zip(&self.position);
        state
            .momentum
            .iter_mut()
            .zip(fixed)
            .filter(|(_, (fixed, _))| **fixed)
            .for_each(|(p, (_, mv))| *p = *mv);
    }
}
