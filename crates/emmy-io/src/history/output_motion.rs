//! The motion in the frame of reference of an output.

use std::borrow::Cow;

use emmy::body::{FieldName, NodalMotion};
use emmy::motion::{Motion, ReferenceMotion, State};

/// Displacement, velocity and acceleration in a frame of reference, and the state for all other fields.
pub(crate) struct OutputMotion<'a> {
    state: &'a State,
    relative: [Cow<'a, [f64]>; 2],
    /// Empty if no field needs it, and before the first step.
    acceleration: Vec<f64>,
}

impl<'a> OutputMotion<'a> {
    /// The motion for some fields. On a team a call of all ranks.
    pub(crate) fn new(
        motion: &'a Motion<'_>,
        reference: Option<&ReferenceMotion>,
        mut fields: impl Iterator<Item = FieldName>,
    ) -> Self {
        let is_accelerated = fields.any(|name| name == FieldName::Acceleration);
        OutputMotion {
            state: motion.state(),
            relative: motion.seen_from(reference),
            acceleration: if is_accelerated { motion.mean_acceleration(reference) } else { Vec::new() },
        }
    }

    /// The motion that a field takes.
    pub(crate) fn of(&self, name: FieldName) -> NodalMotion<'_> {
        match name.is_of_motion() {
            true => {
                let [displacement, velocity] = &self.relative;
                NodalMotion { displacement, velocity, acceleration: &self.acceleration }
            }
            false => NodalMotion::from([&self.state.displacement, &self.state.velocity]),
        }
    }

    /// The vectors of displacement, velocity or acceleration, `[n_nodes][3]`; NaN where they are unknown.
    pub(crate) fn vectors(&self, name: FieldName) -> Cow<'_, [f64]> {
        let NodalMotion { displacement, velocity, acceleration } = self.of(name);
        match name {
            FieldName::Displacement => displacement.into(),
            FieldName::Velocity => velocity.into(),
            _ if acceleration.is_empty() => vec![f64::NAN; displacement.len()].into(),
            _ => acceleration.into(),
        }
    }
}
