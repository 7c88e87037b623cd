//! The time finite element of degree k (section 3): coefficients of its stage equations.

use super::stage_system::StageForm;
use super::{Dissipation, Scheme};
use crate::average::Rule;
use crate::error::{Error, Result};
use crate::quadrature::{gauss, lobatto};
use crate::sparse::inverse;

/// Time element of a degree with the averaging rule of a scheme.
///
/// On a step of size h, `q^h(alpha) = q_1 + sum_j L_j(alpha) x_j`, where `L_j` are the integrals of the Lagrange basis
/// on the k Gauss points `c_i`. The unknowns x_j \[length\] obey, for i = 1..k,
///
/// ```math
/// R_i = sum_j (a^-1)_ij (M x_j - h p_1) + h^2 (f_i - f_i^ext) = 0,     p_2 = p_1 - h sum_j b_j (f_j - f_j^ext)
/// ```
///
/// (Betsch and Steinmann (2001), equations (28)-(32); for k = 1 equation (42).)
///
/// ```
/// use emmy::time::{Scheme, TimeElement};
/// let element = TimeElement::new(Scheme::MID_POINT, 1)?;
/// assert_eq!(element.inverse_coefficients(), [2.0]);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct TimeElement {
    scheme: Scheme,
    rule: Rule,
    inverse: Vec<f64>,
    dissipation: Option<Dissipation>,
}

impl TimeElement {
    /// The element.
    ///
    /// # Errors
    /// [`Error::Scheme`] if the scheme is not a time element's or cannot go with the degree.
    pub fn new(scheme: Scheme, degree: usize) -> Result<Self> {
        scheme.check(degree)?;
        let rule = match scheme {
            Scheme::Standard(n) => Rule::standard(degree, &gauss(n)),
            Scheme::AssumedStrain(n) | Scheme::DissipativeAssumedStrain { points: n, .. } => {
                Rule::assumed_strain(degree, n)
            }
            Scheme::DiscreteGradient | Scheme::DissipativeDiscreteGradient { .. } => {
                Rule::discrete_gradient(degree)
            }
            Scheme::Trapezoidal => Rule::standard(degree, &lobatto(2)),
            Scheme::Lobatto(n) => Rule::standard(degree, &lobatto(n)),
            _ => {
                let reason = "it is a stepper of its own, not a time element".to_string();
                return Err(Error::Scheme { scheme: scheme.to_string(), reason });
            }
        };
        let inverse = inverse(rule.coefficients());
        let dissipation = scheme.dissipation().map(|radius| Dissipation::new(&rule, &inverse, radius));
        Ok(TimeElement { scheme, rule, inverse, dissipation })
    }

    /// Scheme.
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// Averaging rule.
    pub fn rule(&self) -> &Rule {
        &self.rule
    }

    /// Degree k.
    pub fn degree(&self) -> usize {
        self.rule.degree()
    }

    /// Coefficients (a^-1)_ij, `[i k + j]`.
    pub fn inverse_coefficients(&self) -> &[f64] {
        &self.inverse
    }
}

impl From<TimeElement> for StageForm {
    fn from(element: TimeElement) -> StageForm {
        let TimeElement { rule, dissipation, .. } = element;
        let (mass, a) = match &dissipation {
            None => (element.inverse, rule.coefficients().to_vec()),
            Some(dissipation) => {
                let a = dissipation.coefficients(&rule);
                (inverse(&a), a)
            }
        };
        StageForm { mass, inverse_mass: a.clone(), response: a, dissipation, rule }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_those_of_gauss_collocation() {
        // Butcher (1964): the two-stage Gauss method.
        let element = TimeElement::new(Scheme::Standard(2), 2).unwrap();
        let root = 3f64.sqrt() / 6.0;
        let expected = [0.25, 0.25 - root, 0.25 + root, 0.25];
        for (a, b) in element.rule().coefficients().iter().zip(expected) {
            assert!((a - b).abs() < 1e-15);
        }
        for k in 1..=super::super::MAX_DEGREE {
            let element = TimeElement::new(Scheme::DiscreteGradient, k).unwrap();
            let (a, inverse) = (element.rule().coefficients(), element.inverse_coefficients());
            for (i, j) in (0..k * k).map(|n| (n / k, n % k)) {
                let product: f64 = (0..k).map(|m| a[i * k + m] * inverse[m * k + j]).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn continuation_is_exact_for_the_polynomial() {
        // q = t^3 on a step 0..1, continued over 1..1.7: rates dq/dalpha at the Gauss points.
        let element = TimeElement::new(Scheme::Standard(3), 3).unwrap();
        let c = element.rule().nodes();
        let (old, ratio) = ([0, 1, 2].map(|j| 3.0 * c[j] * c[j]), 0.7);
        let mut e = [0.0; 9];
        element.rule().continuation(ratio, &mut e);
        for i in 0..3 {
            let t = 1.0 + ratio * c[i];
            let rate: f64 = (0..3).map(|j| e[3 * i + j] * old[j]).sum();
            assert!((rate - 3.0 * t * t * ratio).abs() < 1e-13);
        }
    }
}
