//! Isochoric neo-Hooke material.

use super::elastic::ELASTIC_CONSTANTS;
use super::isochoric::Isochoric;
use super::model::{Model, ModelCells, Modelled, VOLUMETRIC, Values};
use super::volumetric::Volume;
use super::{Volumetric, positive, split_material};
use crate::error::Result;
use crate::tensor::Lane;

/// Neo-Hooke material with its energy split into an isochoric and a volumetric part, for nearly incompressible rubber.
///
/// ```math
/// W = mu/2 (I1bar - 3) + W_vol(J),      I1bar = J^(-2/3) tr C
/// ```
///
/// Source: Flory (1961), Trans. Faraday Soc. 57; Simo and Taylor (1991), Comput. Methods Appl. Mech. Eng. 85. Shear
/// modulus mu and bulk modulus in \[force/length^2\].
///
/// ```
/// use emmy::prelude::*;
/// let rubber = NeoHookeIsochoric::new(8.0, 1000.0, Volumetric::default())?;
/// // Simple shear by 0.4: I1 = 3 + 0.4^2, J = 1.
/// let energy = rubber.strain_energy(&[0.0, 0.08, 0.0, 0.2, 0.0, 0.0]);
/// assert!((energy - 4.0 * 0.16).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeoHookeIsochoric {
    mu: f64,
    volume: Volume,
}

const NAME: &str = "neo-hooke-isochoric";

impl NeoHookeIsochoric {
    /// The material with shear modulus, bulk modulus, and volumetric law.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless both moduli are positive and finite.
    pub fn new(mu: f64, bulk_modulus: f64, volumetric: Volumetric) -> Result<Self> {
        positive(NAME, "mu", mu)?;
        Ok(NeoHookeIsochoric { mu, volume: Volume::new(NAME, bulk_modulus, volumetric)? })
    }
}

impl Modelled for NeoHookeIsochoric {
    const MODEL: Model = Model {
        name: NAME,
        energy: "mu/2 (I1bar - 3) + W_vol(J)",
        purpose: "nearly incompressible rubber, moderate strain",
        parameters: &[ELASTIC_CONSTANTS, &[VOLUMETRIC]],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let own = values.elastic(NAME)?;
        NeoHookeIsochoric::new(own.mu, own.bulk_modulus, values.law())
    }
}

impl Isochoric for NeoHookeIsochoric {
    fn volume(&self) -> &Volume {
        &self.volume
    }
    fn with_volume(&self, volume: Volume) -> Self {
        NeoHookeIsochoric { volume, ..*self }
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, x: L) -> L {
        x * (0.5 * self.mu)
    }
    #[inline(always)]
    fn energy_change<L: Lane>(&self, _: L, dx: L) -> L {
        dx * (0.5 * self.mu)
    }
    #[inline(always)]
    fn derivatives<L: Lane>(&self, x: L) -> [L; 2] {
        [x.splat(0.5 * self.mu), x.splat(0.0)]
    }
}

split_material!(NeoHookeIsochoric, isochoric);

#[cfg(test)]
mod tests {
    use super::super::conformance::{big, big_det, big_isochoric, conforms};
    use super::super::tests::rejects;
    use super::super::volumetric::tests::energy;
    use super::*;

    #[test]
    fn conforms_to_its_textbook_form() {
        for law in Volumetric::ALL {
            let mu = 400.0;
            let K = 2000.0;
            conforms(&NeoHookeIsochoric::new(mu, K, law).unwrap(), [K - 2.0 / 3.0 * mu, mu], |C| {
                let [I1, _] = big_isochoric(C);
                big(mu / 2.0) * (I1 - big(3.0)) + energy(law, K, &big_det(C))
            });
        }
    }

    #[test]
    fn bad_parameters_are_rejected() {
        let new = |mu, K| NeoHookeIsochoric::new(mu, K, Volumetric::default());
        rejects("mu", new(0.0, 1.0));
        rejects("mu", new(f64::NAN, 1.0));
        rejects("bulk_modulus", new(1.0, -1.0));
    }
}
