//! Errors of the library as exceptions of the package; their classes are in `emmy._errors`.

use emmy::Error;
use emmy::motion::MarchError;
use emmy_cli::Failure;
use emmy_io::input::{InputError, Place, StartError};
use emmy_io::limits::LimitExceeded;
use emmy_io::message::{shown, with_causes};
use pyo3::call::PyCallArgs;
use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError};
use pyo3::prelude::*;

/// An exception of a class of `emmy._errors`.
fn made<'py>(py: Python<'py>, class: &str, arguments: impl PyCallArgs<'py>) -> PyErr {
    let made = || py.import("emmy._errors")?.getattr(class)?.call1(arguments);
    made().map_or_else(|error| error, PyErr::from_value)
}

/// A fault: place, message, help, missing group, groups that would be valid there.
type Fault = (String, String, String, Option<String>, Option<Vec<String>>);

fn of_faults(py: Python<'_>, faults: Vec<Fault>) -> PyErr {
    let class = match &faults[..] {
        faults if faults.iter().all(|(_, _, _, group, _)| group.is_some()) => "UnknownGroupError",
        faults if faults.iter().all(|(place, ..)| place == "mesh" || place.starts_with("mesh.")) => {
            "MeshError"
        }
        _ => "InputError",
    };
    made(py, class, (faults,))
}

/// All faults of an input: `(place, message, help, group, available)` each.
pub(crate) fn input(py: Python<'_>, error: &InputError) -> PyErr {
    let faults: Vec<_> = error
        .faults()
        .iter()
        .map(|fault| {
            let place = fault.place().map_or(String::new(), |place| match Place::path(place) {
                Some(path) => path.to_string(),
                None => format!("{}:{}:{}", place.source_name(), place.line(), place.column()),
            });
            let help = [fault.suggestion(), fault.advice()].into_iter().flatten().next();
            let group = fault.missing_group().map(|group| (group.name.clone(), group.available.clone()));
            let (group, available) = group.unzip();
            let help = help.unwrap_or_default().to_string();
            (place, shown(fault.message()).into_owned(), help, group, available)
        })
        .collect();
    of_faults(py, faults)
}

/// A fault of an argument.
pub(crate) fn argument(py: Python<'_>, place: &str, message: &str) -> PyErr {
    of_faults(py, vec![(place.to_string(), message.to_string(), String::new(), None, None)])
}

/// An error of the library about its input.
pub(crate) fn library(py: Python<'_>, error: &Error) -> PyErr {
    if matches!(error, Error::StartMomentum { .. } | Error::StartHeld { .. }) {
        let help = "a State with momentum=None gets the momentum M v of its velocity, and rest where supports hold it";
        return of_faults(py, vec![("start".into(), with_causes(error), help.into(), None, None)]);
    }
    let place = match error {
        Error::InvertedCell { .. }
        | Error::Inverted { .. }
        | Error::EmptyMesh
        | Error::TooManyCells { .. }
        | Error::NodeOutOfRange { .. }
        | Error::WrongNodeCount { .. }
        | Error::CoordinateNotFinite { .. }
        | Error::NotInPlane { .. }
        | Error::FacetWithoutCell { .. } => "mesh",
        _ => "",
    };
    argument(py, place, &with_causes(error))
}

/// A failed step.
pub(crate) fn step(py: Python<'_>, error: &Error) -> PyErr {
    let mut place = Whereabouts::default();
    place.read(error);
    let Whereabouts { step, time, node, position, cause } = place;
    made(py, "ConvergenceError", (with_causes(error), step, time, node, position, cause.unwrap_or_default()))
}

/// Step, time, node and position of a failure.
#[derive(Default)]
struct Whereabouts {
    step: Option<usize>,
    time: Option<f64>,
    node: Option<usize>,
    position: Option<[f64; 3]>,
    cause: Option<String>,
}

