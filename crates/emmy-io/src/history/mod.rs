//! `history.csv`: one row for the start and one for each step.

mod columns;
mod file;
mod header;
mod measures;
mod mechanism;
mod output_motion;
mod peaks;
mod reader;
mod regions;

use std::fmt;

use emmy::motion::StepLimit;

#[cfg(test)]
pub(crate) use columns::every_column;
pub(crate) use columns::fixed_names;
pub use columns::{ColumnInfo, HistoryColumns, Row, required};
pub use file::HistoryFile;
pub(crate) use header::{line as csv_line, names as csv_cells};
pub use measures::Extreme;
pub(crate) use measures::keep_largest;
pub(crate) use mechanism::MechanismColumns;
pub(crate) use mechanism::{HIDDEN, RESIDUAL};
pub(crate) use output_motion::OutputMotion;
pub(crate) use peaks::column_of_peak;
pub use peaks::{Peak, Peaks};
pub use reader::{History, HistoryError, Rows};
pub(crate) use regions::{RegionMembers, nodes_of};

/// A number of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// A count.
    Whole(usize),
    /// A quantity.
    Real(f64),
    /// The limit that set the size of the step: a word in files, otherwise [`StepLimit::index`].
    Limit(StepLimit),
    /// Nothing: the quantity is not known in this row.
    Missing,
}

impl Number {
    /// As a floating-point number; NaN for a missing one.
    pub fn value(self) -> f64 {
        match self {
            Number::Whole(value) => value as f64,
            Number::Real(value) => value,
            Number::Limit(limit) => limit.index() as f64,
            Number::Missing => f64::NAN,
        }
    }
}

/// As in a file: with 17 significant digits, so that the same number is read back.
impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Number::Whole(value) => write!(f, "{value}"),
            Number::Real(value) => write!(f, "{value:.16e}"),
            Number::Limit(limit) => f.write_str(limit.name()),
            Number::Missing => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use emmy::motion::Record;

    use super::*;

    #[test]
    fn a_word_says_what_set_the_size_of_a_step() {
        let temp = tempfile::tempdir().unwrap();
        let path = temp.path().join("history.csv");
        let mut columns = HistoryColumns::default();
        columns.is_adaptive = true;
        let mut file = HistoryFile::create(&path, &columns).unwrap();
        for step_limit in [None, Some(StepLimit::Kink)] {
            file.write(&columns.numbers(&Record { step_limit, ..Default::default() }, 0.0)).unwrap();
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let place = columns.names().iter().position(|name| name == "limited_by").unwrap();
        let words: Vec<&str> = text.lines().map(|line| line.split(',').nth(place).unwrap()).collect();
        assert_eq!(words, ["limited_by", "", "kink"]);
        let read = History::read(&path).unwrap().column("limited_by").unwrap();
        assert!(read[0].is_nan() && read[1] == StepLimit::Kink.index() as f64);
        std::fs::write(&path, text.replace("kink", "kinks")).unwrap();
        let error = History::read(&path).unwrap_err().to_string();
        assert!(error.contains("`kinks` is not a number"), "{error}");
    }

    #[test]
    fn rows_have_a_number_for_each_column_with_all_digits() {
        let temp = tempfile::tempdir().unwrap();
        let path = temp.path().join("history.csv");
        let record = Record { step: 3, time: 0.1 + 0.2, kinetic_energy: 1e-300, ..Default::default() };
        let columns = HistoryColumns::default();
        HistoryFile::create(&path, &columns).unwrap().write(&columns.numbers(&record, 0.5)).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(lines[0], required().collect::<Vec<_>>());
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
        let columns: Vec<&str> = required().collect();
        let head = columns.join(",");
        let row = vec!["1.0"; columns.len()].join(",");
        assert_eq!(read(format!("{head}\n{row}\n{row}\n")), Ok(2));
        // Killed while writing a row.
        assert_eq!(read(format!("{head}\n{row}\n1.0,1.")), Ok(1));
        assert_eq!(read(format!("{head}\n")), Ok(0));
        for (text, part) in [
            (String::new(), ":1: there is no column `step`"),
            ("a,b\n1,2\n".into(), "no column"),
            (format!("{head}\n{row}\n1,2\n"), ":3: there are 2 numbers for 19 columns"),
            (format!("{head}\n{}\n", row.replacen("1.0", "one", 1)), ":2: `one` is not a number"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(part), "{error}");
        }
    }
}
