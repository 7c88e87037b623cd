//! The whole state of a motion between two steps.

use super::{Record, Subdivision};
use crate::time::{Memory, State};

/// The whole state of a motion between two steps. [`super::Motion::resumed`] continues from it, bit-identical to the motion itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Snapshot {
    /// The state.
    pub state: State,
    /// The record of the last step, with what has accumulated.
    pub record: Record,
    /// Progress within the present planned step.
    pub subdivision: Subdivision,
    /// Memory of the control, where sizes are chosen by the error.
    pub control: Option<Memory>,
    /// Number of supports that are released by now.
    pub releases: usize,
    /// Whether Newton's iteration has ended at its rounding floor before.
    pub was_at_rounding_floor: bool,
    /// The stepper's own memory; `None`: a new stepper starts from the state, as it must with another scheme or degree.
    pub memory: Option<Memory>,
}
