//! The time finite element of degree k (section 3) as a value, and the coefficients of its stage equations.

use std::fmt;

use super::scheme_force::SchemeDamping;
use super::stage_coefficients::StageCoefficients;
use crate::average::{AveragingRule, Rule};
use crate::error::{Error, Result};
use crate::force::Sampling;
use crate::sparse::accurate_inverse;

/// Highest degree of a time element: beyond, the stage equations are too ill-conditioned for any gain.
///
/// ```
/// use emmy::time::{MAX_DEGREE, TimeElement};
/// assert!(TimeElement::discrete_gradient(MAX_DEGREE).is_ok() && TimeElement::discrete_gradient(MAX_DEGREE + 1).is_err());
/// ```
pub const MAX_DEGREE: usize = 8;

/// Time finite element: an averaging rule, a degree, and optional dissipation.
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
/// With a spectral radius rho at infinite frequency, from 1 (no dissipation) to 0, the element dissipates energy in the
/// highest polynomial mode of a step and never adds any. Momenta are conserved, rigid motions are not damped, the order
/// is 2 k - 1. After Hairer and Wanner (1981), Armero and Romero (2001).
///
/// ```
/// use emmy::time::TimeElement;
/// let element = TimeElement::discrete_gradient(2)?.dissipating(0.8)?;
/// assert_eq!(element.to_string(), "DGM(0.8), degree 2");
/// assert_eq!((element.order(), element.conserving().order()), (3, 4));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeElement {
    /// Averaging rule.
    pub rule: AveragingRule,
    /// Degree k.
    pub degree: usize,
    /// Spectral radius at infinite frequency of a dissipative element.
    pub spectral_radius: Option<f64>,
}

impl TimeElement {
    /// The mid-point rule, FE(1) of degree 1.
    pub const MID_POINT: TimeElement =
        TimeElement { rule: AveragingRule::Standard(1), degree: 1, spectral_radius: None };
    /// The method of Simo and Tarnow (1992) for the St. Venant-Kirchhoff material, AS(1) of degree 1.
    pub const SIMO_TARNOW: TimeElement =
        TimeElement { rule: AveragingRule::AssumedStrain(1), degree: 1, spectral_radius: None };

    /// An element without dissipation.
    ///
    /// # Errors
    /// [`Error::Scheme`] if the degree is not between 1 and [`MAX_DEGREE`], or the rule has too few points for it.
    pub fn new(rule: AveragingRule, degree: usize) -> Result<Self> {
        let element = TimeElement { rule, degree, spectral_radius: None };
        element.check().map(|()| element)
    }

    /// `FE(n)`: standard element with n Gauss points.
    ///
    /// # Errors
    /// As [`TimeElement::new`].
    pub fn standard(points: usize, degree: usize) -> Result<Self> {
        TimeElement::new(AveragingRule::Standard(points), degree)
    }

    /// `AS(n)`: assumed strain in time with n inner Gauss points. It conserves momenta, and energy up to the inner
    /// rule.
    ///
    /// # Errors
    /// As [`TimeElement::new`].
    pub fn assumed_strain(points: usize, degree: usize) -> Result<Self> {
        TimeElement::new(AveragingRule::AssumedStrain(points), degree)
    }

    /// `DGM`: discrete gradient method. It conserves momenta and energy for every material.
    ///
    /// # Errors
    /// As [`TimeElement::new`].
    pub fn discrete_gradient(degree: usize) -> Result<Self> {
        TimeElement::new(AveragingRule::DiscreteGradient, degree)
    }

    /// The element with dissipation; `spectral_radius`: at infinite frequency, from 1 (none) to 0.
    ///
    /// # Errors
    /// [`Error::Scheme`] if the spectral radius is not in \[0, 1\], or the rule is neither AS nor DGM.
    pub fn dissipating(self, spectral_radius: f64) -> Result<Self> {
        let element = TimeElement { spectral_radius: Some(spectral_radius), ..self };
        element.check().map(|()| element)
    }

    /// The element without its dissipation.
    pub fn conserving(self) -> Self {
        TimeElement { spectral_radius: None, ..self }
    }

    /// The element of another degree, with more points if that degree needs them.
    ///
    /// ```
    /// use emmy::time::TimeElement;
    /// assert_eq!(TimeElement::MID_POINT.at_degree(2)?, TimeElement::standard(2, 2)?);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`TimeElement::new`].
    pub fn at_degree(self, degree: usize) -> Result<Self> {
        let element = TimeElement { rule: self.rule.for_degree(degree), degree, ..self };
        element.check().map(|()| element)
    }

    /// Order of the error at the time nodes: 2 k, and 2 k - 1 with dissipation.
    pub fn order(self) -> usize {
        if self.spectral_radius.is_some() { 2 * self.degree - 1 } else { 2 * self.degree }
    }

