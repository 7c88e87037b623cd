//! Load factors over time.

mod acceleration;
mod entries;
mod smooth;

use std::sync::Arc;

use crate::average::Rule;
use crate::error::{Error, Result};
use crate::quadrature::Quadrature;
use acceleration::Integrated;
use entries::{Entry, around, value_before};
use smooth::Smooth;

/// Factor over time: a table, linear between its entries and constant outside (two entries at one time are a jump), a
/// smooth function, or the double integral of one of these.
///
/// ```
/// use emmy::body::TimeFunction;
/// let hat = TimeFunction::new(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)])?;
/// assert_eq!([hat.value(0.25), hat.value(0.75), hat.value(7.0)], [0.5, 0.5, 0.0]);
/// let parabola = TimeFunction::smooth("t^2", |t| [t * t, 2.0 * t, 2.0]);
/// assert_eq!((parabola.value(3.0), parabola.rate(3.0)), (9.0, 6.0));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TimeFunction {
    law: Law,
}

#[derive(Debug, Clone, PartialEq)]
enum Law {
    Table(Table),
    Smooth(Smooth),
    Integrated(Arc<Integrated>),
}

/// Entries (time, factor), and the times at which adaptive steps end; `None`: at every entry.
#[derive(Debug, Clone, PartialEq)]
struct Table {
    entries: Arc<[Entry]>,
    corners: Option<Arc<[f64]>>,
}

/// A time at which a function is not a finite number, and its value there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NotFinite {
    pub(crate) time: f64,
    pub(crate) value: f64,
}

/// Times at which a function is evaluated at once.
const AT_ONCE: usize = 32;

/// The parts of a step between some times, as parts of [0, 1].
fn between(times: impl Iterator<Item = f64>, time: f64, h: f64) -> impl Iterator<Item = [f64; 2]> {
    let ends = times.map(move |end| (end - time) / h).take_while(|&alpha| alpha < 1.0);
    let mut from = 0.0;
    ends.chain([1.0]).filter_map(move |to| match to > from {
        true => Some([std::mem::replace(&mut from, to), to]),
        false => None,
    })
}

impl TimeFunction {
    /// The factor 1 at all times.
    pub fn constant() -> Self {
        TimeFunction { law: Law::Table(Table { entries: [(0.0, 1.0)].into(), corners: None }) }
    }

    /// The factor that grows evenly from 0 at t = 0 to a value at t = 1.
    pub(crate) fn ramp(value: f64) -> Self {
        TimeFunction { law: Law::Table(Table { entries: [(0.0, 0.0), (1.0, value)].into(), corners: None }) }
    }

    /// The time function with entries (time, factor).
    ///
    /// # Errors
    /// [`Error::TimeFunction`] if it is empty, an entry is not finite, or a time lies before its predecessor.
    pub fn new(entries: Vec<(f64, f64)>) -> Result<Self> {
        if entries.is_empty() {
            return Err(Error::TimeFunction { entry: 0, reason: "it has no entries" });
        }
        for (entry, &(time, factor)) in entries.iter().enumerate() {
            if !(time.is_finite() && factor.is_finite()) {
                return Err(Error::TimeFunction { entry, reason: "time and factor must be finite numbers" });
            }
            if entry > 0 && time < entries[entry - 1].0 {
                return Err(Error::TimeFunction { entry, reason: "times must not go back" });
            }
        }
        Ok(TimeFunction { law: Law::Table(Table { entries: entries.into(), corners: None }) })
    }

    /// A table with many entries, such as a measurement. Its integrals are as exact as those of [`TimeFunction::new`],
    /// but adaptive steps end only where it turns by more than 1 % of its largest size.
    ///
    /// ```
    /// use emmy::body::TimeFunction;
    /// let ramp = TimeFunction::measured((0..=1000).map(|i| (f64::from(i), 2.0 * f64::from(i))).collect())?;
    /// assert_eq!((ramp.entries().len(), ramp.value(1.5)), (1001, 3.0));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`TimeFunction::new`].
    pub fn measured(entries: Vec<(f64, f64)>) -> Result<Self> {
        let mut table = TimeFunction::new(entries)?;
        if let Law::Table(Table { entries, corners }) = &mut table.law {
            *corners = Some(entries::corners(entries).into());
        }
        Ok(table)
    }

