//! Runs that take turns: compared runs are in the same session, one after the other, several times.

use crate::job::{Case, Job};
use crate::outcome::{Outcome, median};

/// Options of the runs.
#[derive(Debug, Clone)]
pub(crate) struct Session {
    /// Small meshes and few steps, without verdicts about time: for continuous integration.
    pub quick: bool,
    /// How often everything runs.
    pub rounds: usize,
    /// Core of the runs with one thread.
    pub core: Option<usize>,
}

impl Session {
    /// Runs jobs in turns; one [`Runs`] per job.
    ///
    /// # Errors
    /// The message of the first one that fails.
    pub(crate) fn in_turns(&self, jobs: &[Job]) -> Result<Vec<Runs>, String> {
        self.attempts(jobs, |_| false).into_iter().collect()
    }

    /// The same; a job whose failure is expected keeps its message, and the others go on.
    pub(crate) fn attempts(&self, jobs: &[Job], expected: fn(&str) -> bool) -> Vec<Result<Runs, String>> {
        let mut attempts = vec![Ok(Runs(Vec::new())); jobs.len()];
        for round in 1..=self.rounds {
            for (index, (job, attempt)) in jobs.iter().zip(&mut attempts).enumerate() {
                let Ok(runs) = attempt else { continue };
                eprintln!("round {round} of {}, run {} of {}: {job}", self.rounds, index + 1, jobs.len());
                match job.run(self.core) {
                    Ok(outcome) => {
                        let whole = outcome.cpu_seconds_with_start.unwrap_or(outcome.cpu_seconds);
                        eprintln!("    {:.6} CPU s a step, {whole:.3} in all", step_seconds(&outcome));
                        runs.0.push(outcome);
                    }
                    Err(message) if expected(&message) => *attempt = Err(message),
                    Err(message) => return vec![Err(message)],
                }
            }
        }
        attempts
    }

    /// Runs cases of Emmy in turns.
    ///
    /// # Errors
    /// As [`Session::in_turns`].
    pub(crate) fn cases(&self, cases: &[Case]) -> Result<Vec<Runs>, String> {
        self.in_turns(&cases.iter().map(Job::case).collect::<Result<Vec<_>, _>>()?)
    }

    /// The first value in the quick set, otherwise the second.
    pub(crate) fn choose<T>(&self, quick: T, full: T) -> T {
        if self.quick { quick } else { full }
    }
}

/// The rounds of one job. A shared machine disturbs single rounds, so figures are medians over them.
#[derive(Debug, Clone)]
pub(crate) struct Runs(Vec<Outcome>);

impl Runs {
    /// The last round, for figures that are equal in all rounds.
    pub(crate) fn last(&self) -> &Outcome {
        &self.0[self.0.len() - 1]
    }

    /// Median of a figure.
    pub(crate) fn median(&self, figure: impl Fn(&Outcome) -> f64) -> f64 {
        median(&self.0.iter().map(figure).collect::<Vec<_>>())
    }

    /// Median of a figure that some runs lack.
    pub(crate) fn median_of_some(&self, figure: impl Fn(&Outcome) -> Option<f64>) -> Option<f64> {
        let figures: Option<Vec<f64>> = self.0.iter().map(figure).collect();
        figures.map(|figures| median(&figures))
    }

    /// Median of the ratios of a figure to the figure of another job in the same round.
    pub(crate) fn ratio(&self, other: &Runs, figure: impl Fn(&Outcome) -> f64) -> f64 {
        let ratios = self.0.iter().zip(&other.0).map(|(a, b)| figure(a) / figure(b));
        median(&ratios.collect::<Vec<_>>())
    }
}

/// Mean CPU time of a step \[s\].
///
/// Emmy's steps differ: some take an additional iteration, or new factors. A median would hide these.
pub(crate) fn step_seconds(outcome: &Outcome) -> f64 {
    outcome.cpu_seconds_per_step_mean
}
