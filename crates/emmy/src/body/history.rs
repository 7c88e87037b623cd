//! Load factors over time.

use crate::average::Rule;
use crate::error::{Error, Result};

/// Factor over time, linear between its entries and constant outside. Two entries at one time are a jump.
///
/// ```
/// use emmy::body::History;
/// let hat = History::new(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)])?;
/// assert_eq!([hat.value(0.25), hat.value(0.75), hat.value(7.0)], [0.5, 0.5, 0.0]);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    entries: Vec<(f64, f64)>,
}

impl History {
    /// The factor 1 at all times.
    pub fn constant() -> Self {
        History { entries: vec![(0.0, 1.0)] }
    }

    /// The history with entries (time, factor).
    ///
    /// # Errors
    /// [`Error::History`] if it is empty, an entry is not finite, or a time lies before its predecessor.
    pub fn new(entries: Vec<(f64, f64)>) -> Result<Self> {
        if entries.is_empty() {
            return Err(Error::History { entry: 0, reason: "it has no entries" });
        }
        for (entry, &(time, factor)) in entries.iter().enumerate() {
            if !(time.is_finite() && factor.is_finite()) {
                return Err(Error::History { entry, reason: "time and factor must be finite numbers" });
            }
            if entry > 0 && time < entries[entry - 1].0 {
                return Err(Error::History { entry, reason: "times must not go back" });
            }
        }
        Ok(History { entries })
    }

    /// Entries (time, factor).
    pub fn entries(&self) -> &[(f64, f64)] {
        &self.entries
    }

    /// The factor at a time; at a jump, the value after it.
    pub fn value(&self, time: f64) -> f64 {
        let after = self.entries.partition_point(|&(t, _)| t <= time);
        match (after.checked_sub(1).map(|i| self.entries[i]), self.entries.get(after)) {
            (None, Some(&(_, factor))) => factor,
            (Some((_, factor)), None) => factor,
            (Some((t0, f0)), Some(&(t1, f1))) => f0 + (f1 - f0) * (time - t0) / (t1 - t0),
            (None, None) => 1.0,
        }
    }

    /// Averages of the factor over a step, weighted with the basis of a time element, exact for every kink and jump
    /// inside the step.
    ///
    /// ```math
    /// (1/b_i) integral_0^1 l_i(alpha) f(t + alpha h) dalpha
    /// ```
    ///
    /// `averages: [k]`, with the k, c_i and b_i of the rule.
    pub fn averages(&self, time: f64, step_size: f64, rule: &Rule, averages: &mut [f64]) {
        averages.fill(0.0);
        let mut from = 0.0;
        let first = self.entries.partition_point(|&(t, _)| t <= time);
        let kinks = self.entries[first..].iter().map(|&(t, _)| (t - time) / step_size);
        for to in kinks.take_while(|&alpha| alpha < 1.0).chain([1.0]) {
            if to > from {
                self.add_segment(time, step_size, [from, to], rule, averages);
                from = to;
            }
        }
    }

    /// Adds the integral over a segment on which the factor is linear.
    fn add_segment(&self, time: f64, h: f64, [from, to]: [f64; 2], rule: &Rule, averages: &mut [f64]) {
        for (&[s], w) in rule.load_quadrature().iter() {
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
    fn averages_are_exact_across_kinks_and_jumps() {
        // f = 0 before t = 1, jumps to 2, falls to 0 at t = 2. Step from 0.5 to 3 (h = 2.5).
        let history = History::new(vec![(1.0, 0.0), (1.0, 2.0), (2.0, 0.0)]).unwrap();
        let rule = Rule::discrete_gradient(2);
        let (b, c) = (rule.weights(), rule.nodes());
        let mut averages = [0.0; 2];
        history.averages(0.5, 2.5, &rule, &mut averages);
        // sum_i b_i avg_i = integral f / h = 1 / 2.5; sum_i b_i c_i avg_i = integral alpha f: by hand 1/h int (t - 0.5)/h f dt
        let zeroth: f64 = (0..2).map(|i| b[i] * averages[i]).sum();
        let first: f64 = (0..2).map(|i| b[i] * c[i] * averages[i]).sum();
        // integral over [1, 2] of (t - 0.5) 2 (2 - t) dt = 5/6
        assert!((zeroth - 0.4).abs() < 1e-15 && (first - 5.0 / 6.0 / 6.25).abs() < 1e-15);
    }

    #[test]
    fn histories_must_go_forward() {
        assert!(matches!(History::new(vec![(1.0, 0.0), (0.5, 0.0)]), Err(Error::History { entry: 1, .. })));
        assert!(History::new(vec![]).is_err());
        assert!(History::new(vec![(0.0, f64::NAN)]).is_err());
    }
}
