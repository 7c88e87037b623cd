//! Goals, gradients, errors of goals.

use std::cell::RefCell;

use emmy::adjoint;
use emmy::motion::State;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::body::Body;
use crate::errors;
use crate::mesh::vectors;
use crate::motion::Motion;

/// A quantity at the end of a motion.
#[pyclass(frozen, module = "emmy._emmy")]
pub(crate) struct Goal {
    pub(crate) goal: adjoint::Goal,
}

impl Goal {
    fn at(
        py: Python<'_>,
        body: &Body,
        node: usize,
        direction: [f64; 3],
        goal: fn(&emmy::body::Body, usize, [f64; 3]) -> adjoint::Goal,
    ) -> PyResult<Self> {
        let n = body.inner().mesh().n_nodes();
        if node >= n {
            let message = format!("there is no node {node} among {n}, counted from 0");
            return Err(errors::argument(py, "node", &message));
        }
        Ok(Goal { goal: goal(body.inner(), node, direction) })
    }

    /// Checks that it belongs to the body of a state.
    pub(crate) fn check(&self, py: Python<'_>, state: &State) -> PyResult<()> {
        match state.displacement.len() == self.goal.displacement.len() {
            true => Ok(()),
            false => Err(errors::argument(py, "goal", "it belongs to a body with another number of nodes")),
        }
    }
}

#[pymethods]
impl Goal {
    #[staticmethod]
    fn displacement_at(py: Python<'_>, body: &Body, node: usize, direction: [f64; 3]) -> PyResult<Self> {
        Goal::at(py, body, node, direction, adjoint::Goal::displacement_at)
    }

    #[staticmethod]
    fn velocity_at(py: Python<'_>, body: &Body, node: usize, direction: [f64; 3]) -> PyResult<Self> {
        Goal::at(py, body, node, direction, adjoint::Goal::velocity_at)
    }

    fn value(&self, py: Python<'_>, motion: &Motion) -> PyResult<f64> {
        motion.with_state(|state| {
            self.check(py, state)?;
            Ok(self.goal.value(state))
        })?
    }
}

/// A parameter of a body.
#[pyclass(frozen, module = "emmy._emmy")]
pub(crate) struct Parameter {
    pub(crate) parameter: adjoint::Parameter,
}

#[pymethods]
impl Parameter {
    /// `body` makes the native body for a value.
    #[new]
    fn new(py: Python<'_>, value: f64, body: &Bound<'_, PyAny>, linear: bool, scale: f64) -> PyResult<Self> {
        let raised = RefCell::new(None);
        let make = |value: f64| {
            let made =
                body.call1((value,)).and_then(|body| Ok(body.extract::<PyRef<'_, Body>>()?.inner().clone()));
            made.map_err(|error| {
                let message = error.to_string();
                raised.replace(Some(error));
                emmy::Error::Observer { message }
            })
        };
        let parameter = match linear {
            true => adjoint::Parameter::linear(value, scale, make),
            false => adjoint::Parameter::smooth(value, scale, make),
        };
        match (raised.into_inner(), parameter) {
            (Some(raised), _) => Err(raised),
            (None, parameter) => Ok(Parameter {
                parameter: parameter.map_err(|error| errors::argument(py, "scale", &error.to_string()))?,
            }),
        }
    }
}

/// Derivatives of a goal.
#[pyclass(frozen, module = "emmy._emmy")]
pub(crate) struct Gradient {
    pub(crate) gradient: adjoint::Gradient,
    pub(crate) n_dofs: usize,
}

#[pymethods]
impl Gradient {
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(py, &self.gradient.displacement[..self.n_dofs])
    }

    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(py, &self.gradient.velocity[..self.n_dofs])
    }

    #[getter]
    fn momentum<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(py, &self.gradient.momentum[..self.n_dofs])
    }

    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.gradient.parameters)
    }
}

/// Estimated error of a goal.
#[pyclass(frozen, module = "emmy._emmy")]
pub(crate) struct GoalError {
    pub(crate) error: adjoint::GoalError,
}

#[pymethods]
impl GoalError {
    #[getter]
    fn steps<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.error.steps)
    }

    #[getter]
    fn total(&self) -> f64 {
        self.error.total()
    }

    #[getter]
    fn size(&self) -> f64 {
        self.error.size()
    }
}
