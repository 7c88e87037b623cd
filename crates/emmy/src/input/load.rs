//! Loads of a body.

use super::field::Field;
use super::time_function::TimeFunction;
use crate::error::Result;

/// A load: where it acts and how, with a factor over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Kind of the load.
    pub kind: LoadKind,
    /// Factor over time.
    pub time_function: TimeFunction,
}

impl Load {
    /// A load of constant size.
    pub fn new(kind: LoadKind) -> Self {
        Load { kind, time_function: TimeFunction::constant() }
    }

    /// A force \[force\] at each node of a group.
    pub fn nodal_force(group: impl Into<String>, force: [f64; 3]) -> Self {
        Load::new(LoadKind::NodalForce { group: group.into(), force })
    }

    /// A resultant \[force\] spread evenly over the reference area of a facet group.
    pub fn force(group: impl Into<String>, force: [f64; 3]) -> Self {
        Load::new(LoadKind::Force { group: group.into(), force })
    }

    /// A traction per reference area \[force/length^2\] on a facet group.
    pub fn traction(group: impl Into<String>, traction: [f64; 3]) -> Self {
        Load::new(LoadKind::Traction { group: group.into(), traction })
    }

    /// A moment \[force length\] on a rigid body, in the axes of space.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let wheel = RigidBody::new("wheel", 2.0, [0.0; 3], [0.1, 0.1, 0.18]);
    /// let turned = Load::moment("wheel", [0.0, 0.0, 0.36]);
    /// let body = Body::builder(Mesh::without_cells()).rigid(wheel).load(turned).build()?;
    /// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(2)?)?;
    /// let record = motion.step(0.1)?;
    /// assert!((record.angular_momentum[2] - 0.036).abs() < 1e-14); // M t
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn moment(body: impl Into<String>, moment: [f64; 3]) -> Self {
        Load::new(LoadKind::Moment { group: body.into(), moment, follow: false })
    }

    /// A moment \[force length\] that turns with a rigid body, in its axes, which are along x, y and z in the drawing.
    pub fn following_moment(body: impl Into<String>, moment: [f64; 3]) -> Self {
        Load::new(LoadKind::Moment { group: body.into(), moment, follow: true })
    }

    /// A force \[force\] at the centre of a rigid body that turns with it, in its axes, which are along x, y and z in
    /// the drawing. It has no potential; its work is that of other loads.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let puck = RigidBody::new("puck", 2.0, [0.0; 3], [0.1, 0.1, 0.18]);
    /// let thrust = Load::following_force("puck", [4.0, 0.0, 0.0]);
    /// let body = Body::builder(Mesh::without_cells()).rigid(puck).load(thrust).build()?;
    /// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(2)?)?;
    /// let record = motion.step(0.1)?;
    /// assert!((record.linear_momentum[0] - 0.4).abs() < 1e-13); // it does not turn: F t
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn following_force(body: impl Into<String>, force: [f64; 3]) -> Self {
        Load::new(LoadKind::FollowingForce { group: body.into(), force })
    }

    /// A pressure \[force/length^2\] on a facet group that follows the motion.
    pub fn pressure(group: impl Into<String>, pressure: f64) -> Self {
        Load::new(LoadKind::Pressure { group: group.into(), pressure })
    }

    /// An acceleration \[length/time^2\] of all masses, such as gravity.
    pub fn acceleration(acceleration: [f64; 3]) -> Self {
        Load::new(LoadKind::Acceleration { group: None, acceleration })
    }

