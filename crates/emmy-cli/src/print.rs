//! Results on standard output; numbers in them.

pub(crate) use emmy::internals::number::{short as number, short_vector as vector};
use emmy_io::message::escaped;

use crate::failure::Failure;
use crate::host::Host;

/// Hands a result to the host; control characters of names and titles are escaped.
pub(crate) fn result(host: &dyn Host, text: &str) -> Result<(), Failure> {
    host.output(&escaped(text)).map_err(Failure::from_stdout)
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
