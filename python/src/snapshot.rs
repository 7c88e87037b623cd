//! States and snapshots.

use emmy::body::Body;
use emmy::motion::State;
use emmy_io::checkpoint::{self, Checkpoint};
use emmy_io::message::counted;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;
use crate::mesh::vectors;

/// Time, displacement, velocity, momentum, step, low part of the displacement, incompatible modes and coordinates of
/// joints if there are some.
pub(crate) type StateTuple<'py> =
    (f64, Array<'py>, Array<'py>, Array<'py>, usize, Array<'py>, Option<Array<'py>>, Option<List<'py>>);
type Array<'py> = Bound<'py, PyArray2<f64>>;
type List<'py> = Bound<'py, PyArray1<f64>>;

/// The same, given.
pub(crate) type StateArrays<'py> = (
    f64,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray2<'py, f64>,
    Option<PyReadonlyArray2<'py, f64>>,
    usize,
    Option<PyReadonlyArray2<'py, f64>>,
    Option<PyReadonlyArray2<'py, f64>>,
    Option<PyReadonlyArray1<'py, f64>>,
);

/// The arrays of a state.
pub(crate) fn tuple<'py>(py: Python<'py>, body: &Body, state: &State) -> PyResult<StateTuple<'py>> {
    let n = body.mesh().n_dofs();
    let array = |numbers: &[f64]| match numbers {
        [] => vectors(py, &vec![0.0; n]),
        numbers => vectors(py, &numbers[..n]),
    };
    let [displacement, velocity] = [array(&state.displacement)?, array(&state.velocity)?];
    let [momentum, low] = [array(&state.momentum)?, array(&state.displacement_low)?];
    let modes = body.modes_of(&state.displacement);
    let modes = if modes.is_empty() { None } else { Some(vectors(py, &modes)?) };
    let has_joints = !state.coordinates.is_empty();
    let coordinates = has_joints.then(|| PyArray1::from_slice(py, &state.coordinates));
    Ok((state.time, displacement, velocity, momentum, state.step, low, modes, coordinates))
}

/// The numbers of an array `(n, 3)` for the nodes of a body.
pub(crate) fn nodal(
    py: Python<'_>,
    body: &Body,
    array: &PyReadonlyArray2<'_, f64>,
    name: &str,
) -> PyResult<Vec<f64>> {
    let (array, n) = (array.as_array(), body.mesh().n_nodes());
    if array.dim() == (n, 3) {
        return Ok(array.iter().copied().collect());
    }
    let (rows, columns) = array.dim();
    Err(errors::argument(py, name, &format!("must have the shape ({n}, 3), not ({rows}, {columns})")))
}

/// The state of a body with given arrays; without a momentum it has p = M v.
pub(crate) fn arrays(py: Python<'_>, body: &Body, given: StateArrays<'_>) -> PyResult<State> {
    let (time, displacement, velocity, momentum, step, low, modes, coordinates) = given;
    let n = body.mesh().n_dofs();
    let numbers =
        |array: &PyReadonlyArray2<'_, f64>, name: &str| nodal(py, body, array, &format!("start.{name}"));
    let mut displacement = numbers(&displacement, "displacement")?;
    if let Some(modes) = modes {
        let (found, expected) = (modes.as_array().nrows(), (body.n_dofs() - n) / 3);
        if found != expected {
            let reason =
                format!("{found} vectors given, but the incompatible modes of the body need {expected}");
            return Err(errors::argument(py, "start.modes", &reason));
        }
        let modes: Vec<f64> = modes.as_array().iter().copied().collect();
        displacement = body.with_modes(displacement, &modes);
    }
    let displaced = State::displaced(body, time, displacement, &[]);
    let mut state = displaced.map_err(|error| errors::library(py, &error))?;
    state.velocity[..n].copy_from_slice(&numbers(&velocity, "velocity")?);
    if let Some(low) = low {
        state.displacement_low[..n].copy_from_slice(&numbers(&low, "displacement_low")?);
    }
    match momentum {
        Some(momentum) => state.momentum[..n].copy_from_slice(&numbers(&momentum, "momentum")?),
        None => state = state.transferred(body, time).map_err(|error| errors::library(py, &error))?,
    }
    if let Some(coordinates) = coordinates {
        let coordinates: Vec<f64> = coordinates.as_array().iter().copied().collect();
        let (found, expected) = (coordinates.len(), body.joints().len());
        if found != expected {
            let reason = format!(
                "{} given, but the body has {}",
                counted(found, "number", "numbers"),
                counted(expected, "joint", "joints")
            );
            return Err(errors::argument(py, "start.coordinates", &reason));
        }
        state.coordinates = coordinates;
    }
    state.step = step;
    Ok(state)
}

/// Everything that determines the rest of a motion.
#[pyclass(frozen, module = "emmy._emmy")]
pub(crate) struct Snapshot {
    pub(crate) checkpoint: Checkpoint,
}

#[pymethods]
impl Snapshot {
    #[getter]
    fn time(&self) -> f64 {
        self.checkpoint.snapshot.state.time
    }

    #[getter]
    fn number(&self) -> usize {
        self.checkpoint.snapshot.state.step
    }

    fn __bytes__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = checkpoint::bytes(&self.checkpoint).map_err(|error| errors::results(py, &error))?;
        Ok(PyBytes::new(py, &bytes))
    }

    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let read = checkpoint::parse(bytes);
        let checkpoint = read.map_err(|reason| errors::results(py, &format!("the snapshot {reason}")))?;
        Ok(Snapshot { checkpoint })
    }
}
