//! The trajectory of a motion, kept in checkpoints, and the adjoint motion back along it.

use super::parameter::Residual;
use super::segment::{Checkpoint, Segment, StepSize};
use super::step::{AdjointState, AdjointStep, StepData, check_body};
use super::{Goal, GoalError, Gradient, Parameter};
use crate::body::{Body, MassSolver};
use crate::equilibrium::multipliers;
use crate::error::{Error, Result};
use crate::motion::{Motion, NewtonSettings, Observer, View};
use crate::sparse::reduce::dot;
use crate::time::{Scheme, State, Stepper, TimeElement, TimeElementStepper};

/// The trajectory of a motion: an observer that keeps checkpoints, from which goals are differentiated.
///
/// It begins with the first state that it observes. The steps between checkpoints are repeated exactly; if none of them
/// was rejected or cut, they are bit-identical, and the gradient does not depend on the checkpoints.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::adjoint::{Goal, Trajectory};
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(Region::new(rubber, 1.0)).build()?;
/// let state = State::initial(&body, 0.0, &[InitialVelocity { velocity: [2.0, 0.0, 0.0], ..Default::default() }])?;
/// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(2)?)?.from(state)?;
/// let mut trajectory = Trajectory::new(&motion)?;
/// motion.march(&StepPlan::new(0.0, vec![Phase { until: 3.0, size: 0.1 }])?, &mut [&mut trajectory]).unwrap();
/// // A change of all velocities shifts the end by the time that has passed.
/// let gradient = trajectory.gradient(&Goal::displacement_at(&body, 0, [1.0, 0.0, 0.0]), &[])?;
/// let sum: f64 = gradient.velocity.iter().step_by(3).sum();
/// assert!((sum - 3.0).abs() < 1e-10);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct Trajectory<'a> {
    body: &'a Body,
    element: TimeElement,
    settings: NewtonSettings,
    /// Number of steps between checkpoints.
    spacing: usize,
    /// Whether the spacing grows with the number of steps.
    grows: bool,
    checkpoints: Vec<Checkpoint>,
    steps: Vec<StepSize>,
}

impl<'a> Trajectory<'a> {
    /// The trajectory of a motion, with about sqrt(N) checkpoints for N steps: the distance between them doubles as
    /// their number grows.
    ///
    /// # Errors
    /// [`Error::Adjoint`] for a motion that the adjoint does not cover.
    pub fn new(motion: &Motion<'a>) -> Result<Self> {
        let body = motion.body();
        let Scheme::TimeElement(element @ TimeElement { spectral_radius: None, .. }) = motion.scheme() else {
            return Err(Error::Adjoint {
                reason: "it needs a time element without dissipation (FE, AS, DGM)".to_string(),
            });
        };
        body.space.check_whole("an adjoint")?;
        check_body(body)?;
        Ok(Trajectory {
            body,
            element,
            settings: motion.settings(),
            spacing: 1,
            grows: true,
            checkpoints: Vec::new(),
            steps: Vec::new(),
        })
    }

    /// The trajectory with a checkpoint every given number of steps.
    pub fn with_spacing(self, steps: usize) -> Self {
        Trajectory { spacing: steps.max(1), grows: false, ..self }
    }

    /// Records the present state of the motion; a march does this for its observers.
    ///
    /// # Errors
    /// [`Error::Adjoint`] for another motion, or if the motion has done more than one step since.
    pub fn record(&mut self, motion: &Motion<'_>) -> Result<()> {
        let fail = |reason: &str| Err(Error::Adjoint { reason: reason.to_string() });
        let settings = (motion.scheme(), motion.settings());
        if !std::ptr::eq(motion.body(), self.body) || settings != (self.element.into(), self.settings) {
            return fail("the motion has another body, scheme or settings than the trajectory");
        }
        let record = motion.record();
        if let Some(first) = self.checkpoints.first() {
            match record.step.checked_sub(first.state.step + self.steps.len()) {
                Some(0) => return Ok(()),
                Some(1) => self.steps.push(StepSize { size: record.step_size, end: record.time }),
                _ => return fail("the motion did steps that the trajectory did not see"),
            }
        }
        if self.steps.len().is_multiple_of(self.spacing) {
            let state = motion.state().clone();
            let memory = motion.stepper().memory();
            self.checkpoints.push(Checkpoint { state, memory });
            self.thin_out();
        }
        Ok(())
    }

    /// Number of steps.
    pub fn n_steps(&self) -> usize {
        self.steps.len()
    }

    /// Number of checkpoints.
    pub fn n_checkpoints(&self) -> usize {
        self.checkpoints.len()
    }

