//! Reads the files of sweeps, and puts the rows of several sweeps side by side.

use std::io;
use std::path::{Path, PathBuf};

use super::file::{NAMED, ROWS};
use super::{SWEEP_WITNESS, SweepError};
use crate::chart::{Axis, Chart, Figure, Series, Style};
use crate::history::{csv_cells, csv_line};
use crate::message::shown;
use crate::whole_file::{self, remove, replace};

/// A row of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct TableRow {
    /// Number of the run, from 1.
    pub run: usize,
    /// Values of the swept keys.
    pub values: Vec<String>,
    /// `done` or `failed`.
    pub status: String,
    /// Numbers of the columns; NaN where the cell is empty.
    pub numbers: Vec<f64>,
    /// Why the run failed.
    pub message: String,
}

/// The table of a sweep, from its directory.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepTable {
    /// Name of the directory.
    pub name: String,
    /// The swept keys.
    pub keys: Vec<String>,
    /// Columns of numbers.
    pub columns: Vec<String>,
    /// Columns X whose peaks the input asks for by name.
    pub named: Vec<String>,
    /// Rows of the finished runs.
    pub rows: Vec<TableRow>,
}

/// Whether a directory holds a sweep.
pub fn is_sweep(directory: &Path) -> bool {
    directory.join(SWEEP_WITNESS).is_file()
}

impl SweepTable {
    /// Reads the table of a sweep, which may still be running.
    ///
    /// # Errors
    /// [`SweepError`] if there is none, or if it is damaged.
    pub fn read(directory: &Path) -> Result<Self, SweepError> {
        let path = directory.join(ROWS);
        let text = whole_file::read_text(&path)
            .map_err(|error| SweepError::Unreadable { path: path.clone(), error })?;
        let damaged = |line: usize, reason: &str| SweepError::Damaged {
            path: path.clone(),
            line: line + 1,
            reason: reason.to_string(),
        };
        // A sweep that is running or was killed may leave an incomplete line.
        let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
        let mut lines = whole.lines().enumerate();
        let head = csv_cells(lines.next().map_or("", |(_, line)| line));
        let status = head.iter().position(|name| name == "status");
        let (Some(status), Some("run"), Some("message")) =
            (status, head.first().map(String::as_str), head.last().map(String::as_str))
        else {
            return Err(damaged(0, "this is not the head of a sweep"));
        };
        let row = |line: &str| -> Option<TableRow> {
            let mut cells = csv_cells(line);
            let (message, run) = (cells.pop()?, cells.first()?.parse().ok()?);
            let number = |cell: &String| if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok() };
            let numbers: Vec<f64> = cells.get(status + 1..)?.iter().map(number).collect::<Option<_>>()?;
            let (values, status) = (cells[1..status].to_vec(), cells[status].clone());
            (cells.len() + 1 == head.len()).then_some(TableRow { run, values, status, numbers, message })
        };
        let rows =
            lines.map(|(at, line)| row(line).ok_or_else(|| damaged(at, "this is no row of the sweep")));
        let rows = rows.collect::<Result<Vec<_>, _>>()?;
        let witness = whole_file::read_text(&directory.join(SWEEP_WITNESS)).unwrap_or_default();
        let named = witness.lines().find_map(|line| line.strip_prefix(NAMED)).map_or(Vec::new(), csv_cells);
        let columns = head[status + 1..head.len() - 1].to_vec();
        let name = directory.file_name().map(|name| name.to_string_lossy().into_owned());
        Ok(SweepTable {
            name: name.unwrap_or_else(|| directory.display().to_string()),
            keys: head[1..status].to_vec(),
            named: named.into_iter().filter(|name| columns.contains(name)).collect(),
            columns,
            rows,
        })
    }

    /// The number of a column in a row; NaN if there is none.
    pub fn number(&self, row: &TableRow, column: &str) -> f64 {
        let place = self.columns.iter().position(|name| name == column);
        place.map_or(f64::NAN, |place| row.numbers[place])
    }
}

/// The same values, as numbers if they are numbers.
fn agree(a: &[String], b: &[String]) -> bool {
    let number = |text: &String| text.parse::<f64>().ok().filter(|number| !number.is_nan());
    let same = |(a, b): (&String, &String)| a == b || number(a).is_some_and(|a| number(b) == Some(a));
    a.len() == b.len() && a.iter().zip(b).all(same)
}

