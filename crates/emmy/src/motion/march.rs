//! The loop over the steps of a plan.

use super::stepping::{SAME_TIME, SmallestStep};
use super::{
    EventKind, MarchError, Motion, Observer, PlannedStep, Record, Resolution, StepPlan, Subdivision, View,
};
use crate::error::{Error, Result};
use crate::number::short;
use crate::time::{LARGEST_ROUNDING, Scheme};

impl Motion<'_> {
    /// Marches through a plan. Observers see the start and every step.
    ///
    /// # Errors
    /// [`MarchError::Step`] if a step fails, [`MarchError::Observer`] if an observer does.
    pub fn march(&mut self, plan: &StepPlan, observers: &mut [&mut dyn Observer]) -> Result<(), MarchError> {
        self.notify(observers)?;
        self.resolution = Resolution::new(self.body, self.scheme, plan);
        if let Some(adaptivity) = plan.adaptivity() {
            return self.march_adaptively(plan, adaptivity, observers);
        }
        plan.steps().try_for_each(|step| self.march_through(&step, observers))
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
        self.resolution = Resolution::new(self.body, self.scheme, plan);
        if let Some(adaptivity) = plan.adaptivity() {
            return self.march_adaptively(plan, adaptivity, observers);
        }
        for mut step in plan.steps_from(self.state.time) {
            let sliver = SAME_TIME * step.size;
            if (self.subdivision.start(&step) - self.state.time).abs() > sliver {
                self.subdivision = Subdivision { substep: 0, ..self.subdivision };
                let start = self.state.time;
                if (step.start - start).abs() > sliver {
                    step = PlannedStep { start, size: step.end - start, ..step };
                }
            }
            self.march_through(&step, observers)?;
        }
        Ok(())
    }

    /// Does the rest of a planned step, in substeps where it fails.
    fn march_through(
        &mut self,
        step: &PlannedStep,
        observers: &mut [&mut dyn Observer],
    ) -> Result<(), MarchError> {
        loop {
            let (size, until) = self.subdivision.next(step);
            if let Err(error) = self.step_with_end(size, until) {
                let cut = self.cut(step, size, error);
                self.tell(observers)?;
                cut?;
                continue;
            }
            let end = self.subdivision.pass();
            if end.has_grown {
                self.note(EventKind::Grown, self.state.step, format!("step size back to {}", 2.0 * size));
            }
            self.notify(observers)?;
            self.check_digits()?;
            if end.is_done {
                return Ok(());
            }
        }
    }

    /// Cuts a failed step by two.
    ///
    /// # Errors
    /// The error of the step, if it may not be cut; [`Error::SmallestStep`] if it has been cut before.
    fn cut(&mut self, step: &PlannedStep, size: f64, error: Error) -> Result<(), MarchError> {
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
        self.note(EventKind::Cut, self.state.step + 1, format!("step cut to {}: {error}", short(0.5 * size)));
        Ok(())
    }

    /// The error of a step that failed with every size down to a given one.
    pub(super) fn smallest_step_error(&self, step_size: f64, cause: Error) -> Error {
        if self.scheme == Scheme::Static {
            let fraction = self.state.time;
            return Error::NoEquilibrium { fraction, increment: step_size, cause: Box::new(cause) };
        }
        let step = self.state.step + 1;
        Error::SmallestStep { step, start: self.state.time, step_size, cause: Box::new(cause) }
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
        for event in self.events.drain(..) {
            let told = observers.iter_mut().try_for_each(|observer| observer.notice(&event));
            told.map_err(MarchError::Observer)?;
        }
        Ok(())
    }

    pub(super) fn notify(&mut self, observers: &mut [&mut dyn Observer]) -> Result<(), MarchError> {
        self.tell(observers)?;
        let body = self.body;
        let state = &self.state;
        let record = &self.record;
        let newton_residuals = self.stepper.newton_history();
        let view = View { body, state, record, newton_residuals, motion: self };
        observers.iter_mut().try_for_each(|observer| observer.observe(view)).map_err(MarchError::Observer)
    }
}
