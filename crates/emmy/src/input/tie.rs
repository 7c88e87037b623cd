//! Ties between the parts of a body.

/// Nodes that follow the points of a surface, of a volume, or other nodes, on which they lie.
///
/// A follower moves with the nearest point X of the leader, `u_s = sum_A N_A(X) u_A`, and is moved there in the
/// reference configuration. It is eliminated: its mass, its forces and its stiffness act on the nodes A. A uniform
/// stress does not pass exactly between meshes that do not match.
///
/// ```
/// use emmy::prelude::*;
/// let tie = Tie::nodes("upper-face", "lower-face").with_tolerance(0.1);
/// assert_eq!((tie.leader.as_str(), tie.tolerance), ("lower-face", 0.1));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// Group of the nodes that follow.
    pub follower: String,
    /// Group that they follow: its facets; if it has none its nodes, else its cells.
    pub leader: String,
    /// Largest distance of a follower from the leader, over the longest edge of the facet or cell there; for nodes over
    /// the shortest edge at the follower.
    pub tolerance: f64,
}

impl Tie {
    /// The tie of the nodes of one group to another group, with a tolerance of 0.05.
    pub fn nodes(follower: impl Into<String>, leader: impl Into<String>) -> Self {
        Tie { follower: follower.into(), leader: leader.into(), tolerance: 0.05 }
    }

    /// The same tie with another tolerance.
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Tie { tolerance, ..self }
    }
}
