//! Velocity of a body at the start.

use crate::tensor::cross;

/// Initial velocity field of a group.
///
/// ```math
/// v(X) = velocity + angular_velocity x (X - about) + gradient X
/// ```
///
/// ```
/// use emmy::prelude::*;
/// let spin = InitialVelocity { angular_velocity: [0.0, 0.0, 2.0], ..InitialVelocity::default() };
/// assert_eq!(spin.at([3.0, 0.0, 0.0]), [0.0, 6.0, 0.0]);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InitialVelocity {
    /// Group of nodes, facets or cells; `None`: all nodes.
    pub group: Option<String>,
    /// Velocity \[length/time\].
    pub velocity: [f64; 3],
    /// Angular velocity \[1/time\].
    pub angular_velocity: [f64; 3],
    /// Centre of the rotation \[length\].
    pub about: [f64; 3],
    /// Velocity gradient \[1/time\], row by row.
    pub gradient: [[f64; 3]; 3],
}

impl InitialVelocity {
    /// The velocity at a reference position.
    pub fn at(&self, X: [f64; 3]) -> [f64; 3] {
        let r = [0, 1, 2].map(|i| X[i] - self.about[i]);
        let rotation = cross(self.angular_velocity, r);
        [0, 1, 2].map(|i| {
            let stretching: f64 = (0..3).map(|j| self.gradient[i][j] * X[j]).sum();
            self.velocity[i] + rotation[i] + stretching
        })
    }
}
