//! The state of a motion between two steps.

use serde::{Deserialize, Serialize};

use super::{Record, RunStatistics, Subdivision};
use crate::body::Entries;
use crate::time::{Memory, State};

/// The complete state of a motion between two steps. [`super::Motion::resumed`] continues from it, bit-identical to the
/// motion itself.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let flight = InitialVelocity { velocity: [3.0, 0.0, 0.0], ..InitialVelocity::default() };
/// let state = State::initial(&body, 0.0, &[flight])?;
/// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.from(state)?;
/// motion.step(0.1)?;
/// let (scheme, settings) = (motion.scheme(), motion.settings());
/// let mut resumed = Motion::resumed(&body, scheme, settings, motion.snapshot())?;
/// assert_eq!(resumed.step(0.1)?, motion.step(0.1)?); // bit for bit
/// # Ok::<(), emmy::Error>(())
/// ```
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

impl Snapshot {
    /// The lists over nodes and cells, by their names. On a team they are those of a rank; all else is the same on all
    /// ranks.
    #[doc(hidden)]
    pub fn lists_mut<'a>(&'a mut self) -> impl Iterator<Item = (String, Entries, &'a mut Vec<f64>)> {
        let State {
            time: _,
            step: _,
            displacement,
            momentum,
            velocity,
            displacement_low,
            momentum_error: _,
            is_equilibrium: _,
            history: _,
            coordinates: _,
        } = &mut self.state;
        let of_state = [
            ("displacement", displacement),
            ("momentum", momentum),
            ("velocity", velocity),
            ("displacement_low", displacement_low),
        ];
        let of_state = of_state.map(|(name, list)| (format!("state.{name}"), Entries::Nodes, list));
        let of_memory = |name: &'static str, memory: &'a mut Option<Memory>| {
            let lists = memory.iter_mut().flat_map(Memory::lists_mut);
            lists.map(move |(list, entries, numbers)| (format!("{name}.{list}"), entries, numbers))
        };
        let of_steps = of_memory("control", &mut self.control).chain(of_memory("memory", &mut self.memory));
        of_state.into_iter().chain(of_steps)
    }
}
