//! Rigid bodies and joints in records.

use super::Record;
use crate::body::{Body, ConstrainedVelocity};
use crate::error::Result;
use crate::time::State;

/// Takes joints and rigid bodies of a state into records.
#[derive(Debug)]
pub(super) struct MechanismRecorder {
    velocity: ConstrainedVelocity,
    /// Memory of the body's size.
    allowed: Vec<f64>,
}

impl MechanismRecorder {
    /// A recorder; `None` for a body without rigid bodies and joints.
    ///
    /// # Errors
    /// As [`ConstrainedVelocity::new`].
    pub(super) fn new(body: &Body) -> Result<Option<Self>> {
        if body.mechanism.is_empty() {
            return Ok(None);
        }
        Ok(Some(MechanismRecorder { velocity: ConstrainedVelocity::new(body)?, allowed: Vec::new() }))
    }

    /// Sets joints and rigid bodies in the record of a state, whose forces of joints are set.
    pub(super) fn set(&mut self, body: &Body, state: &State, record: &mut Record) {
        let u = |dof: usize| state.displacement[dof];
        body.mechanism.set_coordinates(&u, &state.coordinates, &mut record.joints);
        self.allowed.clear();
        self.allowed.extend_from_slice(&state.velocity);
        // A position in which no velocity is allowed is reported by the next step.
        let hidden = self.velocity.project_joints(body, state.time, &state.displacement, &mut self.allowed);
        record.hidden_constraint = hidden.unwrap_or(f64::NAN);
        record.rigid_bodies = body.mechanism.motions(&u, &|dof| self.allowed[dof]);
        record.constraint_residual = self.velocity.opening(body, &state.displacement);
    }
}