    /// The displacement with an acceleration, from rest at the first of two times; the second bounds the times at which
    /// it is needed. A table is integrated exactly, a smooth function to round-off.
    ///
    /// ```math
    /// u(t) = integral from start to t of (t - s) a(s) ds
    /// ```
    ///
    /// ```
    /// use emmy::body::TimeFunction;
    /// let fall = TimeFunction::from_acceleration(&TimeFunction::new(vec![(0.0, -9.81)])?, [0.0, 2.0])?;
    /// assert!((fall.value(2.0) + 19.62).abs() < 1e-14 && (fall.rate(2.0) + 19.62).abs() < 1e-14);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::TimeFunction`] if the acceleration is such an integral itself, or is not finite.
    pub fn from_acceleration(acceleration: &TimeFunction, span: [f64; 2]) -> Result<Self> {
        let integrated = Integrated::new(acceleration, span)?;
        Ok(TimeFunction { law: Law::Integrated(Arc::new(integrated)) })
    }

    /// The acceleration of a displacement made by [`TimeFunction::from_acceleration`].
    pub fn acceleration(&self) -> Option<&TimeFunction> {
        match &self.law {
            Law::Table(_) | Law::Smooth(_) => None,
            Law::Integrated(integrated) => Some(integrated.acceleration()),
        }
    }

    /// Whether it is a measured table.
    pub fn is_measured(&self) -> bool {
        matches!(&self.law, Law::Table(Table { corners: Some(_), .. }))
    }

    /// A smooth time function, or one that is smooth between its kinks ([`TimeFunction::with_kinks`]): `function`
    /// returns the factor and its first and second derivatives at a time; the second one is not used at present. `text`
    /// names it; time functions with equal texts count as equal.
    pub fn smooth(text: &str, function: impl Fn(f64) -> [f64; 3] + Send + Sync + 'static) -> Self {
        TimeFunction { law: Law::Smooth(Smooth::of_derivatives(text, function)) }
    }

    /// A smooth time function by its values at many times: `values` sets the factor for each time. A load calls it once
    /// in a step, with all quadrature points; the check of a planned step calls it twice more. `text` as in
    /// [`TimeFunction::smooth`].
    ///
    /// The check that the steps resolve a function compares it on two panels a step only, so that shorter features may
    /// be missed: give these as a table.
    ///
    /// Values suffice for a load and for [`TimeFunction::from_acceleration`]. A support that moves also needs the rate,
    /// for its velocity: [`TimeFunction::with_rate`]. A step in which a value is not a finite number fails with
    /// [`Error::NotFiniteAt`]; values that the function does not set are NaN.
    ///
    /// ```
    /// use emmy::body::TimeFunction;
    /// let square = |times: &[f64], factors: &mut [f64]| {
    ///     factors.iter_mut().zip(times).for_each(|(factor, t)| *factor = t * t);
    /// };
    /// let parabola = TimeFunction::of_times("t^2", square);
    /// assert!(parabola.value(3.0) == 9.0 && !parabola.has_rate());
    /// ```
    pub fn of_times(text: &str, values: impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static) -> Self {
        TimeFunction { law: Law::Smooth(Smooth::new(text, values)) }
    }

    /// A smooth function with a rate \[1/time\], which `rates` sets for each time. The rate of a table or of a double
    /// integral is known, so these do not change.
    ///
    /// ```
    /// use emmy::body::TimeFunction;
    /// let ramp = TimeFunction::of_times("3 t", |times, factors| {
    ///     factors.iter_mut().zip(times).for_each(|(factor, t)| *factor = 3.0 * t);
    /// });
    /// assert!(ramp.rate(0.5).is_nan());
    /// assert_eq!(ramp.with_rate(|_, rates| rates.fill(3.0)).rate(0.5), 3.0);
    /// ```
    pub fn with_rate(self, rates: impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static) -> Self {
        match self.law {
            Law::Smooth(smooth) => TimeFunction { law: Law::Smooth(smooth.with_rate(rates)) },
            law @ (Law::Table(_) | Law::Integrated(_)) => TimeFunction { law },
        }
    }

    /// A smooth function with the times of its kinks and jumps: it is integrated exactly up to each of them, and
    /// adaptive steps end there. At a jump, the function returns the value after it. Other functions do not change.
    ///
    /// ```
    /// use emmy::body::TimeFunction;
    /// let pulse = |t: f64| if (0.0..2.0).contains(&t) { [t * (2.0 - t), 2.0 - 2.0 * t, -2.0] } else { [0.0; 3] };
    /// let pulse = TimeFunction::smooth("pulse", pulse).with_kinks([0.0, 2.0]);
    /// assert_eq!((pulse.next_kink(0.0), pulse.next_kink(2.0), pulse.first_jump()), (Some(2.0), None, None));
    /// ```
    pub fn with_kinks(self, times: impl IntoIterator<Item = f64>) -> Self {
        match self.law {
            Law::Smooth(smooth) => TimeFunction { law: Law::Smooth(smooth.with_kinks(times)) },
            law @ (Law::Table(_) | Law::Integrated(_)) => TimeFunction { law },
        }
    }