/// The rows of sweeps over the same keys, side by side: for each combination of values the row of each sweep that has
/// it. Combinations are in the order of the first sweep that has them.
pub fn rows_side_by_side(sweeps: &[SweepTable]) -> Vec<Vec<Option<&TableRow>>> {
    let mut all: Vec<Vec<Option<&TableRow>>> = Vec::new();
    for (place, sweep) in sweeps.iter().enumerate() {
        for row in &sweep.rows {
            let has_values = |own: &&mut Vec<Option<&TableRow>>| {
                own[place].is_none() && own.iter().flatten().any(|other| agree(&other.values, &row.values))
            };
            match all.iter_mut().find(has_values) {
                Some(own) => own[place] = Some(row),
                None => {
                    let mut own = vec![None; sweeps.len()];
                    own[place] = Some(row);
                    all.push(own);
                }
            }
        }
    }
    all
}

/// The columns that the inputs of some sweeps name, each once.
pub fn named_columns(sweeps: &[SweepTable]) -> Vec<String> {
    columns_of_all(sweeps, |sweep| &sweep.named)
}

/// All columns of some sweeps, each once.
fn columns_of_all(sweeps: &[SweepTable], of: fn(&SweepTable) -> &[String]) -> Vec<String> {
    let mut all = Vec::new();
    sweeps.iter().for_each(|sweep| super::add_new(&mut all, of(sweep).iter().cloned()));
    all
}

/// The rows of all sweeps as one table: sweep, run, swept keys, status, the columns of all, message.
fn joined(sweeps: &[SweepTable]) -> String {
    let columns = columns_of_all(sweeps, |sweep| &sweep.columns);
    let keys = sweeps.first().map_or(&[][..], |sweep| &sweep.keys);
    let words = |words: &[&str]| words.iter().map(|word| word.to_string()).collect::<Vec<_>>();
    let head = [&words(&["sweep", "run"])[..], keys, &words(&["status"]), &columns, &words(&["message"])];
    let mut text = format!("{}\n", csv_line(&head.concat()));
    for sweep in sweeps {
        for row in &sweep.rows {
            let cell = |column: &String| match sweep.number(row, column) {
                number if number.is_nan() => String::new(),
                number => format!("{number:.16e}"),
            };
            let cells: Vec<String> = columns.iter().map(cell).collect();
            let first = [sweep.name.clone(), row.run.to_string()];
            let line = [
                &first[..],
                &row.values,
                std::slice::from_ref(&row.status),
                &cells,
                std::slice::from_ref(&row.message),
            ]
            .concat();
            text += &format!("{}\n", csv_line(&line));
        }
    }
    text
}

/// Writes the rows of all sweeps as `compare.csv`, and charts over the swept key as `compare.svg` and `.png`. A page of
/// an earlier comparison is removed.
///
/// # Errors
/// Errors of the system.
pub fn write(directory: &Path, sweeps: &[SweepTable]) -> io::Result<()> {
    figure(sweeps).write(&directory.join("compare"))?;
    replace(&directory.join("compare.csv"), joined(sweeps).as_bytes())?;
    remove(&directory.join("report.html"))
}

/// Charts of a figure at most.
const MAX_CHARTS: usize = 6;

/// Smallest and largest values over the first swept key with numbers, of the columns that the inputs name; of the total
/// energy at the end if there are none.
fn figure(sweeps: &[SweepTable]) -> Figure {
    let named = named_columns(sweeps);
    let charts = match named.is_empty() {
        true => vec![chart(sweeps, "total_energy", &[("total_energy", Style::LineAndPoints)])],
        false => named.iter().take(MAX_CHARTS).map(|name| peaks(sweeps, name)).collect(),
    };
    Figure { columns: charts.len().min(2), charts }
}

