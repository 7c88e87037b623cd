//! A rigid link.

use super::affine::Affine;
use super::attachments::Attachments;
use super::constraint::Constraint;
use super::source::ConstraintSource;
use crate::error::{Error, Result};

/// A rigid link without mass, as long as it is in the mesh: between two nodes, or between a node and a point of the
/// ground.
///
/// ```math
/// (|p - r|^2 - L^2) / 2 = 0
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RigidLink {
    /// Two nodes of the mesh.
    Nodes([u32; 2]),
    /// A node of the mesh and a point of the ground.
    Ground(u32, [f64; 3]),
}

impl ConstraintSource for RigidLink {
    fn constraints(&self, attachments: &Attachments<'_>) -> Result<Vec<Constraint>> {
        let mesh = attachments.mesh;
        let X = |node: u32| {
            let (node, n_nodes) = (node as usize, mesh.n_nodes());
            let group = "rigid link".to_string();
            mesh.points().get(node).copied().ok_or(Error::GroupNodeOutOfRange { group, node, n_nodes })
        };
        let (nodes, weights, other) = match *self {
            RigidLink::Nodes([a, b]) => (vec![a, b], vec![1.0, -1.0], X(b)?),
            RigidLink::Ground(node, point) => (vec![node], vec![1.0], point),
        };
        let first = X(nodes[0])?;
        let reference = [0, 1, 2].map(|d| first[d] - other[d]);
        let square: f64 = reference.iter().map(|x| x * x).sum();
        if !(square > 0.0 && square.is_finite()) {
            return Err(Error::NotPositive { what: "length of a rigid link".into(), value: square.sqrt() });
        }
        let arm = Affine { nodes, weights, reference };
        Ok(vec![Constraint { pairs: vec![(arm.clone(), arm, 0.5)], value: 0.5 * square }])
    }

    fn is_grounded(&self) -> bool {
        matches!(self, RigidLink::Ground(..))
    }
}
