//! The loop over the steps of a plan.

use super::failure::{event_of_cut, is_lost, may_shrink_after};
use super::stepping::SmallestStep;
use super::{
    EventKind, MarchError, Motion, Observer, ObserverResult, PlannedStep, Record, Resolution, StepPlan,
    Subdivision,
};
use crate::error::{Error, Result};
use crate::input::SAME_TIME;
use crate::number::short;
use crate::time::{LARGEST_ROUNDING, Scheme};

impl Motion<'_> {
    /// Marches through a plan from wherever the motion is in it. Observers see the present state and every step.
    ///
    /// # Errors
    /// [`MarchError::Step`] if a step fails, [`MarchError::Observer`] if an observer does. State and record then belong
    /// to the last good step, and the motion can go on.
    pub fn march(&mut self, plan: &StepPlan, observers: &mut [&mut dyn Observer]) -> Result<(), MarchError> {
        self.notify(observers)?;
        self.march_on(plan, observers)
    }

    /// Marches through the rest of a plan. Observers see every step, but not the present state. The time may differ
    /// from the plan's grid by rounding; from a time inside a planned step, the march first completes that step.
    ///
    /// # Errors
    /// As [`Motion::march`].
    pub fn march_on(
        &mut self,
        plan: &StepPlan,
        observers: &mut [&mut dyn Observer],
    ) -> Result<(), MarchError> {
        self.follow(plan)?;
        while self.step_along(plan, observers)? {}
        Ok(())
    }

    /// Does the next step of a plan from wherever the motion is, or the next substep of a planned step that was cut.
    /// `None` at the end of the plan. A loop of such steps has the same bits as [`Motion::march_on`].
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
    /// let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.4 }])?;
    /// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?;
    /// let mut times = Vec::new();
    /// while let Some(record) = motion.next_step(&plan, &mut [])? {
    ///     times.push(record.time);
    /// }
    /// assert_eq!(times, [0.4, 0.8, 1.0]);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Motion::march`].
    pub fn next_step(
        &mut self,
        plan: &StepPlan,
        observers: &mut [&mut dyn Observer],
    ) -> Result<Option<&Record>, MarchError> {
        self.follow(plan)?;
        Ok(self.step_along(plan, observers)?.then_some(&self.record))
    }

    /// Prepares the steps of a plan, unless the motion follows it already; every march does so first. Smooth functions
    /// of time are evaluated over the whole plan, for their largest values.
    ///
    /// # Errors
    /// Those of the first size of adaptive steps; [`Error::Plan`] for a motion at a time before the plan begins.
    pub fn follow(&mut self, plan: &StepPlan) -> Result<()> {
        let (time, start) = (self.state.time, plan.start());
        if start - time > SAME_TIME * (plan.end() - start) {
            let reason =
                format!("it begins at t = {}, and the motion is at t = {}", short(start), short(time));
            return Err(Error::Plan { phase: 0, reason });
        }
        if self.plan.as_ref() != Some(plan) {
            self.planned = None;
            self.resolution = Resolution::new(self.body, self.scheme, plan);
            self.plan = Some(plan.clone());
        }
        match plan.adaptivity() {
            Some(adaptivity) => self.control_steps(plan, adaptivity),
            None => Ok(()),
        }
    }

    /// Does the next good step of the plan that the motion follows; false at its end.
    fn step_along(
        &mut self,
        plan: &StepPlan,
        observers: &mut [&mut dyn Observer],
    ) -> Result<bool, MarchError> {
        let is_done = match plan.adaptivity() {
            Some(adaptivity) => self.adaptive_step(plan, adaptivity, observers)?,
            None => self.planned_step(plan, observers)?,
        };
        if is_done {
            self.notify(observers)?;
            self.check_digits()?;
        }
        Ok(is_done)
    }

    /// Does the next step of a plan, or the next substep of a planned step that was cut; false at the end of the plan.
    fn planned_step(
        &mut self,
        plan: &StepPlan,
        observers: &mut [&mut dyn Observer],
    ) -> Result<bool, MarchError> {
        let Some(step) = self.step_of(plan) else { return Ok(false) };
        self.planned = Some(step);
        let mut failed = None;
        loop {
            let (size, until) = self.subdivision.next(&step);
            if let Err(error) = self.step_with_end(size, until) {
                let cut = self.cut(&step, size, error, failed);
                self.tell(observers)?;
                failed = Some(cut?);
                continue;
            }
            let end = self.subdivision.pass();
            if end.has_grown {
                self.note(EventKind::Grown, self.state.step, format!("step size back to {}", 2.0 * size));
            }
            if end.is_done {
                self.planned = None;
            }
            return Ok(true);
        }
    }

    /// The planned step in progress, or the next one of a plan.
    fn step_of(&mut self, plan: &StepPlan) -> Option<PlannedStep> {
        let time = self.state.time;
        let in_progress = self.planned.filter(|step| {
            let (size, _) = self.subdivision.next(step);
            (self.subdivision.start(step) - time).abs() <= SAME_TIME * size
        });
        if in_progress.is_some() {
            return in_progress;
        }
        let step = plan.steps_from(time).next()?;
        let sliver = SAME_TIME * step.size;
        if (self.subdivision.start(&step) - time).abs() <= sliver {
            return Some(step);
        }
        self.subdivision = Subdivision { substep: 0, ..self.subdivision };
        if (step.start - time).abs() <= sliver {
            return Some(step);
        }
        Some(PlannedStep { start: time, size: step.end - time, ..step })
    }

    /// Cuts a failed step by two. Returns its error; `before`: that of the last size, which counts once a step is lost
    /// in the rounding of the time.
    ///
    /// # Errors
    /// The error of the step, if it may not be cut; [`Error::SmallestStep`] if it has been cut before.
    fn cut(
        &mut self,
        step: &PlannedStep,
        size: f64,
        error: Error,
        before: Option<Error>,
    ) -> Result<Error, MarchError> {
        if !may_shrink_after(&error) {
            return Err(MarchError::Step(self.final_error(size, error, before)));
        }
        let may_be_cut = match self.smallest {
            None => false,
            Some(SmallestStep::Halvings(most)) => self.subdivision.halvings < most,
            Some(SmallestStep::Size(smallest)) => 0.5 * size >= smallest * (1.0 - SAME_TIME),
        };
        if !may_be_cut {
            let was_cut = size < step.size;
            return Err(MarchError::Step(if was_cut {
                self.smallest_step_error(size, error)
            } else {
                error
            }));
        }
        self.subdivision.cut();
        self.cuts += 1;
        let what = if self.scheme == Scheme::Static { "increment" } else { "step" };
        let message = format!("{what} cut to {}: {error}", short(0.5 * size));
        self.note(event_of_cut(&error), self.state.step + 1, message);
        Ok(error)
    }

    /// The error of a step that no smaller size can help.
    pub(super) fn final_error(&self, size: f64, error: Error, before: Option<Error>) -> Error {
        match before {
            Some(before) if is_lost(&error) => self.smallest_step_error(size, before),
            _ => error,
        }
    }

    /// The error of a step that failed with every size down to a given one.
    pub(super) fn smallest_step_error(&self, step_size: f64, cause: Error) -> Error {
        if self.scheme == Scheme::Static {
            let fraction = self.state.time;
            return Error::NoEquilibrium { fraction, increment: step_size, cause: Box::new(cause) };
        }
        let step = self.state.step + 1;
        let has_cells = self.body.has_cells();
        Error::SmallestStep { step, start: self.state.time, step_size, has_cells, cause: Box::new(cause) }
    }

    /// Ends a march in which rounding leaves fewer than three digits: smaller steps would not help.
    ///
    /// # Errors
    /// [`Error::NoDigits`].
    pub(super) fn check_digits(&self) -> Result<()> {
        let Record { step, time, rounding, .. } = self.record;
        if rounding <= LARGEST_ROUNDING {
            return Ok(());
        }
        Err(Error::NoDigits { step, time, digits: -rounding.log10() })
    }

    /// Passes new events to the observers.
    pub(super) fn tell(&mut self, observers: &mut [&mut dyn Observer]) -> Result<(), MarchError> {
        // After an error of an observer the next call tells the rest.
        while !self.events.is_empty() {
            let event = self.events.remove(0);
            let told = self.all_told(observers, |observer| observer.notice(&event));
            self.agree_on(told)?;
        }
        Ok(())
    }

    /// Tells the observers, up to the first that fails; on a team all of them, since another may call all ranks.
    fn all_told(
        &self,
        observers: &mut [&mut dyn Observer],
        tell: impl Fn(&mut dyn Observer) -> ObserverResult,
    ) -> ObserverResult {
        let mut outcome = Ok(());
        for observer in observers {
            if outcome.is_ok() {
                outcome = tell(&mut **observer);
            } else if self.body.space.is_shared() {
                // The first error counts.
                _ = tell(&mut **observer);
            }
        }
        outcome
    }

    /// The outcome of the observers: on a team an error of one rank ends the march of all.
    fn agree_on(&self, outcome: ObserverResult) -> Result<(), MarchError> {
        let told = match &outcome {
            Ok(()) => Ok(()),
            Err(error) => Err(Error::Observer { message: error.to_string() }),
        };
        let agreed = self.body.space.agree(told);
        outcome.map_err(MarchError::Observer)?;
        Ok(agreed?)
    }

    pub(super) fn notify(&mut self, observers: &mut [&mut dyn Observer]) -> Result<(), MarchError> {
        self.tell(observers)?;
        let view = self.view();
        let told = self.all_told(observers, |observer| observer.observe(view));
        self.agree_on(told)
    }
}
