//! Rigid bodies.

/// A rigid body without cells, by its mass, centre and inertia.
///
/// ```
/// use emmy::internals::unknowns::RigidBody;
/// let wheel = RigidBody::new("wheel", 2.0, [0.0; 3], [0.1, 0.1, 0.18]);
/// assert_eq!(wheel.inertia[2], [0.0, 0.0, 0.18]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBody {
    /// Its name.
    pub name: String,
    /// Mass.
    pub mass: f64,
    /// Centre of mass \[length\].
    pub centre: [f64; 3],
    /// Inertia tensor about the centre \[mass length^2\].
    pub inertia: [[f64; 3]; 3],
}

impl RigidBody {
    /// A rigid body with its principal moments of inertia about axes along x, y and z.
    pub fn new(name: impl Into<String>, mass: f64, centre: [f64; 3], moments: [f64; 3]) -> Self {
        let [x, y, z] = moments;
        let inertia = [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
        RigidBody { name: name.into(), mass, centre, inertia }
    }
}
