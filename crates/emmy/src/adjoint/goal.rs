//! Goals: functions of the state at the end of a motion.

use crate::body::Body;
use crate::nodal;
use crate::sparse::reduce::dot;
use crate::time::State;

/// A linear function of the displacement and the velocity at the end of a motion, given by its gradients.
///
/// ```math
/// J(u, v) = g_u . u + g_v . v
/// ```
///
/// For a non-linear function, give its gradients at the last state of the motion.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::adjoint::Goal;
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(Region::new(rubber, 1.0)).build()?;
/// let state = State::initial(&body, 0.0, &[InitialVelocity { velocity: [3.0, 4.0, 0.0], ..Default::default() }])?;
/// assert!((Goal::velocity_at(&body, 7, [0.6, 0.8, 0.0]).value(&state) - 5.0).abs() < 1e-14);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Goal {
    /// Gradient by the displacement, `[n_nodes][3]`.
    pub displacement: Vec<f64>,
    /// Gradient by the velocity, `[n_nodes][3]`.
    pub velocity: Vec<f64>,
}

impl Goal {
    /// Displacement of a node along a direction; up to a constant, its position along it.
    pub fn displacement_at(body: &Body, node: usize, direction: [f64; 3]) -> Self {
        let mut goal = Goal::zero(body);
        *nodal::at_mut(&mut goal.displacement, node) = direction;
        goal
    }

    /// Velocity of a node along a direction.
    pub fn velocity_at(body: &Body, node: usize, direction: [f64; 3]) -> Self {
        let mut goal = Goal::zero(body);
        *nodal::at_mut(&mut goal.velocity, node) = direction;
        goal
    }

    /// The value at a state.
    pub fn value(&self, state: &State) -> f64 {
        dot(&self.displacement, &state.displacement) + dot(&self.velocity, &state.velocity)
    }

    fn zero(body: &Body) -> Self {
        Goal { displacement: vec![0.0; body.n_dofs()], velocity: vec![0.0; body.n_dofs()] }
    }
}
