//! Viscosity of a region.

use crate::error::{Error, Result};
use crate::tensor::Elasticity;

/// Kelvin and Voigt's viscosity: a stress that is linear in the rate of the Green-Lagrange strain.
///
/// ```math
/// S = t_v D_0 : E' + 2 eta dev E' + zeta tr(E') I
/// ```
///
/// with the elasticity D_0 of the material at rest. In a linear body `t_v` is stiffness-proportional (Rayleigh)
/// damping: a mode of angular frequency omega has the damping ratio `t_v omega/2`. Rigid motions are not damped, and
/// both momenta are conserved, because the stress is internal. The power dissipated per volume is `S : E'`. Fibres that
/// bear tension only have no stiffness at rest and no part in D_0: `t_v` damps only the matrix around them. In a cell
/// with a projected volume theta, the part of D_0 that belongs to its energy U is the pressure `t_v U''(0) theta'`.
///
/// ```
/// use emmy::body::Viscosity;
/// assert!(Viscosity { shear: 3.0, ..Viscosity::default() }.check().is_ok());
/// assert!(Viscosity { bulk: -1.0, ..Viscosity::default() }.check().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Viscosity {
    /// Time t_v by which the elasticity at rest is multiplied \[time\].
    pub time: f64,
    /// Shear viscosity eta \[stress time\].
    pub shear: f64,
    /// Bulk viscosity zeta \[stress time\].
    pub bulk: f64,
}

impl Viscosity {
    /// Checks that no number is negative.
    ///
    /// # Errors
    /// [`Error::Viscosity`].
    pub fn check(&self) -> Result<()> {
        let numbers = [("time", self.time), ("shear", self.shear), ("bulk", self.bulk)];
        match numbers.into_iter().find(|(_, value)| !(*value >= 0.0 && value.is_finite())) {
            Some((name, value)) => Err(Error::Viscosity { name, value }),
            None => Ok(()),
        }
    }

    /// Whether there is none.
    pub fn is_zero(&self) -> bool {
        *self == Viscosity::default()
    }

    /// The tensor of a material with an elasticity at rest, over doubled shears \[stress time\].
    pub(crate) fn tensor(&self, at_rest: &Elasticity<f64>) -> Elasticity<f64> {
        let mut tensor = at_rest.map(|row| row.map(|entry| self.time * entry));
        for a in 0..3 {
            for b in 0..3 {
                let own = if a == b { 2.0 * self.shear } else { 0.0 };
                tensor[a][b] += own - 2.0 / 3.0 * self.shear + self.bulk;
            }
            // A doubled shear represents two components.
            tensor[3 + a][3 + a] += self.shear;
        }
        tensor
    }
}
