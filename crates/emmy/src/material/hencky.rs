//! Hencky material.

use super::elastic::ELASTIC_CONSTANTS;
use super::model::{Model, ModelCells, Modelled, Values};
use super::principal::StrainChange;
use super::spectral::Separable;
use super::volumetric::Volume;
use super::{Volumetric, lame, split_material, stable_lame};
use crate::error::Result;
use crate::tensor::Lane;

/// Hencky material: linear elasticity in the logarithmic strain, for metals and polymers at stretches from 0.7 to 1.3.
///
/// ```math
/// W = lambda/2 (tr h)^2 + mu h : h,      h = 1/2 ln C
/// ```
///
/// It is not elliptic at large stretches, as W grows slower than linearly there.
///
/// Source: Hencky (1928), Z. Tech. Phys. 9; Anand (1979), J. Appl. Mech. 46. Parameters in \[force/length^2\].
///
/// ```
/// use emmy::prelude::*;
/// let metal = Hencky::new(1.0, 2.0)?;
/// let energy = metal.strain_energy(&[1.5, 0.0, 0.0, 0.0, 0.0, 0.0]); // stretched to twice its length
/// let ln_2 = std::f64::consts::LN_2;
/// assert!((energy - 2.5 * ln_2 * ln_2).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hencky {
    mu: f64,
    volume: Volume,
}

const NAME: &str = "hencky";

impl Hencky {
    /// The material with Lame parameters.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless mu > 0 and lambda > -2/3 mu.
    pub fn new(lambda: f64, mu: f64) -> Result<Self> {
        stable_lame(NAME, lambda, mu)?;
        let bulk_modulus = lambda + 2.0 / 3.0 * mu;
        Ok(Hencky { mu, volume: Volume::new(NAME, bulk_modulus, Volumetric::Logarithmic)? })
    }

    /// The material whose small-strain Young's modulus and Poisson's ratio are given.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless E > 0 and -1 < nu < 1/2.
    pub fn from_engineering(youngs_modulus: f64, poissons_ratio: f64) -> Result<Self> {
        let (lambda, mu) = lame(NAME, youngs_modulus, poissons_ratio)?;
        Hencky::new(lambda, mu)
    }
}

impl Modelled for Hencky {
    const MODEL: Model = Model {
        name: NAME,
        energy: "lambda/2 (tr h)^2 + mu h : h",
        purpose: "metals and polymers, stretches from 0.7 to 1.3",
        parameters: &[ELASTIC_CONSTANTS],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let own = values.elastic(NAME)?;
        Hencky::new(own.lambda, own.mu)
    }
}

impl Separable for Hencky {
    fn volume(&self) -> &Volume {
        &self.volume
    }
    fn with_volume(&self, volume: Volume) -> Self {
        Hencky { volume, ..*self }
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, e: L) -> L {
        e * e * self.mu
    }
    /// The sum of the squares is 6 m^2 + 2 d^2, with the mean m and half the gap d of e_2 and e_3.
    #[inline(always)]
    fn energy_change<L: Lane>(&self, change: &StrainChange<L>) -> L {
        let of_mean = change.mean_change * (change.mean * 2.0 + change.mean_change) * 6.0;
        (of_mean + change.sum * change.difference * 2.0) * self.mu
    }
    #[inline(always)]
    fn derivatives<L: Lane>(&self, e: L) -> [L; 2] {
        [e * (2.0 * self.mu), e.splat(2.0 * self.mu)]
    }
    #[inline(always)]
    fn divided_difference<L: Lane>(&self, e: L, _: L) -> L {
        e.splat(2.0 * self.mu)
    }
}

split_material!(Hencky, spectral);

#[cfg(test)]
mod tests {
    use super::super::conformance::{big, big_principal_stretches, conforms};
    use super::super::tests::rejects;
    use super::*;

    #[test]
    fn conforms_to_its_textbook_form() {
        let [lambda, mu] = [1000.0, 500.0];
        conforms(&Hencky::new(lambda, mu).unwrap(), [lambda, mu], |C| {
            let h = big_principal_stretches(C).map(|stretch| stretch.ln());
            let trace = &h[0] + &h[1] + &h[2];
            let square = &h[0] * &h[0] + &h[1] * &h[1] + &h[2] * &h[2];
            big(lambda / 2.0) * &trace * &trace + big(mu) * square
        });
    }

    #[test]
    fn bad_parameters_are_rejected() {
        rejects("mu", Hencky::new(1.0, 0.0));
        rejects("lambda", Hencky::new(-2.0, 3.0));
        rejects("youngs_modulus", Hencky::from_engineering(-1.0, 0.3));
        rejects("poissons_ratio", Hencky::from_engineering(1.0, 0.5));
    }
}
