//! Ogden material.

use super::model::{BULK_MODULUS, Model, ModelCells, Modelled, Parameter, VOLUMETRIC, Values};
use super::principal::{StrainChange, sinh_cosh_m1};
use super::spectral::Separable;
use super::volumetric::Volume;
use super::{Volumetric, finite, fulfils, split_material};
use crate::error::Result;
use crate::tensor::{Lane, exp_m1_minus, exp_m1_over, inlined};

/// Ogden material with any number of terms, for rubber at any strain.
///
/// ```math
/// W = sum_p mu_p/alpha_p (l_1^alpha_p + l_2^alpha_p + l_3^alpha_p - 3) + W_vol(J),      l_i = J^(-1/3) lambda_i
/// mu = 1/2 sum_p mu_p alpha_p
/// ```
///
/// Source: Ogden (1972), Proc. R. Soc. Lond. A 326; split as in Simo and Taylor (1991).
/// mu_p and the bulk modulus in \[force/length^2\]; alpha_p, of either sign, have no dimension. Some programs use 2
/// mu_p / alpha_p^2 instead of mu_p / alpha_p.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = Ogden::new(&[(3.0, 2.0), (-1.0, -2.0)], 100.0, Volumetric::default())?;
/// // With these exponents, Mooney-Rivlin: c10 = 3/2, c01 = 1/2. Simple shear by 0.4: I1 = I2 = 3 + 0.4^2, J = 1.
/// let energy = rubber.strain_energy(&[0.0, 0.08, 0.0, 0.2, 0.0, 0.0]);
/// assert!((energy - 2.0 * 0.16).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Ogden {
    /// (mu_p, alpha_p).
    terms: Vec<(f64, f64)>,
    volume: Volume,
}

const NAME: &str = "ogden";

impl Ogden {
    /// The material with terms (mu_p, alpha_p), bulk modulus, and law of volume.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless every alpha_p is finite and not zero, every mu_p is finite, the sum
    /// of mu_p alpha_p is positive (so there is at least one), and so is the bulk modulus.
    pub fn new(terms: &[(f64, f64)], bulk_modulus: f64, volumetric: Volumetric) -> Result<Self> {
        for &(mu, alpha) in terms {
            finite(NAME, "mu", mu)?;
            let usable = alpha.is_finite() && alpha != 0.0;
            fulfils(usable, NAME, "alpha", alpha, "must be finite and not zero")?;
        }
        let sum = terms.iter().map(|(mu, alpha)| mu * alpha).sum();
        let requirement =
            "is the sum of mu alpha over the terms; it must be positive (twice the shear modulus)";
        fulfils(sum > 0.0, NAME, "mu", sum, requirement)?;
        Ok(Ogden { terms: terms.to_vec(), volume: Volume::new(NAME, bulk_modulus, volumetric)? })
    }

    #[inline(always)]
    fn sum<L: Lane>(&self, zero: L, term: impl Fn(f64, f64) -> L) -> L {
        let mut sum = zero.splat(0.0);
        for &(mu, alpha) in &self.terms {
            sum += term(mu, alpha);
        }
        sum
    }
}

impl Modelled for Ogden {
    const MODEL: Model = Model {
        name: NAME,
        energy: "sum_p mu_p/alpha_p (l_1^alpha_p + l_2^alpha_p + l_3^alpha_p - 3) + W_vol(J)",
        purpose: "rubber, any strain",
        parameters: &[&[
            Parameter::numbers(
                "mu",
                "stress",
                "Moduli mu_p, one a term; half the sum of mu_p alpha_p is the shear modulus",
            ),
            Parameter::numbers("alpha", "", "Exponents alpha_p, one a term, not 0"),
            BULK_MODULUS,
            VOLUMETRIC,
        ]],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let (bulk_modulus, law) = values.volume();
        let terms: Vec<(f64, f64)> =
            values.numbers("mu").iter().copied().zip(values.numbers("alpha").iter().copied()).collect();
        Ogden::new(&terms, bulk_modulus, law)
    }
}

