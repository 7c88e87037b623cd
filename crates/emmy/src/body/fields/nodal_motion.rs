//! How the nodes move.

/// Displacement, velocity and acceleration of the nodes of a body, `[n_nodes][3]` each.
///
/// ```
/// use emmy::body::NodalMotion;
/// let [displacement, velocity] = [vec![0.0; 24], vec![1.0; 24]];
/// let motion = NodalMotion::from([&displacement, &velocity]);
/// assert!(motion.acceleration.is_empty());
/// ```
#[derive(Debug, Clone, Copy)]
pub struct NodalMotion<'a> {
    /// u \[length\].
    pub displacement: &'a [f64],
    /// v \[length/time\].
    pub velocity: &'a [f64],
    /// a \[length/time^2\]; empty: unknown, and its field is NaN.
    pub acceleration: &'a [f64],
}

impl<'a, X: AsRef<[f64]> + ?Sized> From<[&'a X; 2]> for NodalMotion<'a> {
    /// A motion whose acceleration is unknown.
    fn from([displacement, velocity]: [&'a X; 2]) -> Self {
        let [displacement, velocity] = [displacement.as_ref(), velocity.as_ref()];
        NodalMotion { displacement, velocity, acceleration: &[] }
    }
}

impl NodalMotion<'_> {
    /// The three vectors of a node.
    pub(super) fn at(&self, node: usize) -> [[f64; 3]; 3] {
        [self.displacement, self.velocity, self.acceleration]
            .map(|vectors| vectors.as_chunks().0.get(node).copied().unwrap_or([f64::NAN; 3]))
    }
}
