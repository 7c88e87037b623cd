//! Marching with step sizes chosen by the error.

use super::adaptive::{
    AFTER_KINK, Control, Controller, DegreeChoice, FIRST, MAX_WORK_RATIO, MIN_TELLING_ERROR, size_of,
};
use super::failure::{event_of_cut, may_shrink_after, placed};
use super::resolution::Unresolved;
use super::{Adaptivity, EventKind, MarchError, Motion, Observer, StepLimit, StepPlan};
use crate::error::{Error, Result};
use crate::number::short;
use crate::time::{Estimator, LocalError, Scheme, State, StepOutcome, TimeElement};

/// Consecutive rejections of one step: smaller steps do not help.
const MAX_REJECTIONS: usize = 60;

/// A step is hard if it takes more than this part of the allowed Newton iterations.
const HARD_ITERATIONS: f64 = 0.75;

/// A time at which a step must end, and what is there.
#[derive(Debug, Clone, Copy)]
struct Stop {
    time: f64,
    limit: StepLimit,
}

impl<'a> Motion<'a> {
    /// Prepares steps chosen by the error.
    pub(super) fn control_steps(&mut self, plan: &StepPlan, adaptivity: &Adaptivity) -> Result<()> {
        self.control = Some(self.control(plan, adaptivity)?);
        Ok(())
    }

    /// Does the next step with a size chosen by the error; false at the end of the plan. A step ends at every end of a
    /// phase and every kink of a load.
    pub(super) fn adaptive_step(
        &mut self,
        plan: &StepPlan,
        adaptivity: &Adaptivity,
        observers: &mut [&mut dyn Observer],
    ) -> Result<bool, MarchError> {
        // In its place whenever observers see a step: a snapshot contains it.
        let Some(mut control) = self.control.take() else { return Ok(false) };
        let stop = self.next_stop(&control, plan);
        let outcome = stop.map(|stop| {
            let longest = adaptivity.largest.min(plan.interval().unwrap_or(f64::INFINITY));
            self.step_towards(&mut control, stop, longest, observers)
        });
        self.control = Some(control);
        outcome.transpose()?;
        Ok(stop.is_some())
    }

    /// The next time at which a step must end; none after the end of the plan.
    fn next_stop(&self, control: &Control<'_>, plan: &StepPlan) -> Option<Stop> {
        let same = control.same_time;
        let ended = plan.phases().partition_point(|phase| phase.until - self.state.time <= same);
        let until = plan.phases().get(ended)?.until;
        let output = plan.next_output(self.state.time);
        let kink = self.body.next_corner(self.state.time + same).unwrap_or(f64::INFINITY);
        let before = |time: f64, limit: f64| if time < limit - same { time } else { limit };
        let time = before(kink, before(output.unwrap_or(f64::INFINITY), until));
        let limit = match time {
            time if kink <= time + same => StepLimit::Kink,
            time if time == until => StepLimit::Phase,
            _ => StepLimit::Output,
        };
        Some(Stop { time, limit })
    }

    /// Does the next step, repeated until it is accepted, not beyond a time. `longest`: the longest possible step.
    fn step_towards(
        &mut self,
        control: &mut Control<'a>,
        stop: Stop,
        longest: f64,
        observers: &mut [&mut dyn Observer],
    ) -> Result<(), MarchError> {
        self.release_under(control)?;
        control.start.copy_from(&self.state);
        let (mut rejections, mut rejected) = (0, None);
        loop {
            let left = stop.time - self.state.time;
            let wanted = control.controller.size_within(left);
            let (size, missed) = self.resolved_size(control, wanted)?;
            let limit = match size {
                size if size < wanted => StepLimit::Load,
                size if size == control.controller.size() => control.controller.limit(),
                _ => stop.limit,
            };
            match self.attempt(control, size) {
                Ok((outcome, error)) if control.controller.accepts(error) => {
                    let most = HARD_ITERATIONS * self.settings.max_iterations as f64;
                    control.controller.accept(size, error, outcome.newton.iterations as f64 > most);
                    control.estimator.accept(size);
                    let is_met = size == left;
                    let end = if is_met { stop.time } else { self.state.time + size };
                    self.conclude(size, end, &outcome, missed);
                    self.record.local_error = error;
                    self.record.step_limit = Some(limit);
                    self.count_step();
                    self.choose_degree(control, (size, error), longest)?;
                    if is_met && stop.limit == StepLimit::Kink {
                        control.estimator.restart(&self.state)?;
                        let time = control.travel_time(self.body, &self.state)?;
                        // The last size itself: the intended one, not shortened by the kink, fails after a pulse.
                        let next = size.clamp(FIRST * time, AFTER_KINK * time);
                        control.controller.restart(next, StepLimit::Kink);
                    }
                    return Ok(());
                }
                attempt => {
                    let error = attempt.map(|(_, error)| error);
                    rejected =
                        Some(self.reject(control, size, error, rejected, rejections < MAX_REJECTIONS)?);
                }
            }
            rejections += 1;
            self.tell(observers)?;
        }
    }

