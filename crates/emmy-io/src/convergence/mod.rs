//! Convergence studies: the error of runs as a function of their step size, measured against a reference.
//!
//! Members and reference start from the same state and have the same phases with steps of their own ([`Study`]). The
//! reference is sampled at the times of the members ([`emmy::motion::Samples`]) and kept on disk ([`kept`]). Each
//! member is compared with it while it marches ([`emmy::motion::ErrorNorm`]) and yields a [`MemberRun`].

pub mod kept;
mod runs;
mod table;

pub use crate::side_by_side::on_one_thread;
pub use runs::{members, reference, start, until};
pub use table::{Measure, MemberRun, chart, orders, write};

use emmy::Result;
use emmy::motion::{Phase, StepPlan};
use emmy::time::Scheme;

use crate::units::Units;

/// A convergence study.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Scheme of the members.
    pub scheme: Scheme,
    /// Time at which all runs start from the same state.
    pub from: f64,
    /// Times between which the error is measured; the runs end at the later one.
    pub window: (f64, f64),
    /// Step sizes of the members.
    pub sizes: Vec<f64>,
    /// Scheme of the reference.
    pub reference_scheme: Scheme,
    /// Step size of the reference.
    pub reference_size: f64,
    /// Times at which supports and joints are released; steps end there.
    pub releases: Vec<f64>,
    /// Units of the charts.
    pub units: Units,
}

impl Study {
    /// Plan of a run with steps of a size. A step ends at each end of the window; it is shortened if necessary.
    ///
    /// # Errors
    /// [`emmy::Error::Plan`].
    pub fn plan(&self, size: f64) -> Result<StepPlan> {
        let (start, end) = self.window;
        let ends = [start, end].into_iter().filter(|&until| until > self.from);
        let plan = StepPlan::new(self.from, ends.map(|until| Phase { until, size }).collect())?;
        Ok(self.releases.iter().fold(plan, |plan, &time| plan.with_end_at(time)))
    }

    /// Times within the window at which a run with steps of a size has a state.
    ///
    /// # Errors
    /// [`emmy::Error::Plan`].
    pub fn times(&self, size: f64) -> Result<Vec<f64>> {
        let plan = self.plan(size)?;
        let ends = std::iter::once(self.from).chain(plan.steps().map(|step| step.end));
        Ok(ends.filter(|&time| time >= self.window.0 - self.tolerance()).collect())
    }

    /// Times of all members, at which the reference is needed: ascending, each once.
    ///
    /// # Errors
    /// [`emmy::Error::Plan`].
    pub fn sample_times(&self) -> Result<Vec<f64>> {
        let mut times = Vec::new();
        for &size in &self.sizes {
            times.extend(self.times(size)?);
        }
        times.sort_by(f64::total_cmp);
        times.dedup_by(|next, kept| (*next - *kept).abs() <= self.tolerance());
        Ok(times)
    }

    /// How many of some times lie inside a step of the reference, where it is interpolated.
    ///
    /// # Errors
    /// [`emmy::Error::Plan`].
    pub fn n_interpolated(&self, times: &[f64]) -> Result<usize> {
        let own = self.times(self.reference_size)?;
        let is_own = |time: &&f64| {
            let next = own.partition_point(|other| *other < **time - self.tolerance());
            own.get(next).is_some_and(|other| *other <= **time + self.tolerance())
        };
        Ok(times.len() - times.iter().filter(is_own).count())
    }

    /// Times closer together than this differ by round-off only.
    pub fn tolerance(&self) -> f64 {
        16.0 * f64::EPSILON * self.window.0.abs().max(self.window.1.abs())
    }
}

#[cfg(test)]
mod tests {
    use emmy::time::TimeElement;

    use super::*;

    fn study(from: f64, window: (f64, f64), sizes: &[f64]) -> Study {
        let scheme = TimeElement::discrete_gradient(1).unwrap().into();
        Study {
            scheme,
            from,
            window,
            sizes: sizes.to_vec(),
            reference_scheme: scheme,
            reference_size: 0.05,
            releases: Vec::new(),
            units: Units::default(),
        }
    }

    #[test]
    fn times_of_the_members_occur_once() {
        let study = study(1.0, (1.0, 2.0), &[0.5, 0.25, 0.1]);
        let times = study.sample_times().unwrap();
        let expected = [1.0, 1.1, 1.2, 1.25, 1.3, 1.4, 1.5, 1.6, 1.7, 1.75, 1.8, 1.9, 2.0];
        assert_eq!(times.len(), expected.len());
        assert!(times.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15));
        assert_eq!(study.n_interpolated(&times).unwrap(), 0);
        assert_eq!(Study { reference_size: 0.1, ..study }.n_interpolated(&times).unwrap(), 2);
    }

    #[test]
    fn steps_end_on_both_ends_of_the_window() {
        let study = study(0.0, (0.35, 0.9), &[0.1]);
        let times = study.times(0.1).unwrap();
        assert_eq!((times[0], times[times.len() - 1]), (0.35, 0.9));
        assert_eq!(study.plan(0.1).unwrap().n_steps(), 4 + 6);
    }

    #[test]
    fn a_window_may_begin_with_the_study() {
        assert_eq!(study(0.0, (0.0, 1.0), &[0.1]).times(0.1).unwrap().len(), 11);
    }
}
