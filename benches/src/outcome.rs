//! Outcome of one run: one line of JSON, with the same form for Emmy and other programs.

use serde::{Deserialize, Serialize};

/// Figures of a run. Figures that a program does not report are left out of its line.
///
/// The first two steps are left out of all times per step, because they contain the set-up of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Outcome {
    /// Name and version.
    pub program: String,
    /// Linear solver.
    pub solver: String,
    /// Number of cells.
    pub cells: usize,
    /// Number of degrees of freedom.
    pub dofs: usize,
    /// Number of threads.
    pub threads: usize,
    /// CPU time of a step, median \[s\].
    pub cpu_seconds_per_step: f64,
    /// CPU time of a step, mean \[s\].
    pub cpu_seconds_per_step_mean: f64,
    /// Wall time of a step, mean \[s\].
    pub wall_seconds_per_step_mean: f64,
    /// CPU time of all steps \[s\].
    pub cpu_seconds: f64,
    /// CPU time of the process up to the last step, or of another program without its imports and its compiler \[s\].
    pub cpu_seconds_with_start: Option<f64>,
    /// Newton iterations per step.
    pub newton_per_step: f64,
    /// Iterations of the linear solver per step.
    pub linear_per_step: f64,
    /// Cells per second and core in the assembly of residual and tangent.
    pub assembled_cells_per_second: Option<f64>,
    /// Kinetic energy at the end \[energy\].
    pub kinetic_energy: f64,
    /// Strain energy at the end \[energy\].
    pub strain_energy: f64,
    /// Steps in the lowest elastic period, if the statement on accuracy has it.
    pub steps_per_lowest_period: Option<f64>,
    /// Largest resident memory \[MB = 2^20 bytes\].
    pub peak_megabytes: Option<f64>,
}

impl Outcome {
    /// The outcome in the last line printed by a program.
    ///
    /// # Errors
    /// A message if there is no such line.
    pub(crate) fn in_output(output: &str) -> Result<Outcome, String> {
        let line = output.lines().last().ok_or("it printed nothing")?;
        serde_json::from_str(line).map_err(|error| format!("{error} in: {line}"))
    }

    /// Bytes of memory per degree of freedom.
    pub(crate) fn bytes_per_dof(&self) -> Option<f64> {
        self.peak_megabytes.map(|megabytes| megabytes * f64::from(1 << 20) / self.dofs as f64)
    }
}

/// Arithmetic mean.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Median; the mean of the two in the middle of an even number.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let half = sorted.len() / 2;
    if sorted.len() % 2 == 1 { sorted[half] } else { mean(&sorted[half - 1..=half]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
    }

    #[test]
    fn the_last_line_counts_and_missing_columns_are_empty() {
        let outcome =
            Outcome::in_output("a warning\n{\"program\": \"P\", \"dofs\": 1024, \"peak_megabytes\": 2}\n");
        let outcome = outcome.unwrap();
        assert_eq!((outcome.program.as_str(), outcome.bytes_per_dof()), ("P", Some(2048.0)));
        assert!(Outcome::in_output("").is_err() && Outcome::in_output("Traceback").is_err());
    }
}
