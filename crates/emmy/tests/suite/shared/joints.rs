//! Ends of joints, and hinges.

use emmy::prelude::*;

/// The end of a joint at a rigid body.
pub(crate) fn rigid(name: &str) -> JointEnd {
    JointEnd::Rigid(name.into())
}

/// A hinge between two ends.
pub(crate) fn hinge(name: &str, between: [JointEnd; 2], at: [f64; 3], axis: [f64; 3]) -> Joint {
    Joint::new(name, JointKind::Revolute { axis }, between, at)
}

/// A hinge about z.
pub(crate) fn plane_hinge(name: &str, between: [JointEnd; 2], at: [f64; 3]) -> Joint {
    hinge(name, between, at, [0.0, 0.0, 1.0])
}
