//! The runs of a study, with progress and a kept reference.

use std::path::Path;
use std::time::Instant;

use emmy::motion::{Samples, State};
use emmy_io::convergence::kept::{self, Found, Key};
use emmy_io::convergence::{self, MemberRun, Study};
use emmy_io::input::Problem;

use super::not_written;
use crate::failure::{Failure, with_causes};
use crate::host::{Host, message};
use crate::print::number;
use crate::progress::Progress;

/// The reference, at the times of the members.
#[derive(Debug)]
pub(super) struct Reference {
    /// Its samples.
    pub samples: Samples,
    /// Whether it comes from an earlier study.
    pub is_kept: bool,
    /// Duration in seconds; 0 if it was kept.
    pub wall_seconds: f64,
    /// Number of samples inside a step, which are interpolated.
    pub n_interpolated: usize,
}

/// The runs of a study.
#[derive(Debug, Clone, Copy)]
pub(super) struct Runs<'a> {
    pub study: &'a Study,
    pub host: &'a dyn Host,
    /// No progress.
    pub is_quiet: bool,
}

impl Runs<'_> {
    /// The common initial state of all runs, reached with the plan of the input.
    pub(super) fn start(&self, problem: &Problem) -> Result<State, Failure> {
        let from = self.study.from;
        let plan = convergence::until(&problem.plan, from).unwrap_or_else(|_| problem.plan.clone());
        let mut progress = Progress::of(self.host, "start", &plan, problem.units, self.is_quiet);
        let outcome = convergence::start(problem, from, &mut [&mut progress]);
        progress.end();
        outcome.map_err(|error| stopped("the run to the common start", &error, "steps of the input"))
    }

    /// The reference, from an earlier study or computed.
    pub(super) fn reference(
        &self,
        problem: &Problem,
        state: &State,
        times: &[f64],
        directory: &Path,
    ) -> Result<Reference, Failure> {
        let Runs { study, host, is_quiet } = *self;
        let key = Key::new(problem, study, state).map_err(|error| not_written(directory, &error))?;
        let n_interpolated = study.n_interpolated(times)?;
        let path = key.path(directory);
        if n_interpolated > 0 {
            message!(
                host,
                "note: {n_interpolated} of {} times lie inside a step of the reference and are interpolated (order 4 in its \
                 step); a --reference that divides the sizes has them all",
                times.len()
            );
        }
        match kept::find(directory, &key, times, study.tolerance()) {
            Found::Samples(samples) => {
                if !is_quiet {
                    message!(host, "reference: kept from an earlier study in {}", path.display());
                }
                return Ok(Reference { samples, is_kept: true, wall_seconds: 0.0, n_interpolated });
            }
            Found::Unusable(reason) => {
                message!(host, "note: {} {reason}; it is computed again", path.display());
            }
            Found::Nothing => {}
        }
        let started = Instant::now();
        let samples = self.march_reference(problem, state, times)?;
        kept::keep(directory, &key, &samples).map_err(|error| not_written(&path, &error))?;
        let wall_seconds = started.elapsed().as_secs_f64();
        Ok(Reference { samples, is_kept: false, wall_seconds, n_interpolated })
    }

    fn march_reference(&self, problem: &Problem, state: &State, times: &[f64]) -> Result<Samples, Failure> {
        let plan = self.study.plan(self.study.reference_size)?;
        let mut progress = Progress::of(self.host, "reference", &plan, problem.units, self.is_quiet);
        let outcome = convergence::reference(problem, self.study, state, times, &mut progress);
        progress.end();
        outcome.map_err(|error| stopped("the reference", &error, "--reference"))
    }

    /// All members, side by side.
    pub(super) fn members(&self, problem: &Problem, state: &State, samples: &Samples) -> Vec<MemberRun> {
        convergence::members(problem, self.study, state, samples, |row| {
            if !self.is_quiet {
                self.report(row);
            }
        })
    }

    fn report(&self, row: &MemberRun) {
        let size = number(row.step_size);
        match row.error() {
            Some(error) => message!(self.host, "h = {size}: error {error:.3e} in {:.2} s", row.wall_seconds),
            None => message!(self.host, "h = {size}: no convergence"),
        }
    }
}

fn stopped(what: &str, error: &dyn std::error::Error, smaller: &str) -> Failure {
    let message = format!("{what} did not converge: {}", with_causes(error));
    Failure::Study { message, help: format!("nothing was measured; try smaller {smaller}") }
}
