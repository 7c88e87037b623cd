//! Ties between the parts of a body.

/// Nodes that follow a surface, a volume, or other nodes, on which they lie.
///
/// A follower moves with some nodes of the leader, `u_s = sum_A w_A u_A`, and is moved to their point `sum_A w_A X_A`
/// in the reference configuration. It is eliminated: its mass, its forces and its stiffness act on the nodes A.
///
/// ```
/// use emmy::prelude::*;
/// let tie = Tie::nodes("upper-face", "lower-face").with_tolerance(0.1);
/// assert_eq!((tie.leader.as_str(), tie.tolerance), ("lower-face", 0.1));
/// assert_eq!(Tie::new("upper-face", "lower-face").kind, None);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// Group of the nodes that follow.
    pub follower: String,
    /// Group that they follow: its facets; if it has none its nodes, else its cells.
    pub leader: String,
    /// How its weights are found; `None` for mortar where both are groups of facets, nodes otherwise.
    pub kind: Option<TieKind>,
    /// Largest distance of a follower from the leader, over the longest edge of the facet or cell there; for nodes over
    /// the shortest edge at the follower.
    pub tolerance: f64,
    /// Weights of the nodes of the leader in ascending order, with the sum 1, for a follower of one node; then the kind
    /// has no effect. `None`: found by the kind.
    pub weights: Option<Vec<f64>>,
    /// Whether nodes beyond the tolerance, and nodes of the leader itself, stay free; else they are an error.
    pub partial: bool,
}

/// How the weights of a tie are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TieKind {
    /// By integrals over two surfaces (dual mortar): a uniform stress passes exactly between plane facets, whatever
    /// their meshes.
    Mortar,
    /// Each follower moves with the nearest point of the leader, `w_A = N_A(X)`. A uniform stress does not pass exactly
    /// between meshes that do not match.
    Nodes,
}

impl Tie {
    /// The tie of one group to another, with a tolerance of 0.05.
    pub fn new(follower: impl Into<String>, leader: impl Into<String>) -> Self {
        Tie {
            follower: follower.into(),
            leader: leader.into(),
            kind: None,
            tolerance: 0.05,
            weights: None,
            partial: false,
        }
    }

    /// The tie of the nodes of one group to another group, with a tolerance of 0.05.
    pub fn nodes(follower: impl Into<String>, leader: impl Into<String>) -> Self {
        Tie { kind: Some(TieKind::Nodes), ..Tie::new(follower, leader) }
    }

    /// The tie of two surfaces by mortar, with a tolerance of 0.05.
    pub fn mortar(follower: impl Into<String>, leader: impl Into<String>) -> Self {
        Tie { kind: Some(TieKind::Mortar), ..Tie::new(follower, leader) }
    }

    /// The tie of one node to the nodes of a group with their weights, with a tolerance of 0.05.
    pub fn weighted(
        follower: impl Into<String>,
        leader: impl Into<String>,
        weights: impl Into<Vec<f64>>,
    ) -> Self {
        Tie { weights: Some(weights.into()), ..Tie::nodes(follower, leader) }
    }

    /// The same tie, of the nodes within its tolerance alone.
    pub fn partial(self) -> Self {
        Tie { partial: true, ..self }
    }

    /// The same tie with another tolerance.
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Tie { tolerance, ..self }
    }
}
