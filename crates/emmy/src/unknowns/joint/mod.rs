//! Joints as constraints on two bodies. Each kind has its own file.

mod cylindrical;
mod fixed;
mod inline;
mod planar;
mod prismatic;
mod revolute;
mod spherical;
mod universal;

use super::affine::Affine;
use super::attachments::{Attachments, JointEnd};
use super::constraint::Constraint;
use super::source::ConstraintSource;
use crate::error::{Error, Result};
use crate::tensor::cross;

/// A joint of two bodies, as they are drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name, for messages.
    pub name: String,
    /// Its kind, which says how the bodies move against each other.
    pub kind: JointKind,
    /// The two bodies.
    pub between: [JointEnd; 2],
    /// A point of both \[length\].
    pub at: [f64; 3],
}

/// Kinds of joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// A point in common.
    Spherical,
    /// A point and an axis in common.
    Revolute {
        /// Direction of the axis.
        axis: [f64; 3],
    },
    /// A point in common, and an angle between an axis of each.
    Universal {
        /// An axis of the first body and one of the second.
        axes: [[f64; 3]; 2],
    },
    /// An axis in common, along which they slide.
    Cylindrical {
        /// Direction of the axis.
        axis: [f64; 3],
    },
    /// An axis in common, along which they slide without turning.
    Prismatic {
        /// Direction of the axis.
        axis: [f64; 3],
    },
    /// A point of the first body on an axis of the second.
    Inline {
        /// Direction of the axis.
        axis: [f64; 3],
    },
    /// A plane in common.
    Planar {
        /// Normal of the plane.
        axis: [f64; 3],
    },
    /// All in common.
    Fixed,
}

impl ConstraintSource for Joint {
    fn constraints(&self, attachments: &Attachments<'_>) -> Result<Vec<Constraint>> {
        let ends = Ends { joint: self, attachments };
        match self.kind {
            JointKind::Spherical => spherical::constraints(&ends),
            JointKind::Revolute { axis } => revolute::constraints(&ends, ends.triad(axis)?),
            JointKind::Universal { axes } => universal::constraints(&ends, axes),
            JointKind::Cylindrical { axis } => cylindrical::constraints(&ends, ends.triad(axis)?),
            JointKind::Prismatic { axis } => prismatic::constraints(&ends, ends.triad(axis)?),
            JointKind::Inline { axis } => inline::constraints(&ends, ends.triad(axis)?),
            JointKind::Planar { axis } => planar::constraints(&ends, ends.triad(axis)?),
            JointKind::Fixed => fixed::constraints(&ends),
        }
    }

    fn is_grounded(&self) -> bool {
        self.between.contains(&JointEnd::Ground)
    }
}

/// The bodies of a joint: points and vectors of the first and the second.
struct Ends<'a> {
    joint: &'a Joint,
    attachments: &'a Attachments<'a>,
}

/// An axis a with two normals e_1, e_2, all of unit length.
type Triad = [[f64; 3]; 3];

impl Ends<'_> {
    fn point(&self, end: usize, point: [f64; 3]) -> Result<Affine> {
        self.attachments.point(&self.joint.between[end], point).map_err(|reason| self.fault(reason))
    }

    fn vector(&self, end: usize, direction: [f64; 3]) -> Result<Affine> {
        self.attachments.vector(&self.joint.between[end], direction).map_err(|reason| self.fault(reason))
    }

    /// The point of the first body less that of the second.
    fn offset(&self) -> Result<Affine> {
        Ok(self.point(0, self.joint.at)?.less(&self.point(1, self.joint.at)?))
    }

    /// Points in common.
    fn meet(&self) -> Result<Vec<Constraint>> {
        let offset = self.offset()?;
        let along = |d: usize| {
            let mut axis = [0.0; 3];
            axis[d] = 1.0;
            Constraint { pairs: vec![(offset.clone(), Affine::constant(axis), 1.0)], value: 0.0 }
        };
        Ok([0, 1, 2].map(along).to_vec())
    }

    /// The offset of the points has no component along directions of the second body.
    fn no_offset_along(&self, directions: &[[f64; 3]]) -> Result<Vec<Constraint>> {
        let offset = self.offset()?;
        let row = |&direction: &[f64; 3]| {
            Ok(Constraint { pairs: vec![(offset.clone(), self.vector(1, direction)?, 1.0)], value: 0.0 })
        };
        directions.iter().map(row).collect()
    }

    /// Directions of the first body keep their angle to others of the second.
    fn keep_angles(&self, pairs: &[([f64; 3], [f64; 3])]) -> Result<Vec<Constraint>> {
        let row = |&(own, other): &([f64; 3], [f64; 3])| {
            let value = (0..3).map(|d| own[d] * other[d]).sum();
            Ok(Constraint { pairs: vec![(self.vector(0, own)?, self.vector(1, other)?, 1.0)], value })
        };
        pairs.iter().map(row).collect()
    }

    /// A triad: e is the coordinate axis with the smallest component along a (the first, if equal),
    /// e_1 = a x e / |a x e|, e_2 = a x e_1.
    fn triad(&self, axis: [f64; 3]) -> Result<Triad> {
        let a = self.unit(axis)?;
        let least = (0..3).fold(0, |least, d| if a[d].abs() < a[least].abs() { d } else { least });
        let mut e = [0.0; 3];
        e[least] = 1.0;
        let first = self.unit(cross(a, e))?;
        Ok([a, first, cross(a, first)])
    }

    fn unit(&self, axis: [f64; 3]) -> Result<[f64; 3]> {
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 && length.is_finite() {
            return Ok(axis.map(|x| x / length));
        }
        Err(self.fault("its axis must have a direction"))
    }

    fn fault(&self, reason: impl Into<String>) -> Error {
        Error::Joint { joint: self.joint.name.clone(), reason: reason.into() }
    }
}
