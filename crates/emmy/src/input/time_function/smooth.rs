//! Smooth functions of time.

use std::fmt;
use std::sync::Arc;

/// A function of times: it sets a number for each of them.
type OfTimes = dyn Fn(&[f64], &mut [f64]) + Send + Sync;

/// A smooth function of time, identified by its text.
#[derive(Clone)]
pub(super) struct Smooth {
    pub(super) text: Arc<str>,
    values: Arc<OfTimes>,
    rates: Option<Arc<OfTimes>>,
    /// Whether a call is costly.
    pub(super) is_costly: bool,
}

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
        Smooth { text: text.into(), values: Arc::new(values), rates: None, is_costly: true }
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