    /// The centrifugal force on all masses, for an observer that turns about an axis (of any length) through a point,
    /// with a speed \[rad/time\]: for equilibria and their modes.
    ///
    /// A mass m on a spring k, its length r_0 along the radius: `r = k r_0/(k - m Omega^2)`.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// use emmy::equilibrium::Equilibrium;
    /// let line = JointKind::Line { to: [2.0, 0.0, 0.0] };
    /// let spring = Joint::new("spring", line, [JointEnd::Rigid("ball".into()), JointEnd::Ground], [1.0, 0.0, 0.0]);
    /// let body = Body::builder(Mesh::without_cells())
    ///     .rigid(RigidBody::point("ball", 2.0, [1.0, 0.0, 0.0]))
    ///     .joint(spring.with_spring(8.0, None))
    ///     .support(Support::of_components("ball", [false, true, true]))
    ///     .load(Load::rotation([0.0, 0.0, 1.0], [0.0; 3], 1.0))
    ///     .build()?;
    /// let state = Equilibrium::new(&body, 0.0, 1)?.start(NewtonSettings::default(), &[], &mut [])?;
    /// assert!((1.0 + state.displacement[0] - 8.0 / (8.0 - 2.0)).abs() < 1e-12);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn rotation(axis: [f64; 3], about: [f64; 3], speed: f64) -> Self {
        Load::new(LoadKind::Rotation { axis, about, speed })
    }

    /// The same load with a factor over time: a table of (time, factor).
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let pull = Load::nodal_force("right", [0.0, 0.0, -2.0]).over([(0.0, 0.0), (0.1, 1.0), (0.2, 0.0)])?;
    /// assert_eq!(pull.time_function.value(0.05), 0.5);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`TimeFunction::new`].
    pub fn over(self, table: impl Into<Vec<(f64, f64)>>) -> Result<Self> {
        Ok(self.with_time_function(TimeFunction::new(table.into())?))
    }

    /// The same load with a factor over time.
    pub fn with_time_function(self, time_function: TimeFunction) -> Self {
        Load { time_function, ..self }
    }
}

/// Kind of a load. All are dead, they keep their direction while the body turns, but the pressure, the rotation, and
/// the moments and forces that follow a rigid body.
///
/// ```
/// use emmy::prelude::*;
/// let weight = Load::new(LoadKind::Acceleration { group: None, acceleration: [0.0, 0.0, -9.81] });
/// assert_eq!(weight, Load::acceleration([0.0, 0.0, -9.81]));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum LoadKind {
    /// Traction per reference area \[force/length^2\] on a facet group.
    Traction {
        /// Facet group.
        group: String,
        /// Traction.
        traction: [f64; 3],
    },
    /// Pressure \[force/length^2\] on a facet group that follows the motion: it acts along the current normal on the
    /// current area, and pushes onto the body where it is positive.
    ///
    /// ```math
    /// F_A = - p(t) integral N_A (q_,xi x q_,eta) dxi deta
    /// ```
    Pressure {
        /// Facet group.
        group: String,
        /// Pressure.
        pressure: f64,
    },
    /// Resultant \[force\] spread evenly over the reference area of a facet group.
    Force {
        /// Facet group.
        group: String,
        /// Resultant.
        force: [f64; 3],
    },
    /// Traction per reference area \[force/length^2\] on a facet group, by a function of reference position and time.
    TractionField {
        /// Facet group.
        group: String,
        /// Traction.
        field: Field,
    },
    /// Force per reference volume \[force/length^3\] on a cell group, by a function of reference position and time.
    BodyForceField {
        /// Cell group; `None`: all cells.
        group: Option<String>,
        /// Body force.
        field: Field,
    },
    /// Force \[force\] at each node of a group: n nodes carry n times the force.
    NodalForce {
        /// Group of nodes, facets or cells.
        group: String,
        /// Force at each node.
        force: [f64; 3],
    },
    /// Moment \[force length\] on a rigid body.
    Moment {
        /// Name of the rigid body.
        group: String,
        /// Moment, in the axes of space; if it follows, in those of the body, which are the same in the drawing.
        moment: [f64; 3],
        /// Whether it turns with the body.
        follow: bool,
    },
    /// Force \[force\] at the centre of a rigid body that turns with it.
    FollowingForce {
        /// Name of the rigid body.
        group: String,
        /// Force in the axes of the body, which are along x, y and z in the drawing.
        force: [f64; 3],
    },
    /// Acceleration \[length/time^2\] of every mass of a cell group, such as gravity; of all masses, point masses
    /// included, without a group.
    Acceleration {
        /// Cell group; `None`: all cells.
        group: Option<String>,
        /// Acceleration.
        acceleration: [f64; 3],
    },
    /// Centrifugal force on all masses, for an observer that turns with `Omega a` about the line through c: the body
    /// is at rest in the observer's axes, in which supports, springs and other loads are given, too. It acts on the
    /// positions q, with `P = 1 - a a^T`:
    ///
    /// ```math
    /// F_A = Omega^2 sum_B M_AB P (q_B - c)
    /// ```
    ///
    /// It is the gradient of the potential `Omega^2/2 (q - c) . M P (q - c)`. In a motion the body itself turns, so
    /// motions reject it.
    Rotation {
        /// Axis, of any length.
        axis: [f64; 3],
        /// A point c on the axis \[length\].
        about: [f64; 3],
        /// Speed Omega \[rad/time\].
        speed: f64,
    },
    /// Acceleration \[length/time^2\] of every mass of a cell group, by a function of reference position and time; of
    /// all masses, point masses included, without a group.
    ///
    /// ```math
    /// F_A = integral rho N_A f(X, t) dV
    /// ```
    AccelerationField {
        /// Cell group; `None`: all cells.
        group: Option<String>,
        /// Acceleration.
        field: Field,
    },
}

