//! Single steps of a motion.

use std::f64::consts::PI;

use super::failure::placed;
use super::plan::SHORTEST;
use super::resolution::Unresolved;
use super::{EventKind, Motion, PlannedStep, Record};
use crate::error::{Error, Result};
use crate::input::SAME_TIME;
use crate::number::short;
use crate::tensor::dot3;
use crate::time::StepOutcome;

impl Motion<'_> {
    /// Advances by one step of a size and records it. A released support holds until the first step that starts at the
    /// time of release or after it.
    ///
    /// # Errors
    /// As [`Stepper::advance`](crate::time::Stepper::advance), after a release also as
    /// [`Scheme::stepper`](crate::time::Scheme::stepper); state and record then belong to the last good step.
    pub fn step(&mut self, step_size: f64) -> Result<&Record> {
        self.step_with_end(step_size, self.state.time + step_size)
    }

    /// Advances by one step that ends at a time.
    ///
    /// # Errors
    /// As [`Motion::step`].
    pub fn step_to(&mut self, end: f64) -> Result<&Record> {
        self.step_with_end(end - self.state.time, end)
    }

    /// Advances by a step of a plan, exactly to its end.
    ///
    /// # Errors
    /// As [`Motion::step`].
    pub fn step_of_plan(&mut self, step: &PlannedStep) -> Result<&Record> {
        self.step_with_end(step.size, step.end)
    }

    /// Advances by one step of a size; the time at its end may differ from the sum by rounding.
    pub(super) fn step_with_end(&mut self, step_size: f64, end: f64) -> Result<&Record> {
        self.release(SAME_TIME * step_size)?;
        let outcome = self.advance(step_size);
        let outcome = outcome.map_err(|error| placed(error, self.body, &self.state, step_size))?;
        let missed =
            self.resolution.as_ref().and_then(|resolution| resolution.unresolved(self.state.time, step_size));
        self.conclude(step_size, end, &outcome, missed);
        self.count_step();
        Ok(&self.record)
    }

    /// Advances the state. A state that is not finite is rejected, even if its residual is small.
    ///
    /// # Errors
    /// As [`Stepper::advance`](crate::time::Stepper::advance), [`Error::NoDuration`], [`Error::NotANumber`]; the state
    /// is then unchanged.
    pub(super) fn advance(&mut self, step_size: f64) -> Result<StepOutcome> {
        self.check_step_size(step_size)?;
        self.last.copy_from(&self.state);
        let outcome = self.stepper.advance(&mut self.state, step_size);
        // A given motion may fail at the end of the step.
        let outcome = outcome.inspect_err(|_| self.state.copy_from(&self.last))?;
        let lists = [&self.state.displacement, &self.state.velocity, &self.state.momentum];
        let dof = lists.iter().find_map(|list| list.iter().position(|value| !value.is_finite()));
        let node = self.body.space.lowest_node(dof.map(|dof| dof / 3));
        if node.is_none() && outcome.strain_state.strain_energy.is_finite() {
            return Ok(outcome);
        }
        self.state.copy_from(&self.last);
        let node = node.unwrap_or(0);
        let position = self.body.space.at_node(node, |node| self.state.position(self.body, node));
        let (step, time) = (self.state.step + 1, self.state.time + step_size);
        Err(Error::NotANumber { step, time, node, position })
    }

    /// Checks that a step takes time forward.
    ///
    /// # Errors
    /// [`Error::NoDuration`].
    pub(super) fn check_step_size(&self, step_size: f64) -> Result<()> {
        let time = self.state.time;
        match step_size > SHORTEST * time.abs() && step_size.is_finite() {
            true => Ok(()),
            false => Err(Error::NoDuration { time, step_size }),
        }
    }

    /// Records the step that led to the present state. `missed`: a function of time that it does not resolve.
    pub(super) fn conclude(
        &mut self,
        step_size: f64,
        end: f64,
        outcome: &StepOutcome,
        missed: Option<Unresolved>,
    ) {
        self.state.time = end;
        self.state.step += 1;
        self.state.is_equilibrium = false;
        self.record = self.record.after(self.body, &self.state, step_size, outcome);
        self.record.joints = self.stepper.joints().to_vec();
        if let Some(recorder) = &mut self.mechanism {
            recorder.set(self.body, &self.state, &mut self.record);
            self.note_turn(step_size);
        }
        self.reactions.clear();
        self.reactions.extend_from_slice(self.stepper.reactions());
        self.record.cuts = std::mem::take(&mut self.cuts);
        self.record.rejections = std::mem::take(&mut self.rejections);
        self.record.releases = std::mem::take(&mut self.released);
        self.record.degree = self.scheme.degree();
        self.record.is_unresolved = missed.is_some();
        if let Some(missed) = missed.filter(|_| self.statistics.unresolved_loads == 0) {
            let message = format!("a step of {} does not resolve {missed}", short(step_size));
            self.note(EventKind::Unresolved, self.state.step, message);
        }
        if self.record.at_rounding_floor && !self.was_at_rounding_floor {
            self.was_at_rounding_floor = true;
            let message = "Newton's iteration ended at the rounding floor, above the tolerance; the end of the run says how many digits are left";
            self.note(EventKind::RoundingFloor, self.state.step, message.to_string());
        }
    }

    /// Counts a step in which a rigid body turns further than the step can follow, and notes the first one.
    fn note_turn(&mut self, step_size: f64) {
        let turns = self.record.rigid_bodies.iter().map(|own| step_size * dot3(own.spin, own.spin).sqrt());
        let largest = turns.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((number, turn)) = largest.filter(|(_, turn)| *turn > self.largest_turn()) else {
            return;
        };
        self.record.is_turned_over = true;
        if self.statistics.unresolved_turns == 0 {
            let name = self.body.rigid_bodies().nth(number).map_or("", |own| own.name.as_str());
            let (turn, size) = (short(turn), short(step_size));
            let message = format!(
                "a step of {size} turns the rigid body \"{name}\" by {turn} rad, more than it can follow"
            );
            self.note(EventKind::Unresolved, self.state.step, message);
        }
    }

    /// Largest turn of a rigid body in a step: half a turn, or one of which a tenth is lost. A step of degree k turns
    /// by the diagonal Pade approximation of the exponential: `x^2/12` of a turn x is lost at degree 1, `x^4/720` at
    /// degree 2.
    fn largest_turn(&self) -> f64 {
        let tenth: f64 = match self.scheme.degree() {
            1 => 1.2f64.sqrt(),
            2 => 72f64.powf(0.25),
            _ => PI,
        };
        tenth.min(PI)
    }
}
