//! `newton.csv`: the residuals of the Newton iteration in every step.

use std::fmt::Write as _;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

use emmy::motion::View;

use crate::rows::RowFile;
use crate::whole_file;

/// Columns of the file.
pub const COLUMNS: &str = "step,iteration,residual,target";

/// The file: one row for each evaluation of the residual, with the number of corrections before it and the tolerance.
/// Norms have four digits; every step is written at once.
#[derive(Debug)]
pub struct NewtonFile {
    rows: RowFile,
}

impl NewtonFile {
    /// A new file with its header.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn create(path: &Path) -> io::Result<Self> {
        Ok(NewtonFile { rows: RowFile::create(path, COLUMNS)? })
    }

    /// The file of a run that is resumed after a step; later rows are removed.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn resume(path: &Path, step: usize) -> io::Result<Self> {
        if !path.exists() {
            return NewtonFile::create(path);
        }
        Ok(NewtonFile { rows: RowFile::resume(path, step)? })
    }

    /// Writes the rows of a step.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&mut self, view: View<'_>) -> io::Result<()> {
        self.write_step(view.record.step, view.newton_residuals, view.record.newton_target)
    }

    fn write_step(&mut self, step: usize, residuals: &[f64], target: f64) -> io::Result<()> {
        let mut rows = String::new();
        for (iteration, residual) in residuals.iter().enumerate() {
            let _ = writeln!(rows, "{step},{iteration},{residual:.3e},{target:.3e}");
        }
        if rows.is_empty() { Ok(()) } else { self.rows.write(rows.trim_end()) }
    }
}

/// The Newton iteration in a step.
#[derive(Debug, Clone, PartialEq)]
pub struct NewtonStep {
    /// Number of the step.
    pub step: usize,
    /// Norms of the residuals, one for each evaluation.
    pub residuals: Vec<f64>,
    /// Tolerance.
    pub target: f64,
}

/// Reads the wanted steps, in ascending order. Damaged and incomplete rows are left out.
///
/// # Errors
/// Errors of the system.
pub fn read(path: &Path, mut is_wanted: impl FnMut(usize) -> bool) -> io::Result<Vec<NewtonStep>> {
    let mut reader = BufReader::new(whole_file::open(path)?);
    let mut steps = Vec::<NewtonStep>::new();
    let mut line = String::new();
    loop {
        line.clear();
        if reader.read_line(&mut line)? == 0 || !line.ends_with('\n') {
            return Ok(steps);
        }
        let Some((step, residual, target)) = row(&line) else { continue };
        if steps.last().is_none_or(|last| last.step != step) {
            if !is_wanted(step) {
                continue;
            }
            steps.push(NewtonStep { step, residuals: Vec::new(), target });
        }
        if let Some(last) = steps.last_mut() {
            last.residuals.push(residual);
        }
    }
}

fn row(line: &str) -> Option<(usize, f64, f64)> {
    let mut cells = line.trim_end().split(',');
    let step = cells.next()?.parse().ok()?;
    let residual = cells.nth(1)?.parse().ok()?;
    Some((step, residual, cells.next()?.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn steps_are_read_back() {
        let temp = tempfile::tempdir().unwrap();
        let path = temp.path().join("newton.csv");
        let mut file = NewtonFile::create(&path).unwrap();
        file.write_step(0, &[], 0.0).unwrap();
        file.write_step(1, &[2.0, 1.234e-5], 1e-8).unwrap();
        file.write_step(2, &[f64::NAN], 0.5).unwrap();
        file.write_step(3, &[1e300, 0.0], 0.5).unwrap();
        // Killed while writing a row.
        let mut file = std::fs::File::options().append(true).open(&path).unwrap();
        file.write_all(b"4,0,1.0").unwrap();
        let steps = read(&path, |step| step != 2).unwrap();
        let expected = [(1, vec![2.0, 1.234e-5], 1e-8), (3, vec![1e300, 0.0], 0.5)];
        assert_eq!(steps, expected.map(|(step, residuals, target)| NewtonStep { step, residuals, target }));
    }
}
