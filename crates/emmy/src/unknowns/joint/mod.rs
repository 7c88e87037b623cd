//! Joints as constraints on two bodies. Each kind has its own file.

mod cylindrical;
mod distance;
mod drive;
mod fixed;
mod inline;
mod measure;
mod planar;
mod prismatic;
mod revolute;
mod spherical;
mod universal;

pub(crate) use measure::{MAX_DOFS, Measure};

use super::affine::Affine;
use super::attachments::Attachments;
use super::constraint::{Constraint, Coordinate, Drive};
use crate::error::{Error, Result};
use crate::input::{Joint, JointKind, TimeFunction};
use crate::tensor::{cross, dot3};

/// A joint on the nodes of a body.
#[derive(Debug)]
pub(crate) struct JointParts {
    pub constraints: Vec<Constraint>,
    /// The point of each body.
    pub points: [Affine; 2],
    /// The coordinate that it leaves, if it has one.
    pub measure: Option<Measure>,
    /// The slide of a cylindrical joint, its second one.
    pub slide: Option<Measure>,
}

impl JointParts {
    /// The parts of a joint with a number.
    ///
    /// # Errors
    /// [`Error::Joint`].
    pub(crate) fn new(joint: &Joint, number: usize, attachments: &Attachments<'_>) -> Result<Self> {
        let ends = Ends { joint, attachments };
        if joint.between[0] == joint.between[1] {
            return Err(ends.fault("it is between a body and itself"));
        }
        let constraints = match joint.kind {
            JointKind::Spherical => spherical::constraints(&ends),
            JointKind::Revolute { axis } => revolute::constraints(&ends, ends.triad(axis)?),
            JointKind::Universal { axes } => universal::constraints(&ends, axes),
            JointKind::Cylindrical { axis } => cylindrical::constraints(&ends, ends.triad(axis)?),
            JointKind::Prismatic { axis } => prismatic::constraints(&ends, ends.triad(axis)?),
            JointKind::Inline { axis } => inline::constraints(&ends, ends.triad(axis)?),
            JointKind::Planar { axis } => planar::constraints(&ends, ends.triad(axis)?),
            JointKind::Fixed => fixed::constraints(&ends),
            JointKind::Distance { to } => distance::constraints(&ends, to),
            JointKind::Line { .. } => Ok(Vec::new()),
        }?;
        let to = match joint.kind {
            JointKind::Distance { to } | JointKind::Line { to } => to,
            _ => joint.at,
        };
        let points = [ends.point(0, joint.at)?, ends.point(1, to)?];
        let (measure, slide) = (ends.measure()?, ends.second_measure()?);
        let mut parts = JointParts { constraints, points, measure, slide };
        if let Some(law) = &joint.drive {
            drive::add(&ends, number, law, &mut parts)?;
        }
        Ok(parts)
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

    /// The coordinate that the joint leaves.
    fn measure(&self) -> Result<Option<Measure>> {
        Ok(match self.joint.kind {
            JointKind::Revolute { axis } | JointKind::Cylindrical { axis } => {
                let [_, first, second] = self.triad(axis)?;
                let own = self.vector(0, first)?;
                Some(Measure::angle(&own, [self.vector(1, first)?, self.vector(1, second)?]))
            }
            JointKind::Prismatic { axis } => {
                Some(Measure::slide(self.offset()?, self.vector(1, self.unit(axis)?)?))
            }
            JointKind::Distance { to } | JointKind::Line { to } => {
                let arm = self.point(0, self.joint.at)?.less(&self.point(1, to)?);
                if dot3(arm.reference, arm.reference) == 0.0 {
                    let reason = "its points coincide; a distance needs two points, a spherical joint one";
                    return Err(self.fault(reason));
                }
                Some(Measure::distance(arm))
            }
            _ => None,
        })
    }

    /// The slide of a cylindrical joint.
    fn second_measure(&self) -> Result<Option<Measure>> {
        let JointKind::Cylindrical { axis } = self.joint.kind else { return Ok(None) };
        Ok(Some(Measure::slide(self.offset()?, self.vector(1, self.unit(axis)?)?)))
    }

    /// Points in common.
    fn meet(&self) -> Result<Vec<Constraint>> {
        let offset = self.offset()?;
        let along = |d: usize| {
            let mut axis = [0.0; 3];
            axis[d] = 1.0;
            Constraint::new(vec![(offset.clone(), Affine::constant(axis), 1.0)], 0.0)
        };
        Ok([0, 1, 2].map(along).to_vec())
    }

    /// The offset of the points has no component along directions of the second body.
    fn no_offset_along(&self, directions: &[[f64; 3]]) -> Result<Vec<Constraint>> {
        let offset = self.offset()?;
        let row = |&direction: &[f64; 3]| {
            Ok(Constraint::new(vec![(offset.clone(), self.vector(1, direction)?, 1.0)], 0.0))
        };
        directions.iter().map(row).collect()
    }

    /// Directions of the first body keep their angle to others of the second.
    fn keep_angles(&self, pairs: &[([f64; 3], [f64; 3])]) -> Result<Vec<Constraint>> {
        let row = |&(own, other): &([f64; 3], [f64; 3])| {
            Ok(Constraint::new(vec![(self.vector(0, own)?, self.vector(1, other)?, 1.0)], dot3(own, other)))
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
