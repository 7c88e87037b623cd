//! The history in a page, reduced to a limited number of rows.

use std::io::{self, BufRead, BufReader};
use std::path::Path;

use serde_json::{Value, json};

use super::pack::Pack;
use super::thinning::{KeptRow, kept_rows};
use crate::history::{HistoryError, Rows, required};
use crate::newton;
use crate::whole_file::open;

/// The rows of a history that are kept.
#[derive(Debug)]
pub(super) struct Thinned {
    columns: Vec<String>,
    rows: Vec<KeptRow>,
    /// Number of rows in the file.
    written: usize,
    stretches: usize,
    /// Number of the step at each of the given times.
    pub(super) steps: Vec<u32>,
}

/// Largest number of values; with many probes, fewer rows are kept.
const MAX_NUMBERS: usize = 600_000;

impl Thinned {
    /// Reads a history, keeps at most `limit` rows, and finds the steps at some ascending times: the first rows that
    /// are not before them.
    pub(super) fn read(path: &Path, limit: usize, times: &[f64]) -> Result<Self, HistoryError> {
        let rows = Rows::open(path)?;
        let system = |error| HistoryError::System { path: path.to_path_buf(), error };
        let written = count(path).map_err(system)?.saturating_sub(1);
        let columns = rows.columns().to_vec();
        // These columns only increase, or have no peaks, so that the first row of a stretch is enough.
        let is_steady = |name: &str| matches!(name, "step" | "time" | "wall_seconds" | "limited_by");
        let peaked: Vec<usize> =
            (0..columns.len().min(required().count() + 24)).filter(|&i| !is_steady(&columns[i])).collect();
        let limit = limit.min(MAX_NUMBERS / columns.len()).max(1);
        let (step, time) = (index_of(&columns, "step"), index_of(&columns, "time"));
        let mut steps = Vec::new();
        let mut last = 0;
        let rows = rows.inspect(|row| {
            let Ok(row) = row else { return };
            last = row[step] as u32;
            let n = times[steps.len()..].iter().take_while(|own| **own <= row[time]).count();
            steps.extend(std::iter::repeat_n(last, n));
        });
        let (rows, stretches) = kept_rows(rows, written, &peaked, limit)?;
        steps.resize(times.len(), last);
        Ok(Thinned { columns, rows, written, stretches, steps })
    }

    fn column(&self, index: usize) -> Vec<f64> {
        self.rows.iter().map(|(_, row)| row[index]).collect()
    }

    /// Packs the columns, and returns their manifest.
    pub(super) fn pack(&self, pack: &mut Pack) -> Value {
        for (index, name) in self.columns.iter().enumerate() {
            pack.push(&format!("history/{name}"), &self.column(index));
        }
        let written = self.written;
        let kept = self.rows.len();
        json!({ "columns": self.columns, "written": written, "kept": kept, "buckets": self.stretches })
    }

    /// Packs the Newton residuals of the kept rows, with the times between which the page shows them.
    pub(super) fn pack_newton(&self, path: &Path, pack: &mut Pack) {
        let time = self.column(index_of(&self.columns, "time"));
        let numbers: Vec<usize> =
            self.column(index_of(&self.columns, "step")).iter().map(|step| *step as usize).collect();
        let Ok(steps) = newton::read(path, |step| numbers.binary_search(&step).is_ok()) else { return };
        let (mut start, mut end) = (Vec::new(), Vec::new());
        for of_step in &steps {
            let Ok(at) = numbers.binary_search(&of_step.step) else { continue };
            // The next kept step covers those that are left out.
            start.push(time[at.saturating_sub(1)]);
            end.push(time[at]);
        }
        pack.push("newton/start", &start);
        pack.push("newton/end", &end);
        pack.push("newton/count", &steps.iter().map(|step| step.residuals.len() as u32).collect::<Vec<_>>());
        pack.push(
            "newton/residual",
            &steps.iter().flat_map(|s| s.residuals.iter().map(|&r| r as f32)).collect::<Vec<_>>(),
        );
        pack.push("newton/target", &steps.iter().map(|step| step.target as f32).collect::<Vec<_>>());
    }
}

/// Index of a required column.
fn index_of(columns: &[String], name: &str) -> usize {
    columns.iter().position(|column| column == name).unwrap_or(0)
}

/// Number of complete lines.
fn count(path: &Path) -> io::Result<usize> {
    let mut reader = BufReader::with_capacity(1 << 16, open(path)?);
    let mut n = 0;
    loop {
        let bytes = reader.fill_buf()?;
        if bytes.is_empty() {
            return Ok(n);
        }
        n += bytes.iter().filter(|&&byte| byte == b'\n').count();
        let length = bytes.len();
        reader.consume(length);
    }
}
