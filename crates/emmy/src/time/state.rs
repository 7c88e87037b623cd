//! State of a motion.

use serde::{Deserialize, Serialize};

use crate::body::{Body, InitialVelocity};
use crate::error::Result;

/// State of a body in motion.
///
/// Displacement instead of position keeps the digits of small strains; see ARCHITECTURE.md.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// Time \[time\].
    pub time: f64,
    /// Number of steps done.
    pub step: usize,
    /// Displacement u = q - X, `[n_nodes][3]` \[length\].
    pub displacement: Vec<f64>,
    /// Momentum p = M v, `[n_nodes][3]` \[mass length/time\]; M is the consistent mass, for central differences the lumped
    /// one.
    pub momentum: Vec<f64>,
    /// Velocity v = M^-1 p, `[n_nodes][3]` \[length/time\].
    pub velocity: Vec<f64>,
}

impl State {
    /// The undeformed body with an initial velocity field (at rest without one).
    ///
    /// # Errors
    /// [`crate::Error::UnknownGroup`], [`crate::Error::NotFinite`], [`crate::Error::DrivenStart`].
    pub fn initial(body: &Body, time: f64, fields: &[InitialVelocity]) -> Result<Self> {
        let (momentum, velocity) = body.initial_motion(time, fields)?;
        Ok(State { time, step: 0, displacement: vec![0.0; body.n_dofs()], momentum, velocity })
    }

    /// Takes over another state of the same body, in the memory that there is.
    pub fn copy_from(&mut self, other: &State) {
        (self.time, self.step) = (other.time, other.step);
        self.displacement.copy_from_slice(&other.displacement);
        self.momentum.copy_from_slice(&other.momentum);
        self.velocity.copy_from_slice(&other.velocity);
    }

    /// Current position of a node.
    pub fn position(&self, body: &Body, node: usize) -> [f64; 3] {
        [0, 1, 2].map(|i| body.mesh().points()[node][i] + self.displacement[3 * node + i])
    }
}