    /// Derivatives of a goal at the last state by the first one and by parameters. The displacement of a motion that
    /// starts from its equilibrium ([`State::is_equilibrium`]) changes with the parameters; any other start does not.
    ///
    /// # Errors
    /// [`Error::Adjoint`] if there is no step, or the goal or a parameter is of another body; [`Error::Linear`]; the
    /// errors of a step.
    pub fn gradient(&self, goal: &Goal, parameters: &[Parameter]) -> Result<Gradient> {
        parameters.iter().try_for_each(|parameter| parameter.check(self.body))?;
        let mut sums = vec![0.0; parameters.len()];
        let mut residual = Residual::new(self.body, &self.element.coefficients().rule);
        let adjoint = self.go_back(goal, |visit| {
            for (sum, parameter) in sums.iter_mut().zip(parameters) {
                *sum -= parameter.product(&visit.step, visit.multipliers, &mut residual)?;
            }
            Ok(())
        })?;
        let first = &self.checkpoints[0].state;
        if first.is_equilibrium && !parameters.is_empty() {
            let multipliers = multipliers(self.body, first, &adjoint.displacement)?;
            for (sum, parameter) in sums.iter_mut().zip(parameters) {
                *sum -= parameter.equilibrium_product(first, &multipliers)?;
            }
        }
        let mut momentum = vec![0.0; self.body.n_dofs()];
        MassSolver::new(self.body)?.velocity(self.body, &adjoint.velocity, &mut momentum)?;
        let AdjointState { displacement, velocity } = adjoint;
        Ok(Gradient { displacement, velocity, momentum, parameters: sums })
    }

    /// Estimated error of a goal at the last state, by the local errors of the steps; see [`crate::adjoint`]. Newton's
    /// tolerance must be small compared with them.
    ///
    /// # Errors
    /// As [`Trajectory::gradient`], and the errors of steps of degree k + 1.
    pub fn goal_error(&self, goal: &Goal) -> Result<GoalError> {
        let next = self.element.at_degree(self.element.degree + 1)?;
        let mut stepper = TimeElementStepper::new(self.body, next, self.settings)?;
        let mut terms = Vec::with_capacity(self.steps.len());
        self.go_back(goal, |visit| {
            let mut better = visit.start.clone();
            stepper.advance(&mut better, visit.step.size)?;
            terms.push(weighted(visit.adjoint, visit.end, &better));
            Ok(())
        })?;
        terms.reverse();
        Ok(GoalError { steps: terms })
    }

    /// Goes back along the trajectory; visitors see every step from the last to the first.
    fn go_back(&self, goal: &Goal, mut visit: impl FnMut(Visit<'_>) -> Result<()>) -> Result<AdjointState> {
        self.check(goal)?;
        let coefficients = self.element.coefficients();
        let mut stepper = TimeElementStepper::new(self.body, self.element, self.settings)?;
        let mut adjoint_step = AdjointStep::new(self.body, self.element, self.settings)?;
        let mut adjoint = AdjointState::new(self.body, &goal.displacement, &goal.velocity);
        let mut segment = Segment::default();
        for (checkpoint, steps) in self.checkpoints.iter().zip(self.steps.chunks(self.spacing)).rev() {
            segment.redo(&mut stepper, checkpoint, steps)?;
            for index in (0..segment.len()).rev() {
                let step = segment.step(&coefficients, index);
                let [start, end] = segment.ends(index);
                let at_end = adjoint.clone();
                adjoint_step.take_back(&step, &mut adjoint)?;
                let multipliers = adjoint_step.multipliers();
                visit(Visit { step, start, end, adjoint: &at_end, multipliers })?;
            }
        }
        Ok(adjoint)
    }

    fn check(&self, goal: &Goal) -> Result<()> {
        let fail = |reason: &str| Err(Error::Adjoint { reason: reason.to_string() });
        if self.steps.is_empty() {
            return fail("there is no step; let the motion march with the trajectory among its observers");
        }
        if [&goal.displacement, &goal.velocity].iter().any(|list| list.len() != self.body.n_dofs()) {
            return fail("the goal has another number of degrees of freedom than the body");
        }
        Ok(())
    }

    /// Doubles the spacing if there are more than twice as many checkpoints as steps between them.
    fn thin_out(&mut self) {
        while self.grows && self.checkpoints.len() > 2 * self.spacing + 1 {
            let mut index = 0;
            self.checkpoints.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.spacing *= 2;
        }
    }
}

/// A step on the way back.
struct Visit<'a> {
    step: StepData<'a>,
    start: &'a State,
    end: &'a State,
    /// Derivatives of the goal by the state at the end of the step.
    adjoint: &'a AdjointState,
    multipliers: &'a [f64],
}

/// Effect of the difference of two states on a goal.
fn weighted(adjoint: &AdjointState, state: &State, better: &State) -> f64 {
    let difference = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
    dot(&adjoint.displacement, &difference(&state.displacement, &better.displacement))
        + dot(&adjoint.velocity, &difference(&state.velocity, &better.velocity))
}

impl Observer for Trajectory<'_> {
    fn observe(
        &mut self,
        view: View<'_>,
    ) -> std::result::Result<(), Box<dyn std::error::Error + Send + Sync>> {
        Ok(self.record(view.motion)?)
    }
}