    /// Whether a call is costly, as of a function by its values at many times: it is called as rarely as possible.
    pub(crate) fn is_costly(&self) -> bool {
        match &self.law {
            Law::Smooth(smooth) => smooth.is_costly,
            Law::Table(_) => false,
            Law::Integrated(integrated) => integrated.acceleration().is_costly(),
        }
    }

    /// Whether the rate is known, as a support that moves needs.
    pub fn has_rate(&self) -> bool {
        match &self.law {
            Law::Smooth(smooth) => smooth.has_rate(),
            Law::Table(_) | Law::Integrated(_) => true,
        }
    }

    /// Entries (time, factor) of a table; other functions have none.
    pub fn entries(&self) -> &[(f64, f64)] {
        match &self.law {
            Law::Table(table) => &table.entries,
            Law::Smooth(_) | Law::Integrated(_) => &[],
        }
    }

    /// Text of a smooth function, or of the displacement of a smooth acceleration.
    pub fn text(&self) -> Option<&str> {
        match &self.law {
            Law::Table(_) => None,
            Law::Smooth(smooth) => Some(&smooth.text),
            Law::Integrated(integrated) => integrated.text(),
        }
    }

    /// The factor at a time; at a jump, the value after it.
    pub fn value(&self, time: f64) -> f64 {
        match &self.law {
            Law::Table(table) => match around(&table.entries, time) {
                (None, Some((_, factor))) | (Some((_, factor)), None) => factor,
                (Some((t0, f0)), Some((t1, f1))) => f0 + (f1 - f0) * (time - t0) / (t1 - t0),
                (None, None) => 1.0,
            },
            Law::Smooth(smooth) => smooth.value(time),
            Law::Integrated(integrated) => integrated.at(time).displacement,
        }
    }

    /// Sets the factors at some times, of a smooth function by one call.
    pub(crate) fn values(&self, times: &[f64], values: &mut [f64]) {
        match &self.law {
            Law::Smooth(smooth) => smooth.values(times, values),
            Law::Table(_) | Law::Integrated(_) => {
                values.iter_mut().zip(times).for_each(|(value, &time)| *value = self.value(time));
            }
        }
    }

    /// The factor at a time; at a jump, the value before it.
    pub(crate) fn value_before(&self, time: f64) -> f64 {
        match &self.law {
            Law::Table(table) => value_before(&table.entries, time),
            Law::Smooth(smooth) if smooth.kinks.contains(&time) => smooth.value(time.next_down()),
            Law::Smooth(_) | Law::Integrated(_) => self.value(time),
        }
    }

    /// Rate of the factor \[1/time\]; at a kink or jump, the rate after it. NaN for a function without a rate.
    pub fn rate(&self, time: f64) -> f64 {
        match &self.law {
            Law::Table(table) => match around(&table.entries, time) {
                (Some((t0, f0)), Some((t1, f1))) => (f1 - f0) / (t1 - t0),
                _ => 0.0,
            },
            Law::Smooth(smooth) => smooth.rate(time),
            Law::Integrated(integrated) => integrated.at(time).velocity,
        }
    }

    /// Rate of the factor at a time; at a kink, on the side given by the sign of `shift`.
    pub(crate) fn rate_beside(&self, time: f64, shift: f64) -> f64 {
        match &self.law {
            Law::Table(_) => self.rate(time + shift),
            Law::Smooth(smooth) if smooth.has_kink_near(time, shift.abs()) => smooth.rate(time + shift),
            Law::Smooth(_) | Law::Integrated(_) => self.rate(time),
        }
    }

    /// The times of all kinks and jumps, ascending.
    pub fn kinks(&self) -> Vec<f64> {
        self.kinks_after(f64::NEG_INFINITY).collect()
    }

    /// The first time after another at which a function, or its acceleration, has a kink or a jump.
    pub fn next_kink(&self, after: f64) -> Option<f64> {
        self.kinks_after(after).next()
    }

