//! Smooth functions of time that act on a body, for the check that the steps resolve them.

use std::collections::HashSet;
use std::fmt;
use std::sync::Arc;

use super::system::Body;
use crate::force::FieldLoad;
use crate::force::field_load::POINTS_OF_SIGNALS;
use crate::input::{SignalTarget, TimeFunction};

/// Largest number of components.
pub(crate) const MAX_COMPONENTS: usize = 3 * POINTS_OF_SIGNALS;

/// A function of times: it sets the components for each of them, `[n_times][n_components]`.
type Function = dyn Fn(&[f64], &mut [f64]) + Send + Sync;

/// A smooth function of time that acts on a body: a number, or the components of a field at some of its points.
#[derive(Clone)]
pub(crate) struct Signal {
    /// The load or support.
    pub target: SignalTarget,
    /// Its text, [`TimeFunction::text`] or [`super::Field::text`].
    pub text: Arc<str>,
    /// Time at which a released support ends.
    pub until: Option<f64>,
    /// Displacement per unit of the function \[length\]; of a load 0.
    pub arm: f64,
    /// Number of components.
    pub n_components: usize,
    /// Whether an evaluation is costly: [`TimeFunction::of_times`], [`super::Field::of_points`].
    pub is_costly: bool,
    function: Arc<Function>,
}

impl Signal {
    /// The signal of a field.
    fn of_field(field: &FieldLoad) -> Self {
        let (n_components, function) = field.components();
        Signal {
            target: SignalTarget::Load(field.load),
            text: field.field.text().into(),
            until: None,
            arm: 0.0,
            n_components,
            is_costly: field.field.is_costly(),
            function: Arc::new(function),
        }
    }

    /// Sets the components at some times, `[n_times][n_components]`.
    pub(crate) fn set_at(&self, times: &[f64], values: &mut [f64]) {
        (self.function)(times, values);
    }

    /// The signal of a smooth time function; `None` for a table, which is integrated exactly.
    fn of(time_function: &TimeFunction, target: SignalTarget, until: Option<f64>, arm: f64) -> Option<Self> {
        let text = time_function.text()?.into();
        let is_costly = time_function.is_costly();
        let time_function = time_function.clone();
        let function = move |times: &[f64], values: &mut [f64]| time_function.values(times, values);
        let function = Arc::new(function);
        Some(Signal { target, text, until, arm, n_components: 1, is_costly, function })
    }
}

impl fmt::Debug for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Signal").field("target", &self.target).field("text", &self.text).finish()
    }
}

impl Body {
    /// The smooth functions of time that act on the body, without repetition.
    ///
    /// A field contributes its components at some of its points.
    pub(crate) fn signals(&self) -> Vec<Signal> {
        let loads = self.loads.iter().map(|load| (load.load, &load.time_function));
        let pressures = self.pressures.iter().map(|pressure| (pressure.load, &pressure.time_function));
        let of_loads = loads.chain(pressures).filter_map(|(load, time_function)| {
            Signal::of(time_function, SignalTarget::Load(load), None, 0.0)
        });
        let of_supports = self.drives.iter().flat_map(|drive| {
            let target = SignalTarget::Support(drive.support);
            drive
                .arms()
                .filter_map(move |(time_function, arm)| Signal::of(time_function, target, drive.until, arm))
        });
        let mut known = HashSet::new();
        let is_new = |signal: &Signal| {
            signal.text.is_empty()
                || known.insert((signal.text.clone(), signal.arm.to_bits(), signal.until.map(f64::to_bits)))
        };
        let mut signals: Vec<Signal> = of_loads.chain(of_supports).filter(is_new).collect();
        signals.extend(self.fields.iter().map(Signal::of_field).filter(|signal| signal.n_components > 0));
        signals
    }
}
