//! Masses and forces at single nodes.

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
    /// Masses that are spread.
    pub spread: Vec<SpreadMass>,
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

/// A mass spread evenly over a group: by area over facets, by volume over cells, by length over links, and in equal
/// parts over nodes; of the first of these kinds that the group has.
///
/// ```math
/// M_AB = rho integral N_A N_B dA,      rho = m / integral dA
/// ```
///
/// So its centre and its inertia are those of the area or volume, however uneven the mesh is, as if it were a density
/// of the cells. With the thickness of plane cells; links count with their length alone, and cannot share a group with
/// other cells.
///
/// ```
/// use emmy::body::{PointTerms, SpreadMass};
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
/// let points = PointTerms { spread: vec![SpreadMass { group: "z-max".into(), total: 6.0 }], ..Default::default() };
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).point_terms(points).build()?;
/// assert!((body.lumped_mass().iter().sum::<f64>() - 7.0).abs() < 1e-14);
/// let plate = &body.regions()[1];
/// assert!((plate.centre[2] - 1.0).abs() < 1e-15 && (plate.inertia[2][2] - 1.0).abs() < 1e-14); // m (a^2 + b^2) / 12
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SpreadMass {
    /// Group of facets, cells or nodes.
    pub group: String,
    /// Mass of the whole group \[mass\].
    pub total: f64,
}

/// Springs from the nodes of a group to the ground, equal in all directions and at rest in the reference configuration.
///
/// ```math
/// nodes: V = k/2 sum_A |u_A|^2      facets: V = k/2 integral |u|^2 dA
/// ```
///
/// In a group of facets k is a stiffness per reference area \[force/length^3\], which couples their nodes; else k for
/// each node \[force/length\].
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
/// with the row sums m_A of the consistent mass, so that a uniform attraction gives all nodes the same acceleration;
/// they may be negative at corners of quadratic cells. With central differences m_A are the lumped masses
/// ([`crate::body::Body::lumped`]).
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
