//! Smooth functions of time.

use std::fmt;
use std::sync::Arc;

/// A function of times: it sets a number for each of them.
type OfTimes = dyn Fn(&[f64], &mut [f64]) + Send + Sync;

/// A function of time that is smooth between its kinks, identified by its text.
#[derive(Clone)]
pub(super) struct Smooth {
    pub(super) text: Arc<str>,
    values: Arc<OfTimes>,
    rates: Option<Arc<OfTimes>>,
    /// Times of kinks and jumps, ascending.
    pub(super) kinks: Arc<[f64]>,
    /// Whether a call is costly.
    pub(super) is_costly: bool,
}

/// A change at a kink that is rounding, as a part of the size of values and of rates times the span of the kinks.
const JUMP: f64 = 1e-9;

impl fmt::Debug for Smooth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Smooth").field(&self.text).finish()
    }
}

impl PartialEq for Smooth {
    fn eq(&self, other: &Smooth) -> bool {
        Arc::ptr_eq(&self.values, &other.values) || (!self.text.is_empty() && self.text == other.text)
    }
}

impl Smooth {
    /// A function without a rate.
    pub(super) fn new(text: &str, values: impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static) -> Self {
        Smooth { text: text.into(), values: Arc::new(values), rates: None, kinks: [].into(), is_costly: true }
    }

    /// A function that returns its value and rate first.
    pub(super) fn of_derivatives(
        text: &str,
        function: impl Fn(f64) -> [f64; 3] + Send + Sync + 'static,
    ) -> Self {
        let function = Arc::new(function);
        let component = |derivative: usize| {
            let function = function.clone();
            move |times: &[f64], values: &mut [f64]| {
                let all = values.iter_mut().zip(times);
                all.for_each(|(value, &time)| *value = function(time)[derivative]);
            }
        };
        let smooth = Smooth::new(text, component(0)).with_rate(component(1));
        Smooth { is_costly: false, ..smooth }
    }

    pub(super) fn with_rate(self, rates: impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static) -> Self {
        Smooth { rates: Some(Arc::new(rates)), ..self }
    }

    pub(super) fn with_kinks(self, times: impl IntoIterator<Item = f64>) -> Self {
        let mut kinks: Vec<f64> = times.into_iter().collect();
        kinks.sort_by(f64::total_cmp);
        kinks.dedup();
        Smooth { kinks: kinks.into(), ..self }
    }

    /// Whether a kink is at most as far from a time as a distance.
    pub(super) fn has_kink_near(&self, time: f64, distance: f64) -> bool {
        self.kinks.iter().any(|kink| (kink - time).abs() <= distance)
    }

    /// The first time at which the values on both sides differ by more than rounding.
    pub(super) fn first_jump(&self) -> Option<f64> {
        let span = self.kinks.iter().fold(0f64, |span, kink| span.max((kink - self.kinks[0]).abs()));
        self.kinks.iter().copied().find(|&kink| {
            let sides = [kink.next_down(), kink];
            let change = (self.value(sides[1]) - self.value(sides[0])).abs();
            let size = |time: f64| self.value(time).abs() + (span + time.abs()) * self.rate(time).abs();
            let scale: f64 = sides.map(size).into_iter().sum();
            // The size of a function without a rate is NaN: then only equal values are no jump.
            change != 0.0 && (scale.is_nan() || change > JUMP * scale)
        })
    }

    pub(super) fn has_rate(&self) -> bool {
        self.rates.is_some()
    }

    /// Sets the values at some times; a value that the function leaves out is NaN.
    pub(super) fn values(&self, times: &[f64], values: &mut [f64]) {
        values.fill(f64::NAN);
        (self.values)(times, values);
    }

    pub(super) fn value(&self, time: f64) -> f64 {
        let mut value = [0.0];
        self.values(&[time], &mut value);
        value[0]
    }

    /// The rate at a time; NaN for a function without a rate.
    pub(super) fn rate(&self, time: f64) -> f64 {
        let mut rate = [f64::NAN];
        if let Some(rates) = &self.rates {
            rates(&[time], &mut rate);
        }
        rate[0]
    }
}
