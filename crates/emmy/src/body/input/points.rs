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
/// with the lumped masses m_A ([`crate::body::Body::lumped_mass`]).
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
