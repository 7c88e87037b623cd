//! The summary of a contact.

use crate::contact::{Layer, LayerLaw};

/// A contact of a body.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::body::{Contact, Obstacle};
/// let floor = Obstacle::Plane { point: [0.0, 0.0, -0.1], normal: [0.0, 0.0, 1.0] };
/// let body = Body::builder(mesh::block([1.0; 3], [2; 3])?)
///     .region(Region::new(NeoHooke::from_engineering(1000.0, 0.3)?, 1.0))
///     .contact(Contact::with_obstacle("z-min", floor))
///     .build()?;
/// let contact = body.contacts().next().unwrap();
/// assert_eq!((contact.name.as_str(), contact.n_facets, contact.n_points), ("contact-1", 4, 16));
/// assert!((contact.area - 1.0).abs() < 1e-15 && (contact.stiffness - 1000.0).abs() < 1e-9);
/// assert!((contact.smallest_gap - 0.1).abs() < 1e-15 && (contact.distance - 0.05).abs() < 1e-15);
/// assert_eq!(contact.energy, 0.0);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSummary {
    /// Name of its forces.
    pub name: String,
    /// Number of facets of its surface.
    pub n_facets: usize,
    /// Number of quadrature points on them.
    pub n_points: usize,
    /// Number of triangles into which they are divided; 0 with an obstacle.
    pub n_triangles: usize,
    /// Number of sharp edges; 0 with an obstacle.
    pub n_sharp_edges: usize,
    /// Reference area of the surface \[length^2\].
    pub area: f64,
    /// Modulus of the layer \[force/length^2\].
    pub stiffness: f64,
    /// Thickness of the layer \[length\].
    pub distance: f64,
    /// Law of the layer.
    pub law: LayerLaw,
    /// Smallest gap in the reference configuration \[length\]: between a node and the obstacle, or between two bodies,
    /// where it is infinite beyond 128 default thicknesses.
    pub smallest_gap: f64,
    /// Energy of the layer in the reference configuration \[energy\]; where it is not zero, the layer pushes from the
    /// start.
    pub energy: f64,
    /// The node whose displacement is that of an obstacle that moves.
    pub obstacle: Option<u32>,
}

impl ContactSummary {
    /// Stiffness of the layer at half of its thickness over the area: the second derivative of its energy by the gap
    /// \[force/length^3\].
    pub(crate) fn stiffness_at_half(&self) -> f64 {
        let layer = Layer { modulus: self.stiffness, thickness: self.distance, law: self.law };
        // y = (gap/d)^2
        let (y, by_gap, second) = (0.25, 1.0 / self.distance, 2.0 / self.distance.powi(2));
        layer.curvature(y) * by_gap * by_gap + layer.slope(y) * second
    }
}
