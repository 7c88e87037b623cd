//! Arruda-Boyce material.

use super::elastic::ELASTIC_CONSTANTS;
use super::isochoric::Isochoric;
use super::model::{Bounds, Model, ModelCells, Modelled, Parameter, VOLUMETRIC, Values};
use super::polynomial::Polynomial;
use super::volumetric::Volume;
use super::{Volumetric, fulfils, positive, split_material};
use crate::error::Result;
use crate::tensor::Lane;

/// Arruda-Boyce material: eight chains of rigid links, for rubber up to near its locking stretch.
///
/// ```math
/// W = n sum_i C_i / lambda_m^(2i-2) (I1bar^i - 3^i) + W_vol(J),      C = 1/2, 1/20, 11/1050, 19/7000, 519/673750
/// mu = n (1 + 3/5 r + 99/175 r^2 + 513/875 r^3 + 42039/67375 r^4),      r = 1/lambda_m^2
/// ```
///
/// The inverse Langevin function is expanded to five terms. Source: Arruda and Boyce (1993), J. Mech. Phys. Solids 41.
/// mu, the shear modulus at small strain, and the bulk modulus in \[force/length^2\]; lambda_m, the locking
/// stretch of a chain, has no dimension.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = ArrudaBoyce::new(3.0, 2.8, 100.0, Volumetric::default())?;
/// // Nearly neo-Hooke at a shear by 0.01: W = mu/2 0.01^2.
/// let energy = rubber.strain_energy(&[0.0, 0.5e-4, 0.0, 0.5e-2, 0.0, 0.0]);
/// assert!((energy / 1.5e-4 - 1.0).abs() < 1e-5);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArrudaBoyce {
    polynomial: Polynomial<5>,
    volume: Volume,
}

const NAME: &str = "arruda-boyce";

/// C_i.
const SERIES: [f64; 5] = [0.5, 1.0 / 20.0, 11.0 / 1050.0, 19.0 / 7000.0, 519.0 / 673_750.0];

impl ArrudaBoyce {
    /// The material with shear modulus, locking stretch, bulk modulus, and law of volume.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless mu > 0, lambda_m > 1 and the bulk modulus is positive.
    pub fn new(mu: f64, lambda_m: f64, bulk_modulus: f64, volumetric: Volumetric) -> Result<Self> {
        positive(NAME, "mu", mu)?;
        let locks = lambda_m > 1.0 && lambda_m.is_finite();
        fulfils(locks, NAME, "lambda_m", lambda_m, "must be finite and larger than 1")?;
        let volume = Volume::new(NAME, bulk_modulus, volumetric)?;
        let unscaled = in_powers_of_the_difference(lambda_m);
        let scale = mu / (2.0 * unscaled[0]);
        Ok(ArrudaBoyce { polynomial: Polynomial(unscaled.map(|c| c * scale)), volume })
    }
}

/// The series in powers of x = I1bar - 3, which does not cancel: I1bar^i - 3^i = sum_n (i over n) 3^(i-n) x^n.
fn in_powers_of_the_difference(lambda_m: f64) -> [f64; 5] {
    const PASCAL: [[f64; 5]; 5] = [
        [1.0, 0.0, 0.0, 0.0, 0.0],
        [2.0, 1.0, 0.0, 0.0, 0.0],
        [3.0, 3.0, 1.0, 0.0, 0.0],
        [4.0, 6.0, 4.0, 1.0, 0.0],
        [5.0, 10.0, 10.0, 5.0, 1.0],
    ];
    let r = 1.0 / (lambda_m * lambda_m);
    [0, 1, 2, 3, 4].map(|n| {
        let term = |i: usize| SERIES[i] * r.powi(i as i32) * PASCAL[i][n] * 3f64.powi(i as i32 - n as i32);
        (n..5).map(term).sum()
    })
}

impl Modelled for ArrudaBoyce {
    const MODEL: Model = Model {
        name: NAME,
        energy: "n(mu) sum_i C_i/lambda_m^(2i-2) (I1bar^i - 3^i) + W_vol(J), C = 1/2, 1/20, 11/1050, 19/7000, 519/673750",
        purpose: "rubber, eight chains of rigid links",
        parameters: &[
            ELASTIC_CONSTANTS,
            &[
                Parameter::number("lambda_m", Bounds::Above(1.0), "", "Locking stretch of a chain"),
                VOLUMETRIC,
            ],
        ],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let own = values.elastic(NAME)?;
        ArrudaBoyce::new(own.mu, values.number("lambda_m"), own.bulk_modulus, values.law())
    }
}

impl Isochoric for ArrudaBoyce {
    fn volume(&self) -> &Volume {
        &self.volume
    }
    fn with_volume(&self, volume: Volume) -> Self {
        ArrudaBoyce { volume, ..*self }
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

split_material!(ArrudaBoyce, isochoric);

#[cfg(test)]
mod tests {
    use super::super::conformance::{Big, big, big_det, big_isochoric, conforms};
    use super::super::tests::rejects;
    use super::super::volumetric::tests::energy;
    use super::*;

    #[test]
    fn conforms_to_its_textbook_form() {
        let mu = 500.0;
        let lambda_m = 2.5;
        let K = 1500.0;
        let law = Volumetric::Liu;
        conforms(&ArrudaBoyce::new(mu, lambda_m, K, law).unwrap(), [K - 2.0 / 3.0 * mu, mu], |C| {
            let fraction = |a: f64, b: f64| big(a) / big(b);
            let r = fraction(1.0, lambda_m * lambda_m);
            let series = [(1.0, 2.0), (1.0, 20.0), (11.0, 1050.0), (19.0, 7000.0), (519.0, 673_750.0)];
            let initial = [(1.0, 1.0), (3.0, 5.0), (99.0, 175.0), (513.0, 875.0), (42039.0, 67375.0)];
            let mut power = big(1.0);
            let mut I1 = big_isochoric(C)[0].clone();
            let mut three = big(3.0);
            let (mut sum, mut n): (Big, Big) = (big(0.0), big(0.0));
            let first = I1.clone();
            for ((a, b), (c, d)) in series.into_iter().zip(initial) {
                sum += fraction(a, b) * &power * (&I1 - &three);
                n += fraction(c, d) * &power;
                power *= &r;
                I1 *= &first;
                three *= big(3.0);
            }
            big(mu) / n * sum + energy(law, K, &big_det(C))
        });
    }

    #[test]
    fn bad_parameters_are_rejected() {
        let new = |mu, lambda_m, K| ArrudaBoyce::new(mu, lambda_m, K, Volumetric::default());
        rejects("mu", new(0.0, 2.0, 1.0));
        rejects("lambda_m", new(1.0, 1.0, 1.0));
        rejects("bulk_modulus", new(1.0, 2.0, 0.0));
    }
}
