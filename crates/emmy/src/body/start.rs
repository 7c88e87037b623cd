//! Start of a motion.

use super::{Body, InitialVelocity};
use crate::error::{Error, Result};

impl Body {
    /// Momentum and velocity of an initial velocity field at a time: `(p, v)`, both `[n_nodes][3]`. Fixed components
    /// are at rest, driven ones follow their motion.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::NotFinite`], [`Error::NotFiniteAt`].
    pub(crate) fn initial_motion(
        &self,
        time: f64,
        fields: &[InitialVelocity],
    ) -> Result<(Vec<f64>, Vec<f64>)> {
        let mut velocity = vec![0.0; self.n_dofs()];
        for field in fields {
            let nodes = match &field.group {
                Some(name) => self.mesh.group_nodes(name)?,
                None => (0..self.mesh.n_nodes() as u32).collect(),
            };
            let mut set = nodes.into_iter().map(|node| {
                let v = field.at(self.mesh.points()[node as usize]);
                velocity[3 * node as usize..3 * node as usize + 3].copy_from_slice(&v);
                let wrong = v.into_iter().find(|value| !value.is_finite());
                wrong.map_or(Ok(()), |value| Err(Error::NotFinite { what: "initial velocity".into(), value }))
            });
            self.agree(set.find(Result::is_err).unwrap_or(Ok(())))?;
        }
        self.update_guests("initial velocity", &mut velocity);
        self.set_internal_means(&mut velocity);
        let momentum = self.momentum_of(time, &mut velocity)?;
        Ok((momentum, velocity))
    }

    /// Momentum of a velocity whose fixed and driven components are set to their given motion at a time.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    pub(crate) fn momentum_of(&self, time: f64, velocity: &mut [f64]) -> Result<Vec<f64>> {
        self.set_given_velocity(time, 0.0, velocity)?;
        let mut momentum = vec![0.0; self.n_dofs()];
        self.mass_product(velocity, &mut momentum);
        Ok(momentum)
    }

    /// Checks that driven nodes are where their motion begins.
    ///
    /// # Errors
    /// [`Error::DrivenStart`].
    pub(crate) fn check_start(&self, time: f64, displacement: &[f64]) -> Result<()> {
        if !self.is_driven() {
            return Ok(());
        }
        let distance = self.driven_distance(time, displacement);
        let size = self.mesh.bounds().iter().flatten().fold(0.0, |size: f64, x| size.max(x.abs()));
        // Rounding in an expression that is exactly zero is not a displacement.
        if distance <= 1e-12 * size {
            return Ok(());
        }
        Err(Error::DrivenStart { time, distance })
    }
}
