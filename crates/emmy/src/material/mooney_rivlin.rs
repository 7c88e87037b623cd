//! Mooney-Rivlin material.

use super::isochoric::Isochoric;
use super::model::{BULK_MODULUS, Bounds, Model, ModelCells, Modelled, Parameter, VOLUMETRIC, Values};
use super::volumetric::Volume;
use super::{Volumetric, finite, fulfils, split_material};
use crate::error::Result;
use crate::tensor::Lane;

/// Mooney-Rivlin material, for rubber at moderate strain.
///
/// ```math
/// W = c10 (I1bar - 3) + c01 (I2bar - 3) + W_vol(J),      mu = 2 (c10 + c01)
/// ```
///
/// Source: Mooney (1940), J. Appl. Phys. 11, and Rivlin (1948), Phil. Trans. R. Soc. A 241; split as in Simo and Taylor
/// (1991), Comput. Methods Appl. Mech. Eng. 85. Parameters in \[force/length^2\]. Neither modulus should be negative:
/// otherwise the material is not elliptic at large strain.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = MooneyRivlin::new(3.0, 1.0, 100.0, Volumetric::default())?;
/// // Simple shear by 0.4: I1 = I2 = 3 + 0.4^2, J = 1.
/// let energy = rubber.strain_energy(&[0.0, 0.08, 0.0, 0.2, 0.0, 0.0]);
/// assert!((energy - 4.0 * 0.16).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MooneyRivlin {
    c10: f64,
    c01: f64,
    volume: Volume,
}

const NAME: &str = "mooney-rivlin";

impl MooneyRivlin {
    /// The material with moduli of the first and the second invariant, bulk modulus, and law of volume.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless c10 + c01 > 0 and the bulk modulus is positive.
    pub fn new(c10: f64, c01: f64, bulk_modulus: f64, volumetric: Volumetric) -> Result<Self> {
        finite(NAME, "c10", c10)?;
        finite(NAME, "c01", c01)?;
        fulfils(c10 + c01 > 0.0, NAME, "c01", c01, "must make c10 + c01 positive (half the shear modulus)")?;
        Ok(MooneyRivlin { c10, c01, volume: Volume::new(NAME, bulk_modulus, volumetric)? })
    }
}

impl Modelled for MooneyRivlin {
    const MODEL: Model = Model {
        name: NAME,
        energy: "c10 (I1bar - 3) + c01 (I2bar - 3) + W_vol(J)",
        purpose: "rubber, moderate strain",
        parameters: &[&[
            Parameter::number(
                "c10",
                Bounds::Any,
                "stress",
                "Modulus of the first invariant; mu = 2 (c10 + c01) > 0",
            ),
            Parameter::number(
                "c01",
                Bounds::Any,
                "stress",
                "Modulus of the second invariant; neither should be negative",
            ),
            BULK_MODULUS,
            VOLUMETRIC,
        ]],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let (bulk_modulus, law) = values.volume();
        MooneyRivlin::new(values.number("c10"), values.number("c01"), bulk_modulus, law)
    }
}

impl Isochoric for MooneyRivlin {
    fn volume(&self) -> &Volume {
        &self.volume
    }
    fn with_volume(&self, volume: Volume) -> Self {
        MooneyRivlin { volume, ..*self }
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, x: L) -> L {
        x * self.c10
    }
    #[inline(always)]
    fn energy_change<L: Lane>(&self, _: L, dx: L) -> L {
        dx * self.c10
    }
    #[inline(always)]
    fn derivatives<L: Lane>(&self, x: L) -> [L; 2] {
        [x.splat(self.c10), x.splat(0.0)]
    }
    fn second_modulus(&self) -> f64 {
        self.c01
    }
}

split_material!(MooneyRivlin, isochoric);

#[cfg(test)]
mod tests {
    use super::super::conformance::{big, big_det, big_isochoric, conforms};
    use super::super::tests::rejects;
    use super::super::volumetric::tests::energy;
    use super::*;

    #[test]
    fn conforms_to_its_textbook_form() {
        let [c10, c01] = [200.0, 50.0];
        let K = 1500.0;
        let law = Volumetric::Logarithmic;
        let mu = 2.0 * (c10 + c01);
        conforms(&MooneyRivlin::new(c10, c01, K, law).unwrap(), [K - 2.0 / 3.0 * mu, mu], |C| {
            let [I1, I2] = big_isochoric(C);
            big(c10) * (I1 - big(3.0)) + big(c01) * (I2 - big(3.0)) + energy(law, K, &big_det(C))
        });
    }

    #[test]
    fn bad_parameters_are_rejected() {
        let new = |c10, c01, K| MooneyRivlin::new(c10, c01, K, Volumetric::default());
        rejects("c01", new(1.0, -1.0, 1.0));
        rejects("c10", new(f64::NAN, 1.0, 1.0));
        rejects("c01", new(1.0, f64::INFINITY, 1.0));
        rejects("bulk_modulus", new(1.0, 1.0, -1.0));
        assert!(new(1.0, -0.2, 1.0).is_ok());
    }
}