    /// Its scheme as written in an input, without the degree: `DGM(0.8)`.
    pub fn name(self) -> String {
        let (word, points) = self.rule.word_and_points();
        named(word, points.map(|n| n as f64).into_iter().chain(self.spectral_radius))
    }

    /// Checks that rule, degree and spectral radius are compatible.
    ///
    /// # Errors
    /// [`Error::Scheme`].
    pub fn check(self) -> Result<()> {
        let checked = if (1..=MAX_DEGREE).contains(&self.degree) {
            self.rule.check_degree(self.degree).and_then(|()| self.check_spectral_radius())
        } else {
            Err(format!("the degree must be between 1 and {MAX_DEGREE}, not {}", self.degree))
        };
        checked.map_err(|reason| Error::Scheme { scheme: self.name(), reason })
    }

    /// Checks the spectral radius; the error is the reason.
    pub(super) fn check_spectral_radius(self) -> Result<(), String> {
        match self.spectral_radius {
            Some(radius) => {
                check_spectral_radius(radius)?;
                if self.rule.is_energy_momentum() {
                    Ok(())
                } else {
                    Err("only AS and DGM can dissipate".to_string())
                }
            }
            None => Ok(()),
        }
    }

    /// Coefficients of the stage equations.
    pub(crate) fn coefficients(self) -> StageCoefficients {
        let rule = Rule::new(self.rule, self.degree);
        let a = rule.coefficients().to_vec();
        let [a_inverse, low] = accurate_inverse(&a);
        match self.spectral_radius {
            None => StageCoefficients {
                sampling: Sampling::Averages,
                mass: a_inverse,
                mass_low: low,
                inverse_mass: a.clone(),
                response: a,
                damping: None,
                rule,
            },
            Some(radius) => {
                let damping = SchemeDamping::new(&rule, &a_inverse, radius);
                let a = damping.coefficients(&rule);
                let [mass, mass_low] = accurate_inverse(&a);
                StageCoefficients {
                    sampling: Sampling::Averages,
                    mass,
                    mass_low,
                    inverse_mass: a.clone(),
                    response: a,
                    damping: Some(damping),
                    rule,
                }
            }
        }
    }
}

impl fmt::Display for TimeElement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, degree {}", self.name(), self.degree)
    }
}

/// A word with arguments, `AS(5, 0.8)`; the word alone if there are none.
pub(super) fn named(word: &str, arguments: impl IntoIterator<Item = f64>) -> String {
    let arguments: Vec<String> = arguments.into_iter().map(|value| value.to_string()).collect();
    if arguments.is_empty() { word.to_string() } else { format!("{word}({})", arguments.join(", ")) }
}

/// Checks the range of a spectral radius at infinite frequency; the error is the reason.
pub(super) fn check_spectral_radius(radius: f64) -> Result<(), String> {
    if (0.0..=1.0).contains(&radius) {
        Ok(())
    } else {
        Err("rho, the spectral radius at infinity, must be in [0, 1]".to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_match_gauss_collocation() {
        // Butcher (1964): the two-stage Gauss method.
        let coefficients = TimeElement::standard(2, 2).unwrap().coefficients();
        let root = 3f64.sqrt() / 6.0;
        let expected = [0.25, 0.25 - root, 0.25 + root, 0.25];
        for (a, b) in coefficients.rule.coefficients().iter().zip(expected) {
            assert!((a - b).abs() < 1e-15);
        }
        for k in 1..=MAX_DEGREE {
            let StageCoefficients { rule, mass, .. } =
                TimeElement::discrete_gradient(k).unwrap().coefficients();
            let a = rule.coefficients();
            for (i, j) in (0..k * k).map(|n| (n / k, n % k)) {
                let product: f64 = (0..k).map(|m| a[i * k + m] * mass[m * k + j]).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn continuation_is_exact_for_the_polynomial() {
        // q = t^3 on a step 0..1, continued over 1..1.7: rates dq/dalpha at the Gauss points.
        let rule = TimeElement::standard(3, 3).unwrap().coefficients().rule;
        let c = rule.nodes();
        let old = [0, 1, 2].map(|j| 3.0 * c[j] * c[j]);
        let ratio = 0.7;
        let mut e = [0.0; 9];
        rule.continuation(ratio, &mut e);
        for i in 0..3 {
            let t = 1.0 + ratio * c[i];
            let rate: f64 = (0..3).map(|j| e[3 * i + j] * old[j]).sum();
            assert!((rate - 3.0 * t * t * ratio).abs() < 1e-13);
        }
    }

    #[test]
    fn only_energy_momentum_rules_dissipate() {
        assert!(TimeElement::assumed_strain(3, 2).unwrap().dissipating(0.5).is_ok());
        assert!(TimeElement::MID_POINT.dissipating(0.5).is_err());
        assert!(TimeElement::SIMO_TARNOW.dissipating(f64::NAN).is_err());
    }
}
