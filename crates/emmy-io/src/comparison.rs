//! Charts of several runs side by side, from their files.

use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::chart::{Axis, Chart, Figure, Series, Style};
use crate::history::{History, HistoryError};
use crate::message::shown;
use crate::units::{UnitSystem, Units};
use crate::whole_file;

/// The results of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Name in charts and tables.
    pub name: String,
    /// Its history.
    pub history: History,
    /// Its summary.
    pub summary: Value,
    /// Its input with all defaults; empty if it is missing.
    pub input: toml::Table,
}

/// Why a directory cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// It is missing, or a file.
    #[error("{path} is not a directory of a run")]
    NotADirectory {
        /// The path.
        path: PathBuf,
    },
    /// Its history cannot be used.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// Its summary cannot be used.
    #[error("{path}: {reason}; `emmy run` writes it")]
    Summary {
        /// The path.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
}

impl Run {
    /// Reads a run.
    ///
    /// # Errors
    /// [`RunError`] if `history.csv` or `summary.json` is missing or damaged.
    pub fn read(directory: &Path) -> Result<Self, RunError> {
        check(directory)?;
        let history = History::read(&directory.join("history.csv"))?;
        let summary = summary(directory)?;
        let name = directory.file_name().map(|name| name.to_string_lossy().into_owned());
        let name = name.unwrap_or_else(|| directory.display().to_string());
        let input = whole_file::read_text(&directory.join("input.toml")).unwrap_or_default();
        Ok(Run { name, history, summary, input: input.parse().unwrap_or_default() })
    }

    /// A column of the history; empty if it is missing.
    fn column(&self, name: &str) -> Vec<f64> {
        self.history.column(name).unwrap_or_default()
    }

    /// Name, scheme and degree.
    fn label(&self) -> String {
        // Charts cannot hold control characters.
        let name = shown(&self.name);
        let scheme = self.summary["scheme"].as_str().unwrap_or("?");
        match self.summary["degree"].as_u64() {
            Some(degree) if degree > 1 => format!("{name}: {scheme}, degree {degree}"),
            _ => format!("{name}: {scheme}"),
        }
    }

    fn units(&self) -> Units {
        units_of(&self.summary)
    }

    fn angular_momentum(&self) -> Vec<f64> {
        let [x, y, z] = ["x", "y", "z"].map(|axis| self.column(&format!("angular_momentum_{axis}")));
        x.iter().zip(&y).zip(&z).map(|((x, y), z)| (x * x + y * y + z * z).sqrt()).collect()
    }
}

/// Checks that the directory exists.
pub(crate) fn check(directory: &Path) -> Result<(), RunError> {
    if directory.is_dir() { Ok(()) } else { Err(RunError::NotADirectory { path: directory.to_path_buf() }) }
}

/// The summary of a run.
pub(crate) fn summary(directory: &Path) -> Result<Value, RunError> {
    let path = directory.join("summary.json");
    let fail = |reason: String| RunError::Summary { path: path.clone(), reason };
    let text = whole_file::read_text(&path).map_err(|error| fail(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| fail(format!("not valid JSON: {error}")))
}

/// The units of a run by its summary; none if it has none.
pub(crate) fn units_of(summary: &Value) -> Units {
    let system = summary["units"]["system"].as_str().and_then(UnitSystem::named);
    system.map_or(Units::default(), Units::from)
}

/// The units of all runs; none if they differ.
fn common_units(runs: &[Run]) -> Units {
    let mut units = runs.iter().map(Run::units);
    let first = units.next().unwrap_or_default();
    if units.all(|other| other == first) { first } else { Units::default() }
}

const MOMENTUM: &str = "mass·length/time";
const ANGULAR_MOMENTUM: &str = "mass·length²/time";

/// The charts of some runs, each with the ending of its file name.
pub fn charts(runs: &[Run]) -> Vec<(&'static str, Chart)> {
    let units = common_units(runs);
    let of = |name: &'static str| move |run: &Run| run.column(name);
    let state = |label: &str, dimension: &str, values: &dyn Fn(&Run) -> Vec<f64>| {
        chart(runs, Axis::linear(units.label(label, dimension)), values)
    };
    let residual = |label: &str, dimension: &str, name: &'static str| {
        chart(runs, Axis::log(units.label(label, dimension)), residuals(name))
    };
    let step = |label: &str, dimension: &str, name: &'static str| {
        stairs(chart(runs, Axis::linear(units.label(label, dimension)), of(name)))
    };
    let has_contact = |run: &Run| !run.column("contact_energy").is_empty();
    let energies = if runs.iter().any(has_contact) { "T + V + V_c" } else { "T + V" };
    vec![
        ("total-energy", state(&format!("total energy {energies}"), "energy", &of("total_energy"))),
        ("energy-residual", residual("|energy residual| of a step", "energy", "energy_residual")),
        ("angular-momentum", state("angular momentum |L|", ANGULAR_MOMENTUM, &Run::angular_momentum)),
        (
            "angular-momentum-residual",
            residual("angular momentum residual", ANGULAR_MOMENTUM, "angular_momentum_residual"),
        ),
        ("newton-iterations", step("corrections of a step", "", "newton_iterations")),
        ("step-size", step("step size", "time", "step_size")),
        (
            "linear-momentum-residual",
            residual("linear momentum residual", MOMENTUM, "linear_momentum_residual"),
        ),
        ("angular-momentum-components", components(runs)),
    ]
}

