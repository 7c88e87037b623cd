//! Load factors over time.

use std::fmt;
use std::sync::Arc;

use crate::average::Rule;
use crate::error::{Error, Result};
use crate::quadrature::Quadrature;

/// Factor over time: a table, linear between its entries and constant outside (two entries at one time are a jump), or
/// a smooth function.
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
    Table(Vec<(f64, f64)>),
    Smooth(Smooth),
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
        TimeFunction { law: Law::Table(vec![(0.0, 1.0)]) }
    }

    /// The factor that grows evenly from 0 at t = 0 to a value at t = 1.
    pub(super) fn ramp(value: f64) -> Self {
        TimeFunction { law: Law::Table(vec![(0.0, 0.0), (1.0, value)]) }
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
        Ok(TimeFunction { law: Law::Table(entries) })
    }

    /// A smooth time function: `function` returns the factor and its first and second derivatives at a time. `text`
    /// names it; time functions with equal texts count as equal.
    pub fn smooth(text: &str, function: impl Fn(f64) -> [f64; 3] + Send + Sync + 'static) -> Self {
        TimeFunction { law: Law::Smooth(Smooth { text: text.into(), function: Arc::new(function) }) }
    }

    /// Entries (time, factor) of a table; a smooth function has none.
    pub fn entries(&self) -> &[(f64, f64)] {
        match &self.law {
            Law::Table(entries) => entries,
            Law::Smooth(_) => &[],
        }
    }

    /// Text of a smooth function.
    pub fn text(&self) -> Option<&str> {
        match &self.law {
            Law::Table(_) => None,
            Law::Smooth(smooth) => Some(&smooth.text),
        }
    }

    /// The factor at a time; at a jump, the value after it.
    pub fn value(&self, time: f64) -> f64 {
        match &self.law {
            Law::Table(entries) => match around(entries, time) {
                (None, Some((_, factor))) | (Some((_, factor)), None) => factor,
                (Some((t0, f0)), Some((t1, f1))) => f0 + (f1 - f0) * (time - t0) / (t1 - t0),
                (None, None) => 1.0,
            },
            Law::Smooth(smooth) => (smooth.function)(time)[0],
        }
    }

    /// Rate of the factor \[1/time\]; at a kink or jump, the rate after it.
    pub fn rate(&self, time: f64) -> f64 {
        match &self.law {
            Law::Table(entries) => match around(entries, time) {
                (Some((t0, f0)), Some((t1, f1))) => (f1 - f0) / (t1 - t0),
                _ => 0.0,
            },
            Law::Smooth(smooth) => (smooth.function)(time)[1],
        }
    }

    /// The first time after another at which a table has a kink or a jump.
    pub fn next_kink(&self, after: f64) -> Option<f64> {
        let entries = self.entries();
        entries.get(entries.partition_point(|&(t, _)| t <= after)).map(|&(t, _)| t)
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
        if let Law::Smooth(_) = self.law {
            return self.add_segment(time, step_size, [0.0, 1.0], rule, rule.smooth_quadrature(), averages);
        }
        let mut from = 0.0;
        let first = self.entries().partition_point(|&(t, _)| t <= time);
        let kinks = self.entries()[first..].iter().map(|&(t, _)| (t - time) / step_size);
        for to in kinks.take_while(|&alpha| alpha < 1.0).chain([1.0]) {
            if to > from {
                self.add_segment(time, step_size, [from, to], rule, rule.load_quadrature(), averages);
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

/// An entry of a table: (time, factor).
type Entry = (f64, f64);

/// The entries of a table before (or at) a time and after it.
fn around(entries: &[Entry], time: f64) -> (Option<Entry>, Option<Entry>) {
    let after = entries.partition_point(|&(t, _)| t <= time);
    (after.checked_sub(1).map(|i| entries[i]), entries.get(after).copied())
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn times_must_go_forward() {
        assert!(matches!(
            TimeFunction::new(vec![(1.0, 0.0), (0.5, 0.0)]),
            Err(Error::TimeFunction { entry: 1, .. })
        ));
        assert!(TimeFunction::new(vec![]).is_err());
        assert!(TimeFunction::new(vec![(0.0, f64::NAN)]).is_err());
    }
}
