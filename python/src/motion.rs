//! Motions.

use std::sync::{Mutex, MutexGuard, TryLockError};
use std::time::Duration;

use emmy::body::{FieldName, Fields, NodalMotion, Place, Selection};
use emmy::mesh::Mesh;
use emmy::motion::{MarchError, State};
use emmy_io::directory;
use emmy_io::results::Results;
use emmy_io::summary::Status;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::adjoint::{Goal, GoalError, Gradient, Parameter};
use crate::body::{Body, Sparse, entries, sparse};
use crate::function::Callables;
use crate::mesh::{table_of, vectors};
use crate::snapshot::{Snapshot, StateTuple, tuple};
use crate::starting::{self, Begin, Given};
use crate::step::{Step, is_whole};
use crate::tree::tree;
use crate::work::Work;
use crate::{errors, plan, pool};

/// A motion. It is locked while it works; `try_lock` gives a second thread an error at once.
#[pyclass(frozen, module = "emmy._emmy")]
pub(crate) struct Motion {
    body: Py<Body>,
    work: Mutex<Work>,
}

impl Motion {
    fn lock(&self) -> PyResult<MutexGuard<'_, Work>> {
        match self.work.try_lock() {
            Ok(work) => Ok(work),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "the motion is at work in another thread, or in a function that it calls",
            )),
            Err(TryLockError::Poisoned(_)) => Err(PyRuntimeError::new_err(
                "an internal error interrupted a step; this motion cannot be used any more",
            )),
        }
    }

    /// Passes the present state to a function.
    pub(crate) fn with_state<T>(&self, work: impl FnOnce(&State) -> T) -> PyResult<T> {
        Ok(work(self.lock()?.running.motion().state()))
    }

    /// The result of the stage equations at rates.
    fn at_rates<T: Send>(
        &self,
        py: Python<'_>,
        rates: &PyReadonlyArray2<'_, f64>,
        equations: impl FnOnce(&mut emmy::motion::Motion<'_>, &[f64]) -> emmy::Result<T> + Send,
    ) -> PyResult<T> {
        self.body.get().check_nodes(py)?;
        let rates: Vec<f64> = rates.as_array().iter().copied().collect();
        let mut work = self.lock()?;
        let running = &mut work.running;
        let found = pool::work(py, || running.with_motion(|motion| equations(motion, &rates)))?;
        found.map_err(|error| errors::library(py, &error))
    }

    fn array<'py>(&self, py: Python<'py>, of: fn(&State) -> &[f64]) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let work = self.lock()?;
        let motion = work.running.motion();
        vectors(py, &of(motion.state())[..motion.body().mesh().n_dofs()])
    }
}

/// A field by its name.
fn field(py: Python<'_>, fields: &Fields, name: &str) -> PyResult<FieldName> {
    let unknown = || {
        let known: Vec<&str> = FieldName::ALL.map(FieldName::name).to_vec();
        errors::argument(py, "name", &format!("{name:?} is not a field; there is {}", known.join(", ")))
    };
    let found = FieldName::from_name(name).ok_or_else(unknown)?;
    match fields.has(found) {
        true => Ok(found),
        false => Err(errors::argument(py, "name", &format!("the body has no field {name:?}"))),
    }
}

/// The members of a group for a field; nodes of a group of cells see these cells alone.
fn selection(
    py: Python<'_>,
    fields: &Fields,
    mesh: &Mesh,
    name: FieldName,
    group: &str,
) -> PyResult<Selection> {
    let cells = mesh.groups().cells(group).ok();
    let nodes =
        || mesh.volume_nodes(group).map_err(|error| errors::argument(py, "group", &error.to_string()));
    match (name.place(), cells) {
        (Place::Cells, Some(cells)) => Ok(fields.select_cells(cells)),
        (Place::Cells, None) => {
            let message = format!("the mesh has no group {group:?} of cells, where \"{name}\" is");
            Err(errors::argument(py, "group", &message))
        }
        (Place::Nodes, Some(cells)) => Ok(fields.select_nodes_in(&nodes()?, cells.to_vec())),
        (Place::Nodes, None) => Ok(fields.select_nodes(&nodes()?)),
    }
}

