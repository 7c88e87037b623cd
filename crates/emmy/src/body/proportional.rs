//! The loads of a time, applied in proportion.

use super::system::Body;

impl Body {
    /// The body under the loads and given displacements of a time, before a jump there, all in proportion to a load
    /// fraction from 0 to 1 that takes the place of time; given motions and motors of joints, too. Attractions act in
    /// full. Supports and joints released by that time are gone; none is released later.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let pull = Load::traction("x-max", [2.0, 0.0, 0.0]).over([(0.0, 3.0), (1.0, 0.0)])?;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).load(pull).build()?;
    /// let mut force = vec![0.0; body.n_dofs()];
    /// body.in_proportion(0.0).loads_at(0.5, &mut force)?;
    /// assert!((force.iter().sum::<f64>() - 0.5 * 3.0 * 2.0).abs() < 1e-14);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn in_proportion(&self, time: f64) -> Body {
        let body = self.at(time);
        let forces = body.forces.in_proportion(time, body.n_dofs());
        let leaders = |node: u32| body.space.ties().leaders_of(node);
        let (mechanism, forces) = match body.mechanism.in_proportion(time, body.mesh(), leaders) {
            Ok(grown) if !grown.is_empty() => body.with_mechanism(&forces, grown),
            // The joints were built before, so there is no fault.
            _ => (body.mechanism.clone(), forces),
        };
        Body {
            mechanism,
            forces,
            space: body.space.in_proportion(time),
            lumped: None,
            release: None,
            ..body.clone()
        }
    }
}