    /// The largest size up to a given one that resolves all functions of time, and what even the shortest step misses.
    ///
    /// # Errors
    /// [`Error::SmallestStep`] if this needs steps below the smallest size.
    fn resolved_size(&mut self, control: &Control<'_>, size: f64) -> Result<(f64, Option<Unresolved>)> {
        let Some(resolution) = &mut self.resolution else { return Ok((size, None)) };
        resolution.set_degree(self.scheme.degree());
        let time = self.state.time;
        let tolerance = control.adaptivity.tolerance;
        let length = control.length;
        let resolved = resolution.resolved_size(time, size, tolerance, length);
        let smallest = control.adaptivity.smallest.min(size);
        if resolved < smallest
            && let Some(missed) = resolution.missed_within(time, smallest, tolerance, length)
        {
            let cause = Error::Unresolved { what: missed.to_string(), size: smallest };
            return Err(self.smallest_step_error(smallest, cause));
        }
        Ok((resolved.max(smallest), resolution.missed_within(time, resolved, tolerance, length)))
    }

    /// Advances the state and estimates the error.
    fn attempt(&mut self, control: &mut Control<'a>, size: f64) -> Result<(StepOutcome, f64)> {
        let outcome = self.advance(size)?;
        let rates = self.stepper.rates();
        control.estimator.estimate(&control.start, &self.state, rates, size)?;
        let mut error = control.error(self.body);
        // No step is rejected by the estimate of another one.
        if !control.controller.accepts(error)
            && control.estimator.confirm(&control.start, &self.state, rates, size)?
        {
            error = control.error(self.body);
        }
        Ok((outcome, error))
    }

    /// Returns to the start of the step; the next attempt is smaller. Returns why this one failed; `before`: why the
    /// last one did, which counts once a step is lost in the rounding of the time.
    fn reject(
        &mut self,
        control: &mut Control<'a>,
        size: f64,
        error: Result<f64>,
        before: Option<Error>,
        may_shrink: bool,
    ) -> Result<Error, MarchError> {
        self.state.copy_from(&control.start);
        let tolerance = control.adaptivity.tolerance;
        let error = match error {
            Ok(error) => Error::Tolerance { error, tolerance },
            Err(error) => placed(error, self.body, &self.state, size),
        };
        if !may_shrink_after(&error) {
            return Err(MarchError::Step(self.final_error(size, error, before)));
        }
        if !(may_shrink && control.controller.can_shrink(size)) {
            return Err(MarchError::Step(self.smallest_step_error(size, error)));
        }
        let kind = match &error {
            Error::Tolerance { error, .. } => {
                control.controller.reject(size, *error);
                self.rejections += 1;
                EventKind::Rejected
            }
            _ => {
                control.controller.fail(size);
                self.cuts += 1;
                event_of_cut(&error)
            }
        };
        let message =
            format!("step of {} done again with {}: {error}", short(size), short(control.controller.size()));
        self.note(kind, self.state.step + 1, message);
        Ok(error)
    }

    /// Continues with the body without the supports released by now, and replaces the estimator.
    fn release_under(&mut self, control: &mut Control<'a>) -> Result<()> {
        let before = self.releases;
        self.release(control.same_time)?;
        if self.releases > before {
            control.estimator = self.estimator(&control.adaptivity)?;
        }
        Ok(())
    }

