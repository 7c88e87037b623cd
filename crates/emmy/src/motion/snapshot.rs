//! The state of a motion between two steps.

use serde::{Deserialize, Serialize};

use super::{Record, RunStatistics, Subdivision};
use crate::time::{Memory, State};

/// The complete state of a motion between two steps. [`super::Motion::resumed`] continues from it, bit-identical to the
/// motion itself.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Snapshot {
    /// The state.
    pub state: State,
    /// The record of the last step.
    pub record: Record,
    /// Statistics of all steps so far.
    pub statistics: RunStatistics,
    /// Subdivision of the planned step in progress.
    pub subdivision: Subdivision,
    /// State of the step size control, with adaptive steps.
    pub control: Option<Memory>,
    /// Number of supports released so far.
    pub releases: usize,
    /// Whether a Newton iteration has ended at the rounding floor.
    pub was_at_rounding_floor: bool,
    /// Memory of the stepper. With `None`, the stepper starts from the state alone, as it must with another scheme or
    /// degree.
    pub memory: Option<Memory>,
}
