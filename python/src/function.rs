//! Functions of Python as histories and fields.

use std::cell::{Cell, RefCell};
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use emmy::body::{self, TimeFunction};
use emmy::motion::ObserverResult;
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::errors;

thread_local! {
    /// The first exception of a function in the present work. The library calls functions on the thread that does the
    /// work.
    static RAISED: RefCell<Option<PyErr>> = const { RefCell::new(None) };
    /// Number of the present work.
    static WORK: Cell<u64> = const { Cell::new(0) };
    /// Whether the present work is the reading of an input, where a number that is not finite fails no step.
    static IS_INPUT: Cell<bool> = const { Cell::new(false) };
}

/// Number of works so far.
static WORKS: AtomicU64 = AtomicU64::new(0);

/// Does some work, and returns the first exception of a function in it as well.
pub(crate) fn with_exception<T>(work: impl FnOnce() -> T) -> (T, Option<PyErr>) {
    // Of the work in which this one is done: a function may step another motion.
    let outer = (RAISED.take(), WORK.get(), IS_INPUT.take());
    WORK.set(WORKS.fetch_add(1, Ordering::Relaxed) + 1);
    let value = work();
    WORK.set(outer.1);
    IS_INPUT.set(outer.2);
    (value, RAISED.replace(outer.0))
}

/// Does the rest of the present work, in which a number that is not finite is a fault of the input.
pub(crate) fn of_input<T>(work: impl FnOnce() -> T) -> T {
    IS_INPUT.set(true);
    work()
}

/// Forgets an exception of the present work.
pub(crate) fn forget_exception() {
    RAISED.take();
}

/// Ends a march after an exception; smaller steps would not help.
pub(crate) fn check_exception() -> ObserverResult {
    if has_raised() { Err("a function of the body failed".into()) } else { Ok(()) }
}

fn has_raised() -> bool {
    RAISED.with_borrow(Option::is_some)
}

/// The functions of a body.
#[derive(Debug, Default, Clone)]
pub(crate) struct Callables {
    functions: Vec<Arc<Callable>>,
}

impl Callables {
    /// Whether there are no functions.
    pub(crate) fn is_empty(&self) -> bool {
        self.functions.is_empty()
    }

    /// Shows the functions to the garbage collector.
    pub(crate) fn traverse(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        for function in &self.functions {
            // Nobody holds the lock while the collector runs, which needs the lock of the interpreter.
            if let Ok(function) = function.function.try_lock() {
                visit.call(&*function)?;
            }
        }
        Ok(())
    }

    /// Lets the functions go.
    pub(crate) fn clear(&self) {
        for function in &self.functions {
            function.function.lock().unwrap_or_else(PoisonError::into_inner).take();
        }
    }

    /// A function at a path; the same function at several places is one, which is asked once.
    fn add(&mut self, py: Python<'_>, function: &Py<PyAny>, name: &str, path: &str) -> Arc<Callable> {
        let is_same = |own: &&Arc<Callable>| own.function(py).is_some_and(|own| own.is(function));
        if let Some(own) = self.functions.iter().find(is_same) {
            return own.clone();
        }
        let callable = Callable {
            function: Mutex::new(Some(function.clone_ref(py))),
            name: name.to_string(),
            path: path.to_string(),
            last: Mutex::default(),
        };
        let callable = Arc::new(callable);
        self.functions.push(callable.clone());
        callable
    }
}

/// A function of Python where it stands in the input.
struct Callable {
    function: Mutex<Option<Py<PyAny>>>,
    name: String,
    path: String,
    last: Mutex<LastCall>,
}

/// Times and values of the last call: loads with one function ask for the same times.
#[derive(Default)]
struct LastCall {
    /// Number of its work: later the function may have other values.
    work: u64,
    times: Vec<f64>,
    values: Vec<f64>,
}

impl fmt::Debug for Callable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.name, self.path)
    }
}