    /// The times of kinks and jumps after another, ascending.
    pub(crate) fn kinks_after(&self, after: f64) -> impl Iterator<Item = f64> + '_ {
        let law = self.acceleration().unwrap_or(self);
        let kinks = match &law.law {
            Law::Smooth(smooth) => &*smooth.kinks,
            Law::Table(_) | Law::Integrated(_) => &[],
        };
        let entries = law.entries();
        let entries = &entries[entries.partition_point(|&(t, _)| t <= after)..];
        let kinks = &kinks[kinks.partition_point(|&t| t <= after)..];
        entries.iter().map(|&(t, _)| t).chain(kinks.iter().copied())
    }

    /// The parts of a step between kinks, as parts of [0, 1].
    pub(crate) fn segments(&self, time: f64, h: f64) -> impl Iterator<Item = [f64; 2]> + '_ {
        between(self.kinks_after(time), time, h)
    }

    /// The same between corners ([`TimeFunction::next_corner`]), for what costs too much at each row of a record.
    pub(crate) fn long_segments(&self, time: f64, h: f64) -> impl Iterator<Item = [f64; 2]> + '_ {
        between(self.corners_after(time), time, h)
    }

    /// The times after another at which adaptive steps end, ascending.
    pub(crate) fn corners_after(&self, after: f64) -> impl Iterator<Item = f64> + '_ {
        let (corners, kinks) = match &self.acceleration().unwrap_or(self).law {
            Law::Table(Table { corners: Some(corners), .. }) => (&**corners, None),
            _ => (&[][..], Some(self.kinks_after(after))),
        };
        let corners = &corners[corners.partition_point(|&t| t <= after)..];
        corners.iter().copied().chain(kinks.into_iter().flatten())
    }

    /// The first time after another at which adaptive steps end: a kink, but of a measured table only a corner.
    pub(crate) fn next_corner(&self, after: f64) -> Option<f64> {
        self.corners_after(after).next()
    }

    /// Time of the first jump of a table, or of a smooth function with kinks.
    pub fn first_jump(&self) -> Option<f64> {
        if let Law::Smooth(smooth) = &self.law {
            return smooth.first_jump();
        }
        let jump = |pair: &&[(f64, f64)]| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1;
        self.entries().windows(2).find(jump).map(|pair| pair[0].0)
    }

    /// Averages of the factor over a step, weighted with the basis of a time element.
    ///
    /// ```math
    /// (1/b_i) integral_0^1 l_i(alpha) f(t + alpha h) dalpha
    /// ```
    ///
    /// `averages: [k]`, with the k, c_i and b_i of the rule. Exact for a table with any kinks and jumps inside the
    /// step; a smooth function is integrated by [`Rule::smooth_quadrature`] between its kinks.
    ///
    /// # Errors
    /// The first time at which the function is not a finite number.
    pub(crate) fn averages(
        &self,
        time: f64,
        step_size: f64,
        rule: &Rule,
        averages: &mut [f64],
    ) -> std::result::Result<(), NotFinite> {
        averages.fill(0.0);
        let quadrature = match &self.law {
            Law::Table(_) => rule.load_quadrature(),
            Law::Smooth(_) | Law::Integrated(_) => rule.smooth_quadrature(),
        };
        for [from, to] in self.segments(time, step_size) {
            self.for_each_value(time, step_size, [from, to], quadrature, |alpha, w, factor| {
                let weighted = factor * w * (to - from);
                for (i, average) in averages.iter_mut().enumerate() {
                    *average += weighted * rule.basis(i, alpha) / rule.weights()[i];
                }
            })?;
        }
        Ok(())
    }

    /// Visits the points of a quadrature on a segment of a step: its position in the step, its weight on [0, 1], and
    /// the factor there.
    ///
    /// # Errors
    /// The first time at which the function is not a finite number.
    pub(crate) fn for_each_value(
        &self,
        time: f64,
        h: f64,
        [from, to]: [f64; 2],
        quadrature: &Quadrature<1>,
        mut visit: impl FnMut(f64, f64, f64),
    ) -> std::result::Result<(), NotFinite> {
        let weights = quadrature.weights.chunks(AT_ONCE);
        for (points, weights) in quadrature.points.chunks(AT_ONCE).zip(weights) {
            let (mut alphas, mut times, mut factors) = ([0.0; AT_ONCE], [0.0; AT_ONCE], [0.0; AT_ONCE]);
            let n = points.len();
            for (i, &[s]) in points.iter().enumerate() {
                alphas[i] = from + (to - from) * s;
                times[i] = time + alphas[i] * h;
            }
            self.values(&times[..n], &mut factors[..n]);
            for (i, &w) in weights.iter().enumerate() {
                if !factors[i].is_finite() {
                    return Err(NotFinite { time: times[i], value: factors[i] });
                }
                visit(alphas[i], w, factors[i]);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
