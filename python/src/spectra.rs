//! Spectra of series, and harmonic responses.

use emmy::body::{FieldName, Fields};
use emmy::modes::{Excitation, HarmonicResponse, ModalDamping, Quantity};
use emmy::motion::State;
use emmy_io::spectra::{Series, Settings, Spectrum};
use numpy::{Complex64, PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::{errors, pool};

/// Name of the only series.
const NAME: &str = "x";

/// Words of a spectrum: kind, window, trend.
type Words = (String, String, String);

/// A word of a list of names, as its value.
fn word<T: Copy>(py: Python<'_>, place: &str, text: &str, all: &[(&str, T)]) -> PyResult<T> {
    let found = all.iter().find(|(name, _)| *name == text).map(|(_, value)| *value);
    found.ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
        errors::argument(py, place, &format!("{text:?} is unknown; there is {}", names.join(", ")))
    })
}

/// A spectrum of values at times, with an input if its kind has one: columns by name.
#[pyfunction]
#[pyo3(signature = (time, values, input, words, numbers, segment, overlap, frequencies, derivative))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn spectrum<'py>(
    py: Python<'py>,
    time: PyReadonlyArray1<'py, f64>,
    values: PyReadonlyArray1<'py, f64>,
    input: Option<PyReadonlyArray1<'py, f64>>,
    words: Words,
    numbers: (Option<f64>, f64),
    segment: Option<usize>,
    overlap: Option<usize>,
    frequencies: Option<PyReadonlyArray1<'py, f64>>,
    derivative: usize,
) -> PyResult<(Bound<'py, PyDict>, Vec<String>)> {
    use emmy_io::spectra::{Detrend, Kind, Window};
    let (kind, window, detrend) = words;
    let (step, q) = numbers;
    let list = |array: &PyReadonlyArray1<'_, f64>| array.as_array().to_vec();
    let settings = Settings {
        kind: word(py, "kind", &kind, &Kind::ALL)?,
        window: word(py, "window", &window, &Window::ALL)?,
        detrend: word(py, "detrend", &detrend, &Detrend::ALL)?,
        derivative,
        step,
        segment,
        overlap,
        frequencies: frequencies.as_ref().map(list),
        q,
    };
    let values = std::iter::once(&values).chain(&input).map(list).collect();
    let series = Series { time: list(&time), values };
    let found = pool::work(py, || settings.of_series(&series, &[NAME.to_string()]))?;
    let found = found.map_err(|error| errors::argument(py, "", &error.to_string()))?;
    let Spectrum { frequencies, columns, notes, .. } = found;
    let table = PyDict::new(py);
    table.set_item("frequency", PyArray1::from_vec(py, frequencies))?;
    for (name, numbers) in columns {
        table.set_item(&name[NAME.len() + 1..], PyArray1::from_vec(py, numbers))?;
    }
    Ok((table, notes))
}

/// Excitation, damping, quantity and place of a harmonic response.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Request {
    frequencies: Vec<f64>,
    nodes: Vec<usize>,
    base: Option<[f64; 3]>,
    loads: Option<Vec<usize>>,
    damping: Option<Vec<f64>>,
    quantity: String,
    relative: bool,
    count: usize,
}

/// The quantity of a harmonic response.
#[derive(Clone, Copy)]
enum Wanted {
    Motion(Quantity),
    Stress(FieldName),
}

/// All quantities with their names.
const WANTED: [(&str, Wanted); 5] = [
    ("displacement", Wanted::Motion(Quantity::Displacement)),
    ("velocity", Wanted::Motion(Quantity::Velocity)),
    ("acceleration", Wanted::Motion(Quantity::Acceleration)),
    ("cauchy_stress", Wanted::Stress(FieldName::CauchyStress)),
    ("second_piola_kirchhoff_stress", Wanted::Stress(FieldName::SecondPiolaKirchhoffStress)),
];

/// A harmonic response about a state: `amplitudes`, `natural_frequencies`, `damping_ratios`, `modal_forces`.
pub(crate) fn response<'py>(
    py: Python<'py>,
    body: &emmy::body::Body,
    state: Option<&State>,
    request: Request,
) -> PyResult<Bound<'py, PyDict>> {
    let quantity = word(py, "quantity", &request.quantity, &WANTED)?;
    let excitation = match (request.base, request.loads) {
        (Some(base), _) => Excitation::Base(base),
        (None, Some(loads)) => Excitation::Loads(loads),
        (None, None) => Excitation::Loads((0..body.load_resultants().len()).collect()),
    };
    let damping = request.damping.map_or(ModalDamping::OfBody, ModalDamping::Ratios);
    let (nodes, frequencies) = (&request.nodes, &request.frequencies);
    let found = pool::work(py, || -> emmy::Result<_> {
        let found = HarmonicResponse::new(body, state, request.count, &damping, &excitation)?;
        let omegas = || frequencies.iter().map(|f| std::f64::consts::TAU * f);
        let all: Vec<[f64; 2]> = match quantity {
            Wanted::Motion(quantity) => {
                let at = |omega: f64, node: usize| match request.relative {
                    true => found.relative(omega, node, quantity),
                    false => found.absolute(omega, node, quantity),
                };
                omegas().flat_map(|omega| nodes.iter().flat_map(move |&node| at(omega, node))).collect()
            }
            Wanted::Stress(field) => {
                let fields = Fields::new(body);
                let nodes: Vec<u32> = nodes.iter().map(|&node| node as u32).collect();
                let change = found.stress(&fields, &fields.select_nodes(&nodes), field)?;
                omegas().flat_map(|omega| found.stress_amplitudes(omega, &change)).collect()
            }
        };
        let amplitudes: Vec<Complex64> = all.into_iter().map(|[re, im]| Complex64::new(re, im)).collect();
        Ok((found, amplitudes))
    })?;
    let (found, amplitudes) = found.map_err(|error| match error {
        emmy::Error::Modes { .. } | emmy::Error::Linear { .. } => errors::step(py, &error),
        error => errors::library(py, &error),
    })?;
    let table = PyDict::new(py);
    let n_components = if matches!(quantity, Wanted::Stress(_)) { 6 } else { 3 };
    let amplitudes =
        PyArray1::from_vec(py, amplitudes).reshape([frequencies.len(), nodes.len(), n_components])?;
    table.set_item("amplitudes", amplitudes)?;
    let natural = found.modes().iter().map(|mode| mode.frequency());
    table.set_item("natural_frequencies", PyArray1::from_iter(py, natural))?;
    table.set_item("damping_ratios", PyArray1::from_vec(py, found.damping_ratios()))?;
    table.set_item("modal_forces", PyArray1::from_slice(py, found.modal_forces()))?;
    Ok(table)
}
