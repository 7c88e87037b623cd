//! Reads `history.csv`.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

use emmy::motion::StepLimit;

use super::columns::LIMITED_BY;
use super::{Number, header, required};
use crate::whole_file::open;

/// Why a history cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum HistoryError {
    /// An error of the system.
    #[error("cannot read {path}: {error}; `emmy run` writes it")]
    System {
        /// The path.
        path: PathBuf,
        /// The message of the system.
        #[source]
        error: io::Error,
    },
    /// A column is missing.
    #[error("{path}:1: there is no column `{column}`; is this a history of Emmy?")]
    Column {
        /// The path.
        path: PathBuf,
        /// Name of the column.
        column: &'static str,
    },
    /// Its columns differ from the columns of the run to resume.
    #[error(
        "{path}: its columns do not fit the present input; a resumed run cannot change `output.probes`, `reactions`, `extremes` or `values`, or switch between adaptive and planned steps"
    )]
    Columns {
        /// The path.
        path: PathBuf,
    },
    /// It ends before the step of the checkpoint.
    #[error(
        "{path} has no row for step {step} of the checkpoint; it is damaged, start again with `emmy run`"
    )]
    Short {
        /// The path.
        path: PathBuf,
        /// Step of the checkpoint.
        step: usize,
    },
    /// Its rows have changed since the run wrote them.
    #[error(
        "{path} was changed after the run wrote it: its rows do not have the checksum of the checkpoint; restore the file, \
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
        /// Reason.
        reason: String,
    },
}

/// A history in memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct History {
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl History {
    /// Reads a history. An incomplete last line is still being written, and is left out.
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

    /// Rows, each with a number for every column; NaN where the cell is empty.
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
    /// Lines read so far.
    n_lines: usize,
}

impl Rows {
    /// Opens a history.
    ///
    /// # Errors
    /// [`HistoryError`] if the file cannot be read or is not a history.
    pub fn open(path: &Path) -> Result<Self, HistoryError> {
        let system = |error| HistoryError::System { path: path.to_path_buf(), error };
        let reader = BufReader::new(open(path).map_err(system)?);
        let mut rows = Rows { path: path.to_path_buf(), reader, columns: Vec::new(), n_lines: 0 };
        let head = rows.line().map_err(system)?.unwrap_or_default();
        rows.columns = header::names(&head);
        match required().find(|name| !rows.columns.iter().any(|column| column == name)) {
            Some(column) => Err(HistoryError::Column { path: path.to_path_buf(), column }),
            None => Ok(rows),
        }
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The next line, if it is complete.
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
        Some(numbers(&line, &self.columns).map_err(row))
    }
}

fn numbers(line: &str, columns: &[String]) -> Result<Vec<f64>, String> {
    let limit = |place: usize, text: &str| {
        let is_word = columns.get(place).is_some_and(|name| name == LIMITED_BY);
        StepLimit::from_name(text).filter(|_| is_word).map(|limit| Number::Limit(limit).value())
    };
    let number = |(place, text): (usize, &str)| match text {
        "" => Ok(f64::NAN),
        text => {
            let value = text.parse().ok().or_else(|| limit(place, text));
            value.ok_or_else(|| format!("`{text}` is not a number"))
        }
    };
    let numbers = line.split(',').enumerate().map(number).collect::<Result<Vec<f64>, _>>()?;
    match numbers.len() {
        n if n == columns.len() => Ok(numbers),
        n => Err(format!("there are {n} numbers for {} columns", columns.len())),
    }
}
