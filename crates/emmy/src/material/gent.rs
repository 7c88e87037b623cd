//! Gent material.

use super::elastic::ELASTIC_CONSTANTS;
use super::isochoric::Isochoric;
use super::model::{Model, ModelCells, Modelled, Parameter, VOLUMETRIC, Values};
use super::volumetric::Volume;
use super::{Volumetric, positive, split_material};
use crate::error::Result;
use crate::tensor::Lane;

/// Gent material, for rubber whose chains have a limit of extension.
///
/// ```math
/// W = -mu jm/2 ln(1 - (I1bar - 3)/jm) + W_vol(J)
/// ```
///
/// The energy grows without bound as I1bar - 3 approaches jm; beyond it, energy and stress are NaN, and the step is
/// rejected.
///
/// Source: Gent (1996), Rubber Chem. Technol. 69. mu and the bulk modulus in \[force/length^2\], jm has no
/// dimension.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = Gent::new(3.0, 0.32, 100.0, Volumetric::default())?;
/// // Simple shear by 0.4: I1 = 3 + 0.4^2, half of the limit, J = 1.
/// let energy = rubber.strain_energy(&[0.0, 0.08, 0.0, 0.2, 0.0, 0.0]);
/// assert!((energy - 1.5 * 0.32 * std::f64::consts::LN_2).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gent {
    mu: f64,
    jm: f64,
    volume: Volume,
}

const NAME: &str = "gent";

impl Gent {
    /// The material with shear modulus, limit of I1bar - 3, bulk modulus, and law of volume.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless mu, jm and the bulk modulus are positive.
    pub fn new(mu: f64, jm: f64, bulk_modulus: f64, volumetric: Volumetric) -> Result<Self> {
        positive(NAME, "mu", mu)?;
        positive(NAME, "jm", jm)?;
        Ok(Gent { mu, jm, volume: Volume::new(NAME, bulk_modulus, volumetric)? })
    }
}

impl Modelled for Gent {
    const MODEL: Model = Model {
        name: NAME,
        energy: "-mu jm/2 ln(1 - (I1bar - 3)/jm) + W_vol(J)",
        purpose: "rubber with a limit of its stretch",
        parameters: &[
            ELASTIC_CONSTANTS,
            &[Parameter::positive("jm", "", "Limit of I1bar - 3; steps that reach it fail"), VOLUMETRIC],
        ],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let own = values.elastic(NAME)?;
        Gent::new(own.mu, values.number("jm"), own.bulk_modulus, values.law())
    }
}

impl Isochoric for Gent {
    fn volume(&self) -> &Volume {
        &self.volume
    }
    fn with_volume(&self, volume: Volume) -> Self {
        Gent { volume, ..*self }
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, x: L) -> L {
        (x * (-1.0 / self.jm)).ln_1p() * (-0.5 * self.mu * self.jm)
    }
    #[inline(always)]
    fn energy_change<L: Lane>(&self, x: L, dx: L) -> L {
        let left = x.splat(self.jm) - x;
        let change = (-dx / left).ln_1p() * (-0.5 * self.mu * self.jm);
        left.select_below(x.splat(0.0), x.splat(f64::NAN), change)
    }
    #[inline(always)]
    fn derivatives<L: Lane>(&self, x: L) -> [L; 2] {
        let left = x.splat(1.0) - x * (1.0 / self.jm);
        let slope = x.splat(0.5 * self.mu) / left;
        // Beyond the limit the formula would pull the material further apart.
        let slope = left.select_below(x.splat(0.0), x.splat(f64::NAN), slope);
        [slope, slope / left * (1.0 / self.jm)]
    }
}

split_material!(Gent, isochoric);

#[cfg(test)]
mod tests {
    use super::super::Material;
    use super::super::conformance::{big, big_det, big_isochoric, conforms};
    use super::super::tests::rejects;
    use super::super::volumetric::tests::energy;
    use super::*;

    #[test]
    fn conforms_to_its_textbook_form() {
        // The large gradients of the test stay below the limit: tr C <= 18 and J > 0.05 there, so I1bar < 133.
        let mu = 500.0;
        let jm = 150.0;
        let K = 1500.0;
        let law = Volumetric::Miehe;
        conforms(&Gent::new(mu, jm, K, law).unwrap(), [K - 2.0 / 3.0 * mu, mu], |C| {
            let x = big_isochoric(C)[0].clone() - big(3.0);
            big(-0.5 * mu * jm) * (big(1.0) - x / big(jm)).ln() + energy(law, K, &big_det(C))
        });
    }

    #[test]
    fn there_is_nothing_beyond_the_limit() {
        let rubber = Gent::new(1.0, 0.5, 1.0, Volumetric::default()).unwrap();
        let shear = [0.0, 0.5, 0.0, 0.5, 0.0, 0.0]; // by 1: I1 - 3 = 1
        assert!(rubber.strain_energy(&shear).is_nan() && rubber.stress(&shear)[3].is_nan());
    }

    #[test]
    fn bad_parameters_are_rejected() {
        let new = |mu, jm, K| Gent::new(mu, jm, K, Volumetric::default());
        rejects("mu", new(0.0, 1.0, 1.0));
        rejects("jm", new(1.0, -1.0, 1.0));
        rejects("bulk_modulus", new(1.0, 1.0, f64::NAN));
    }
}
