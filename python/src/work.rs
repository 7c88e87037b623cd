//! The state of a motion behind its lock.

use std::sync::Arc;

use emmy::adjoint::Trajectory;
use emmy::body::Fields;
use emmy_io::checkpoint::Identity;
use emmy_io::input::Tree;
use emmy_io::summary;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::adjoint::Goal;
use crate::errors;
use crate::running::Running;
use crate::step::Step;

/// A motion behind its lock.
pub(crate) struct Work {
    pub(crate) running: Running,
    /// The sections of the input that describe the motion.
    pub(crate) further: Vec<(String, Tree)>,
    pub(crate) has_plan: bool,
    /// Remarks of the reader that concern the motion.
    pub(crate) notes: Vec<String>,
    /// The step up to which doubts were told, and the halvings before it.
    pub(crate) told: (usize, usize),
}

impl Work {
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

    /// Doubts about the steps since the last call.
    pub(crate) fn doubts(&mut self) -> Vec<String> {
        let statistics = self.running.motion().statistics();
        let (steps, cuts) = std::mem::replace(&mut self.told, (statistics.steps, statistics.cuts));
        if statistics.steps == steps {
            return Vec::new();
        }
        let mut doubts = summary::warnings(statistics);
        if statistics.cuts > cuts {
            let halvings = statistics.cuts - cuts;
            doubts.push(format!(
                "steps failed and were halved, {halvings} times in all; the events say where and why"
            ));
        }
        doubts
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

    /// Checks that a goal belongs to the body.
    pub(crate) fn check_goal(&self, py: Python<'_>, goal: &Goal) -> PyResult<()> {
        match self.running.motion().state().displacement.len() == goal.goal.displacement.len() {
            true => Ok(()),
            false => Err(errors::argument(py, "goal", "it belongs to a body with another number of nodes")),
        }
    }
}
