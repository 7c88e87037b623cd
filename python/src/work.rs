//! The state of a motion behind its lock.

use std::sync::Arc;

use emmy::adjoint::Trajectory;
use emmy::body::Fields;
use emmy::motion::RunStatistics;
use emmy_io::accuracy::{self, Accuracy};
use emmy_io::checkpoint::{Checkpoint, Identity};
use emmy_io::input::Tree;
use emmy_io::summary;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::running::Running;
use crate::step::Step;

/// A motion behind its lock.
pub(crate) struct Work {
    pub(crate) running: Running,
    /// The sections of the input that describe the motion.
    pub(crate) sections: Vec<(String, Tree)>,
    pub(crate) has_plan: bool,
    /// Remarks of the reader that concern the motion.
    pub(crate) notes: Vec<String>,
    /// Statistics up to the last warnings.
    warned_up_to: RunStatistics,
    /// The lowest elastic period, once it is computed.
    period: Option<Option<f64>>,
}

impl Work {
    pub(crate) fn new(
        running: Running,
        sections: Vec<(String, Tree)>,
        has_plan: bool,
        notes: Vec<String>,
    ) -> Self {
        let warned_up_to = running.motion().statistics().clone();
        Work { running, sections, has_plan, notes, warned_up_to, period: None }
    }

    /// The last step, or the start.
    pub(crate) fn step(&self) -> Step {
        let recorder = &self.running.recorder;
        let record = self.running.motion().record();
        let row = recorder.rows[recorder.rows.len() - recorder.names.len()..].to_vec();
        let solver = record.solver.map(|solver| solver.to_string());
        let counts = (record.cuts, record.rejections, record.releases, record.degree, solver);
        Step::with(recorder.names.clone(), row, counts)
    }

    /// The fields of the body, computed on first use.
    pub(crate) fn fields(&mut self) -> Arc<Fields> {
        if let Some(fields) = &self.running.fields {
            return fields.clone();
        }
        let fields = Arc::new(Fields::new(self.running.motion().body()));
        self.running.fields.insert(fields).clone()
    }

    /// The run to which a snapshot belongs.
    pub(crate) fn identity(&mut self) -> Identity {
        let problem = self.running.cell.borrow_owner();
        self.running.identity.get_or_insert_with(|| Identity::new(problem)).clone()
    }

    /// Everything that determines the rest of the motion.
    pub(crate) fn checkpoint(&mut self) -> Checkpoint {
        let identity = self.identity();
        Checkpoint::of(identity, self.running.motion())
    }

    /// The statement on the accuracy in time of the steps so far.
    pub(crate) fn accuracy(&mut self) -> Option<Accuracy> {
        let (problem, statistics) = (self.running.problem(), self.running.motion().statistics());
        let known = &mut self.period;
        let period = || *known.get_or_insert_with(|| accuracy::lowest_period(problem));
        Accuracy::of(problem, &self.running.plan, statistics, None, period)
    }

    /// Warnings about the steps since the last call.
    pub(crate) fn warnings(&mut self) -> Vec<String> {
        let now = self.running.motion().statistics().clone();
        let before = std::mem::replace(&mut self.warned_up_to, now.clone());
        let is_small =
            |then: &RunStatistics| then.smallest_gap.is_some_and(|gap| gap.value < summary::SMALL_GAP);
        let mut warnings = summary::warnings(&RunStatistics {
            steps: now.steps - before.steps,
            unresolved_loads: now.unresolved_loads - before.unresolved_loads,
            unresolved_turns: now.unresolved_turns - before.unresolved_turns,
            rounding: if now.rounding > before.rounding { now.rounding } else { 0.0 },
            smallest_gap: now.smallest_gap.filter(|_| !is_small(&before)),
            ..Default::default()
        });
        if now.cuts > before.cuts {
            let times = match now.cuts - before.cuts {
                1 => "once".to_string(),
                cuts => format!("{cuts} times"),
            };
            warnings.push(format!("failed steps were halved {times}; see `motion.events`"));
        }
        warnings
    }

    /// The trajectory of a motion that has done a step.
    pub(crate) fn trajectory(&self) -> PyResult<&Trajectory<'_>> {
        match &self.running.cell.borrow_dependent().trajectory {
            None => Err(PyRuntimeError::new_err("the motion keeps no trajectory; make it with adjoint=True")),
            Some(trajectory) if trajectory.n_steps() == 0 => {
                Err(PyRuntimeError::new_err("the motion has not done a step yet"))
            }
            Some(trajectory) => Ok(trajectory),
        }
    }
}
