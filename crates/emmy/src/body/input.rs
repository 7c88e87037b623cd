//! Parts of a body besides its mesh: regions, supports, loads, initial velocity. Plain data.

use super::{Field, TimeFunction, Viscosity, solid::RegionMaterial};
use crate::error::Result;
use crate::material::{Link, Material};
use crate::mesh::Mesh;

/// Part of the body with one material and density.
#[derive(Debug)]
pub struct Region {
    /// Cell group; `None`: every cell.
    pub group: Option<String>,
    /// Reference density \[mass/length^3\].
    pub density: f64,
    /// Thickness of its plane cells \[length\]; 1 unless it is set.
    pub thickness: f64,
    /// Viscosity; none unless it is set. Links have [`Viscosity::time`] only.
    pub viscosity: Viscosity,
    pub(super) material: RegionMaterial,
}

impl Region {
    /// The region of all cells, of a material with a reference density \[mass/length^3\].
    pub fn new(material: impl Material, density: f64) -> Self {
        Region::of(RegionMaterial::Solid(material.compiled()), density)
    }

    /// The region of all cells, with links. Bars need the density; springs and attractions have no mass.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let mesh = Mesh::from_cells(CellKind::Line2, &[[0.0; 3], [3.0, 4.0, 0.0]], &[[0, 1]])?;
    /// let bar = Region::links(Link::bar(1000.0, 0.1)?, 2.0);
    /// assert!((Body::builder(mesh).region(bar).build()?.regions()[0].mass - 1.0).abs() < 1e-15);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn links(link: Link, density: f64) -> Self {
        Region::of(RegionMaterial::Link(link), density)
    }

    fn of(material: RegionMaterial, density: f64) -> Self {
        Region { group: None, density, thickness: 1.0, viscosity: Viscosity::default(), material }
    }

    /// The same region on the cells of a group.
    pub fn on(self, group: impl Into<String>) -> Self {
        Region { group: Some(group.into()), ..self }
    }

    /// The link of a region of links.
    pub fn link(&self) -> Option<Link> {
        match self.material {
            RegionMaterial::Solid(_) => None,
            RegionMaterial::Link(link) => Some(link),
        }
    }

    /// The same region with another thickness of its plane cells.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let plate = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0).with_thickness(0.1);
    /// let body = Body::builder(mesh::rectangle([3.0, 4.0], [3, 4])?).region(plate).build()?;
    /// assert!((body.regions()[0].mass - 2.4).abs() < 1e-14);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn with_thickness(self, thickness: f64) -> Self {
        Region { thickness, ..self }
    }

    /// The same region with a viscosity.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let viscosity = Viscosity { time: 1e-3, ..Viscosity::default() };
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0).with_viscosity(viscosity);
    /// assert!(Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?.is_viscous());
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn with_viscosity(self, viscosity: Viscosity) -> Self {
        Region { viscosity, ..self }
    }
}

/// Masses and forces at single nodes.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::body::{GroundSpring, PointTerms};
/// let points = PointTerms {
///     masses: vec![PointMass { group: "tip".into(), mass: 2.0 }],
///     springs: vec![GroundSpring { group: "tip".into(), stiffness: 50.0 }],
///     ..PointTerms::default()
/// };
/// let spring = Region::links(Link::spring(1.0, None)?, 0.0);
/// let mesh = Mesh::from_cells(CellKind::Line2, &[[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]])?
///     .with_node_group("left", [0])?
///     .with_node_group("tip", [1])?;
/// let body = Body::builder(mesh).region(spring).point_terms(points).support(Support::fixed("left")).build()?;
/// assert_eq!(body.lumped_mass(), [0.0, 2.0]);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PointTerms {
    /// Point masses.
    pub masses: Vec<PointMass>,
    /// Springs to the ground.
    pub springs: Vec<GroundSpring>,
    /// Attraction to points of space.
    pub attractions: Vec<GroundAttraction>,
}

/// A mass at every node of a group.
///
/// ```
/// use emmy::body::PointMass;
/// assert_eq!(PointMass { group: "tip".into(), mass: 2.0 }.mass, 2.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PointMass {
    /// Group of nodes, facets or cells.
    pub group: String,
    /// Mass of each node \[mass\].
    pub mass: f64,
}

