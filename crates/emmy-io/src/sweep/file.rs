//! `sweep.csv`, and `sweep.toml`, which says what it belongs to.

use std::collections::HashSet;
use std::io;
use std::path::{Path, PathBuf};

use super::{Sweep, SweepRow, key_of, value_of};
use crate::directory::{self, DirectoryError, Lock, MARK};
use crate::history::{Number, csv_cells, csv_line};
use crate::message::escaped;
use crate::rows::RowFile;
use crate::summary::Status;
use crate::whole_file::{self, remove, replace};

/// The kind of results, for messages.
pub const SWEEP_KIND: &str = "sweep";

/// The file by which the directory of a sweep is recognized.
pub const SWEEP_WITNESS: &str = "sweep.toml";

pub(super) const ROWS: &str = "sweep.csv";

/// Folder of the kept files of runs, in the directory of a sweep.
pub const KEPT: &str = "runs";

/// Why a sweep cannot be written or continued.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The directory.
    #[error(transparent)]
    Directory(#[from] DirectoryError),
    /// There is nothing to continue.
    #[error("{path} holds no sweep to resume: there is no {SWEEP_WITNESS}")]
    Nothing {
        /// The directory.
        path: PathBuf,
    },
    /// The sweep in the directory has another input.
    #[error("the sweep in {path} has another input: {difference}")]
    Changed {
        /// The directory.
        path: PathBuf,
        /// The first difference.
        difference: String,
    },
    /// The table cannot be read.
    #[error("cannot read {path}: {error}; `emmy sweep` writes it")]
    Unreadable {
        /// The table.
        path: PathBuf,
        /// The message of the system.
        #[source]
        error: io::Error,
    },
    /// The table is damaged.
    #[error("{path}:{line}: {reason}")]
    Damaged {
        /// The table.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The reason.
        reason: String,
    },
    /// An error of the system.
    #[error("cannot write the sweep: {0}")]
    System(#[from] io::Error),
}

/// The table of a sweep. Rows are written when their runs end, and sorted at the end.
#[derive(Debug)]
pub struct SweepFile<'a> {
    sweep: &'a Sweep,
    path: PathBuf,
    rows: RowFile,
    _lock: Lock,
}

impl<'a> SweepFile<'a> {
    /// A new table in a directory, which may hold an earlier sweep; that one is replaced.
    ///
    /// # Errors
    /// [`SweepError`].
    pub fn create(sweep: &'a Sweep, directory: &Path) -> Result<Self, SweepError> {
        let lock = prepare(sweep, directory)?;
        let path = directory.join(ROWS);
        // Without its rows, a killed sweep cannot be resumed as another one.
        remove(&path)?;
        directory::remove_numbered_runs(&directory.join(KEPT))?;
        replace(&directory.join(SWEEP_WITNESS), sweep.description().as_bytes())?;
        let rows = RowFile::create(&path, &sweep.header())?;
        Ok(SweepFile { sweep, path, rows, _lock: lock })
    }

    /// The table of an interrupted sweep of the same input, with its rows.
    ///
    /// # Errors
    /// [`SweepError`]; nothing is changed then.
    pub fn resume(sweep: &'a Sweep, directory: &Path) -> Result<(Self, Vec<SweepRow>), SweepError> {
        let witness = directory.join(SWEEP_WITNESS);
        if !witness.is_file() {
            return Err(SweepError::Nothing { path: directory.to_path_buf() });
        }
        let lock = prepare(sweep, directory)?;
        let before = whole_file::read_text(&witness)?;
        if let Some(difference) = difference(&before, &sweep.description()) {
            return Err(SweepError::Changed { path: directory.to_path_buf(), difference });
        }
        let path = directory.join(ROWS);
        let text = whole_file::read_text(&path).unwrap_or_default();
        // A killed sweep may leave an incomplete line.
        let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
        let rows = sweep.rows(whole).map_err(|(line, reason)| SweepError::Damaged {
            path: path.clone(),
            line,
            reason,
        })?;
        let file = match whole.is_empty() {
            true => RowFile::create(&path, &sweep.header())?,
            false => RowFile::resume_at(&path, whole.len() as u64)?,
        };
        Ok((SweepFile { sweep, path, rows: file, _lock: lock }, rows))
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&mut self, row: &SweepRow) -> io::Result<()> {
        self.rows.write(&self.sweep.line(row))
    }

    /// Replaces the table by all its rows in the order of the runs.
    ///
    /// # Errors
    /// An error if the file has changed since, and errors of the system.
    pub fn finish(self, rows: &[SweepRow]) -> io::Result<()> {
        self.rows.verify()?;
        let mut sorted: Vec<&SweepRow> = rows.iter().collect();
        sorted.sort_by_key(|row| row.run);
        let lines: String = sorted.into_iter().map(|row| format!("{}\n", self.sweep.line(row))).collect();
        replace(&self.path, format!("{}\n{lines}", self.sweep.header()).as_bytes())
    }

