//! The step plan: step sizes over time.

use super::Adaptivity;
use crate::error::{Error, Result};
use crate::number::short;

/// Phase of a plan: steps of one size until a time.
///
/// ```
/// use emmy::prelude::*;
/// let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.25 }])?;
/// assert_eq!(plan.steps().count(), 4);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Time at which the phase ends \[time\].
    pub until: f64,
    /// Step size \[time\].
    pub size: f64,
}

/// One step of a plan.
///
/// ```
/// use emmy::prelude::*;
/// let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.75 }])?;
/// let last = plan.steps().last().unwrap();
/// assert_eq!((last.start, last.end, last.size), (0.75, 1.0, 0.25));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannedStep {
    /// Time at the start of the step.
    pub start: f64,
    /// Time at its end.
    pub end: f64,
    /// Step size: the plan's own, or less where a phase ends.
    pub size: f64,
}

/// A sequence of phases from a start time.
///
/// Steps fall on t_0 + i h, computed by multiplication so that no error adds up; the last one of a phase is shortened
/// to end on `until`.
///
/// ```
/// use emmy::prelude::*;
/// let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.3 }, Phase { until: 2.0, size: 0.5 }])?;
/// let ends: Vec<f64> = plan.steps().map(|step| step.end).collect();
/// assert_eq!(ends, [0.3, 0.6, 0.8999999999999999, 1.0, 1.5, 2.0]);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StepPlan {
    start: f64,
    phases: Vec<Phase>,
    adaptivity: Option<Adaptivity>,
    /// Time between outputs, counted from the start.
    interval: Option<f64>,
}

/// Steps shorter than this part of the size are merged with the previous one: they come from rounding of `until /
/// size`.
const SLIVER: f64 = 1e-6;

/// Smallest step relative to the time: three digits of the size must be left in the difference of two times.
pub(super) const SHORTEST: f64 = 1024.0 * f64::EPSILON;

/// Times closer together than this part of an adaptive plan differ by rounding. Its largest size is no measure: it may
/// exceed the distance of two times that must be met.
const ROUNDING: f64 = 1e-12;

impl StepPlan {
    /// The plan, checked.
    ///
    /// # Errors
    /// [`Error::Plan`] if it has no phase, a size is not positive, or a phase ends before it begins.
    pub fn new(start: f64, phases: Vec<Phase>) -> Result<Self> {
        let fail = |phase, reason: String| Err(Error::Plan { phase, reason });
        if phases.is_empty() {
            return fail(0, "the plan has no phases".into());
        }
        let mut begin = start;
        for (phase, &Phase { until, size }) in phases.iter().enumerate() {
            if !(size > 0.0 && size.is_finite()) {
                let reason = format!("the step size must be positive and finite, not {}", short(size));
                return fail(phase, reason);
            }
            if !until.is_finite() || until <= begin {
                let [until, begin] = [until, begin].map(short);
                return fail(
                    phase,
                    format!("it ends at {until}, but begins at {begin}; `until` must increase"),
                );
            }
            if (until - begin) / size > 1e12 {
                let [size, until] = [size, until].map(short);
                return fail(phase, format!("steps of {size} until {until} are more than 1e12 steps"));
            }
            let shortest = SHORTEST * begin.abs().max(until.abs());
            if size <= shortest || until - begin <= shortest {
                let size = size.min(until - begin);
                return fail(
                    phase,
                    format!(
                        "steps of {} are lost in the rounding of t = {}; take steps above {}",
                        short(size),
                        short(until),
                        short(shortest)
                    ),
                );
            }
            begin = until;
        }
        Ok(StepPlan { start, phases, adaptivity: None, interval: None })
    }

    /// A plan of steps chosen by the error. Its phases give the times that are met and the largest step sizes.
    ///
    /// ```
    /// use emmy::motion::{Adaptivity, StepPlan};
    /// let plan = StepPlan::adaptive(0.0, 2.0, Adaptivity::new(1e-4))?.with_end_at(0.5);
    /// let ends: Vec<f64> = plan.phases().iter().map(|phase| phase.until).collect();
    /// assert_eq!(ends, [0.5, 2.0]);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`StepPlan::new`] and [`Adaptivity::check`].
    pub fn adaptive(start: f64, until: f64, adaptivity: Adaptivity) -> Result<Self> {
        adaptivity.check()?;
        let largest = adaptivity.largest.min(until - start);
        let size = if largest > 0.0 { largest } else { 1.0 };
        let plan = StepPlan::new(start, vec![Phase { until, size }])?;
        Ok(StepPlan { adaptivity: Some(adaptivity), ..plan })
    }

