//! `history.csv`: one row for the start and one a step; written, and read back.

mod file;

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

use emmy::motion::{Record, View};

use crate::input::{Probe, Problem};
pub use file::HistoryFile;

/// Columns that every history has.
pub const COLUMNS: [&str; 18] = [
    "step",
    "time",
    "step_size",
    "kinetic_energy",
    "strain_energy",
    "external_work",
    "total_energy",
    "energy_residual",
    "linear_momentum_x",
    "linear_momentum_y",
    "linear_momentum_z",
    "angular_momentum_x",
    "angular_momentum_y",
    "angular_momentum_z",
    "linear_momentum_residual",
    "angular_momentum_residual",
    "newton_iterations",
    "wall_seconds",
];

/// Column after [`COLUMNS`]: smallest det F at the quadrature points; `inf` for a body of links.
const SMALLEST_DETERMINANT: &str = "smallest_determinant";

/// Column of a run with adaptive steps: estimated error of the step, relative to the scales.
const LOCAL_ERROR: &str = "local_error";

/// Column of a run in which something takes energy out of the body: what it has lost so far.
const DISSIPATED_ENERGY: &str = "dissipated_energy";
/// Column of a run whose degree is chosen: degree of the step's element.
const DEGREE: &str = "degree";

/// Which columns a history has beside [`COLUMNS`] and `smallest_determinant`.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent {
    /// Whether step sizes are chosen by the error: a column `local_error`.
    pub is_adaptive: bool,
    /// Whether viscosity, drag or the scheme dissipate: a column `dissipated_energy`.
    pub dissipates: bool,
    /// Whether degrees are chosen too: a column `degree`.
    pub has_degrees: bool,
    /// Probes: three columns each.
    pub probes: Vec<Probe>,
}

impl Extent {
    /// That of the history of a problem.
    pub fn of(problem: &Problem) -> Self {
        let Problem { body, scheme, .. } = problem;
        let adaptivity = problem.plan.adaptivity();
        Extent {
            dissipates: body.is_viscous() || body.drag() > 0.0 || scheme.dissipation().is_some(),
            is_adaptive: adaptivity.is_some(),
            has_degrees: adaptivity.is_some_and(|adaptivity| adaptivity.degrees.is_some()),
            probes: problem.output.probes.clone(),
        }
    }
}

/// A number of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// A count.
    Whole(usize),
    /// A quantity.
    Real(f64),
}

/// Names of all columns: [`COLUMNS`], `smallest_determinant`, `local_error` of adaptive steps, `dissipated_energy` where there is any, `degree` where it is
/// chosen, then the current position of each probe.
pub fn columns(extent: &Extent) -> Vec<String> {
    let own = COLUMNS.into_iter().chain([SMALLEST_DETERMINANT]);
    let own = own.chain(extent.is_adaptive.then_some(LOCAL_ERROR));
    let own = own.chain(extent.dissipates.then_some(DISSIPATED_ENERGY));
    let own = own.chain(extent.has_degrees.then_some(DEGREE)).map(str::to_string);
    let of_probe = |probe: &Probe| ["x", "y", "z"].map(|axis| format!("{}_{axis}", probe.name));
    own.chain(extent.probes.iter().flat_map(of_probe)).collect()
}

/// The numbers of a row, in the order of [`columns`]. `wall_seconds`: since the start of the run.
pub fn row(view: View<'_>, extent: &Extent, wall_seconds: f64) -> Vec<Number> {
    let mut row = own_columns(view.record, wall_seconds);
    row.extend(extent.is_adaptive.then_some(Number::Real(view.record.local_error)));
    row.extend(extent.dissipates.then_some(Number::Real(view.record.dissipated_energy)));
    row.extend(extent.has_degrees.then_some(Number::Whole(view.record.degree)));
    for probe in &extent.probes {
        let point = view.body.mesh().points()[probe.node];
        row.extend((0..3).map(|i| Number::Real(point[i] + view.state.displacement[3 * probe.node + i])));
    }
    row
}

fn own_columns(record: &Record, wall_seconds: f64) -> Vec<Number> {
    use Number::{Real, Whole};
    let mut row = vec![
        Whole(record.step),
        Real(record.time),
        Real(record.step_size),
        Real(record.kinetic_energy),
        Real(record.strain_energy),
        Real(record.external_work),
        Real(record.total_energy),
        Real(record.energy_residual),
    ];
    row.extend(record.linear_momentum.map(Real));
    row.extend(record.angular_momentum.map(Real));
    row.push(Real(record.linear_momentum_residual));
    row.push(Real(record.angular_momentum_residual));
    row.push(Whole(record.newton_iterations));
    row.push(Real(wall_seconds));
    row.push(Real(record.smallest_determinant));
    row
}

/// Why a history cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum HistoryError {
    /// The system refused.
    #[error("cannot read {path}: {error}; `emmy run` writes it")]
    System {
        /// The path.
        path: PathBuf,
        /// What the system says.
        #[source]
        error: io::Error,
    },
    /// A column is missing: it is another file.
    #[error("{path}:1: there is no column `{column}`; is it a history of Emmy?")]
    Column {
        /// The path.
        path: PathBuf,
        /// Name of the column.
        column: &'static str,
    },
    /// It has other columns than the run that is to go on.
    #[error(
        "{path}: its columns are not those of the input now; `output.probes` cannot change when a run goes on, nor adaptive steps come or go"
    )]
    Columns {
        /// The path.
        path: PathBuf,
    },
    /// It ends before the checkpoint.
    #[error(
        "{path} has no row of step {step}, from which the checkpoint goes on; it is damaged, start again with `emmy run`"
    )]
    Short {
        /// The path.
        path: PathBuf,
        /// Step of the checkpoint.
        step: usize,
    },
    /// Its rows are not those that the run wrote.
    #[error(
        "{path} was changed after the run wrote it: its rows do not have the checksum of the checkpoint; bring back the file as it was, \
         or start again with `emmy run`"
    )]
    Changed {
        /// The path.
        path: PathBuf,
    },
    /// A row is damaged.
    #[error("{path}:{line}: {reason}")]
    Row {
        /// The path.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
}

