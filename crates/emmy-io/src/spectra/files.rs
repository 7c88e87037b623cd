//! Files of spectra: a table and its plot.

use std::path::Path;

use super::{Kind, Spectrum};
use crate::chart::{Axis, Chart, Figure, Series, Style};
use crate::directory::{self, DirectoryError, Lock};
use crate::message::shown;
use crate::report::{Curves, write_curves};
use crate::units::Units;
use crate::whole_file::replace;

/// Kind of the directory, in messages.
const KIND: &str = "spectrum";

/// The plot, by which the directory is recognized.
const WITNESS: &str = "spectrum.svg";

/// The table.
pub const TABLE: &str = "spectrum.csv";

/// Checks that a spectrum may be written into a directory. Nothing is changed.
///
/// # Errors
/// [`DirectoryError`].
pub fn check(directory: &Path) -> Result<(), DirectoryError> {
    directory::check_kind(directory, KIND, WITNESS)
}

/// Writes table, plot and page of a spectrum of a run into a directory, in place of an earlier one. `run`: its name.
///
/// # Errors
/// [`DirectoryError`].
pub fn write(directory: &Path, run: &str, spectrum: &Spectrum) -> Result<(), DirectoryError> {
    directory::prepare_kind(directory, KIND, WITNESS)?;
    let _lock = Lock::take(directory)?;
    let system = |error| DirectoryError::System { path: directory.to_path_buf(), error };
    let caption = format!("{run}, {}", spectrum.caption);
    let mut figure = figure(spectrum);
    if let Some(first) = figure.charts.first_mut() {
        first.title = shown(&caption).into_owned();
    }
    figure.write(&directory.join("spectrum")).map_err(system)?;
    let curves = Curves {
        heading: spectrum.kind.title(),
        caption: &caption,
        figure: &figure,
        input: None,
        files: &[TABLE, WITNESS],
    };
    write_curves(directory, &curves).map_err(system)?;
    let columns = spectrum.columns.iter().map(|(name, numbers)| (name.as_str(), &numbers[..]));
    let columns = std::iter::once(("frequency", &spectrum.frequencies[..])).chain(columns);
    replace(&directory.join(TABLE), table(&columns.collect::<Vec<_>>()).as_bytes()).map_err(system)
}

/// A table of columns of equal length as CSV, with 17 significant digits; NaN is an empty cell.
pub(crate) fn table(columns: &[(&str, &[f64])]) -> String {
    let cell = |number: f64| if number.is_nan() { String::new() } else { format!("{number:.16e}") };
    let head: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    let n = columns.first().map_or(0, |(_, numbers)| numbers.len());
    let row = |at: usize| {
        let cells: Vec<String> = columns.iter().map(|(_, numbers)| cell(numbers[at])).collect();
        format!("{}\n", cells.join(","))
    };
    format!("{}\n{}", head.join(","), (0..n).map(row).collect::<String>())
}

/// Charts of columns over the frequency, one above the other.
pub(crate) fn over_frequency<'a>(
    frequencies: &'a [f64],
    units: Units,
    is_log: bool,
) -> impl Fn(Axis, &[(String, &[f64])]) -> Chart + 'a {
    let label = units.label("frequency f", "frequency");
    move |y, columns| {
        let series = |(colour, (name, numbers)): (usize, &(String, &[f64]))| Series {
            label: shown(name).into_owned(),
            points: frequencies.iter().copied().zip(numbers.iter().copied()).collect(),
            style: Style::Line,
            colour,
        };
        let x = if is_log { Axis::log(label.clone()) } else { Axis::linear(label.clone()) };
        let series = columns.iter().enumerate().map(series).collect();
        Chart { title: String::new(), x, y, series, guides: Vec::new() }
    }
}

/// Charts of a spectrum: endings of the columns of each, and its ordinate.
fn figure(spectrum: &Spectrum) -> Figure {
    let units = spectrum.units;
    let linear = |label: &str| Axis::linear(label);
    let of_columns = |label: &str| match &spectrum.unit {
        Some(unit) => Axis::log(format!("{label} [{unit}]")),
        None => Axis::log(label),
    };
    let charts = match spectrum.kind {
        Kind::Density => {
            let label = "power spectral density";
            let unit = spectrum.unit.as_ref().map(|unit| format!("({unit})²"));
            let per = units.system().map(|system| system.unit("frequency"));
            let label =
                unit.zip(per).map_or(label.to_string(), |(unit, per)| format!("{label} [{unit}/{per}]"));
            vec![("_psd", Axis::log(label))]
        }
        Kind::Amplitude => vec![("_amplitude", of_columns("amplitude"))],
        Kind::Response => vec![
            ("_amplitude", Axis::log("amplitude")),
            ("_phase", linear("phase [rad]")),
            ("_coherence", linear("coherence")),
        ],
        Kind::Transmissibility => {
            vec![("_transmissibility", Axis::log("transmissibility")), ("_coherence", linear("coherence"))]
        }
        Kind::Shock => vec![
            ("_acceleration_maximax", of_columns("absolute acceleration")),
            ("_displacement_maximax", Axis::log(units.label("relative displacement", "length"))),
        ],
    };
    let chart = over_frequency(&spectrum.frequencies, spectrum.units, spectrum.kind == Kind::Shock);
    let charts = charts.into_iter().map(|(ending, y)| {
        let named = spectrum
            .columns
            .iter()
            .filter_map(|(name, numbers)| Some((name.strip_suffix(ending)?.to_string(), &numbers[..])));
        chart(y, &named.collect::<Vec<_>>())
    });
    Figure { charts: charts.collect(), columns: 1 }
}
