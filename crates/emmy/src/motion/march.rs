//! The loop over the steps.

use super::{MarchError, Observer, Record, State, StepPlan, View};
use crate::body::{Body, sum};
use crate::error::Result;
use crate::newton::NewtonSettings;
use crate::sparse::reduce::dot;
use crate::time::{Scheme, StepOutcome, Stepper};

/// A body in motion: its state, and the stepper that advances it.
///
/// ```
/// use emmy::{body::{Body, Region, InitialVelocity}, material::NeoHooke, mesh};
/// use emmy::{motion::{Motion, NewtonSettings, Phase, State, StepPlan}, time::Scheme};
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let body = Body::new(mesh::block([1.0; 3], [1; 3])?, vec![Region::new(None, 1.0, rubber)], &[], &[])?;
/// let spin = InitialVelocity { angular_velocity: [0.0, 0.0, 6.0], about: [0.5; 3], ..Default::default() };
/// let state = State::initial(&body, 0.0, &[spin])?;
/// let mut motion = Motion::new(&body, Scheme::DiscreteGradient, 2, NewtonSettings::default(), state)?;
/// motion.march(&StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.1 }])?, &mut []).unwrap();
/// assert!((motion.record().total_energy - 3.0).abs() < 1e-12); // m (a^2 + b^2) / 12 * omega^2 / 2
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct Motion<'a> {
    body: &'a Body,
    scheme: Scheme,
    degree: usize,
    settings: NewtonSettings,
    stepper: Box<dyn Stepper + 'a>,
    state: State,
    record: Record,
}

/// Times that lie closer together than this part of a step are the same: they differ by rounding.
const SAME_TIME: f64 = 1e-6;

impl<'a> Motion<'a> {
    /// A motion that starts from a state.
    ///
    /// # Errors
    /// Those of [`Scheme::stepper`].
    pub fn new(
        body: &'a Body,
        scheme: Scheme,
        degree: usize,
        settings: NewtonSettings,
        mut state: State,
    ) -> Result<Self> {
        let stepper = scheme.stepper(body, degree, settings, &mut state)?;
        let record =
            Record { step: state.step, time: state.time, ..Record::default() }.with_invariants(body, &state);
        Ok(Motion { body, scheme, degree, settings, stepper, state, record })
    }

    /// The state reached.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The record of the last step.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The stepper.
    pub fn stepper(&self) -> &(dyn Stepper + 'a) {
        &*self.stepper
    }

    /// Goes over to the body without the supports that are released by now. The state goes on as it is.
    fn release(&mut self, step_size: f64) -> Result<()> {
        while let Some((time, body)) = self.body.release() {
            if self.state.time < time - SAME_TIME * step_size {
                break;
            }
            self.stepper = self.scheme.stepper(body, self.degree, self.settings, &mut self.state)?;
            self.body = body;
        }
        Ok(())
    }

    /// Advances by one step of a size and records it. A support that is released holds until the first step that starts at the
    /// time of the release or after it.
    ///
    /// # Errors
    /// Those of [`Stepper::advance`], after a release those of [`Scheme::stepper`]; state and record are then those of the last
    /// good step.
    pub fn step(&mut self, step_size: f64, end: f64) -> Result<&Record> {
        self.release(step_size)?;
        let outcome = self.stepper.advance(&mut self.state, step_size)?;
        self.state.time = end;
        self.state.step += 1;
        self.record = self.record.after(self.body, &self.state, step_size, &outcome);
        Ok(&self.record)
    }

    /// Marches through a plan. Observers see the start and every step.
    ///
    /// # Errors
    /// [`MarchError::Step`] if a step fails, [`MarchError::Observer`] if an observer does.
    pub fn march(&mut self, plan: &StepPlan, observers: &mut [&mut dyn Observer]) -> Result<(), MarchError> {
        self.notify(observers)?;
        for step in plan.steps() {
            self.step(step.size, step.end)?;
            self.notify(observers)?;
        }
        Ok(())
    }

    fn notify(&self, observers: &mut [&mut dyn Observer]) -> Result<(), MarchError> {
        let (body, state, record) = (self.body, &self.state, &self.record);
        let view = View { body, state, record, newton_residuals: self.stepper.newton_history() };
        observers.iter_mut().try_for_each(|observer| observer.observe(view)).map_err(MarchError::Observer)
    }
}

impl Record {
    /// The record with energies and momenta of a state.
    fn with_invariants(mut self, body: &Body, state: &State) -> Record {
        self.kinetic_energy = 0.5 * dot(&state.momentum, &state.velocity);
        let strained = body.strained(&state.displacement);
        self.strain_energy = strained.strain_energy;
        self.smallest_determinant = strained.smallest_determinant;
        self.total_energy = self.kinetic_energy + self.strain_energy;
        self.linear_momentum = sum(&state.momentum);
        self.angular_momentum = body.moment(&state.displacement, &state.momentum);
        self
    }

    /// The record of a step that ended in a state; `self` is that of the step before.
    fn after(&self, body: &Body, state: &State, step_size: f64, outcome: &StepOutcome) -> Record {
        let impulses = &outcome.impulses;
        let record = Record {
            step: state.step,
            time: state.time,
            step_size,
            external_work: self.external_work + impulses.work,
            newton_iterations: outcome.newton.iterations,
            newton_target: outcome.newton.target,
            linear_iterations: outcome.newton.linear_iterations,
            renewals: outcome.newton.renewals,
            took_exact_tangent: outcome.newton.took_exact_tangent,
            solver: outcome.solver,
            at_rounding_floor: outcome.newton.at_rounding_floor,
            ..Record::default()
        };
        let record = record.with_invariants(body, state);
        // Differences part by part: T and V may be large and cancel in their change.
        let kinetic = record.kinetic_energy - self.kinetic_energy;
        let strain = record.strain_energy - self.strain_energy;
        Record {
            energy_residual: kinetic + strain - impulses.work,
            linear_momentum_residual: defect(record.linear_momentum, self.linear_momentum, impulses.linear),
            angular_momentum_residual: defect(
                record.angular_momentum,
                self.angular_momentum,
                impulses.angular,
            ),
            ..record
        }
    }
}

/// Norm of `now - before - impulse`.
fn defect(now: [f64; 3], before: [f64; 3], impulse: [f64; 3]) -> f64 {
    (0..3).map(|i| (now[i] - before[i] - impulse[i]).powi(2)).sum::<f64>().sqrt()
}