    fn estimator(&self, adaptivity: &Adaptivity) -> Result<LocalError<'a>> {
        let element = time_element(self.scheme)?;
        let kind = self.kind_of_estimator(adaptivity, element);
        LocalError::new(self.body, element, kind, self.settings, &self.state)
    }

    /// The estimator of [`Adaptivity::estimator_of`]; of a mechanism the only one that knows multipliers, unless
    /// another one is requested, which refuses it.
    fn kind_of_estimator(&self, adaptivity: &Adaptivity, element: TimeElement) -> Estimator {
        match adaptivity.estimator {
            None if !self.body.mechanism.is_empty() => Estimator::Element,
            _ => adaptivity.estimator_of(element),
        }
    }

    /// The control of a plan: from the previous march, from the snapshot, or a new one.
    fn control(&mut self, plan: &StepPlan, adaptivity: &Adaptivity) -> Result<Control<'a>> {
        if let Some(control) = self.control.take().filter(|control| control.adaptivity == *adaptivity) {
            return Ok(Control { same_time: plan.same_time(0.0), ..control });
        }
        let element = time_element(self.scheme)?;
        let length = adaptivity.length.unwrap_or_else(|| self.body.radius_of_gyration());
        if length == 0.0 {
            let reason = "must be given: the body is a point".to_string();
            return Err(Error::Adaptivity { setting: "length", reason });
        }
        adaptivity.check_degree(element)?;
        let order = LocalError::order(element);
        let mut control = Control {
            adaptivity: *adaptivity,
            controller: Controller::new(
                adaptivity,
                order,
                adaptivity.first.unwrap_or(f64::INFINITY),
                StepLimit::Start,
            ),
            estimator: self.estimator(adaptivity)?,
            degrees: adaptivity.degrees.map(DegreeChoice::new),
            length,
            duration: plan.end() - plan.start(),
            same_time: plan.same_time(0.0),
            start: self.state.clone(),
        };
        if adaptivity.first.is_none() {
            let first = FIRST * control.travel_time(self.body, &self.state)?;
            control.controller.restart(first, StepLimit::Start);
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

    /// Changes to the cheapest degree, if trials are due, after a step with its size and error. `longest`: another
    /// limit of the size.
    fn choose_degree(
        &mut self,
        control: &mut Control<'a>,
        (size, error): (f64, f64),
        longest: f64,
    ) -> Result<()> {
        let aim = Controller::AIM * control.adaptivity.tolerance;
        let Some(mut choice) = control.degrees else { return Ok(()) };
        let is_telling = error >= MIN_TELLING_ERROR * aim || size >= 0.5 * longest;
        if choice.is_due(is_telling) {
            let work = |degree: usize, size: f64| degree as f64 / size.min(longest);
            let element = time_element(self.scheme)?;
            let own = size_of(LocalError::order(element), size, error / aim);
            let mut best = (MAX_WORK_RATIO * work(element.degree, own), None);
            for degree in choice.neighbours(element.degree) {
                let Some(error) = self.error_of_degree(control, degree, size) else { continue };
                let size = size_of(LocalError::order(TimeElement { degree, ..element }), size, error / aim);
                if work(degree, size) < best.0 {
                    best = (work(degree, size), Some((degree, size)));
                }
            }
            choice.wait(best.1.is_some());
            if let (_, Some((degree, size))) = best {
                self.change_degree(control, degree, size)?;
            }
        }
        control.degrees = Some(choice);
        Ok(())
    }

    /// Error of a step of another degree from the start of the last step; none if it fails. Trials are rare, so they
    /// allocate everything again.
    fn error_of_degree(&self, control: &Control<'a>, degree: usize, size: f64) -> Option<f64> {
        let element = time_element(self.scheme_of(degree).ok()?).ok()?;
        let mut end: State = control.start.clone();
        let mut stepper = Scheme::from(element).stepper(self.body, self.settings, &mut end).ok()?;
        let kind = self.kind_of_estimator(&control.adaptivity, element);
        let estimator = LocalError::new(self.body, element, kind, self.settings, &control.start);
        let mut estimator = estimator.ok()?;
        stepper.advance(&mut end, size).ok()?;
        estimator.estimate(&control.start, &end, stepper.rates(), size).ok()?;
        Some(control.size_of_error(self.body, &estimator)).filter(|error| error.is_finite())
    }

    fn change_degree(&mut self, control: &mut Control<'a>, degree: usize, size: f64) -> Result<()> {
        let message =
            format!("elements of degree {degree} after {}, steps of {size:.3e}", self.scheme.degree());
        self.set_degree(degree)?;
        control.estimator = self.estimator(&control.adaptivity)?;
        let order = LocalError::order(time_element(self.scheme)?);
        control.controller = Controller::new(&control.adaptivity, order, size, StepLimit::Error);
        self.note(EventKind::Degree, self.state.step, message);
        Ok(())
    }
}

/// The time element of a scheme.
///
/// # Errors
/// [`Error::Scheme`] if it is none.
fn time_element(scheme: Scheme) -> Result<TimeElement> {
    scheme.time_element().ok_or_else(|| Error::Scheme {
        scheme: scheme.name(),
        reason: "adaptive steps need a time element".to_string(),
    })
}