/// Where a load by a field acts.
///
/// ```
/// use emmy::body::{Field, FieldDomain, LoadKind};
/// let wind = LoadKind::TractionField { group: "x-max".into(), field: Field::new(|_, t| [t, 0.0, 0.0]) };
/// assert_eq!(wind.field().unwrap().1, FieldDomain::Facets("x-max"));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldDomain<'a> {
    /// A facet group.
    Facets(&'a str),
    /// The volume of a cell group; `None`: all cells.
    Cells(Option<&'a str>),
    /// The masses of a cell group; `None`: all masses.
    Masses(Option<&'a str>),
}

impl LoadKind {
    /// Whether it acts on mass or volume, not on a surface or at single nodes.
    pub(crate) fn acts_on_mass(&self) -> bool {
        use LoadKind::{Acceleration, AccelerationField, BodyForceField};
        matches!(self, Acceleration { .. } | AccelerationField { .. } | BodyForceField { .. })
    }

    /// Whether it is the force that an observer sees who turns.
    pub(crate) fn turns_observer(&self) -> bool {
        matches!(self, LoadKind::Rotation { .. })
    }

    /// The function of position and time of a load by a field, and where it acts.
    ///
    /// ```
    /// use emmy::body::{Field, FieldDomain, LoadKind};
    /// let field = Field::named("0, 0, t", |_, t| [0.0, 0.0, t]);
    /// let kind = LoadKind::BodyForceField { group: None, field: field.clone() };
    /// assert_eq!(kind.field(), Some((&field, FieldDomain::Cells(None))));
    /// ```
    pub fn field(&self) -> Option<(&Field, FieldDomain<'_>)> {
        match self {
            LoadKind::TractionField { group, field } => Some((field, FieldDomain::Facets(group))),
            LoadKind::BodyForceField { group, field } => Some((field, FieldDomain::Cells(group.as_deref()))),
            LoadKind::AccelerationField { group, field } => {
                Some((field, FieldDomain::Masses(group.as_deref())))
            }
            LoadKind::Traction { .. }
            | LoadKind::Pressure { .. }
            | LoadKind::Force { .. }
            | LoadKind::NodalForce { .. }
            | LoadKind::Moment { .. }
            | LoadKind::FollowingForce { .. }
            | LoadKind::Rotation { .. }
            | LoadKind::Acceleration { .. } => None,
        }
    }
}