/// A history that was read back.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl History {
    /// Reads a history. A last line without its end is still being written, and is left out.
    ///
    /// # Errors
    /// [`HistoryError`] with the line.
    pub fn read(path: &Path) -> Result<Self, HistoryError> {
        let rows = Rows::open(path)?;
        Ok(History { columns: rows.columns.clone(), rows: rows.collect::<Result<_, _>>()? })
    }

    /// A column by its name.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.columns.iter().position(|column| column == name)?;
        Some(self.rows.iter().map(|row| row[index]).collect())
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Rows, each with a number for every column.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.rows.len()
    }
}

/// The rows of a history, read one by one.
#[derive(Debug)]
pub struct Rows {
    path: PathBuf,
    reader: BufReader<File>,
    columns: Vec<String>,
    /// Lines that were read.
    n_lines: usize,
}

impl Rows {
    /// Opens a history.
    ///
    /// # Errors
    /// [`HistoryError`] if it cannot be read, or is another file.
    pub fn open(path: &Path) -> Result<Self, HistoryError> {
        let system = |error| HistoryError::System { path: path.to_path_buf(), error };
        let reader = BufReader::new(File::open(path).map_err(system)?);
        let mut rows = Rows { path: path.to_path_buf(), reader, columns: Vec::new(), n_lines: 0 };
        let head = rows.line().map_err(system)?.unwrap_or_default();
        rows.columns = head.split(',').map(str::to_string).collect();
        match COLUMNS.into_iter().find(|name| !rows.columns.iter().any(|column| column == name)) {
            Some(column) => Err(HistoryError::Column { path: path.to_path_buf(), column }),
            None => Ok(rows),
        }
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The next line, if it has its end: the last one may still be being written.
    fn line(&mut self) -> io::Result<Option<String>> {
        let mut line = String::new();
        self.reader.read_line(&mut line)?;
        self.n_lines += 1;
        let Some(whole) = line.strip_suffix('\n') else { return Ok(None) };
        let length = whole.trim_end_matches('\r').len();
        line.truncate(length);
        Ok(Some(line))
    }
}

impl Iterator for Rows {
    type Item = Result<Vec<f64>, HistoryError>;

    fn next(&mut self) -> Option<Self::Item> {
        let line = match self.line() {
            Ok(line) => line?,
            Err(error) => return Some(Err(HistoryError::System { path: self.path.clone(), error })),
        };
        let row = |reason| HistoryError::Row { path: self.path.clone(), line: self.n_lines, reason };
        Some(numbers(&line, self.columns.len()).map_err(row))
    }
}

fn numbers(line: &str, n_columns: usize) -> Result<Vec<f64>, String> {
    let number = |text: &str| text.parse().map_err(|_| format!("`{text}` is not a number"));
    let numbers = line.split(',').map(number).collect::<Result<Vec<f64>, _>>()?;
    match numbers.len() {
        n if n == n_columns => Ok(numbers),
        n => Err(format!("there are {n} numbers for {n_columns} columns")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_have_as_many_numbers_as_columns_and_all_digits() {
        let temp = tempfile::tempdir().unwrap();
        let path = temp.path().join("history.csv");
        let record = Record { step: 3, time: 0.1 + 0.2, kinetic_energy: 1e-300, ..Default::default() };
        let extent = Extent { is_adaptive: false, dissipates: false, has_degrees: false, probes: Vec::new() };
        HistoryFile::create(&path, &extent).unwrap().write(&own_columns(&record, 0.5)).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(lines[0][..COLUMNS.len()], COLUMNS);
        assert_eq!(lines[0][COLUMNS.len()..], [SMALLEST_DETERMINANT]);
        assert_eq!(lines[1].len(), lines[0].len());
        assert_eq!((lines[1][0], lines[1][1].parse()), ("3", Ok(0.1 + 0.2)));
        assert_eq!(lines[1][3].parse(), Ok(1e-300));
        let history = History::read(&path).unwrap();
        assert_eq!(history.column("time"), Some(vec![0.1 + 0.2]));
        assert_eq!((history.column("tip_x"), history.n_rows()), (None, 1));
    }

    #[test]
    fn damaged_histories_name_their_line() {
        let temp = tempfile::tempdir().unwrap();
        let path = temp.path().join("history.csv");
        let read = |text: String| {
            std::fs::write(&path, text).unwrap();
            History::read(&path).map(|history| history.n_rows()).map_err(|error| error.to_string())
        };
        let (head, row) = (COLUMNS.join(","), ["1.0"; COLUMNS.len()].join(","));
        assert_eq!(read(format!("{head}\n{row}\n{row}\n")), Ok(2));
        // Killed while it wrote a row.
        assert_eq!(read(format!("{head}\n{row}\n1.0,1.")), Ok(1));
        assert_eq!(read(format!("{head}\n")), Ok(0));
        for (text, part) in [
            (String::new(), ":1: there is no column `step`"),
            ("a,b\n1,2\n".into(), "no column"),
            (format!("{head}\n{row}\n1,2\n"), ":3: there are 2 numbers for 18 columns"),
            (format!("{head}\n{}\n", row.replacen("1.0", "one", 1)), ":2: `one` is not a number"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(part), "{error}");
        }
    }
}
