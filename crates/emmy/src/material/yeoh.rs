//! Yeoh material.

use super::isochoric::Isochoric;
use super::model::{BULK_MODULUS, Bounds, Model, ModelCells, Modelled, Parameter, VOLUMETRIC, Values};
use super::polynomial::Polynomial;
use super::volumetric::Volume;
use super::{Volumetric, finite, positive, split_material};
use crate::error::Result;
use crate::tensor::Lane;

/// Yeoh material, for filled rubber at large strain: it softens first and stiffens later.
///
/// ```math
/// W = c10 (I1bar - 3) + c20 (I1bar - 3)^2 + c30 (I1bar - 3)^3 + W_vol(J),      mu = 2 c10
/// ```
///
/// Source: Yeoh (1993), Rubber Chem. Technol. 66. Parameters in \[force/length^2\].
///
/// ```
/// use emmy::prelude::*;
/// let rubber = Yeoh::new([3.0, -0.5, 2.0], 100.0, Volumetric::default())?;
/// // Simple shear by 0.4: I1 = 3 + 0.4^2, J = 1.
/// let energy = rubber.strain_energy(&[0.0, 0.08, 0.0, 0.2, 0.0, 0.0]);
/// assert!((energy - (3.0 * 0.16 - 0.5 * 0.0256 + 2.0 * 0.004096)).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Yeoh {
    polynomial: Polynomial<3>,
    volume: Volume,
}

const NAME: &str = "yeoh";

impl Yeoh {
    /// The material with the moduli c10, c20, c30, bulk modulus, and law of volume.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless c10 > 0, the others are finite, and the bulk modulus is positive.
    pub fn new(moduli: [f64; 3], bulk_modulus: f64, volumetric: Volumetric) -> Result<Self> {
        positive(NAME, "c10", moduli[0])?;
        finite(NAME, "c20", moduli[1])?;
        finite(NAME, "c30", moduli[2])?;
        Ok(Yeoh { polynomial: Polynomial(moduli), volume: Volume::new(NAME, bulk_modulus, volumetric)? })
    }
}

impl Modelled for Yeoh {
    const MODEL: Model = Model {
        name: NAME,
        energy: "c10 (I1bar - 3) + c20 (I1bar - 3)^2 + c30 (I1bar - 3)^3 + W_vol(J)",
        purpose: "filled rubber",
        parameters: &[&[
            Parameter::positive("c10", "stress", "Linear modulus; mu = 2 c10"),
            Parameter::number("c20", Bounds::Any, "stress", "Quadratic modulus"),
            Parameter::number("c30", Bounds::Any, "stress", "Cubic modulus"),
            BULK_MODULUS,
            VOLUMETRIC,
        ]],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let (bulk_modulus, law) = values.volume();
        Yeoh::new(["c10", "c20", "c30"].map(|name| values.number(name)), bulk_modulus, law)
    }
}

impl Isochoric for Yeoh {
    fn volume(&self) -> &Volume {
        &self.volume
    }
    fn with_volume(&self, volume: Volume) -> Self {
        Yeoh { volume, ..*self }
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, x: L) -> L {
        self.polynomial.value(x)
    }
    #[inline(always)]
    fn energy_change<L: Lane>(&self, x: L, dx: L) -> L {
        self.polynomial.change(x, dx)
    }
    #[inline(always)]
    fn derivatives<L: Lane>(&self, x: L) -> [L; 2] {
        self.polynomial.derivatives(x)
    }
}

split_material!(Yeoh, isochoric);

#[cfg(test)]
mod tests {
    use super::super::conformance::{big, big_det, big_isochoric, conforms};
    use super::super::tests::rejects;
    use super::super::volumetric::tests::energy;
    use super::*;

    #[test]
    fn conforms_to_its_textbook_form() {
        let c = [250.0, -20.0, 40.0];
        let K = 1500.0;
        let law = Volumetric::SimoTaylor;
        conforms(&Yeoh::new(c, K, law).unwrap(), [K - 4.0 / 3.0 * c[0], 2.0 * c[0]], |C| {
            let x = big_isochoric(C)[0].clone() - big(3.0);
            big(c[0]) * &x + big(c[1]) * &x * &x + big(c[2]) * &x * &x * &x + energy(law, K, &big_det(C))
        });
    }

    #[test]
    fn bad_parameters_are_rejected() {
        let new = |c, K| Yeoh::new(c, K, Volumetric::default());
        rejects("c10", new([0.0, 1.0, 1.0], 1.0));
        rejects("c20", new([1.0, f64::NAN, 1.0], 1.0));
        rejects("c30", new([1.0, 1.0, f64::INFINITY], 1.0));
        rejects("bulk_modulus", new([1.0, 1.0, 1.0], 0.0));
    }
}
