//! The places of joints: points and directions of rigid bodies, nodes, and the ground.

use super::affine::Affine;
use super::frame::Frame;
use crate::input::JointEnd;
use crate::mesh::{Mesh, distance};
use crate::number::short_vector;

/// The places of a body to which joints are attached.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Attachments<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frames: &'a [Frame],
}

/// Distance between the place of a joint and its node, over the size of the mesh, that is rounding.
const SAME_PLACE: f64 = 1e-9;

impl Attachments<'_> {
    /// A point of one end.
    ///
    /// # Errors
    /// The fault of the end.
    pub(crate) fn point(&self, end: &JointEnd, point: [f64; 3]) -> Result<Affine, String> {
        match end {
            JointEnd::Ground => Ok(Affine::constant(point)),
            JointEnd::Rigid(name) => {
                let frame = self.frame(name)?;
                let found = frame.point(point);
                found.ok_or_else(|| {
                    let centre = short_vector(frame.centre());
                    format!("\"{name}\" is a point at {centre}; give an inertia, or place the joint there")
                })
            }
            JointEnd::Node(node) => {
                let X = self.mesh.points().get(*node as usize);
                let X = *X.ok_or_else(|| format!("node {node} does not exist"))?;
                if distance(X, point) > SAME_PLACE * self.mesh.diagonal() {
                    let [X, point] = [X, point].map(short_vector);
                    return Err(format!("its node lies at {X}, not at {point}"));
                }
                Ok(Affine { nodes: vec![*node], weights: vec![1.0], reference: point })
            }
        }
    }

    /// A direction of one end.
    ///
    /// # Errors
    /// The fault of the end.
    pub(crate) fn vector(&self, end: &JointEnd, direction: [f64; 3]) -> Result<Affine, String> {
        match end {
            JointEnd::Ground => Ok(Affine::constant(direction)),
            JointEnd::Rigid(name) => {
                let found = self.frame(name)?.vector(direction);
                found.ok_or_else(|| {
                    format!("\"{name}\" has no inertia, so it is a point and has no direction")
                })
            }
            JointEnd::Node(_) => Err("a node has no direction; a spherical joint takes it".to_string()),
        }
    }

    fn frame(&self, name: &str) -> Result<&Frame, String> {
        let found = self.frames.iter().find(|frame| frame.name() == name);
        found.ok_or_else(|| format!("there is no rigid body \"{name}\""))
    }
}
