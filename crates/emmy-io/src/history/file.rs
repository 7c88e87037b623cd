//! Writes `history.csv`, with a checksum of its rows.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;

use crc32fast::Hasher;

use super::{HistoryColumns, HistoryError, Number, header};
use crate::rows::{RowFile, step_of};
use crate::whole_file::{PART, named, open, with_ending};

/// The file; every row is on disk once it is written.
#[derive(Debug)]
pub struct HistoryFile {
    rows: RowFile,
    sum: RowSum,
}

/// Checksum of rows, without the time of the last one: another plan of a resumed run may change its last bit.
#[derive(Debug, Default)]
struct RowSum {
    before: Hasher,
    last: Vec<u8>,
}

impl RowSum {
    fn add(&mut self, row: &[u8]) {
        self.before.update(&self.last);
        self.last.clear();
        self.last.extend(row);
    }

    fn value(&self) -> u32 {
        let mut sum = self.before.clone();
        let cells = self.last.split(|&byte| byte == b',').enumerate().filter(|(i, _)| *i != 1);
        cells.for_each(|(_, cell)| [cell, b","].iter().for_each(|part| sum.update(part)));
        sum.finalize()
    }
}

impl HistoryFile {
    /// A new file with its header.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn create(path: &Path, columns: &HistoryColumns) -> io::Result<Self> {
        let rows = RowFile::create(path, &header::line(&columns.names()))?;
        Ok(HistoryFile { rows, sum: RowSum::default() })
    }

    /// The history of a run that is resumed after a step; later rows are removed. `checksum`: of the rows up to that
    /// step. The time in the last row becomes the time of the state, which differs in the last bit if the plan had
    /// ended there.
    ///
    /// # Errors
    /// [`HistoryError`] if the file is damaged, has other columns or other rows, or ends before the step.
    pub fn resume(
        path: &Path,
        columns: &HistoryColumns,
        step: usize,
        time: f64,
        checksum: u32,
    ) -> Result<Self, HistoryError> {
        let system = |error| HistoryError::System { path: path.to_path_buf(), error };
        let mut reader = BufReader::new(open(path).map_err(system)?);
        let mut line = Vec::new();
        let mut length = reader.read_until(b'\n', &mut line).map_err(system)?;
        if line.trim_ascii_end() != header::line(&columns.names()).as_bytes() {
            return Err(HistoryError::Columns { path: path.to_path_buf() });
        }
        let mut own = RowSum::default();
        let mut last = None;
        loop {
            line.clear();
            reader.read_until(b'\n', &mut line).map_err(system)?;
            match step_of(&line) {
                Some(number) if number <= step => last = Some(number),
                _ => break,
            }
            length += line.len();
            own.add(&line);
        }
        if last != Some(step) {
            return Err(HistoryError::Short { path: path.to_path_buf(), step });
        }
        if own.value() != checksum {
            return Err(HistoryError::Changed { path: path.to_path_buf() });
        }
        let row = with_time(&own.last, time);
        if row != own.last {
            let before = (length - own.last.len()) as u64;
            length = before as usize + row.len();
            replace_end(path, before, &row).map_err(system)?;
            own.last = row;
        }
        let rows = RowFile::resume_at(path, length as u64).map_err(system)?;
        Ok(HistoryFile { rows, sum: own })
    }

    /// Checksum of the rows so far.
    pub fn sum(&self) -> u32 {
        self.sum.value()
    }

    /// Reads the file, and checks that all rows are still there.
    ///
    /// # Errors
    /// How the file has changed.
    pub fn verify(&self) -> io::Result<()> {
        self.rows.verify()?;
        let path = self.rows.path();
        let mut reader = BufReader::with_capacity(1 << 16, open(path).map_err(named(path))?);
        let mut found = RowSum::default();
        let mut line = Vec::new();
        let mut is_row = false;
        while reader.read_until(b'\n', &mut line).map_err(named(path))? > 0 {
            if is_row {
                found.add(&line);
            }
            is_row = true;
            line.clear();
        }
        if found.value() == self.sum.value() {
            return Ok(());
        }
        Err(named(path)(io::Error::other(
            "it was changed during the run: its rows are not those that the run wrote",
        )))
    }

    /// Syncs all rows to the disk.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn sync(&self) -> io::Result<()> {
        self.rows.sync()
    }

    /// Writes a row.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&mut self, row: &[Number]) -> io::Result<()> {
        let row = row.iter().map(Number::to_string).collect::<Vec<_>>().join(",");
        self.rows.write(&row)?;
        self.sum.add(format!("{row}\n").as_bytes());
        Ok(())
    }
}

/// A row with another time.
fn with_time(row: &[u8], time: f64) -> Vec<u8> {
    let time = Number::Real(time).to_string().into_bytes();
    let cells = row.split(|&byte| byte == b',').enumerate();
    cells.map(|(i, cell)| if i == 1 { &time[..] } else { cell }).collect::<Vec<_>>().join(&b',')
}

/// Replaces the end of a file from an offset on. At every moment, either the old or the new file exists and is
/// complete.
fn replace_end(path: &Path, offset: u64, end: &[u8]) -> io::Result<()> {
    let part = with_ending(path, PART);
    let mut new = File::create(&part).map_err(named(&part))?;
    io::copy(&mut open(path)?.take(offset), &mut new)
        .and_then(|_| new.write_all(end))
        .map_err(named(&part))?;
    fs::rename(&part, path).map_err(named(path))
}