impl Callable {
    fn function(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        let function = self.function.lock().unwrap_or_else(PoisonError::into_inner);
        function.as_ref().map(|function| function.clone_ref(py))
    }

    /// Keeps the first exception; without a value the step fails, and the exception ends the march.
    fn fail(&self, py: Python<'_>, error: PyErr, time: f64) {
        if has_raised() {
            return;
        }
        let place = errors::place(py, &self.path).unwrap_or_default();
        let note = format!("in {place} ({}) at t = {time}", self.name);
        let _ = error.value(py).call_method1("add_note", (note,));
        RAISED.set(Some(error));
    }

    /// The values at some times; NaN after an exception. The lock of the interpreter is taken once.
    fn values(&self, times: &[f64], values: &mut [f64]) {
        // Not locked during a call: the function may step another motion with the same function.
        let last = || self.last.lock().unwrap_or_else(PoisonError::into_inner);
        {
            let last = last();
            if last.work == WORK.get() && last.times == times {
                return values.copy_from_slice(&last.values);
            }
        }
        values.fill(f64::NAN);
        if has_raised() {
            return;
        }
        Python::attach(|py| {
            for (value, &time) in values.iter_mut().zip(times) {
                *value = self.call(py, time);
                if value.is_nan() {
                    break;
                }
            }
        });
        if values.iter().all(|value| value.is_finite()) {
            let LastCall { work, times: old_times, values: old_values } = &mut *last();
            *work = WORK.get();
            old_times.clear();
            old_times.extend_from_slice(times);
            old_values.clear();
            old_values.extend_from_slice(values);
        }
    }

    fn call(&self, py: Python<'_>, time: f64) -> f64 {
        let Some(function) = self.function(py) else { return f64::NAN };
        let value = function.call1(py, (time,)).and_then(|value| self.number(value.bind(py)));
        match value {
            Ok(value) if value.is_finite() => value,
            Ok(value) => {
                let message = format!("{} returned {value} at t = {time}", self.name);
                self.fail(py, self.not_finite(py, &message, time), time);
                f64::NAN
            }
            Err(error) => {
                self.fail(py, error, time);
                f64::NAN
            }
        }
    }

    /// The number that the function has returned.
    fn number(&self, value: &Bound<'_, PyAny>) -> PyResult<f64> {
        // An array of one number has `__float__` too, but is no number.
        let is_array =
            value.hasattr("ndim")? && value.getattr("ndim")?.extract::<usize>().is_ok_and(|ndim| ndim > 0);
        let is_truth = value.is_instance_of::<PyBool>()
            || value.hasattr("dtype")? && value.getattr("dtype")?.getattr("kind")?.eq("b")?;
        let number = if is_array || is_truth { None } else { value.extract::<f64>().ok() };
        number.ok_or_else(|| match value.get_type().name() {
            Ok(kind) => self.mistyped(value.py(), &format!("{kind} in place of a number")),
            Err(error) => error,
        })
    }

    /// The error for a number that is not finite.
    fn not_finite(&self, py: Python<'_>, message: &str, time: f64) -> PyErr {
        errors::not_finite(py, &self.path, message, (!IS_INPUT.get()).then_some(time))
    }

    /// The error for a value of another type.
    fn mistyped(&self, py: Python<'_>, what: &str) -> PyErr {
        let place = errors::place(py, &self.path).unwrap_or_default();
        PyTypeError::new_err(format!("{place}: {} returned {what}", self.name))
    }

    /// The vectors at some points and a time; NaN after an exception.
    fn vectors(&self, points: &[[f64; 3]], time: f64, vectors: &mut [[f64; 3]]) {
        vectors.fill([f64::NAN; 3]);
        if has_raised() {
            return;
        }
        Python::attach(|py| match self.call_at(py, points, time) {
            Ok(values) => vectors.copy_from_slice(&values),
            Err(error) => self.fail(py, error, time),
        });
    }

