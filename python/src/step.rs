//! Rows of the history.

use std::sync::Arc;

use emmy::motion::StepLimit;
use pyo3::exceptions::{PyAttributeError, PyKeyError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// Counts of a step that are not columns.
pub(crate) type Counts = (usize, usize, usize, usize, Option<String>);

/// A step of a motion, or its start: the row of the history, and counts.
///
/// Every column of the history is an attribute and a key: `step.total_energy` is `step["total_energy"]`. Steps compare
/// and pickle by value.
///
/// Attributes
/// ----------
/// number : int
///     Number of the step; 0 at the start.
/// time, step_size : float
///     Time at the end, and size.
/// kinetic_energy, strain_energy, total_energy : float
///     Energies.
/// external_work : float
///     Work of loads and supports since the start.
/// energy_residual : float
///     Residual of the energy balance in the step, an energy.
/// linear_momentum, angular_momentum : array (3,)
///     Momenta.
/// newton_iterations, degree : int
///     Iterations of Newton's method, and degree in time.
/// cuts, rejections, releases : int
///     Halvings, rejected attempts, and released supports.
/// solver : str or None
///     Linear solver.
///
/// Examples
/// --------
/// >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
/// >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=2))
/// >>> motion = emmy.Motion(body, initial=emmy.Initial(velocity=(0, 0, 1)))
/// >>> step = motion.step(0.5)
/// >>> step.number, step.time, round(step["kinetic_energy"], 12)
/// (1, 0.5, 1.0)
#[pyclass(frozen, module = "emmy")]
pub(crate) struct Step {
    names: Arc<Vec<String>>,
    row: Vec<f64>,
    /// Cuts, rejections, releases, degree, linear solver.
    counts: Counts,
}

impl Step {
    pub(crate) fn with(names: Arc<Vec<String>>, row: Vec<f64>, counts: Counts) -> Self {
        Step { names, row, counts }
    }

    fn number_of(&self, name: &str) -> Option<f64> {
        let at = self.names.iter().position(|own| own == name)?;
        self.row.get(at).copied()
    }

    /// Names of the columns without the number of the step.
    fn columns(&self) -> impl Iterator<Item = &str> {
        self.names.iter().skip(1).map(String::as_str)
    }

    fn vector(&self, name: &str) -> [f64; 3] {
        ["x", "y", "z"].map(|axis| self.number_of(&format!("{name}_{axis}")).unwrap_or(f64::NAN))
    }
}

/// Columns of whole numbers.
pub(crate) fn is_whole(name: &str) -> bool {
    matches!(name, "step" | "newton_iterations" | "degree" | "contact_points")
}

#[pymethods]
impl Step {
    #[new]
    fn new(names: Vec<String>, row: Vec<f64>, counts: Counts) -> Self {
        Step { names: Arc::new(names), row, counts }
    }

    /// Number of the step; 0 at the start.
    #[getter]
    fn number(&self) -> usize {
        self.row.first().map_or(0, |&number| number as usize)
    }

    /// Linear momentum.
    #[getter]
    fn linear_momentum<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        numpy::PyArray1::from_slice(py, &self.vector("linear_momentum"))
    }

    /// Angular momentum about the origin.
    #[getter]
    fn angular_momentum<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        numpy::PyArray1::from_slice(py, &self.vector("angular_momentum"))
    }

    /// How often the step was halved.
    #[getter]
    fn cuts(&self) -> usize {
        self.counts.0
    }

    /// How often it was tried with a larger size.
    #[getter]
    fn rejections(&self) -> usize {
        self.counts.1
    }

    /// Number of supports released in it.
    #[getter]
    fn releases(&self) -> usize {
        self.counts.2
    }

    /// Degree in time.
    #[getter]
    fn degree(&self) -> usize {
        self.counts.3
    }

    /// Linear solver, if there was a system.
    #[getter]
    fn solver(&self) -> Option<&str> {
        self.counts.4.as_deref()
    }

    /// The columns of the history.
    fn __getattr__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let number = self.number_of(name).filter(|_| name != "step").ok_or_else(|| {
            PyAttributeError::new_err(format!(
                "a step has no attribute {name:?}; it has {}",
                self.columns().collect::<Vec<_>>().join(", ")
            ))
        })?;
        match name {
            "limited_by" => {
                let limit = StepLimit::ALL.get(number as usize).filter(|_| number >= 0.0);
                Ok(limit.map_or("", |limit| limit.name()).into_pyobject(py)?.into_any())
            }
            name if is_whole(name) => Ok((number as i64).into_pyobject(py)?.into_any()),
            _ => Ok(number.into_pyobject(py)?.into_any()),
        }
    }

    /// A column by its name.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        match name {
            "step" => Ok(self.number().into_pyobject(py)?.into_any()),
            name => self.__getattr__(py, name).map_err(|_| PyKeyError::new_err(name.to_string())),
        }
    }

    fn __dir__(&self) -> Vec<String> {
        let own = [
            "number",
            "linear_momentum",
            "angular_momentum",
            "cuts",
            "rejections",
            "releases",
            "degree",
            "solver",
        ];
        self.columns().chain(own).map(String::from).collect()
    }

    fn __eq__(&self, other: &Step) -> bool {
        // Missing numbers are equal.
        let is_same = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
        let have_rows = self.row.len() == other.row.len() && self.row.iter().zip(&other.row).all(is_same);
        self.names == other.names && have_rows && self.counts == other.counts
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let own = slf.get();
        let arguments = (own.names.to_vec(), own.row.clone(), own.counts.clone()).into_pyobject(slf.py())?;
        Ok((slf.get_type().into_any(), arguments))
    }

    fn __repr__(&self) -> String {
        let of = |name| self.number_of(name).unwrap_or(f64::NAN);
        format!(
            "<emmy.Step {}: t = {}, T + V = {}, energy residual {:.1e}>",
            self.number(),
            of("time"),
            of("total_energy"),
            of("energy_residual")
        )
    }
}