/// Springs from the nodes of a group to the ground, equal in all directions and at rest in the reference configuration.
///
/// ```math
/// V = 1/2 sum_A k_A |u_A|^2
/// ```
///
/// In a group of facets `k_A = k integral N_A dA`, k being a stiffness per reference area \[force/length^3\]; else k
/// for each node \[force/length\].
///
/// ```
/// use emmy::body::GroundSpring;
/// let bedding = GroundSpring { group: "z-min".into(), stiffness: 200.0 };
/// assert_eq!(bedding.stiffness, 200.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GroundSpring {
    /// Group of nodes, facets or cells.
    pub group: String,
    /// Stiffness k.
    pub stiffness: f64,
}

/// Attraction of all masses of a group to a point of space, such as a heavy star.
///
/// ```math
/// V = -sum_A g m_A / |q_A - c|
/// ```
///
/// with the lumped masses m_A ([`super::Body::lumped_mass`]).
///
/// ```
/// use emmy::body::GroundAttraction;
/// let star = GroundAttraction { group: None, centre: [0.0; 3], strength: 4.0 };
/// assert_eq!(star.strength, 4.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GroundAttraction {
    /// Group of nodes, facets or cells; `None`: all nodes.
    pub group: Option<String>,
    /// The point c \[length\].
    pub centre: [f64; 3],
    /// Strength g; for a star, the constant of gravitation times its mass \[length^3/time^2\].
    pub strength: f64,
}

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
    /// Displacement of driven components over time \[length\]: without jumps, and zero at the start.
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
    /// As [`super::symmetry::symmetry_axis`].
    pub fn fixed_components(&self, mesh: &Mesh) -> Result<[bool; 3]> {
        let mut fixed = self.fix;
        if self.symmetry {
            fixed[super::symmetry::symmetry_axis(mesh, &self.group)?] = true;
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
    pub(super) fn leaves_plane(&self) -> bool {
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
    /// Angle over time \[radian\]: without jumps, and zero at the start.
    pub angle: TimeFunction,
}

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

    /// A pressure \[force/length^2\] on a facet group that follows the motion.
    pub fn pressure(group: impl Into<String>, pressure: f64) -> Self {
        Load::new(LoadKind::Pressure { group: group.into(), pressure })
    }

    /// An acceleration \[length/time^2\] of all masses, such as gravity.
    pub fn acceleration(acceleration: [f64; 3]) -> Self {
        Load::new(LoadKind::Acceleration { group: None, acceleration })
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

/// Kind of a load. All but the pressure are dead: they keep their direction while the body turns.
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
    /// Acceleration \[length/time^2\] of every mass of a cell group, such as gravity; of all masses, point masses
    /// included, without a group.
    Acceleration {
        /// Cell group; `None`: all cells.
        group: Option<String>,
        /// Acceleration.
        acceleration: [f64; 3],
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
    /// A cell group; `None`: all cells.
    Cells(Option<&'a str>),
}

impl LoadKind {
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
            LoadKind::Traction { .. }
            | LoadKind::Pressure { .. }
            | LoadKind::Force { .. }
            | LoadKind::NodalForce { .. }
            | LoadKind::Acceleration { .. } => None,
        }
    }
}

/// Initial velocity field of a group.
///
/// ```math
/// v(X) = velocity + angular_velocity x (X - about) + gradient X
/// ```
///
/// ```
/// use emmy::prelude::*;
/// let spin = InitialVelocity { angular_velocity: [0.0, 0.0, 2.0], ..InitialVelocity::default() };
/// assert_eq!(spin.at([3.0, 0.0, 0.0]), [0.0, 6.0, 0.0]);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InitialVelocity {
    /// Group of nodes, facets or cells; `None`: all nodes.
    pub group: Option<String>,
    /// Velocity \[length/time\].
    pub velocity: [f64; 3],
    /// Angular velocity \[1/time\].
    pub angular_velocity: [f64; 3],
    /// Centre of the rotation \[length\].
    pub about: [f64; 3],
    /// Velocity gradient \[1/time\], row by row.
    pub gradient: [[f64; 3]; 3],
}

impl InitialVelocity {
    /// The velocity at a reference position.
    pub fn at(&self, X: [f64; 3]) -> [f64; 3] {
        let r = [0, 1, 2].map(|i| X[i] - self.about[i]);
        let w = self.angular_velocity;
        let rotation = [w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]];
        [0, 1, 2].map(|i| {
            let stretching: f64 = (0..3).map(|j| self.gradient[i][j] * X[j]).sum();
            self.velocity[i] + rotation[i] + stretching
        })
    }
}
