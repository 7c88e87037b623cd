//! Supports of a body.

use super::time_function::TimeFunction;
use crate::error::Result;
use crate::mesh::Mesh;

/// Components of a group with a given motion: at rest, or driven.
///
/// ```
/// use emmy::prelude::*;
/// let rate = TimeFunction::smooth("0.1*t", |t| [0.1 * t, 0.1, 0.0]);
/// let support = Support { group: "x-max".into(), displacement: [Some(rate), None, None], ..Default::default() };
/// assert!(support.is_driven());
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Support {
    /// Group of nodes, facets or cells.
    pub group: String,
    /// Components x, y, z at rest.
    pub fix: [bool; 3],
    /// Displacement of driven components over time \[length\]: without jumps, with a rate, and zero at the start.
    pub displacement: [Option<TimeFunction>; 3],
    /// Rotation that drives all components.
    pub rotation: Option<Rotation>,
    /// Whether the facets of the group lie in a plane of symmetry, normal to a coordinate axis, and stay in it.
    pub symmetry: bool,
    /// Time of release. The momentum is continuous there; a step should end at this time.
    pub until: Option<f64>,
}

impl Support {
    /// A support that holds all components of a group.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// assert_eq!(Support::fixed("left").fix, [true; 3]);
    /// ```
    pub fn fixed(group: impl Into<String>) -> Self {
        Support::of_components(group, [true; 3])
    }

    /// A support that holds some components of a group.
    pub fn of_components(group: impl Into<String>, fix: [bool; 3]) -> Self {
        Support { group: group.into(), fix, ..Default::default() }
    }

    /// A plane of symmetry through the facets of a group.
    pub fn symmetry(group: impl Into<String>) -> Self {
        Support { group: group.into(), symmetry: true, ..Default::default() }
    }

    /// A support that moves the nodes of a group by a displacement over time, in the components that are given.
    pub fn driven(group: impl Into<String>, displacement: [Option<TimeFunction>; 3]) -> Self {
        Support { group: group.into(), displacement, ..Default::default() }
    }

    /// The same support, released at a time.
    pub fn until(self, time: f64) -> Self {
        Support { until: Some(time), ..self }
    }

    /// Components at rest: `fix`, and the normal of the plane of symmetry.
    ///
    /// # Errors
    /// As [`crate::input::symmetry::symmetry_axis`].
    pub fn fixed_components(&self, mesh: &Mesh) -> Result<[bool; 3]> {
        let mut fixed = self.fix;
        if self.symmetry {
            fixed[crate::input::symmetry::symmetry_axis(mesh, &self.group)?] = true;
        }
        Ok(fixed)
    }

    /// Whether the support drives anything.
    pub fn is_driven(&self) -> bool {
        self.time_functions().next().is_some()
    }

    /// Whether the support drives a component.
    pub fn drives(&self, component: usize) -> bool {
        self.rotation.is_some() || self.displacement[component].is_some()
    }

    /// Whether the given motion has a component along z.
    pub(crate) fn leaves_plane(&self) -> bool {
        let about_z = |rotation: &Rotation| rotation.axis[..2] == [0.0; 2];
        self.displacement[2].is_some() || self.rotation.as_ref().is_some_and(|rotation| !about_z(rotation))
    }

    /// The time functions of the given motion.
    pub fn time_functions(&self) -> impl Iterator<Item = &TimeFunction> + '_ {
        self.displacement.iter().flatten().chain(self.rotation.as_ref().map(|rotation| &rotation.angle))
    }
}

/// Rotation of a group, `q = about + R(angle) (X - about)`, with the displacement of the support added to it.
///
/// ```
/// use emmy::prelude::*;
/// // A turn about z by t radian.
/// let turn = Rotation { axis: [0.0, 0.0, 1.0], about: [0.0; 3], angle: TimeFunction::smooth("t", |t| [t, 1.0, 0.0]) };
/// assert_eq!((turn.angle.value(0.5), turn.angle.rate(0.5)), (0.5, 1.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rotation {
    /// Direction of the axis, of any length.
    pub axis: [f64; 3],
    /// A point of the axis \[length\].
    pub about: [f64; 3],
    /// Angle over time \[radian\]: without jumps, with a rate, and zero at the start.
    pub angle: TimeFunction,
}