/// Absolute values of a column of residuals; the start has none.
fn residuals(name: &'static str) -> impl Fn(&Run) -> Vec<f64> {
    move |run| {
        let mut values: Vec<f64> = run.column(name).into_iter().map(f64::abs).collect();
        values.iter_mut().take(1).for_each(|value| *value = f64::NAN);
        values
    }
}

/// A chart of a quantity of steps: each value holds from the previous point on, and the start has no value.
fn stairs(mut chart: Chart) -> Chart {
    for series in &mut chart.series {
        series.style = Style::Stairs;
        if let [start, first, ..] = &mut series.points[..] {
            start.1 = first.1;
        }
    }
    chart
}

/// The first six charts under one legend.
pub fn figure(charts: &[(&'static str, Chart)]) -> Figure {
    let charts = charts.iter().take(6).map(|(_, chart)| chart.clone()).collect();
    Figure { charts, columns: 2 }
}

/// Writes `compare.svg` with the figure, `compare-NAME.svg` with each chart, and all of them as PNG.
///
/// # Errors
/// Errors of the system.
pub fn write(directory: &Path, runs: &[Run]) -> io::Result<()> {
    let charts = charts(runs);
    figure(&charts).write(&directory.join("compare"))?;
    charts.iter().try_for_each(|(name, chart)| chart.write(&directory.join(format!("compare-{name}"))))
}

/// A quantity over time.
fn chart(runs: &[Run], y: Axis, values: impl Fn(&Run) -> Vec<f64>) -> Chart {
    let series = |(colour, run): (usize, &Run)| Series {
        label: run.label(),
        points: run.column("time").into_iter().zip(values(run)).collect(),
        style: Style::of_line(colour, y.scale),
        colour,
    };
    let series = runs.iter().enumerate().map(series).collect();
    Chart { title: String::new(), x: time_axis(runs), y, series, guides: Vec::new() }
}

fn time_axis(runs: &[Run]) -> Axis {
    Axis::linear(common_units(runs).label("time t", "time"))
}

fn components(runs: &[Run]) -> Chart {
    let axes = [("x", Style::Line), ("y", Style::Dashed), ("z", Style::Dotted)];
    let all = runs.iter().enumerate().flat_map(|run| axes.map(|axis| (run, axis)));
    let series = |((colour, run), (axis, style)): ((usize, &Run), (&str, Style))| Series {
        label: format!("{} {axis}", shown(&run.name)),
        points: run.column("time").into_iter().zip(run.column(&format!("angular_momentum_{axis}"))).collect(),
        style,
        colour,
    };
    Chart {
        title: String::new(),
        x: time_axis(runs),
        y: Axis::linear(common_units(runs).label("angular momentum", ANGULAR_MOMENTUM)),
        series: all.map(series).collect(),
        guides: Vec::new(),
    }
}
