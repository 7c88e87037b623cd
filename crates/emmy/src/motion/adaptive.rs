//! Marching with step sizes that are chosen by the error.

use super::degrees::DegreeChoice;
use super::march::placed;
use super::{Adaptivity, Controller, EventKind, MarchError, Motion, Observer, State, StepPlan};
use crate::body::Body;
use crate::error::{Error, Result};
use crate::number::short;
use crate::time::{LocalError, Memory, StepOutcome};

/// What chooses the step sizes of a motion.
#[derive(Debug)]
pub struct Control<'a> {
    pub(super) adaptivity: Adaptivity,
    pub(super) controller: Controller,
    pub(super) estimator: LocalError<'a>,
    pub(super) degrees: Option<DegreeChoice>,
    length: f64,
    /// Duration of the plan.
    duration: f64,
    /// Times that lie closer together are the same.
    same_time: f64,
    /// The state at the start of the step.
    pub(super) start: State,
}

/// Refusals of one step after the other: a step that small does not help.
const MOST_REFUSALS: usize = 60;

/// Part of the allowed number of Newton iterations from which on a step counts as hard.
const HARD: f64 = 0.75;

/// The first step is this part of the time in which the body moves by its own size.
const FIRST_PART: f64 = 0.01;

/// A time that is to be met.
#[derive(Debug, Clone, Copy)]
struct Stop {
    time: f64,
    is_kink: bool,
}

impl<'a> Control<'a> {
    /// What the choice of the next size depends on.
    pub fn memory(&self, degree: usize) -> Memory {
        let mut memory = self.estimator.memory();
        self.controller.keep(&mut memory);
        if let Some(choice) = &self.degrees {
            choice.keep(degree, &mut memory);
        }
        memory
    }

    /// A size with which to begin: a part of the time in which the body moves by its own length.
    fn first_size(&self, body: &Body, state: &State) -> Result<f64> {
        let acceleration = LocalError::acceleration(body, state)?;
        let by_velocity = self.length / body.mean(&state.velocity);
        let by_acceleration = (2.0 * self.length / body.mean(&acceleration)).sqrt();
        Ok(FIRST_PART * by_velocity.min(by_acceleration).min(self.duration))
    }

    /// Error of the last step: the larger one of those of positions and velocities, in their scales.
    fn error(&self, body: &Body) -> f64 {
        self.size_of_error(body, &self.estimator)
    }

    /// The same of what an estimator estimated.
    pub(super) fn size_of_error(&self, body: &Body, estimator: &LocalError<'_>) -> f64 {
        let position = body.mean(estimator.displacement()) / self.length;
        match self.adaptivity.velocity {
            Some(scale) => larger(position, body.mean(estimator.velocity()) / scale),
            None => position,
        }
    }
}

impl<'a> Motion<'a> {
    /// Marches to the end of a plan with steps that are chosen by the error; every end of a phase and every kink of a load is met.
    pub(super) fn march_adaptively(
        &mut self,
        plan: &StepPlan,
        adaptivity: &Adaptivity,
        observers: &mut [&mut dyn Observer],
    ) -> Result<(), MarchError> {
        self.control = Some(self.control(plan, adaptivity)?);
        for phase in plan.phases() {
            // Back in its place whenever observers look on: a snapshot has it.
            while let Some(mut control) = self.control.take() {
                let output = plan.next_output(self.state.time);
                let stop = self.next_stop(&control, phase.until, output);
                let outcome = match stop {
                    Some(stop) => {
                        let longest = adaptivity.largest.min(plan.interval().unwrap_or(f64::INFINITY));
                        self.step_towards(&mut control, stop, longest, observers)
                    }
                    None => Ok(()),
                };
                self.control = Some(control);
                outcome?;
                if stop.is_none() {
                    break;
                }
                self.notify(observers)?;
                self.check_digits()?;
            }
        }
        Ok(())
    }

    /// The next time that is to be met, and whether it is a kink of a load; none, if the end of the phase is reached. `output`: the next
    /// time for output.
    fn next_stop(&self, control: &Control<'_>, until: f64, output: Option<f64>) -> Option<Stop> {
        let same = control.same_time;
        if until - self.state.time <= same {
            return None;
        }
        let kink = self.body.next_kink(self.state.time + same).unwrap_or(f64::INFINITY);
        let before = |time: f64, limit: f64| if time < limit - same { time } else { limit };
        let time = before(kink, before(output.unwrap_or(f64::INFINITY), until));
        Some(Stop { time, is_kink: kink <= time + same })
    }

    /// Does the next step, as often as it takes to be accepted; it does not go beyond a time. `longest`: the longest that any step can be.
    fn step_towards(
        &mut self,
        control: &mut Control<'a>,
        stop: Stop,
        longest: f64,
        observers: &mut [&mut dyn Observer],
    ) -> Result<(), MarchError> {
        self.release_under(control)?;
        control.start.copy_from(&self.state);
        let mut refusals = 0;
        loop {
            let left = stop.time - self.state.time;
            let (size, missed) = self.resolved_size(control, control.controller.size_within(left))?;
            match self.attempt(control, size) {
                Ok((outcome, error)) if control.controller.accepts(error) => {
                    let limit = HARD * self.settings.max_iterations as f64;
                    control.controller.accept(size, error, outcome.newton.iterations as f64 > limit);
                    control.estimator.accept(size);
                    let is_met = size == left;
                    self.conclude(size, if is_met { stop.time } else { self.state.time + size }, &outcome);
                    self.record.local_error = error;
                    self.record.is_unresolved = missed;
                    self.statistics.add(self.body, &self.state, &self.record);
                    if is_met && stop.is_kink {
                        control.estimator.restart(&self.state)?;
                        control.controller.restart(control.first_size(self.body, &self.state)?);
                    } else {
                        self.choose_degree(control, (size, error), longest)?;
                    }
                    return Ok(());
                }
                attempt => {
                    let error = attempt.map(|(_, error)| error);
                    self.refuse(control, size, error, refusals < MOST_REFUSALS)?;
                }
            }
            refusals += 1;
            self.tell(observers)?;
        }
    }