    /// Path of the table.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Begin of the line with the columns that the inputs name.
pub(super) const NAMED: &str = "# columns that the input names: ";

/// Beginning of the line with the checksum of all runs. Sweeps with the same first run may differ in a file that they
/// read.
const CHECKSUM: &str = "# data of all runs: ";

/// Creates and locks the directory.
fn prepare(sweep: &Sweep, directory: &Path) -> Result<Lock, DirectoryError> {
    let place = |path: &Path| path.canonicalize().ok();
    let own: Vec<PathBuf> =
        [ROWS, SWEEP_WITNESS].iter().filter_map(|name| place(&directory.join(name))).collect();
    if let Some(file) = sweep.files.iter().find(|file| place(file).is_some_and(|file| own.contains(&file))) {
        return Err(DirectoryError::Source { path: directory.to_path_buf(), file: file.clone() });
    }
    directory::prepare_kind(directory, SWEEP_KIND, SWEEP_WITNESS)?;
    Lock::take(directory)
}

/// The first line that differs.
fn difference(before: &str, now: &str) -> Option<String> {
    let (mut old, mut new) = (before.lines(), now.lines());
    loop {
        match (old.next(), new.next()) {
            (None, None) => return None,
            (old, new) if old == new => {}
            // The inputs of the first runs agree.
            (Some(old), Some(new)) if [old, new].iter().all(|line| line.starts_with(CHECKSUM)) => {
                return Some("its mesh, or another file that it reads, has changed".to_string());
            }
            (old, new) => {
                let [old, new] = [old, new].map(|line| line.unwrap_or("").trim_start_matches("# "));
                return Some(format!("`{old}` there, `{new}` now"));
            }
        }
    }
}

impl Sweep {
    /// Keys, values and data of all runs, and the input of the first one.
    fn description(&self) -> String {
        let version = env!("CARGO_PKG_VERSION");
        let values = |flags: &[String]| flags.iter().map(|flag| value_of(flag)).collect::<Vec<_>>().join(",");
        let line = |flags: &Vec<String>| {
            format!("# --set {}\n", one_line(&format!("{}={}", key_of(&flags[0]), values(flags))))
        };
        let flags: String = self.flags.iter().map(line).collect();
        let until = match (self.modes, self.until) {
            (Some(count), _) => format!("--modes {count}"),
            (None, Some(until)) => format!("--until {until:?}"),
            (None, None) => "no --until".to_string(),
        };
        format!(
            "{MARK} {version}: the input of the first run of this sweep.\n{flags}# {until}\n{NAMED}{}\n\n{}\n{CHECKSUM}{:016x}\n",
            csv_line(&self.named),
            self.first,
            self.checksum
        )
    }

    /// The first line of the table.
    fn header(&self) -> String {
        let keys = self.keys().into_iter().map(one_line);
        let names = ["run".to_string()].into_iter().chain(keys).chain(["status".to_string()]);
        let names: Vec<String> =
            names.chain(self.columns.iter().cloned()).chain(["message".to_string()]).collect();
        csv_line(&names)
    }

    /// The line of a row.
    fn line(&self, row: &SweepRow) -> String {
        let cells = self.cells_before(row.run).into_iter().chain([row.status().name().to_string()]);
        let cells = cells.chain(row.numbers.iter().map(Number::to_string));
        let message = one_line(row.failure.as_deref().unwrap_or_default());
        csv_line(&cells.chain([message]).collect::<Vec<_>>())
    }

    /// Number and values of a run.
    fn cells_before(&self, run: usize) -> Vec<String> {
        let values = self.values(run).into_iter().map(one_line);
        [(run + 1).to_string()].into_iter().chain(values).collect()
    }

    /// The rows of a table of complete lines; a fault has its line.
    fn rows(&self, text: &str) -> Result<Vec<SweepRow>, (usize, String)> {
        let mut rows: Vec<SweepRow> = Vec::new();
        let mut known = HashSet::new();
        for (number, line) in text.lines().enumerate() {
            let fault = |reason: &str| (number + 1, reason.to_string());
            if number == 0 {
                match line == self.header() {
                    true => continue,
                    false => return Err(fault("the table has other columns")),
                }
            }
            let row = self.row(&csv_cells(line)).ok_or_else(|| fault("this is no row of the sweep"))?;
            if !known.insert(row.run) {
                return Err(fault("the run is there twice"));
            }
            rows.push(row);
        }
        Ok(rows)
    }

    /// The row of some cells, if they are of a run of this sweep.
    fn row(&self, cells: &[String]) -> Option<SweepRow> {
        let run = cells.first()?.parse::<usize>().ok()?.checked_sub(1).filter(|run| *run < self.n_runs())?;
        let own = self.cells_before(run);
        let rest = cells.strip_prefix(&own[..])?;
        let [status, numbers @ .., message] = rest else { return None };
        let number = |cell: &String| match cell.parse() {
            _ if cell.is_empty() => Some(Number::Missing),
            Ok(whole) => Some(Number::Whole(whole)),
            Err(_) => cell.parse().ok().map(Number::Real),
        };
        let numbers: Vec<Number> = numbers.iter().map(number).collect::<Option<_>>()?;
        let failure = match status.as_str() {
            status if status == Status::Done.name() => None,
            status if status == Status::Failed.name() => Some(message.clone()),
            _ => return None,
        };
        (numbers.len() == self.columns.len()).then_some(SweepRow { run, failure, numbers })
    }
}

/// A text in one line, without control characters.
fn one_line(text: &str) -> String {
    escaped(&text.split_whitespace().collect::<Vec<_>>().join(" ")).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_line_that_differs_says_what_has_changed() {
        let sweep = |until: &str, mu: &str, sum: &str| format!("# {until}\n\nmu = {mu}\n\n{CHECKSUM}{sum}\n");
        let old = sweep("no --until", "1.0", "0f");
        let with = |new: String| difference(&old, &new);
        assert_eq!(with(old.clone()), None);
        let other = with(sweep("--until 0.5", "2.0", "1f"));
        assert_eq!(other.as_deref(), Some("`no --until` there, `--until 0.5` now"));
        assert_eq!(
            with(sweep("no --until", "2.0", "1f")).as_deref(),
            Some("`mu = 1.0` there, `mu = 2.0` now")
        );
        let of_file = with(sweep("no --until", "1.0", "1f"));
        assert_eq!(of_file.as_deref(), Some("its mesh, or another file that it reads, has changed"));
    }
}
