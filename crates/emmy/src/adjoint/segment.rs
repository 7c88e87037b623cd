//! Steps between two checkpoints, repeated.

use super::step::StepData;
use crate::error::Result;
use crate::time::{Memory, StageCoefficients, State, Stepper, TimeElementStepper};

/// The complete motion after a step.
#[derive(Debug, Clone)]
pub(super) struct Checkpoint {
    pub state: State,
    pub memory: Memory,
}

/// Size and end of a step to repeat.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepSize {
    pub size: f64,
    /// Time at the end, which need not be the sum.
    pub end: f64,
}

/// States and rates of the steps of a segment.
#[derive(Debug, Default)]
pub(super) struct Segment {
    /// The state at the start and after each step.
    states: Vec<State>,
    /// Rates of each step, `[k][n_nodes][3]`.
    rates: Vec<Vec<f64>>,
    sizes: Vec<f64>,
}

impl Segment {
    /// Repeats the steps that follow a checkpoint.
    ///
    /// # Errors
    /// As [`Stepper::restore`] and [`Stepper::advance`].
    pub(super) fn redo(
        &mut self,
        stepper: &mut TimeElementStepper<'_>,
        checkpoint: &Checkpoint,
        steps: &[StepSize],
    ) -> Result<()> {
        stepper.restore(&checkpoint.memory)?;
        let mut state = checkpoint.state.clone();
        self.states.clear();
        self.rates.clear();
        self.sizes.clear();
        self.states.push(state.clone());
        for step in steps {
            stepper.advance(&mut state, step.size)?;
            (state.time, state.step) = (step.end, state.step + 1);
            self.states.push(state.clone());
            self.rates.push(stepper.rates().to_vec());
            self.sizes.push(step.size);
        }
        Ok(())
    }

    /// Number of steps.
    pub(super) fn len(&self) -> usize {
        self.sizes.len()
    }

    /// The states at the start and the end of a step.
    pub(super) fn ends(&self, index: usize) -> [&State; 2] {
        [&self.states[index], &self.states[index + 1]]
    }

    /// A step of an element with its coefficients.
    pub(super) fn step<'a>(&'a self, coefficients: &'a StageCoefficients, index: usize) -> StepData<'a> {
        let state = &self.states[index];
        StepData {
            rule: &coefficients.rule,
            inverse: &coefficients.mass,
            time: state.time,
            size: self.sizes[index],
            displacement: &state.displacement,
            velocity: &state.velocity,
            rates: &self.rates[index],
        }
    }
}
