//! Control of the step sizes by the error.

use super::Adaptivity;
use super::adaptivity::Controller;
use super::degree_choice::DegreeChoice;
use crate::body::Body;
use crate::error::Result;
use crate::time::{LocalError, Memory, State};

/// Control of the step sizes of a motion by the error of each step.
#[derive(Debug)]
pub(in crate::motion) struct Control<'a> {
    pub adaptivity: Adaptivity,
    pub controller: Controller,
    pub estimator: LocalError<'a>,
    pub degrees: Option<DegreeChoice>,
    /// Scale of positions.
    pub length: f64,
    /// Duration of the plan.
    pub duration: f64,
    /// Times closer together are equal.
    pub same_time: f64,
    /// The state at the start of the step.
    pub start: State,
}

/// The first step over [`Control::travel_time`].
pub(in crate::motion) const FIRST: f64 = 0.01;

/// The largest step after a kink over this time; the smallest is the first one. Between them, the size before the kink
/// says more about the motion: steps in the shake of `benches` that grew from the first size after each kink had a
/// hundred thousandth of the tolerated error.
pub(in crate::motion) const AFTER_KINK: f64 = 0.3;

impl<'a> Control<'a> {
    /// Memory that the next size depends on.
    pub(in crate::motion) fn memory(&self, degree: usize) -> Memory {
        let mut memory = self.estimator.memory();
        self.controller.save(&mut memory);
        if let Some(choice) = &self.degrees {
            choice.save(degree, &mut memory);
        }
        memory
    }

    /// Time in which the body moves by its own length, at most that of the plan.
    pub(in crate::motion) fn travel_time(&self, body: &Body, state: &State) -> Result<f64> {
        let acceleration = LocalError::acceleration(body, state)?;
        let by_velocity = self.length / body.mass_weighted_rms(&state.velocity);
        let by_acceleration = (2.0 * self.length / body.mass_weighted_rms(&acceleration)).sqrt();
        Ok(by_velocity.min(by_acceleration).min(self.duration))
    }

    /// Error of the last step: the larger of the errors of positions and velocities, in their scales.
    pub(in crate::motion) fn error(&self, body: &Body) -> f64 {
        self.size_of_error(body, &self.estimator)
    }

    /// The same for the errors of a given estimator.
    pub(in crate::motion) fn size_of_error(&self, body: &Body, estimator: &LocalError<'_>) -> f64 {
        let position = body.mass_weighted_rms(estimator.displacement()) / self.length;
        match self.adaptivity.velocity {
            Some(scale) => larger(position, body.mass_weighted_rms(estimator.velocity()) / scale),
            None => position,
        }
    }
}

/// Larger of two errors; NaN if either is NaN.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
