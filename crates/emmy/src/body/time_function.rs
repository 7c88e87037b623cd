//! Load factors over time.

mod acceleration;
mod entries;

use std::fmt;
use std::sync::Arc;

use crate::average::Rule;
use crate::error::{Error, Result};
use crate::quadrature::Quadrature;
use acceleration::Integrated;
use entries::{Entry, around, value_before};

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

/// A smooth function of time, identified by its text.
#[derive(Clone)]
struct Smooth {
    text: Arc<str>,
    function: Arc<dyn Fn(f64) -> [f64; 3] + Send + Sync>,
}

impl fmt::Debug for Smooth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Smooth").field(&self.text).finish()
    }
}

impl PartialEq for Smooth {
    fn eq(&self, other: &Smooth) -> bool {
        self.text == other.text
    }
}

impl TimeFunction {
    /// The factor 1 at all times.
    pub fn constant() -> Self {
        TimeFunction { law: Law::Table(Table { entries: [(0.0, 1.0)].into(), corners: None }) }
    }

    /// The factor that grows evenly from 0 at t = 0 to a value at t = 1.
    pub(super) fn ramp(value: f64) -> Self {
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

    /// A smooth time function: `function` returns the factor and its first and second derivatives at a time. `text`
    /// names it; time functions with equal texts count as equal.
    pub fn smooth(text: &str, function: impl Fn(f64) -> [f64; 3] + Send + Sync + 'static) -> Self {
        TimeFunction { law: Law::Smooth(Smooth { text: text.into(), function: Arc::new(function) }) }
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
            Law::Smooth(smooth) => (smooth.function)(time)[0],
            Law::Integrated(integrated) => integrated.at(time).displacement,
        }
    }

    /// The factor at a time; at a jump, the value before it.
    pub(super) fn value_before(&self, time: f64) -> f64 {
        match &self.law {
            Law::Table(table) => value_before(&table.entries, time),
            Law::Smooth(_) | Law::Integrated(_) => self.value(time),
        }
    }

    /// Rate of the factor \[1/time\]; at a kink or jump, the rate after it.
    pub fn rate(&self, time: f64) -> f64 {
        match &self.law {
            Law::Table(table) => match around(&table.entries, time) {
                (Some((t0, f0)), Some((t1, f1))) => (f1 - f0) / (t1 - t0),
                _ => 0.0,
            },
            Law::Smooth(smooth) => (smooth.function)(time)[1],
            Law::Integrated(integrated) => integrated.at(time).velocity,
        }
    }

    /// Rate of the factor at a time; at a kink, on the side given by the sign of `shift`.
    pub(super) fn rate_beside(&self, time: f64, shift: f64) -> f64 {
        match &self.law {
            Law::Table(_) => self.rate(time + shift),
            Law::Smooth(_) | Law::Integrated(_) => self.rate(time),
        }
    }

    /// The first time after another at which a table, or an acceleration by a table, has a kink or a jump.
    pub fn next_kink(&self, after: f64) -> Option<f64> {
        if let Some(acceleration) = self.acceleration() {
            return acceleration.next_kink(after);
        }
        let entries = self.entries();
        entries.get(entries.partition_point(|&(t, _)| t <= after)).map(|&(t, _)| t)
    }

    /// The first time after another at which adaptive steps end: a kink, but of a measured table only a corner.
    pub(super) fn next_corner(&self, after: f64) -> Option<f64> {
        match &self.law {
            Law::Table(Table { corners: Some(corners), .. }) => {
                corners.get(corners.partition_point(|&t| t <= after)).copied()
            }
            Law::Integrated(integrated) => integrated.acceleration().next_corner(after),
            Law::Table(Table { corners: None, .. }) | Law::Smooth(_) => self.next_kink(after),
        }
    }