#[pymethods]
impl Motion {
    #[new]
    #[pyo3(signature = (sections, body, start, adjoint))]
    fn new(
        py: Python<'_>,
        sections: &Bound<'_, PyAny>,
        body: Py<Body>,
        start: Option<Given<'_>>,
        adjoint: bool,
    ) -> PyResult<Self> {
        let begin = Begin::new(py, body.get(), start)?;
        let work = starting::start(py, body.get(), sections, begin, adjoint)?;
        Ok(Motion { work: Mutex::new(work), body })
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.body)
    }

    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.lock()?.running.motion().time())
    }

    #[getter]
    fn number(&self) -> PyResult<usize> {
        Ok(self.lock()?.running.motion().state().step)
    }

    #[getter]
    fn scheme(&self) -> PyResult<String> {
        Ok(self.lock()?.running.motion().scheme().to_string())
    }

    #[getter]
    fn degree(&self) -> PyResult<usize> {
        Ok(self.lock()?.running.motion().scheme().degree())
    }

    #[getter]
    fn has_plan(&self) -> PyResult<bool> {
        Ok(self.lock()?.has_plan)
    }

    /// End of the plan.
    #[getter]
    fn end(&self) -> PyResult<f64> {
        Ok(self.lock()?.running.plan.end())
    }

    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.array(py, |state| &state.displacement)
    }

    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.array(py, |state| &state.velocity)
    }

    #[getter]
    fn momentum<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.array(py, |state| &state.momentum)
    }

    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let work = self.lock()?;
        let motion = work.running.motion();
        let points = motion.body().mesh().points().as_flattened();
        let positions = points.iter().zip(&motion.state().displacement).map(|(x, u)| x + u);
        table_of(py, positions.collect(), 3)
    }

    fn state<'py>(&self, py: Python<'py>) -> PyResult<StateTuple<'py>> {
        let work = self.lock()?;
        let motion = work.running.motion();
        tuple(py, motion.body(), motion.state())
    }

    /// The last step, or the start.
    fn record(&self) -> PyResult<Step> {
        Ok(self.lock()?.step())
    }

    /// Name, dimension and meaning of each column of the history, and whether its numbers are whole.
    #[getter]
    fn columns(&self) -> PyResult<Vec<(String, String, String, bool)>> {
        let work = self.lock()?;
        let columns = emmy_io::history::HistoryColumns::of(work.running.problem());
        let tuple = |own: emmy_io::history::ColumnInfo| {
            let whole = is_whole(&own.name);
            (own.name, own.dimension, own.meaning, whole)
        };
        Ok(columns.described().map(tuple).collect())
    }

    /// Names of the columns that probes, reactions, extremes and values have.
    #[getter]
    fn asked(&self) -> PyResult<Vec<String>> {
        let columns = self.lock()?.running.problem().quantities.columns();
        Ok(columns.into_iter().map(|column| column.name).collect())
    }

    /// Rows of the history from one on.
    fn rows<'py>(&self, py: Python<'py>, first: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let work = self.lock()?;
        let recorder = &work.running.recorder;
        let columns = recorder.names.len();
        table_of(py, recorder.rows.get(first * columns..).unwrap_or_default().to_vec(), columns)
    }

    /// Step, time, kind and message of each event.
    fn events(&self) -> PyResult<Vec<(usize, f64, &'static str, String)>> {
        let work = self.lock()?;
        let events = work.running.recorder.events.iter();
        Ok(events.map(|event| (event.step, event.time, event.kind.name(), event.message.clone())).collect())
    }

    /// Largest angular momentum that the energy so far allows.
    #[getter]
    fn angular_momentum_scale(&self) -> PyResult<f64> {
        Ok(self.lock()?.running.motion().statistics().angular_momentum_scale)
    }

    /// Work of the largest force of a joint over the size of the mechanism.
    #[getter]
    fn energy_scale(&self) -> PyResult<f64> {
        Ok(self.lock()?.running.motion().statistics().energy_scale)
    }

    /// The statement on the accuracy in time; none before the first step.
    fn accuracy(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let mut work = self.lock()?;
        let work = &mut *work;
        let accuracy = pool::work(py, || work.accuracy())?;
        Ok(accuracy.map(|accuracy| accuracy.text))
    }

    #[getter]
    fn newton_residuals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_slice(py, self.lock()?.running.motion().stepper().newton_history()))
    }

    /// One step of a size.
    fn step(&self, py: Python<'_>, size: f64) -> PyResult<Step> {
        if !(size > 0.0 && size.is_finite()) {
            return Err(errors::argument(py, "size", &format!("must be positive and finite, not {size}")));
        }
        let mut work = self.lock()?;
        let running = &mut work.running;
        pool::work(py, || running.step(size))?.map_err(|error| errors::march(py, error))?;
        Ok(work.step())
    }

    /// Residual of the stage equations at rates `(degree n, 3)`.
    fn residual<'py>(
        &self,
        py: Python<'py>,
        rates: PyReadonlyArray2<'py, f64>,
        size: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let residual = self.at_rates(py, &rates, |motion, rates| motion.residual(rates, size))?;
        vectors(py, &residual)
    }

    /// Derivative of the residual by the rates.
    fn tangent<'py>(
        &self,
        py: Python<'py>,
        rates: PyReadonlyArray2<'py, f64>,
        size: f64,
    ) -> PyResult<Sparse<'py>> {
        sparse(py, &self.at_rates(py, &rates, |motion, rates| motion.tangent(rates, size))?)
    }

    /// The next step of the plan; `None` at its end.
    fn next(&self, py: Python<'_>) -> PyResult<Option<Step>> {
        let mut work = self.lock()?;
        if !work.has_plan {
            return Ok(None);
        }
        let running = &mut work.running;
        let steps = pool::work(py, || running.advance(Duration::ZERO, None))?;
        let steps = steps.map_err(|error| errors::march(py, error))?;
        Ok((steps > 0).then(|| work.step()))
    }

    /// Remarks of the reader that concern the motion.
    #[getter]
    fn notes(&self) -> PyResult<Vec<String>> {
        Ok(self.lock()?.notes.clone())
    }

    /// Warnings about the steps since the last call.
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let mut work = self.lock()?;
        let work = &mut *work;
        pool::work(py, || work.warnings())
    }

    /// A motion that continues from the present state with the same plan.
    fn copy(&self, py: Python<'_>) -> PyResult<Self> {
        let work = starting::copy(py, self.body.get(), &mut *self.lock()?)?;
        Ok(Motion { work: Mutex::new(work), body: self.body.clone_ref(py) })
    }

    /// Steps of the plan during a wall time in seconds, at least one; returns their number, 0 at the end of the plan or
    /// at a time.
    fn advance(&self, py: Python<'_>, seconds: f64, until: Option<f64>) -> PyResult<usize> {
        let mut work = self.lock()?;
        let slice =
            Duration::try_from_secs_f64(seconds).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let running = &mut work.running;
        let steps = pool::work(py, || running.advance(slice, until))?;
        steps.map_err(|error| errors::march(py, error))
    }

    /// Moves the end of the plan.
    fn extend(&self, py: Python<'_>, until: f64, size: Option<f64>) -> PyResult<()> {
        let mut work = self.lock()?;
        let now = work.running.motion().time();
        if !(until > now && until.is_finite()) {
            let message = format!("the plan must end after the present time, {now}, not at {until}");
            return Err(errors::argument(py, "until", &message));
        }
        if !work.has_plan && size.is_none() {
            return Err(errors::argument(py, "size", "the motion has no plan: give the size of the steps"));
        }
        let mut sections = work.sections.clone();
        let plan = work.has_plan.then(|| work.running.plan.clone());
        plan::extend(&mut sections, plan.as_ref(), now, until, size);
        let problem = self.body.get().problem(py, sections.clone())?;
        work.running.plan = problem.plan.clone();
        (work.sections, work.has_plan) = (sections, true);
        Ok(())
    }

    /// A field at the present state; of a group at its members.
    #[pyo3(signature = (name, group = None))]
    fn field<'py>(&self, py: Python<'py>, name: &str, group: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
        let mut work = self.lock()?;
        let fields = work.fields();
        let name = field(py, &fields, name)?;
        let motion = work.running.motion();
        let members = group.map(|group| selection(py, &fields, motion.body().mesh(), name, group));
        let members = members.transpose()?;
        let reference = motion.reference().filter(|_| name.is_of_motion());
        let [displacement, velocity] = motion.seen_from(reference);
        let is_accelerated = name == FieldName::Acceleration;
        let acceleration = if is_accelerated { motion.mean_acceleration(reference) } else { Vec::new() };
        let seen =
            NodalMotion { displacement: &displacement, velocity: &velocity, acceleration: &acceleration };
        let numbers = pool::work(py, || match &members {
            Some(members) => fields.on(members, seen, name),
            None => fields.at(seen, &[name]).remove(0).numbers,
        })?;
        match name.components().len() {
            1 => Ok(PyArray1::from_vec(py, numbers).into_any()),
            n => Ok(table_of(py, numbers, n)?.into_any()),
        }
    }

    /// Names of the fields that the body has.
    fn field_names(&self) -> PyResult<Vec<&'static str>> {
        let fields = self.lock()?.fields();
        Ok(FieldName::ALL.into_iter().filter(|&name| fields.has(name)).map(FieldName::name).collect())
    }

    /// Whether a field has values at `nodes` or in `cells`, by its name.
    #[getter]
    fn fields_at<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let table = PyDict::new(py);
        for name in FieldName::ALL {
            table.set_item(name.name(), if name.place() == Place::Cells { "cells" } else { "nodes" })?;
        }
        Ok(table)
    }

    fn snapshot(&self) -> PyResult<Snapshot> {
        let checkpoint = self.lock()?.checkpoint();
        Ok(Snapshot { checkpoint })
    }

    /// Opens the files of a run, with a table `output`; everything that `emmy run` writes is then written.
    fn open(&self, py: Python<'_>, output: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut work = self.lock()?;
        let mut sections = work.sections.clone();
        let given = entries(tree(output, "output", &mut Callables::default())?);
        plan::add_output(&mut sections, given);
        let problem = self.body.get().problem(py, sections)?;
        let running = &mut work.running;
        let opened = pool::work(py, || -> Result<(), MarchError> {
            let failed = |error: directory::DirectoryError| MarchError::Observer(Box::new(error));
            directory::check_run(&problem).map_err(failed)?;
            let results = Results::create(&problem).map_err(failed)?;
            running.plan = problem.plan.clone();
            running.open(results)
        })?;
        opened.map_err(|error| errors::march(py, error))
    }

    /// Ends the files of a run and returns the summary as JSON.
    fn close(&self, py: Python<'_>, status: &str, message: Option<String>) -> PyResult<String> {
        let all =
            [Status::Done, Status::NoConvergence, Status::LimitExceeded, Status::Interrupted, Status::Failed];
        let status = all.into_iter().find(|own| own.name() == status);
        let status = status.ok_or_else(|| PyValueError::new_err("not a status of a run"))?;
        let mut work = self.lock()?;
        let running = &mut work.running;
        let ended = pool::work(py, || {
            let mut results = running.results.take()?;
            Some((
                results.finish(running.problem(), running.motion(), status, message.as_deref()),
                results.report(),
            ))
        })?;
        let Some((ended, report)) = ended else { return Ok("null".to_string()) };
        if let Some(error) = ended.error {
            return Err(errors::results(py, &format!("the results cannot be written: {error}")));
        }
        report.map_err(|error| errors::results(py, &format!("no report was written: {error}")))?;
        Ok(ended.summary.to_string())
    }

    /// Derivatives of a goal.
    fn gradient(
        &self,
        py: Python<'_>,
        goal: &Goal,
        parameters: Vec<PyRef<'_, Parameter>>,
    ) -> PyResult<Gradient> {
        let work = self.lock()?;
        let trajectory = work.trajectory()?;
        let n_dofs = work.running.motion().body().mesh().n_dofs();
        goal.check(py, work.running.motion().state())?;
        let parameters: Vec<_> = parameters.iter().map(|own| own.parameter.clone()).collect();
        let gradient = pool::work(py, || trajectory.gradient(&goal.goal, &parameters))?;
        let gradient = gradient.map_err(|error| errors::library(py, &error))?;
        Ok(Gradient { gradient, n_dofs })
    }

    /// Error of a goal.
    fn goal_error(&self, py: Python<'_>, goal: &Goal) -> PyResult<GoalError> {
        let work = self.lock()?;
        let trajectory = work.trajectory()?;
        goal.check(py, work.running.motion().state())?;
        let error = pool::work(py, || trajectory.goal_error(&goal.goal))?;
        Ok(GoalError { error: error.map_err(|error| errors::library(py, &error))? })
    }
}
