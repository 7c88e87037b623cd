//! Smooth functions of time that act on a body, for the check that the steps resolve them.

use std::collections::HashSet;
use std::fmt;
use std::sync::Arc;

use super::field_load::FieldLoad;
use super::{Body, TimeFunction};

/// The load or support that a function of time drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SignalTarget {
    /// A load, by its number.
    Load(usize),
    /// A driven support, by its number among the driven supports.
    Support(usize),
}

/// A function of time.
type Function = dyn Fn(f64) -> f64 + Send + Sync;

/// A smooth function of time that acts on a body.
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
    function: Arc<Function>,
}

impl Signal {
    /// The signals of a field.
    fn of_field(field: &FieldLoad) -> impl Iterator<Item = Self> + '_ {
        let target = SignalTarget::Load(field.load);
        field.components().map(move |function| Signal {
            target,
            text: field.field.text().into(),
            until: None,
            arm: 0.0,
            function: Arc::new(function),
        })
    }

    /// Value at a time.
    pub(crate) fn at(&self, time: f64) -> f64 {
        (self.function)(time)
    }

    /// The signal of a smooth time function; `None` for a table, which is integrated exactly.
    fn of(time_function: &TimeFunction, target: SignalTarget, until: Option<f64>, arm: f64) -> Option<Self> {
        let text = time_function.text()?.into();
        let time_function = time_function.clone();
        Some(Signal { target, text, until, arm, function: Arc::new(move |time| time_function.value(time)) })
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
        let of_supports = self.drives.iter().enumerate().flat_map(|(number, drive)| {
            let target = SignalTarget::Support(number);
            drive
                .arms()
                .filter_map(move |(time_function, arm)| Signal::of(time_function, target, drive.until, arm))
        });
        let mut known = HashSet::new();
        let is_new = |signal: &Signal| {
            known.insert((signal.text.clone(), signal.arm.to_bits(), signal.until.map(f64::to_bits)))
        };
        let mut signals: Vec<Signal> = of_loads.chain(of_supports).filter(is_new).collect();
        signals.extend(self.fields.iter().flat_map(Signal::of_field));
        signals
    }
}