    /// The plan with other phases, and the same choice of steps.
    ///
    /// # Errors
    /// As [`StepPlan::new`].
    pub fn with_phases(&self, phases: Vec<Phase>) -> Result<Self> {
        let plan = StepPlan::new(self.start, phases)?;
        Ok(StepPlan { adaptivity: self.adaptivity, interval: self.interval, ..plan })
    }

    /// Settings of adaptive steps; `None` if the phases give the sizes.
    pub fn adaptivity(&self) -> Option<&Adaptivity> {
        self.adaptivity.as_ref()
    }

    /// The plan with a step that ends at a time: its phase is split in two. A time outside the plan changes nothing.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.4 }])?.with_end_at(0.5);
    /// let ends: Vec<f64> = plan.steps().map(|step| step.end).collect();
    /// assert_eq!(ends, [0.4, 0.5, 0.9, 1.0]);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn with_end_at(mut self, time: f64) -> Self {
        let around = self.begins().position(|(begin, phase)| {
            let sliver = self.same_time(phase.size);
            begin + sliver < time && time < phase.until - sliver
        });
        if let Some(index) = around {
            self.phases.insert(index, Phase { until: time, ..self.phases[index] });
        }
        self
    }

    /// Time at which the plan starts.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// Time at which the plan ends.
    pub fn end(&self) -> f64 {
        self.phases[self.phases.len() - 1].until
    }

    /// Phases of the plan.
    pub fn phases(&self) -> &[Phase] {
        &self.phases
    }

    /// Size of the largest step, unless steps are adaptive; a phase may be shorter than its size \[time\].
    pub fn largest_step(&self) -> f64 {
        self.begins().map(|(begin, phase)| phase.size.min(phase.until - begin)).fold(0.0, f64::max)
    }

    /// Number of steps; a lower bound for adaptive steps.
    pub fn n_steps(&self) -> usize {
        self.begins().map(|(begin, phase)| n_steps(begin, phase)).sum()
    }

    /// All steps in order.
    pub fn steps(&self) -> impl Iterator<Item = PlannedStep> + '_ {
        self.steps_after(0, 0)
    }

    /// The steps from a step of a phase on.
    fn steps_after(&self, phase: usize, step: usize) -> impl Iterator<Item = PlannedStep> + '_ {
        self.begins().enumerate().skip(phase).flat_map(move |(index, (begin, own))| {
            let n = n_steps(begin, own);
            let first = if index == phase { step } else { 0 };
            (first..n).map(move |i| planned_step(begin, own, i, n))
        })
    }

    /// Phase and number in it of the first step that ends after a time, by arithmetic: steps before it are not visited.
    fn place(&self, time: f64) -> Option<(usize, usize)> {
        // The last step of an earlier phase ends at or before the time.
        let from = self.phases.partition_point(|phase| phase.until <= time);
        self.begins().enumerate().skip(from).find_map(|(index, (begin, phase))| {
            let n = n_steps(begin, phase);
            // The quotient may be off by rounding; steps before the first one here end before the time.
            let first = (((time - begin) / phase.size) as usize).saturating_sub(2).min(n - 1);
            let is_left = |i: &usize| {
                let step = planned_step(begin, phase, *i, n);
                step.end - time > self.same_time(step.size)
            };
            (first..n).find(is_left).map(|i| (index, i))
        })
    }

    /// The remaining steps at a time, from the step that starts there or contains it.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.25 }])?;
    /// let starts = |time| plan.steps_from(time).map(|step| step.start).collect::<Vec<f64>>();
    /// assert_eq!((starts(0.5), starts(0.7), starts(1.0)), (vec![0.5, 0.75], vec![0.5, 0.75], vec![]));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn steps_from(&self, time: f64) -> impl Iterator<Item = PlannedStep> + '_ {
        let (phase, step) = self.place(time).unwrap_or((self.phases.len(), 0));
        self.steps_after(phase, step)
    }

    /// The time of the plan's grid that differs from a time by rounding only, else the time itself, as always for
    /// adaptive steps.
    pub fn on_grid(&self, time: f64) -> f64 {
        if self.adaptivity.is_some() {
            return time;
        }
        let next = self.steps_from(time).next();
        next.filter(|step| (step.start - time).abs() <= SLIVER * step.size).map_or(time, |step| step.start)
    }

    /// The plan with steps of another size after a time. Earlier steps and the ends of the phases stay.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.25 }])?.with_size_from(0.5, 0.3)?;
    /// let ends: Vec<f64> = plan.steps().map(|step| step.end).collect();
    /// assert_eq!(ends, [0.25, 0.5, 0.8, 1.0]);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`StepPlan::new`]; [`Error::Plan`] for adaptive steps.
    pub fn with_size_from(&self, time: f64, size: f64) -> Result<Self> {
        if self.adaptivity.is_some() {
            let reason = "the sizes of adaptive steps are chosen by the error".to_string();
            return Err(Error::Plan { phase: 0, reason });
        }
        let mut phases = Vec::new();
        for (begin, phase) in self.begins() {
            let sliver = SLIVER * phase.size;
            if phase.until <= time + sliver {
                phases.push(phase);
                continue;
            }
            if begin < time - sliver {
                phases.push(Phase { until: time, ..phase });
            }
            phases.push(Phase { size, ..phase });
        }
        self.with_phases(phases)
    }

    /// The plan with a time between outputs: steps end on every multiple of it, counted from the start, see
    /// [`StepPlan::is_output`].
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.1 }])?;
    /// assert!(plan.clone().with_interval(0.2)?.is_output(0.4));
    /// assert!(plan.with_interval(0.25).is_err());
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Plan`] if it is not positive, or if planned steps miss one of these times. Adaptive steps meet them
    /// all.
    pub fn with_interval(self, interval: f64) -> Result<Self> {
        if !(interval > 0.0 && interval.is_finite()) || (self.end() - self.start) / interval > 1e9 {
            let reason = format!("the time between outputs must be positive and finite, not {interval}");
            return Err(Error::Plan { phase: 0, reason });
        }
        let plan = StepPlan { interval: Some(interval), ..self };
        let missed = plan.begins().enumerate().find_map(|(index, (begin, phase))| {
            plan.missed_output(begin, phase).map(|time| (index, phase.size, time))
        });
        match missed.filter(|_| plan.adaptivity.is_none()) {
            Some((phase, size, time)) => {
                let [size, time, interval] = [size, time, interval].map(short);
                let reason =
                    format!("steps of {size} miss t = {time}, a multiple of the interval {interval}");
                Err(Error::Plan { phase, reason })
            }
            None => Ok(plan),
        }
    }

    /// Time between outputs.
    pub fn interval(&self) -> Option<f64> {
        self.interval
    }

    /// Whether a time is an output time, up to rounding.
    pub fn is_output(&self, time: f64) -> bool {
        let Some(interval) = self.interval else { return false };
        let multiple = self.start + ((time - self.start) / interval).round() * interval;
        (time - multiple).abs() <= self.same_time(interval)
    }

    /// The first output time after a time.
    pub(super) fn next_output(&self, time: f64) -> Option<f64> {
        let interval = self.interval?;
        let after = time + self.same_time(interval);
        let nth = |n: f64| self.start + n * interval;
        let n = ((after - self.start) / interval).floor();
        // The quotient may be off by rounding.
        [n - 1.0, n, n + 1.0, n + 2.0].into_iter().map(nth).find(|&output| output > after)
    }

    /// An output time inside a phase at which none of its steps ends. The first ones suffice: if a second one is met as
    /// well, the interval is a multiple of the size.
    fn missed_output(&self, begin: f64, phase: Phase) -> Option<f64> {
        let sliver = SLIVER * phase.size;
        let outputs = std::iter::successors(self.next_output(begin), |time| self.next_output(*time));
        let inside = outputs.take_while(|time| *time < phase.until - sliver).take(2);
        let offset = |time: f64| (time - begin) - ((time - begin) / phase.size).round() * phase.size;
        inside.into_iter().find(|time| offset(*time).abs() > sliver)
    }

    /// Times closer together than this, among steps of a size, are equal.
    pub(super) fn same_time(&self, size: f64) -> f64 {
        match self.adaptivity {
            Some(_) => ROUNDING * (self.end() - self.start),
            None => SLIVER * size,
        }
    }

    /// Every phase with the time at which it begins.
    fn begins(&self) -> impl Iterator<Item = (f64, Phase)> + '_ {
        let begins = std::iter::once(self.start).chain(self.phases.iter().map(|phase| phase.until));
        begins.zip(self.phases.iter().copied())
    }
}

/// A step of a phase of n steps.
fn planned_step(begin: f64, phase: Phase, i: usize, n: usize) -> PlannedStep {
    let start = begin + i as f64 * phase.size;
    let last = i + 1 == n;
    let end = if last { phase.until } else { begin + (i + 1) as f64 * phase.size };
    // The nominal size where it fits: the difference of the times would carry their rounding.
    let fits = ((end - start) - phase.size).abs() <= SLIVER * phase.size;
    PlannedStep { start, end, size: if fits { phase.size } else { end - start } }
}

fn n_steps(begin: f64, phase: Phase) -> usize {
    // A last step that is lost in the rounding of its end is merged as well.
    let sliver = SLIVER.max(SHORTEST * phase.until.abs() / phase.size);
    (((phase.until - begin) / phase.size - sliver).ceil() as usize).max(1)
}

#[cfg(test)]
mod tests;
