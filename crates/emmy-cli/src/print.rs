//! Results on standard output, and the form of numbers.

use std::io::{self, Write};

use crate::failure::Failure;

/// Prints a result. A reader that has gone away (`emmy list schemes | head -1`) is no failure.
pub fn result(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush());
    written.or_else(without_reader).map_err(Failure::from_stdout)
}

/// Success after all, if nobody reads on.
pub fn without_reader(error: io::Error) -> io::Result<()> {
    if error.kind() == io::ErrorKind::BrokenPipe { Ok(()) } else { Err(error) }
}

/// A number with up to ten significant digits, without trailing zeros.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if !size.is_finite() {
        return value.to_string();
    }
    if size != 0.0 && !(1e-4..1e10).contains(&size) {
        let text = format!("{value:.9e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", trimmed(digits));
    }
    let magnitude = if size == 0.0 { 0 } else { size.log10().floor() as i32 };
    let text = format!("{value:.*}", (9 - magnitude).max(0) as usize);
    match trimmed(&text) {
        "-0" => "0".to_string(),
        digits => digits.to_string(),
    }
}

fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// A vector in brackets.
pub fn vector(values: [f64; 3]) -> String {
    format!("[{}]", values.map(number).join(", "))
}

/// Rows of cells as lines with aligned columns: the first one to the left, the others to the right.
pub fn columns(rows: Vec<Vec<String>>) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_but_whole() {
        let numbers = [0.0, 58.49999999999, -1.5, 1e-15, 1.25e12, 100.0, 0.3, 1e10, -1e-12, f64::NAN];
        let texts = ["0", "58.5", "-1.5", "1e-15", "1.25e12", "100", "0.3", "1e10", "-1e-12", "NaN"];
        assert_eq!(numbers.map(number), texts);
    }
}
