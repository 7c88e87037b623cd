//! The five elastic constants of an isotropic solid at small strain, of which any two determine the others.

#![allow(non_snake_case)]

use super::lame;
use super::model::{BULK_MODULUS, Bounds, IfAbsent, Parameter, Values};
use crate::error::{Error, Result};

/// Lamé parameters, Young's modulus, Poisson's ratio and bulk modulus.
pub const ELASTIC_CONSTANTS: &[Parameter] = &[
    Parameter::number("lambda", Bounds::Any, "stress", "First Lamé parameter, above -2/3 `mu`").of_a_pair(),
    Parameter::positive("mu", "stress", "Shear modulus G at small strain").of_a_pair(),
    Parameter::positive("youngs_modulus", "stress", "Young's modulus E at small strain").of_a_pair(),
    Parameter::number("poissons_ratio", Bounds::Between(-1.0, 0.5), "", "Poisson's ratio nu at small strain")
        .of_a_pair(),
    BULK_MODULUS.of_a_pair(),
];

/// Names of the constants in the order of the formulas below.
const NAMES: [&str; 5] = ["youngs_modulus", "poissons_ratio", "mu", "bulk_modulus", "lambda"];

impl Parameter {
    /// The same parameter as one of the elastic constants.
    const fn of_a_pair(self) -> Self {
        self.if_absent(IfAbsent::FromTwoOthers)
    }
}

/// Lamé parameters and bulk modulus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// First Lamé parameter.
    pub lambda: f64,
    /// Shear modulus.
    pub mu: f64,
    /// Bulk modulus.
    pub bulk_modulus: f64,
}

