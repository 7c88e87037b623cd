//! Joints between rigid bodies, nodes and the ground.

use super::time_function::TimeFunction;

/// A joint of two bodies, as they are drawn.
///
/// ```
/// use emmy::prelude::*;
/// let between = [JointEnd::Rigid("door".into()), JointEnd::Ground];
/// let hinge = Joint::new("hinge", JointKind::Revolute { axis: [0.0, 0.0, 1.0] }, between, [0.0; 3]);
/// assert_eq!(hinge.kind.word(), "revolute");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Its kind, which says how the bodies move against each other.
    pub kind: JointKind,
    /// The two bodies.
    pub between: [JointEnd; 2],
    /// A point of both; of the first body, if the kind has two points \[length\].
    pub at: [f64; 3],
    /// Given motion: the angle of the first body about the axis of the second \[rad\], its slide along the axis
    /// \[length\], or the change of the distance \[length\]. Without jumps, and zero at the start.
    pub drive: Option<TimeFunction>,
    /// A spring in the coordinate.
    pub spring: Option<JointSpring>,
    /// Damping of the coordinate, force or torque over its rate.
    pub damping: f64,
    /// Torque about the axis, force along it, or force that opens the distance, on the first body, over time.
    pub motor: Option<TimeFunction>,
    /// Time of release, from which on it exerts nothing; a step should end there.
    pub until: Option<f64>,
}

/// A spring in the angle, the slide or the distance of a joint: the energy `stiffness (x - rest)^2 / 2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointSpring {
    /// Stiffness, force over length or torque over angle.
    pub stiffness: f64,
    /// Coordinate without a force: an angle or a slide from the drawing, a distance; `None`: as drawn.
    pub rest: Option<f64>,
}

/// One of the two bodies of a joint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum JointEnd {
    /// The ground.
    Ground,
    /// A node of the mesh, which has no direction.
    Node(u32),
    /// A rigid body, or the point of a distributing coupling, by its name.
    Rigid(String),
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
    /// The distance between a point of each: a rigid link without mass.
    Distance {
        /// The point of the second body \[length\].
        to: [f64; 3],
    },
    /// A line between a point of each, without a constraint: it carries a spring, a damping or a motor.
    Line {
        /// The point of the second body \[length\].
        to: [f64; 3],
    },
}

impl Joint {
    /// A joint without a drive.
    pub fn new(name: impl Into<String>, kind: JointKind, between: [JointEnd; 2], at: [f64; 3]) -> Self {
        let (drive, spring, motor, until) = (None, None, None, None);
        Joint { name: name.into(), kind, between, at, drive, spring, damping: 0.0, motor, until }
    }

    /// The same joint with a spring.
    pub fn with_spring(self, stiffness: f64, rest: Option<f64>) -> Self {
        Joint { spring: Some(JointSpring { stiffness, rest }), ..self }
    }

    /// The same joint with a damping.
    pub fn with_damping(self, damping: f64) -> Self {
        Joint { damping, ..self }
    }

    /// The same joint with a torque or force over time.
    pub fn with_motor(self, motor: TimeFunction) -> Self {
        Joint { motor: Some(motor), ..self }
    }

    /// Whether a spring, a damping or a motor acts in it.
    pub fn has_force(&self) -> bool {
        self.spring.is_some() || self.damping != 0.0 || self.motor.is_some()
    }

    /// The same joint with a given motion.
    pub fn driven(self, drive: TimeFunction) -> Self {
        Joint { drive: Some(drive), ..self }
    }

    /// The same joint, released at a time.
    pub fn until(self, time: f64) -> Self {
        Joint { until: Some(time), ..self }
    }
}

impl JointKind {
    /// Its name.
    pub fn word(self) -> &'static str {
        match self {
            JointKind::Spherical => "spherical",
            JointKind::Revolute { .. } => "revolute",
            JointKind::Universal { .. } => "universal",
            JointKind::Cylindrical { .. } => "cylindrical",
            JointKind::Prismatic { .. } => "prismatic",
            JointKind::Inline { .. } => "inline",
            JointKind::Planar { .. } => "planar",
            JointKind::Fixed => "fixed",
            JointKind::Distance { .. } => "distance",
            JointKind::Line { .. } => "line",
        }
    }

    /// The coordinate that its joint leaves and a drive may give: `angle`, `slide` or `distance`.
    pub fn coordinate(self) -> Option<&'static str> {
        match self {
            JointKind::Revolute { .. } | JointKind::Cylindrical { .. } => Some("angle"),
            JointKind::Prismatic { .. } => Some("slide"),
            JointKind::Distance { .. } | JointKind::Line { .. } => Some("distance"),
            _ => None,
        }
    }
}