    fn call_at(&self, py: Python<'_>, points: &[[f64; 3]], time: f64) -> PyResult<Vec<[f64; 3]>> {
        let Some(function) = self.function(py) else { return Ok(vec![[f64::NAN; 3]; points.len()]) };
        let array = PyArray2::from_owned_array(py, numpy::ndarray::arr2(points));
        let values = function.bind(py).call1((array, time))?;
        let wanted = (points.len(), 3);
        let instead = |what: &str| {
            self.mistyped(py, &format!("{what} in place of an array of shape ({}, 3)", points.len()))
        };
        let numpy = py.import("numpy")?;
        let given = numpy.call_method1("asarray", (&values,)).and_then(|array| array.getattr("dtype"));
        // NumPy would leave out imaginary parts with a warning.
        if let Ok(kind) = &given
            && kind.getattr("kind")?.eq("c")?
        {
            return Err(instead(&format!("an array of {kind}")));
        }
        let array = match numpy.call_method1("asarray", (&values, "float64")) {
            // NumPy makes NaN of None.
            Ok(array) if !values.is_none() => array,
            _ => return Err(instead(&values.get_type().name()?.to_string())),
        };
        let of_shape =
            || Ok::<_, PyErr>(instead(&format!("an array of shape {}", array.getattr("shape")?.str()?)));
        let Ok(values) = array.extract::<PyReadonlyArray2<'_, f64>>() else { return Err(of_shape()?) };
        let view = values.as_array();
        if view.dim() != wanted {
            return Err(of_shape()?);
        }
        if let Some(value) = view.iter().find(|value| !value.is_finite()) {
            let message = format!("{} returned {value} at t = {time}", self.name);
            return Err(self.not_finite(py, &message, time));
        }
        Ok(view.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect())
    }
}

/// Numbers that tell functions of one name apart.
static COUNT: AtomicU64 = AtomicU64::new(0);

/// A function of time in place of a history.
#[pyclass(frozen, module = "emmy._emmy")]
pub(crate) struct Function {
    value: Py<PyAny>,
    rate: Option<Py<PyAny>>,
    name: String,
    number: u64,
}

#[pymethods]
impl Function {
    #[new]
    #[pyo3(signature = (value, rate, name))]
    fn new(value: Py<PyAny>, rate: Option<Py<PyAny>>, name: String) -> Self {
        Function { value, rate, name, number: COUNT.fetch_add(1, Ordering::Relaxed) }
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.value)?;
        visit.call(&self.rate)
    }
}

impl Function {
    /// The function as the library sees it; its text is that of the input, and a number.
    pub(crate) fn time_function(
        &self,
        py: Python<'_>,
        path: &str,
        callables: &mut Callables,
    ) -> TimeFunction {
        let text = format!("<function {}>{}", self.name, self.number);
        let value = callables.add(py, &self.value, &self.name, path);
        let rate = self
            .rate
            .as_ref()
            .map(|rate| callables.add(py, rate, &format!("the rate of {}", self.name), path));
        let function = TimeFunction::of_times(&text, move |times, values| value.values(times, values));
        match rate {
            Some(rate) => function.with_rate(move |times, rates| rate.values(times, rates)),
            None => function,
        }
    }
}

/// A function of reference points and time in place of a vector.
#[pyclass(frozen, module = "emmy._emmy")]
pub(crate) struct Field {
    function: Py<PyAny>,
    name: String,
    number: u64,
}

#[pymethods]
impl Field {
    #[new]
    fn new(function: Py<PyAny>, name: String) -> Self {
        Field { function, name, number: COUNT.fetch_add(1, Ordering::Relaxed) }
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.function)
    }
}

impl Field {
    /// The field as the library sees it.
    pub(crate) fn field(&self, py: Python<'_>, path: &str, callables: &mut Callables) -> body::Field {
        let text = format!("<function {}>{}", self.name, self.number);
        let function = callables.add(py, &self.function, &self.name, path);
        body::Field::of_points(&text, move |points, time, vectors| function.vectors(points, time, vectors))
    }
}