impl Values {
    /// Lamé parameters and bulk modulus from the two of [`ELASTIC_CONSTANTS`] that are given; without two they are NaN.
    ///
    /// ```
    /// use emmy::internals::material::{Value, Values};
    /// // The standard formulas for E and G: K = E G / (3 (3 G - E)).
    /// let values = Values::from_iter([("youngs_modulus", Value::Number(2.5)), ("mu", Value::Number(1.0))]);
    /// let elastic = values.elastic("neo-hooke")?;
    /// assert!((elastic.bulk_modulus - 5.0 / 3.0).abs() < 1e-15 && (elastic.lambda - 1.0).abs() < 1e-15);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::MaterialParameter`] if no stable solid has the two.
    pub fn elastic(&self, material: &'static str) -> Result<Elastic> {
        let given = NAMES.map(|name| self.optional(name));
        let (lambda, mu, bulk_modulus) = match given {
            [Some(E), Some(nu), None, None, None] => {
                let (lambda, mu) = lame(material, E, nu)?;
                (lambda, mu, E / (3.0 * (1.0 - 2.0 * nu)))
            }
            [Some(E), None, Some(mu), None, None] => {
                let factor = mu / (3.0 * mu - E);
                (factor * (E - 2.0 * mu), mu, factor * E / 3.0)
            }
            [Some(E), None, None, Some(K), None] => {
                let factor = 3.0 * K / (9.0 * K - E);
                (factor * (3.0 * K - E), factor * E, K)
            }
            [Some(E), None, None, None, Some(lambda)] => {
                let (difference, root) =
                    (E - 3.0 * lambda, (E * E + 9.0 * lambda * lambda + 2.0 * E * lambda).sqrt());
                // Both are the positive root; the second one without cancellation where lambda is large.
                let mu = match difference >= 0.0 {
                    true => (difference + root) / 4.0,
                    false => 2.0 * E * lambda / (root - difference),
                };
                (lambda, mu, lambda + 2.0 / 3.0 * mu)
            }
            [None, Some(nu), Some(mu), None, None] => {
                let factor = 2.0 * mu / (1.0 - 2.0 * nu);
                (factor * nu, mu, factor * (1.0 + nu) / 3.0)
            }
            [None, Some(nu), None, Some(K), None] => {
                let factor = 3.0 * K / (1.0 + nu);
                (factor * nu, factor * (0.5 - nu), K)
            }
            [None, Some(nu), None, None, Some(lambda)] => {
                let factor = lambda / nu;
                (lambda, factor * (0.5 - nu), factor * (1.0 + nu) / 3.0)
            }
            // The constructors check these two pairs.
            [None, None, Some(mu), Some(K), None] => {
                return Ok(Elastic { lambda: K - 2.0 / 3.0 * mu, mu, bulk_modulus: K });
            }
            [None, None, Some(mu), None, Some(lambda)] => {
                return Ok(Elastic { lambda, mu, bulk_modulus: lambda + 2.0 / 3.0 * mu });
            }
            [None, None, None, Some(K), Some(lambda)] => (lambda, 1.5 * (K - lambda), K),
            _ => return Ok(Elastic { lambda: f64::NAN, mu: f64::NAN, bulk_modulus: f64::NAN }),
        };
        if mu > 0.0 && bulk_modulus > 0.0 && bulk_modulus.is_finite() {
            return Ok(Elastic { lambda, mu, bulk_modulus });
        }
        let [_, poissons_ratio, ..] = given;
        Err(match poissons_ratio {
            Some(_) => {
                let requirement = "must be positive: the first Lamé parameter and Poisson's ratio have one sign and are not 0";
                Error::MaterialParameter { material, parameter: "mu", value: mu, requirement }
            }
            None => {
                let value = (3.0 * bulk_modulus - 2.0 * mu) / (6.0 * bulk_modulus + 2.0 * mu);
                let requirement = "must lie between -1 and 0.5 for a stable solid";
                Error::MaterialParameter { material, parameter: "poissons_ratio", value, requirement }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::model::Value;
    use super::*;

    /// The values of two of the constants.
    fn pair(own: [(usize, f64); 2]) -> Values {
        Values::from_iter(own.map(|(index, value)| (NAMES[index], Value::Number(value))))
    }

    #[test]
    fn all_ten_pairs_give_the_same_solid() {
        for nu in [-0.9_f64, -0.2, 0.01, 0.3, 0.4999] {
            // With mu = 2: E = 2 mu (1 + nu), and K and lambda by the definition of Poisson's ratio.
            let (mu, E) = (2.0, 4.0 * (1.0 + nu));
            let lambda = 2.0 * mu * nu / (1.0 - 2.0 * nu);
            let bulk_modulus = lambda + 2.0 * mu / 3.0;
            let all = [E, nu, mu, bulk_modulus, lambda];
            for (i, j) in (0..5).flat_map(|i| (i + 1..5).map(move |j| (i, j))) {
                let own = pair([(i, all[i]), (j, all[j])]).elastic("neo-hooke").unwrap();
                // Some pairs amplify rounding by up to 1/(1 - 2 nu) = 5000, in (E, K), (E, G) and (K, lambda).
                let near =
                    |a: f64, b: f64| (a - b).abs() <= 1e-11 * (1.0 + b.abs()) * (1.0 + mu / (1.0 + nu));
                assert!(
                    near(own.lambda, lambda) && near(own.mu, mu) && near(own.bulk_modulus, bulk_modulus),
                    "{i} {j} {nu}: {own:?}"
                );
            }
        }
    }

    #[test]
    fn pairs_of_no_solid_are_rejected() {
        let parameter = |own| match pair(own).elastic("neo-hooke").unwrap_err() {
            Error::MaterialParameter { parameter, value, .. } => (parameter, value),
            other => panic!("{other}"),
        };
        // E/(2 G) - 1 = 1; a bulk modulus of E/9 belongs to nu = -1, below it there is none.
        assert_eq!(parameter([(0, 4.0), (2, 1.0)]), ("poissons_ratio", 1.0));
        assert_eq!(parameter([(0, 18.0), (3, 1.0)]).0, "poissons_ratio");
        // nu = lambda/(3 K - lambda) = 2.
        assert_eq!(parameter([(3, 1.0), (4, 2.0)]), ("poissons_ratio", 2.0));
        // mu = lambda (1 - 2 nu)/(2 nu).
        assert_eq!(parameter([(1, -0.25), (4, 1.0)]), ("mu", -3.0));
        assert_eq!(parameter([(1, 0.0), (4, 1.0)]).0, "mu");
        assert_eq!(parameter([(0, 1.0), (1, 0.5)]), ("poissons_ratio", 0.5));
    }

    #[test]
    fn nearly_incompressible_solids_keep_their_digits() {
        // E = mu (3 lambda + 2 mu)/(lambda + mu), and mu = 1 for lambda = 1e12.
        let lambda = 1e12;
        let own = pair([(0, (3.0 * lambda + 2.0) / (lambda + 1.0)), (4, lambda)]).elastic("hencky").unwrap();
        assert!((own.mu - 1.0).abs() < 1e-15, "{}", own.mu);
    }
}
