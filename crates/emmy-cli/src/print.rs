//! Results on standard output; numbers in them.

use std::io::{self, Write};

pub(crate) use emmy::internals::number::{short as number, short_vector as vector};
use emmy_io::message::escaped;

use crate::failure::Failure;

/// Prints a result; control characters of names and titles are escaped. A reader that stops early (`emmy list schemes |
/// head -1`) is not a failure.
pub(crate) fn result(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(escaped(text).as_bytes()).and_then(|()| stdout.flush());
    written.or_else(without_reader).map_err(Failure::from_stdout)
}

/// Success if the reader of a pipe has stopped.
pub(crate) fn without_reader(error: io::Error) -> io::Result<()> {
    if error.kind() == io::ErrorKind::BrokenPipe { Ok(()) } else { Err(error) }
}

/// Rows of cells as lines with aligned columns: the first one to the left, the others to the right.
pub(crate) fn columns(rows: Vec<Vec<String>>) -> String {
    let n = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |i: usize| rows.iter().filter_map(|row| Some(row.get(i)?.chars().count())).max().unwrap_or(0);
    let widths: Vec<usize> = (0..n).map(width).collect();
    let cell = |(i, text): (usize, &String)| match i {
        0 => format!("{text:<width$}", width = widths[i]),
        _ => format!("{text:>width$}", width = widths[i]),
    };
    let line = |row: &Vec<String>| row.iter().enumerate().map(cell).collect::<Vec<_>>().join("  ");
    rows.iter().map(|row| format!("{}\n", line(row).trim_end())).collect()
}
