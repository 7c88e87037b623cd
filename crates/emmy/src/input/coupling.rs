//! Distributing couplings.

/// A point that follows a group of nodes on the average, a *distributing* coupling (RBE3): forces, masses, springs,
/// supports and joints at the point act on all nodes of the group, which keep their freedom to deform.
///
/// With weights v_A that sum to 1 (areas of facets, else equal), X = sum v_A X_A the mean and
/// J = sum v_A (X_A - X)(X_A - X)^T, the point X_R moves with the affine mean of the group,
///
/// ```math
/// q_R = sum_A w_A q_A,      w_A = v_A (1 + (X_R - X) . J^-1 (X_A - X)),      sum w_A = 1,   sum w_A X_A = X_R
/// ```
///
/// in any motion, so a force there has its resultant and its moment at the current positions, and momenta are exact.
/// A group in a plane fixes no direction normal to it: the point must lie in the plane. A *rigid* coupling (RBE2) is a
/// [`crate::body::RigidBody::group`] with its centre at the point; it alone takes moments.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?)
///     .region(rubber)
///     .support(Support::fixed("x-min"))
///     .coupling(Coupling::new("hook", "x-max", [1.0, 0.5, 0.25]))
///     .load(Load::nodal_force("hook", [0.0, 0.0, -4.0]))
///     .build()?;
/// let weights = &body.couplings()[0].weights;
/// let of_upper = |(node, weight): &(u32, f64)| weight * body.mesh().points()[*node as usize][2];
/// assert!((weights.iter().map(of_upper).sum::<f64>() - 0.25).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling {
    /// Its name, that of a group with the point as its node.
    pub name: String,
    /// Group of facets, nodes or cells that the point follows.
    pub group: String,
    /// The point in the reference configuration \[length\].
    pub point: [f64; 3],
    /// Weights of the nodes in ascending order, positive, with any sum; `None`: areas of facets, else equal.
    pub weights: Option<Vec<f64>>,
}

impl Coupling {
    /// The coupling of a point to a group with weights by area, or equal ones for nodes.
    pub fn new(name: impl Into<String>, group: impl Into<String>, point: [f64; 3]) -> Self {
        Coupling { name: name.into(), group: group.into(), point, weights: None }
    }

    /// The same coupling with weights of the nodes in ascending order.
    pub fn with_weights(self, weights: impl Into<Vec<f64>>) -> Self {
        Coupling { weights: Some(weights.into()), ..self }
    }
}