    /// Time of the first jump of a table.
    pub fn first_jump(&self) -> Option<f64> {
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
    /// step; a smooth function is integrated by [`Rule::smooth_quadrature`].
    pub fn averages(&self, time: f64, step_size: f64, rule: &Rule, averages: &mut [f64]) {
        averages.fill(0.0);
        let (entries, quadrature) = match &self.law {
            Law::Table(table) => (&*table.entries, rule.load_quadrature()),
            Law::Smooth(_) => (&[][..], rule.smooth_quadrature()),
            Law::Integrated(integrated) => (integrated.acceleration().entries(), rule.smooth_quadrature()),
        };
        let mut from = 0.0;
        let first = entries.partition_point(|&(t, _)| t <= time);
        let kinks = entries[first..].iter().map(|&(t, _)| (t - time) / step_size);
        for to in kinks.take_while(|&alpha| alpha < 1.0).chain([1.0]) {
            if to > from {
                self.add_segment(time, step_size, [from, to], rule, quadrature, averages);
                from = to;
            }
        }
    }

    /// Adds the integral over a segment without kinks.
    fn add_segment(
        &self,
        time: f64,
        h: f64,
        [from, to]: [f64; 2],
        rule: &Rule,
        quadrature: &Quadrature<1>,
        averages: &mut [f64],
    ) {
        for (&[s], w) in quadrature.iter() {
            let alpha = from + (to - from) * s;
            let factor = self.value(time + alpha * h) * w * (to - from);
            for (i, average) in averages.iter_mut().enumerate() {
                *average += factor * rule.basis(i, alpha) / rule.weights()[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jumps_have_a_value_before_and_after() {
        let table = TimeFunction::new(vec![(0.0, 1.0), (0.0, 5.0), (2.0, 3.0), (2.0, 0.0)]).unwrap();
        let values = [-1.0, 0.0, 1.0, 2.0, 3.0].map(|t| [table.value_before(t), table.value(t)]);
        assert_eq!(values, [[1.0, 1.0], [1.0, 5.0], [4.0, 4.0], [3.0, 0.0], [0.0, 0.0]]);
    }

    #[test]
    fn averages_are_exact_across_kinks_and_jumps() {
        // f = 0 before t = 1, jumps to 2, falls to 0 at t = 2. Step from 0.5 to 3 (h = 2.5).
        let time_function = TimeFunction::new(vec![(1.0, 0.0), (1.0, 2.0), (2.0, 0.0)]).unwrap();
        let rule = Rule::discrete_gradient(2);
        let b = rule.weights();
        let c = rule.nodes();
        let mut averages = [0.0; 2];
        time_function.averages(0.5, 2.5, &rule, &mut averages);
        // sum_i b_i avg_i = integral f / h = 1 / 2.5; sum_i b_i c_i avg_i = integral alpha f: by hand 1/h int (t -
        // 0.5)/h f dt
        let zeroth: f64 = (0..2).map(|i| b[i] * averages[i]).sum();
        let first: f64 = (0..2).map(|i| b[i] * c[i] * averages[i]).sum();
        // integral over [1, 2] of (t - 0.5) 2 (2 - t) dt = 5/6
        assert!((zeroth - 0.4).abs() < 1e-15 && (first - 5.0 / 6.0 / 6.25).abs() < 1e-15);
    }

    #[test]
    fn averages_of_a_smooth_function_match_its_integrals() {
        // f = exp(3 t) on a step of 0.1: sum_i b_i avg_i = (e^0.3 - 1) / 0.3 for any degree.
        let time_function =
            TimeFunction::smooth("exp(3 t)", |t| [1.0, 3.0, 9.0].map(|f| f * (3.0 * t).exp()));
        for degree in 1..=4 {
            let rule = Rule::discrete_gradient(degree);
            let mut averages = [0.0; 4];
            time_function.averages(0.0, 0.1, &rule, &mut averages[..degree]);
            let sum: f64 = (0..degree).map(|i| rule.weights()[i] * averages[i]).sum();
            assert!((sum - (0.3f64.exp() - 1.0) / 0.3).abs() < 1e-15, "{degree}");
        }
    }

    #[test]
    fn rates_and_kinks_match_the_table() {
        let time_function = TimeFunction::new(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 0.0), (1.0, 2.0)]).unwrap();
        assert_eq!([-1.0, 0.0, 0.5, 0.7, 1.0].map(|t| time_function.rate(t)), [0.0, 2.0, -2.0, -2.0, 0.0]);
        assert_eq!(
            [-1.0, 0.0, 0.6, 1.0].map(|t| time_function.next_kink(t)),
            [Some(0.0), Some(0.5), Some(1.0), None]
        );
        assert_eq!((time_function.first_jump(), TimeFunction::constant().first_jump()), (Some(1.0), None));
        assert!(TimeFunction::smooth("t", |t| [t, 1.0, 0.0]) == TimeFunction::smooth("t", |_| [0.0; 3]));
    }

    #[test]
    fn steps_end_only_where_a_measured_table_turns() {
        // A hat of 1000 rows with noise of 0.2 % turns at its start, top and end, and jumps at t = 20.
        let hat = |t: f64| (1.0 - (t - 5.0).abs() / 5.0).max(0.0);
        let noise = |i: u32| 0.002 * (f64::from(i * 7919 % 1000) / 1000.0 - 0.5);
        let mut entries: Vec<Entry> =
            (0..=1000).map(|i| (0.015 * f64::from(i), hat(0.015 * f64::from(i)) + noise(i))).collect();
        entries.extend([(20.0, 0.0), (20.0, 0.5), (30.0, 0.5)]);
        let table = TimeFunction::measured(entries.clone()).unwrap();
        let mut corners = vec![-1.0];
        while let Some(corner) = table.next_corner(corners[corners.len() - 1]) {
            corners.push(corner);
        }
        assert!(corners.len() < 20 && corners.contains(&20.0), "{corners:?}");
        for turn in [0.0, 5.0, 10.0] {
            assert!(corners.iter().any(|corner| (corner - turn).abs() < 0.2), "{turn}: {corners:?}");
        }
        // Between corners the table is almost a line.
        for (time, factor) in entries.iter().filter(|entry| entry.0 < 20.0) {
            let next = corners.partition_point(|corner| corner <= time);
            let [a, b] = [corners[next - 1].max(0.0), corners[next]];
            let line = table.value(a) + (table.value(b) - table.value(a)) * (time - a) / (b - a);
            assert!(b == 20.0 || (line - factor).abs() <= 0.02, "{time} {line} {factor}");
        }
        assert_eq!(table.next_kink(0.001), Some(0.015));
        assert_eq!(TimeFunction::new(entries).unwrap().next_corner(0.001), Some(0.015));
    }

    #[test]
    fn times_must_go_forward() {
        assert!(matches!(
            TimeFunction::new(vec![(1.0, 0.0), (0.5, 0.0)]),
            Err(Error::TimeFunction { entry: 1, .. })
        ));
        assert!(TimeFunction::new(vec![]).is_err());
        assert!(TimeFunction::new(vec![(0.0, f64::NAN)]).is_err());
    }
}
