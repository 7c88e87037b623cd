//! `history.csv`: one row for the start and one a step.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use emmy::motion::{Record, View};

use crate::input::Probe;

/// Columns before those of the probes.
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

/// A number of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// A count.
    Whole(usize),
    /// A quantity.
    Real(f64),
}

/// Names of all columns: [`COLUMNS`], then the current position of each probe.
pub fn columns(probes: &[Probe]) -> Vec<String> {
    let own = COLUMNS.iter().map(|name| name.to_string());
    let of_probe = |probe: &Probe| ["x", "y", "z"].map(|axis| format!("{}_{axis}", probe.name));
    own.chain(probes.iter().flat_map(of_probe)).collect()
}

/// The numbers of a row, in the order of [`columns`]. `wall_seconds`: since the start of the run.
pub fn row(view: View<'_>, probes: &[Probe], wall_seconds: f64) -> Vec<Number> {
    let mut row = own_columns(view.record, wall_seconds);
    for probe in probes {
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
    row
}

/// The file; every row is on disk once it is written.
#[derive(Debug)]
pub struct HistoryFile {
    file: File,
}

impl HistoryFile {
    /// A new file with its header.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn create(path: &Path, probes: &[Probe]) -> io::Result<Self> {
        let mut file = File::create(path)?;
        file.write_all((columns(probes).join(",") + "\n").as_bytes())?;
        Ok(HistoryFile { file })
    }

    /// Writes a row with 17 significant digits, which is what it takes to read back the same numbers.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn write(&mut self, row: &[Number]) -> io::Result<()> {
        let text = |number: &Number| match number {
            Number::Whole(value) => value.to_string(),
            Number::Real(value) => format!("{value:.16e}"),
        };
        let line = row.iter().map(text).collect::<Vec<_>>().join(",") + "\n";
        self.file.write_all(line.as_bytes())?;
        self.file.flush()
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
        HistoryFile::create(&path, &[]).unwrap().write(&own_columns(&record, 0.5)).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(lines[0], COLUMNS);
        assert_eq!(lines[1].len(), COLUMNS.len());
        assert_eq!((lines[1][0], lines[1][1].parse()), ("3", Ok(0.1 + 0.2)));
        assert_eq!(lines[1][3].parse(), Ok(1e-300));
    }
}