impl Separable for Ogden {
    fn volume(&self) -> &Volume {
        &self.volume
    }
    fn with_volume(&self, volume: Volume) -> Self {
        Ogden { volume, ..self.clone() }
    }
    /// The strains e add up to zero, so their linear terms may be left out and nothing cancels.
    #[inline(always)]
    fn energy<L: Lane>(&self, e: L) -> L {
        self.sum(
            e,
            #[inline(always)]
            |mu, alpha| exp_m1_minus(e * alpha) * (mu / alpha),
        )
    }
    /// With the mean m and half the gap d of e_2 and e_3, `u = e^(alpha m) - 1` and `v = e^(alpha dm) - 1`, a term is
    ///
    /// ```math
    /// mu/alpha [(e^(-2 alpha m) - 1) (e^(-2 alpha dm) - 1) + v^2 (3 + 2 v)/(1 + v)^2 + 2 v (e^(alpha m) cosh(alpha d) - 1)
    ///     + 4 (1 + u) (1 + v) sinh(alpha (d' + d)/2) sinh(alpha (d' - d)/2)]
    /// ```
    #[inline(always)]
    fn energy_change<L: Lane>(&self, change: &StrainChange<L>) -> L {
        let one = change.mean.splat(1.0);
        let two = change.mean.splat(2.0);
        self.sum(
            one,
            #[inline(always)]
            |mu, alpha| {
                let u = (change.mean * alpha).exp_m1();
                let v = (change.mean_change * alpha).exp_m1();
                let power = (one + u) * (one + v);
                let inverse = one / (power * power);
                let far = u * (two + u) * v * (two + v) * inverse;
                let bent = v * v * (v * 2.0 + one * 3.0) * (one + u) * (one + u) * inverse;
                let [sinh_sum, cosh_sum] = sinh_cosh_m1(change.sum * (0.5 * alpha));
                let [sinh, cosh] = sinh_cosh_m1(change.difference * (0.5 * alpha));
                // cosh(alpha d) - 1
                let start = cosh_sum + cosh + (cosh_sum * cosh - sinh_sum * sinh);
                let moved = v * (u + start + u * start) * 2.0;
                let opened = power * sinh_sum * sinh * 4.0;
                (far + bent + (moved + opened)) * (mu / alpha)
            },
        )
    }
    #[inline(always)]
    fn derivatives<L: Lane>(&self, e: L) -> [L; 2] {
        let one = e.splat(1.0);
        let [mut slope, mut curvature] = [e.splat(0.0); 2];
        for &(mu, alpha) in &self.terms {
            let rise = (e * alpha).exp_m1();
            slope += rise * mu;
            curvature += (one + rise) * (mu * alpha);
        }
        [slope, curvature]
    }
    /// mu alpha exp(alpha e) (exp(alpha difference) - 1) / (alpha difference).
    #[inline(always)]
    fn divided_difference<L: Lane>(&self, e: L, difference: L) -> L {
        let exp = inlined!(|alpha: f64| e.splat(1.0) + (e * alpha).exp_m1());
        self.sum(
            e,
            #[inline(always)]
            |mu, alpha| exp(alpha) * exp_m1_over(difference * alpha) * (mu * alpha),
        )
    }
}

split_material!(Ogden, spectral);

#[cfg(test)]
mod tests {
    use super::super::conformance::{Big, big, big_det, big_principal_stretches, conforms};
    use super::super::tests::rejects;
    use super::super::volumetric::tests::energy;
    use super::*;

    /// The rubber of Treloar, as fitted by Ogden (1972), in N/cm^2.
    const TRELOAR: [(f64, f64); 3] = [(63.0, 1.3), (0.12, 5.0), (-1.0, -2.0)];

    #[test]
    fn conforms_to_its_textbook_form() {
        let K = 200.0;
        let law = Volumetric::Quadratic;
        let mu = TRELOAR.iter().map(|(mu, alpha)| mu * alpha / 2.0).sum();
        conforms(&Ogden::new(&TRELOAR, K, law).unwrap(), [K - 2.0 / 3.0 * mu, mu], |C| {
            let ln_J = big_det(C).ln() / big(2.0);
            let e = big_principal_stretches(C).map(|stretch| stretch.ln() - &ln_J / big(3.0));
            let term = |(mu, alpha): (f64, f64)| {
                let powers = e.iter().fold(big(0.0), |sum: Big, e| sum + (big(alpha) * e).exp());
                big(mu) / big(alpha) * (powers - big(3.0))
            };
            TRELOAR.into_iter().fold(energy(law, K, &big_det(C)), |sum, p| sum + term(p))
        });
    }

    #[test]
    fn bad_parameters_are_rejected() {
        let new = |terms: &[(f64, f64)], K| Ogden::new(terms, K, Volumetric::default());
        rejects("mu", new(&[], 1.0));
        rejects("mu", new(&[(1.0, -2.0)], 1.0));
        rejects("mu", new(&[(f64::NAN, 2.0)], 1.0));
        rejects("alpha", new(&[(1.0, 2.0), (1.0, 0.0)], 1.0));
        rejects("alpha", new(&[(1.0, f64::INFINITY)], 1.0));
        rejects("bulk_modulus", new(&[(1.0, 2.0)], 0.0));
    }
}
