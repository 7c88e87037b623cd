//! All that a motion is between two steps.

use super::{Division, Record, State};
use crate::time::Memory;

/// All that a motion is between two steps: [`super::Motion::resumed`] goes on from it, in every bit as the motion itself would.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Snapshot {
    /// The state.
    pub state: State,
    /// The record of the last step, with what has accumulated.
    pub record: Record,
    /// Where in the plan's steps the motion is.
    pub division: Division,
    /// What the choice of the next size depends on, where sizes are chosen by the error.
    pub control: Option<Memory>,
    /// Number of supports that are released by now.
    pub releases: usize,
    /// Whether Newton's iteration has ended at its rounding floor before.
    pub was_at_rounding_floor: bool,
    /// The stepper's own memory; `None`: the stepper starts anew from the state, as it must with another scheme or degree.
    pub memory: Option<Memory>,
}