fn peaks(sweeps: &[SweepTable], column: &str) -> Chart {
    let [largest, smallest] = ["_max", "_min"].map(|ending| format!("{column}{ending}"));
    match sweeps.iter().any(|sweep| sweep.columns.contains(&largest)) {
        true => chart(sweeps, column, &[(&largest, Style::LineAndPoints), (&smallest, Style::Dashed)]),
        // The frequencies of natural modes are no peaks.
        false => chart(sweeps, column, &[(column, Style::LineAndPoints)]),
    }
}

fn chart(sweeps: &[SweepTable], title: &str, columns: &[(&str, Style)]) -> Chart {
    let axis = first_key_with_numbers(sweeps);
    let mut series: Vec<Series> = Vec::new();
    for sweep in sweeps {
        for row in &sweep.rows {
            let others = row.values.iter().zip(&sweep.keys).enumerate();
            let others = others.filter(|(place, _)| Some(*place) != axis);
            let others: String = others.map(|(_, (value, key))| format!(", {key}={value}")).collect();
            let label = shown(&format!("{}{others}", sweep.name)).into_owned();
            let x = axis.map_or(row.run as f64, |key| row.values[key].parse().unwrap_or(f64::NAN));
            for (column, style) in columns {
                let label = match columns.len() {
                    1 => label.clone(),
                    _ => {
                        format!("{label}: {}", if column.ends_with("_max") { "largest" } else { "smallest" })
                    }
                };
                let point = (x, sweep.number(row, column));
                match series.iter_mut().find(|own| own.label == label) {
                    Some(own) => own.points.push(point),
                    None => {
                        let colour = series.len() / columns.len();
                        series.push(Series { label, points: vec![point], style: *style, colour });
                    }
                }
            }
        }
    }
    let key = axis.and_then(|axis| Some(sweeps.first()?.keys[axis].clone()));
    Chart {
        title: String::new(),
        x: Axis::linear(shown(&key.unwrap_or("run".to_string()))),
        y: Axis::linear(shown(title)),
        series,
        guides: Vec::new(),
    }
}

/// Place of the first swept key whose values are all numbers.
fn first_key_with_numbers(sweeps: &[SweepTable]) -> Option<usize> {
    let n_keys = sweeps.first().map_or(0, |sweep| sweep.keys.len());
    let rows = || sweeps.iter().flat_map(|sweep| &sweep.rows);
    (0..n_keys).find(|&key| rows().all(|row| row.values[key].parse::<f64>().is_ok()))
}

/// Names sweeps in directories of the same name by their full paths.
pub fn name_apart(sweeps: &mut [SweepTable], directories: &[PathBuf]) {
    let names: Vec<String> = sweeps.iter().map(|sweep| sweep.name.clone()).collect();
    for (sweep, directory) in sweeps.iter_mut().zip(directories) {
        if names.iter().filter(|name| **name == sweep.name).count() > 1 {
            sweep.name = directory.display().to_string();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep(name: &str, rows: &[(&str, f64)]) -> SweepTable {
        let row = |(index, (value, number)): (usize, &(&str, f64))| TableRow {
            run: index + 1,
            values: vec![value.to_string()],
            status: "done".into(),
            numbers: vec![*number],
            message: String::new(),
        };
        SweepTable {
            name: name.into(),
            keys: vec!["region.density".into()],
            columns: vec!["tip_x_max".into()],
            named: vec!["tip_x".into()],
            rows: rows.iter().enumerate().map(row).collect(),
        }
    }

    #[test]
    fn rows_of_the_same_values_are_side_by_side_in_any_order_and_spelling() {
        let sweeps = [
            sweep("a", &[("1", 0.5), ("2", 0.6), ("DGM", 0.7)]),
            sweep("b", &[("2.0", 0.8), ("3", 0.9), ("1e0", 1.0)]),
        ];
        let runs: Vec<Vec<Option<usize>>> = rows_side_by_side(&sweeps)
            .iter()
            .map(|own| own.iter().map(|row| row.map(|row| row.run)).collect())
            .collect();
        assert_eq!(runs, [[Some(1), Some(3)], [Some(2), Some(1)], [Some(3), None], [None, Some(2)]]);
        let text = joined(&sweeps);
        assert!(
            text.starts_with("sweep,run,region.density,status,tip_x_max,message\na,1,1,done,5.0"),
            "{text}"
        );
        assert_eq!(text.lines().count(), 7);
    }
}