    /// The largest size up to one whose step resolves all that acts on the body, and whether even the shortest one misses something.
    ///
    /// # Errors
    /// [`Error::SmallestStep`] if that takes steps below the smallest size.
    fn resolved_size(&mut self, control: &Control<'_>, size: f64) -> Result<(f64, bool)> {
        let Some(resolution) = &mut self.resolution else { return Ok((size, false)) };
        resolution.take_degree(self.degree);
        let (time, tolerance, length) = (self.state.time, control.adaptivity.tolerance, control.length);
        let resolved = resolution.resolved_size(time, size, tolerance, length);
        let smallest = control.adaptivity.smallest.min(size);
        if resolved < smallest
            && let Some(missed) = resolution.missed_within(time, smallest, tolerance, length)
        {
            let cause = Error::Unresolved { what: missed.to_string(), size: smallest };
            return Err(self.smallest(smallest, cause));
        }
        Ok((resolved.max(smallest), resolution.missed_within(time, resolved, tolerance, length).is_some()))
    }

    /// Advances the state and estimates the error.
    fn attempt(&mut self, control: &mut Control<'a>, size: f64) -> Result<(StepOutcome, f64)> {
        let outcome = self.advance(size)?;
        let rates = self.stepper.rates();
        control.estimator.estimate(&control.start, &self.state, rates, size)?;
        let mut error = control.error(self.body);
        // No step is refused by what was estimated of another one.
        if !control.controller.accepts(error)
            && control.estimator.confirm(&control.start, &self.state, rates, size)?
        {
            error = control.error(self.body);
        }
        Ok((outcome, error))
    }

    /// Goes back to the start of the step, the next attempt at which will be smaller.
    fn refuse(
        &mut self,
        control: &mut Control<'a>,
        size: f64,
        error: Result<f64>,
        may_shrink: bool,
    ) -> Result<(), MarchError> {
        self.state.copy_from(&control.start);
        let tolerance = control.adaptivity.tolerance;
        let error = match error {
            Ok(error) => Error::Tolerance { error, tolerance },
            Err(error) => placed(error, self.body, &self.state, size),
        };
        if !(may_shrink && control.controller.can_shrink(size)) {
            return Err(MarchError::Step(self.smallest(size, error)));
        }
        let kind = match &error {
            Error::Tolerance { error, .. } => {
                control.controller.refuse(size, *error);
                self.refusals += 1;
                EventKind::Rejected
            }
            _ => {
                control.controller.fail(size);
                self.cuts += 1;
                EventKind::Cut
            }
        };
        let message =
            format!("step of {} done again with {}: {error}", short(size), short(control.controller.size()));
        self.note(kind, self.state.step + 1, message);
        Ok(())
    }

    fn smallest(&self, step_size: f64, cause: Error) -> Error {
        let (step, start) = (self.state.step + 1, self.state.time);
        Error::SmallestStep { step, start, step_size, cause: Box::new(cause) }
    }

    /// Goes over to the body without the supports that are released by now, and the estimator with it.
    fn release_under(&mut self, control: &mut Control<'a>) -> Result<()> {
        let before = self.releases;
        self.release(control.same_time)?;
        if self.releases > before {
            control.estimator = self.estimator(&control.adaptivity)?;
        }
        Ok(())
    }

    pub(super) fn estimator(&self, adaptivity: &Adaptivity) -> Result<LocalError<'a>> {
        let kind = (self.scheme.of_degree(self.degree), self.degree);
        LocalError::new(
            self.body,
            kind,
            adaptivity.estimator_of(self.scheme, self.degree),
            self.settings,
            &self.state,
        )
    }

    /// The control of a plan: that of the march before, that of the snapshot, or a new one.
    fn control(&mut self, plan: &StepPlan, adaptivity: &Adaptivity) -> Result<Control<'a>> {
        if let Some(control) = self.control.take().filter(|control| control.adaptivity == *adaptivity) {
            return Ok(control);
        }
        if !self.scheme.is_time_element() {
            let reason = "adaptive steps go with time elements only".to_string();
            return Err(Error::Scheme { scheme: self.scheme.to_string(), reason });
        }
        let length = adaptivity.length.unwrap_or_else(|| self.body.radius_of_gyration());
        if length == 0.0 {
            let reason = "must be given: the body is a point".to_string();
            return Err(Error::Adaptivity { setting: "length", reason });
        }
        adaptivity.check_degree(self.scheme, self.degree)?;
        let order = LocalError::order(self.scheme, self.degree);
        let mut control = Control {
            adaptivity: *adaptivity,
            controller: Controller::new(adaptivity, order, adaptivity.first.unwrap_or(f64::INFINITY)),
            estimator: self.estimator(adaptivity)?,
            degrees: adaptivity.degrees.map(DegreeChoice::new),
            length,
            duration: plan.end() - plan.start(),
            same_time: plan.same_time(0.0),
            start: self.state.clone(),
        };
        if adaptivity.first.is_none() {
            control.controller.restart(control.first_size(self.body, &self.state)?);
        }
        if let Some(memory) = self.control_memory.take() {
            control.estimator.restore(&memory)?;
            control.controller.restore(&memory)?;
            if let Some(choice) = &mut control.degrees {
                choice.restore(&memory)?;
            }
        }
        Ok(control)
    }
}

/// The larger one of two errors; NaN if one of them is.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
