//! Smooth functions of time that act on a body, for the check that the steps resolve them.

use std::fmt;
use std::sync::Arc;

use crate::input::{Field, SignalTarget, TimeFunction};

/// Points of a field at which its change over time is checked.
pub(crate) const POINTS_OF_SIGNALS: usize = 4;

/// Largest number of components.
pub(crate) const MAX_COMPONENTS: usize = 3 * POINTS_OF_SIGNALS;

/// A function of times: it sets the components for each of them, `[n_times][n_components]`.
type Function = dyn Fn(&[f64], &mut [f64]) + Send + Sync;

/// A smooth function of time that acts on a body: a number, or the components of a field at some of its points.
#[derive(Clone)]
pub struct Signal {
    /// The load or support.
    pub target: SignalTarget,
    /// Its text, [`TimeFunction::text`] or [`crate::input::Field::text`].
    pub text: Arc<str>,
    /// Time at which a released support ends.
    pub until: Option<f64>,
    /// Displacement per unit of the function \[length\]; of a load 0.
    pub arm: f64,
    /// Number of components.
    pub n_components: usize,
    /// Whether an evaluation is costly: [`TimeFunction::of_times`], [`crate::input::Field::of_points`].
    pub is_costly: bool,
    /// Times of kinks and jumps, at which integration stops and starts again.
    pub kinks: Vec<f64>,
    function: Arc<Function>,
}

impl Signal {
    /// The signal of the field of a load, with the kinks of its factor and the function of its components.
    pub(super) fn of_field(
        field: &Field,
        load: usize,
        kinks: Vec<f64>,
        n_components: usize,
        function: impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static,
    ) -> Self {
        Signal {
            target: SignalTarget::Load(load),
            text: field.text().into(),
            until: None,
            arm: 0.0,
            n_components,
            is_costly: field.is_costly(),
            kinks,
            function: Arc::new(function),
        }
    }

    /// Sets the components at some times, `[n_times][n_components]`.
    pub(crate) fn set_at(&self, times: &[f64], values: &mut [f64]) {
        (self.function)(times, values);
    }

    /// The signal of a smooth time function; `None` for a table, which is integrated exactly.
    pub(crate) fn of(
        time_function: &TimeFunction,
        target: SignalTarget,
        until: Option<f64>,
        arm: f64,
    ) -> Option<Self> {
        let text = time_function.text()?.into();
        let is_costly = time_function.is_costly();
        let kinks = time_function.kinks();
        let time_function = time_function.clone();
        let function = move |times: &[f64], values: &mut [f64]| time_function.values(times, values);
        let function = Arc::new(function);
        Some(Signal { target, text, until, arm, n_components: 1, is_costly, kinks, function })
    }
}

impl fmt::Debug for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Signal").field("target", &self.target).field("text", &self.text).finish()
    }
}
