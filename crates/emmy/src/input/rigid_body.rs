//! Rigid bodies.

/// A rigid body: by its mass, centre and inertia, a point mass without inertia; or a group of the mesh that moves as
/// one.
///
/// ```
/// use emmy::prelude::*;
/// let wheel = RigidBody::new("wheel", 2.0, [0.0; 3], [0.1, 0.1, 0.18]);
/// assert_eq!(wheel.inertia.unwrap()[2], [0.0, 0.0, 0.18]);
/// let hub = RigidBody::group("hub", "cells:hub");
/// assert_eq!((hub.mass, hub.centre), (0.0, None));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBody {
    /// Its name.
    pub name: String,
    /// Group of cells, facets or nodes that move with it. The masses of its nodes are those of the body.
    pub group: Option<String>,
    /// Mass; of a group in addition to that of its nodes.
    pub mass: f64,
    /// Centre of mass; of a group the place of the centre and of the mass in addition. `None` for the centre of mass of
    /// the cells of a group, those with all nodes in it, or if there are none the mean of its nodes \[length\].
    pub centre: Option<[f64; 3]>,
    /// Inertia tensor about the centre, that of the mass \[mass length^2\]; `None` for a point, which has no directions
    /// unless it has a group.
    pub inertia: Option<[[f64; 3]; 3]>,
}

impl RigidBody {
    /// A rigid body with its principal moments of inertia about axes along x, y and z.
    pub fn new(name: impl Into<String>, mass: f64, centre: [f64; 3], moments: [f64; 3]) -> Self {
        let [x, y, z] = moments;
        let inertia = Some([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]);
        RigidBody { inertia, ..RigidBody::point(name, mass, centre) }
    }

    /// A point mass.
    pub fn point(name: impl Into<String>, mass: f64, centre: [f64; 3]) -> Self {
        RigidBody { name: name.into(), group: None, mass, centre: Some(centre), inertia: None }
    }

    /// A group of the mesh that moves as one, with the mass of its nodes.
    pub fn group(name: impl Into<String>, group: impl Into<String>) -> Self {
        RigidBody { name: name.into(), group: Some(group.into()), mass: 0.0, centre: None, inertia: None }
    }

    /// Whether it has directions and turns, as all do but point masses.
    pub fn has_axes(&self) -> bool {
        self.inertia.is_some() || self.group.is_some()
    }
}