impl Whereabouts {
    fn read(&mut self, error: &Error) {
        match error {
            Error::SmallestStep { step, start, step_size, cause, .. } => {
                (self.step, self.time) = (Some(*step), Some(start + step_size));
                self.cause = Some(cause.to_string());
                self.read(cause);
            }
            Error::StepFailed { step, time, cause, .. } => {
                self.step.get_or_insert(*step);
                self.time.get_or_insert(*time);
                self.cause.get_or_insert(cause.to_string());
                self.read(cause);
            }
            Error::NoConvergence { step, time, node, position, .. } => {
                self.step.get_or_insert(*step);
                self.time.get_or_insert(*time);
                (self.node, self.position) = (Some(*node), Some(**position));
            }
            Error::StepTooLarge { step, time, .. }
            | Error::NoDigits { step, time, .. }
            | Error::ConstraintsLost { step, time, .. } => {
                self.step.get_or_insert(*step);
                self.time.get_or_insert(*time);
            }
            Error::NotANumber { step, time, node, position } => {
                self.step.get_or_insert(*step);
                self.time.get_or_insert(*time);
                (self.node, self.position) = (Some(*node), Some(*position));
            }
            Error::CellInverted { step, time, position, .. } => {
                self.step.get_or_insert(*step);
                self.time.get_or_insert(*time);
                self.position = Some(*position);
            }
            _ => {}
        }
    }
}

/// The end of a march.
pub(crate) fn march(py: Python<'_>, error: MarchError) -> PyErr {
    match error {
        MarchError::Step(error) => step(py, &error),
        MarchError::Observer(error) => match error.downcast::<LimitExceeded>() {
            Ok(limit) => made(py, "LimitExceeded", (limit.to_string(),)),
            Err(error) => match error.downcast::<Error>() {
                Ok(error) => library(py, &error),
                Err(error) => results(py, &error),
            },
        },
    }
}

/// Results that cannot be written or read.
pub(crate) fn results(py: Python<'_>, error: &impl ToString) -> PyErr {
    made(py, "ResultsError", (error.to_string(),))
}

/// A motion that cannot start.
pub(crate) fn start(py: Python<'_>, error: StartError) -> PyErr {
    match error {
        StartError::March(MarchError::Step(
            error @ (Error::NoEquilibrium { .. } | Error::Singular { .. }),
        )) => step(py, &error),
        StartError::March(MarchError::Step(error)) => library(py, &error),
        StartError::Unstable(error) => input(py, &error),
        other => argument(py, "", &with_causes(&other)),
    }
}

/// A place of the input in the words of the package: `loads[1].group`.
pub(crate) fn place(py: Python<'_>, path: &str) -> PyResult<String> {
    py.import("emmy._errors")?.call_method1("in_words_of_python", (path,))?.extract()
}

/// A function that has returned no finite number: a fault of the input, unless a step to a time asked for it.
pub(crate) fn not_finite(py: Python<'_>, path: &str, message: &str, time: Option<f64>) -> PyErr {
    let place = place(py, path).unwrap_or_default();
    match time {
        None => argument(py, &place, message),
        Some(time) => {
            made(py, "ConvergenceError", (format!("{place}: {message}"), None::<usize>, Some(time)))
        }
    }
}

/// A verb of the command line that has failed.
pub(crate) fn failure(py: Python<'_>, failure: Failure) -> PyErr {
    match failure {
        Failure::Input(error) => input(py, &error),
        Failure::Usage { message, help } => {
            of_faults(py, vec![(String::new(), message, help.unwrap_or_default(), None, None)])
        }
        Failure::NoConvergence(error) => step(py, &error),
        Failure::Study { message, help } => {
            made(py, "ConvergenceError", (format!("{message}; {help}"), None::<usize>, None::<f64>))
        }
        Failure::Files { message, help: None } => results(py, &message),
        Failure::Files { message, help: Some(help) } => results(py, &format!("{message}; {help}")),
        internal @ Failure::Internal(_) => PyRuntimeError::new_err(internal.to_string()),
        Failure::Limit(message) => made(py, "LimitExceeded", (message,)),
        Failure::Interrupted { message, help } => PyKeyboardInterrupt::new_err(format!("{message}; {help}")),
        other => results(py, &other),
    }
}
