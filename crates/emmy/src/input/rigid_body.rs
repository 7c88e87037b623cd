//! Rigid bodies.

/// A rigid body without cells, by its mass, centre and inertia; a point mass without inertia.
///
/// ```
/// use emmy::prelude::*;
/// let wheel = RigidBody::new("wheel", 2.0, [0.0; 3], [0.1, 0.1, 0.18]);
/// assert_eq!(wheel.inertia.unwrap()[2], [0.0, 0.0, 0.18]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBody {
    /// Its name.
    pub name: String,
    /// Mass.
    pub mass: f64,
    /// Centre of mass \[length\].
    pub centre: [f64; 3],
    /// Inertia tensor about the centre \[mass length^2\]; `None` for a point, which has no directions.
    pub inertia: Option<[[f64; 3]; 3]>,
}

impl RigidBody {
    /// A rigid body with its principal moments of inertia about axes along x, y and z.
    pub fn new(name: impl Into<String>, mass: f64, centre: [f64; 3], moments: [f64; 3]) -> Self {
        let [x, y, z] = moments;
        let inertia = Some([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]);
        RigidBody { name: name.into(), mass, centre, inertia }
    }

    /// A point mass.
    pub fn point(name: impl Into<String>, mass: f64, centre: [f64; 3]) -> Self {
        RigidBody { name: name.into(), mass, centre, inertia: None }
    }
}
