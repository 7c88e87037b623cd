//! Schemes as data: printed and parsed as in the paper.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// How a step is made: the rule by which a time element averages the stress over it, or one of the methods in common use
/// that are not time elements. What a time element conserves is that of the paper's Table III.
///
/// | scheme | angular momentum | energy, St. Venant-Kirchhoff | energy, in general |
/// |---|---|---|---|
/// | `FE(k)` at degree k | yes | no | no |
/// | `FE(n)`, n > k | no | up to its quadrature | up to its quadrature |
/// | `AS(k)` | yes | yes | no |
/// | `AS(n)`, n > k | yes | yes | up to its quadrature |
/// | `DGM` | yes | yes | yes |
/// | `AS(n, rho)`, `DGM(rho)` | yes | decays | decays (`AS`: up to its quadrature) |
/// | `Newmark`, `HHT`, `generalized-alpha`, `Bathe` | no | no | no |
/// | `central-differences` | yes | no | no |
///
/// ```
/// use emmy::time::Scheme;
/// let scheme: Scheme = "AS(5)".parse()?;
/// assert_eq!(scheme, Scheme::AssumedStrain(5));
/// assert_eq!(scheme.to_string(), "AS(5)");
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scheme {
    /// `FE(n)`: standard time finite element with n Gauss points (section 4.4.1).
    Standard(usize),
    /// `AS(n)`: assumed strain method in time with n inner Gauss points (equation (62)).
    AssumedStrain(usize),
    /// `DGM`: discrete gradient method (equations (63)-(65)).
    DiscreteGradient,
    /// `AS(n, rho)`: assumed strain method that takes energy out of what changes fast in a step, and never gives any; rho, the
    /// spectral radius at infinite frequency, goes from 1 (nothing is taken) to 0. Momenta are conserved, and motions as of a rigid body are left alone. The order is
    /// 2 k - 1. After Hairer and Wanner (1981), Armero and Romero (2001).
    DissipativeAssumedStrain {
        /// Number n of inner Gauss points.
        points: usize,
        /// Spectral radius rho at infinite frequency.
        spectral_radius: f64,
    },
    /// `DGM(rho)`: the discrete gradient method with the same dissipation.
    DissipativeDiscreteGradient {
        /// Spectral radius rho at infinite frequency.
        spectral_radius: f64,
    },
    /// `trapezoidal`: standard element with the trapezoidal rule; at degree 1 the average acceleration method.
    Trapezoidal,
    /// `Lobatto(n)`: standard element with n Lobatto points.
    Lobatto(usize),
    /// `Newmark(beta, gamma)` (Newmark 1959): 0 < beta <= 1, 1/2 <= gamma <= 1. Of second order for gamma = 1/2; stable at any
    /// step for a linear body if 2 beta >= gamma.
    Newmark {
        /// Weight of the new acceleration in the displacement.
        beta: f64,
        /// Weight of the new acceleration in the velocity.
        gamma: f64,
    },
    /// `HHT(alpha)` (Hilber, Hughes and Taylor 1977), 0 <= alpha <= 1/3: the forces are taken at `1 - alpha` of the step. The
    /// authors' own alpha has the opposite sign.
    HilberHughesTaylor {
        /// Dissipation of the high modes; 0 is the average acceleration method.
        alpha: f64,
    },
    /// `generalized-alpha(rho)` (Chung and Hulbert 1993), 0 <= rho <= 1.
    GeneralizedAlpha {
        /// Spectral radius for infinitely high frequencies: 1 no dissipation, 0 all.
        spectral_radius: f64,
    },
    /// `Bathe`: composite of the trapezoidal rule and the three-point backward Euler method (Bathe and Baig 2005), split at
    /// `2 - sqrt 2` of the step (Bank and others 1985), where both parts have the same matrix.
    Bathe,
    /// `central-differences`: explicit, lumped mass, refuses steps beyond the critical one.
    CentralDifferences,
}

/// One line for each scheme: key word and what it is. The order is that of `emmy list schemes`.
pub const SCHEMES: [(&str, &str); 12] = [
    ("FE(n)", "standard time finite element, n Gauss points (n >= degree); FE(1) is the mid-point rule"),
    (
        "AS(n)",
        "assumed strain in time, n inner Gauss points (n >= degree); conserves momentum, energy up to the inner rule",
    ),
    ("DGM", "discrete gradient method; conserves momentum and energy for every material"),
    (
        "AS(n,rho)",
        "AS(n) that damps what a step does not resolve, rho from 1 (nothing) to 0; order 2 degree - 1",
    ),
    (
        "DGM(rho)",
        "DGM that damps what a step does not resolve, rho from 1 (nothing) to 0; order 2 degree - 1",
    ),
    ("trapezoidal", "trapezoidal rule (degree 1): the average acceleration method"),
    ("Lobatto(n)", "standard time finite element, n Lobatto points (n >= degree + 1)"),
    ("Newmark(beta,gamma)", "Newmark's method (degree 1); Newmark(0.25, 0.5) is average acceleration"),
    ("HHT(alpha)", "Hilber, Hughes and Taylor (degree 1), alpha from 0 (no dissipation) to 1/3"),
    (
        "generalized-alpha(rho)",
        "Chung and Hulbert (degree 1), rho from 1 (no dissipation) to 0: high modes decay by it",
    ),
    ("Bathe", "trapezoidal rule and three-point backward Euler (degree 1); high modes vanish"),
    ("central-differences", "explicit with lumped mass (degree 1); conserves momentum; small steps only"),
];

/// Rules with more points than this gain nothing and cost much; more likely a slip of the keyboard.
const MAX_POINTS: usize = 64;

/// Highest degree of a time element: beyond, the stage equations are too ill-conditioned to gain anything.
pub const MAX_DEGREE: usize = 8;

impl Scheme {
    /// The mid-point rule, FE(1) at degree 1.
    pub const MID_POINT: Scheme = Scheme::Standard(1);
    /// The method of Simo and Tarnow (1992) for the St. Venant-Kirchhoff material, AS(1) at degree 1.
    pub const SIMO_TARNOW: Scheme = Scheme::AssumedStrain(1);

    /// Checks that the scheme can go with a degree.
    ///
    /// # Errors
    /// [`Error::Scheme`]: a rule with too few points leaves the step's equations singular.
    pub fn check(self, degree: usize) -> Result<()> {
        let fail = |reason: String| Err(Error::Scheme { scheme: self.to_string(), reason });
        if !(1..=MAX_DEGREE).contains(&degree) {
            return fail(format!("the degree must be between 1 and {MAX_DEGREE}, not {degree}"));
        }
        match self {
            Scheme::Standard(n)
            | Scheme::AssumedStrain(n)
            | Scheme::DissipativeAssumedStrain { points: n, .. }
                if n < degree =>
            {
                fail(format!("degree {degree} needs at least {degree} points: the step would be singular"))
            }
            Scheme::Lobatto(n) if n < degree + 1 => {
                fail(format!("degree {degree} needs at least {} Lobatto points", degree + 1))
            }
            Scheme::Trapezoidal if degree != 1 => fail(format!(
                "it goes with degree 1 only, not {degree}; Lobatto(n) is its kin for higher degrees"
            )),
            Scheme::Standard(n)
            | Scheme::AssumedStrain(n)
            | Scheme::DissipativeAssumedStrain { points: n, .. }
            | Scheme::Lobatto(n)
                if n > MAX_POINTS =>
            {
                fail(format!("at most {MAX_POINTS} points"))
            }
            _ if degree != 1 && !self.is_time_element() => {
                fail(format!("it is not a time element and goes with degree 1 only, not {degree}"))
            }
            _ => self.check_parameters(),
        }
    }

    /// The scheme with as many more points as another degree needs.
    ///
    /// ```
    /// use emmy::time::Scheme;
    /// assert_eq!(Scheme::MID_POINT.of_degree(2), Scheme::Standard(2));
    /// assert_eq!(Scheme::Trapezoidal.of_degree(2), Scheme::Lobatto(3));
    /// ```
    pub fn of_degree(self, degree: usize) -> Scheme {
        match self {
            Scheme::Standard(n) => Scheme::Standard(n.max(degree)),
            Scheme::AssumedStrain(n) => Scheme::AssumedStrain(n.max(degree)),
            Scheme::Lobatto(n) => Scheme::Lobatto(n.max(degree + 1)),
            Scheme::DissipativeAssumedStrain { points, spectral_radius } => {
                Scheme::DissipativeAssumedStrain { points: points.max(degree), spectral_radius }
            }
            Scheme::Trapezoidal if degree > 1 => Scheme::Lobatto(degree + 1),
            scheme => scheme,
        }
    }

    /// Spectral radius at infinite frequency of a time element that dissipates.
    pub fn dissipation(self) -> Option<f64> {
        match self {
            Scheme::DissipativeAssumedStrain { spectral_radius, .. }
            | Scheme::DissipativeDiscreteGradient { spectral_radius } => Some(spectral_radius),
            _ => None,
        }
    }

    /// The scheme without its dissipation.
    ///
    /// ```
    /// use emmy::time::Scheme;
    /// assert_eq!("AS(5, 0.8)".parse::<Scheme>()?.conserving(), Scheme::AssumedStrain(5));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn conserving(self) -> Scheme {
        match self {
            Scheme::DissipativeAssumedStrain { points, .. } => Scheme::AssumedStrain(points),
            Scheme::DissipativeDiscreteGradient { .. } => Scheme::DiscreteGradient,
            scheme => scheme,
        }
    }

    /// Order of the error of a time element of a degree at its nodes: 2 k, and 2 k - 1 with dissipation.
    pub fn order(self, degree: usize) -> usize {
        if self.dissipation().is_some() { 2 * degree - 1 } else { 2 * degree }
    }

    /// Whether the scheme is a rule of a time element.
    pub fn is_time_element(self) -> bool {
        match self {
            Scheme::Standard(_) | Scheme::AssumedStrain(_) | Scheme::DiscreteGradient => true,
            Scheme::DissipativeAssumedStrain { .. } | Scheme::DissipativeDiscreteGradient { .. } => true,
            Scheme::Trapezoidal | Scheme::Lobatto(_) => true,
            Scheme::Newmark { .. } | Scheme::HilberHughesTaylor { .. } => false,
            Scheme::GeneralizedAlpha { .. } | Scheme::Bathe | Scheme::CentralDifferences => false,
        }
    }

    /// Checks that real parameters are in their range.
    fn check_parameters(self) -> Result<()> {
        let fail = |reason: &str| Err(Error::Scheme { scheme: self.to_string(), reason: reason.to_string() });
        match self {
            Scheme::Newmark { beta: 0.0, .. } => {
                fail("beta must be in (0, 1]; beta = 0 is explicit: central-differences")
            }
            Scheme::Newmark { beta, .. } if !(beta > 0.0 && beta <= 1.0) => fail("beta must be in (0, 1]"),
            Scheme::Newmark { gamma, .. } if !(0.5..=1.0).contains(&gamma) => {
                fail("gamma must be in [0.5, 1]: below 0.5 every motion grows")
            }
            Scheme::HilberHughesTaylor { alpha } if !(0.0..=1.0 / 3.0).contains(&alpha) => fail(
                "alpha must be in [0, 1/3]; it is counted positive: HHT(0.05) is alpha = -0.05 of the authors",
            ),
            Scheme::GeneralizedAlpha { spectral_radius }
            | Scheme::DissipativeAssumedStrain { spectral_radius, .. }
            | Scheme::DissipativeDiscreteGradient { spectral_radius }
                if !(0.0..=1.0).contains(&spectral_radius) =>
            {
                fail("rho, the spectral radius at infinity, must be in [0, 1]")
            }
            _ => Ok(()),
        }
    }
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Scheme::Standard(n) => write!(f, "FE({n})"),
            Scheme::AssumedStrain(n) => write!(f, "AS({n})"),
            Scheme::DiscreteGradient => f.write_str("DGM"),
            Scheme::DissipativeAssumedStrain { points, spectral_radius } => {
                write!(f, "AS({points}, {spectral_radius})")
            }
            Scheme::DissipativeDiscreteGradient { spectral_radius } => write!(f, "DGM({spectral_radius})"),
            Scheme::Trapezoidal => f.write_str("trapezoidal"),
            Scheme::Lobatto(n) => write!(f, "Lobatto({n})"),
            Scheme::Newmark { beta, gamma } => write!(f, "Newmark({beta}, {gamma})"),
            Scheme::HilberHughesTaylor { alpha } => write!(f, "HHT({alpha})"),
            Scheme::GeneralizedAlpha { spectral_radius } => write!(f, "generalized-alpha({spectral_radius})"),
            Scheme::Bathe => f.write_str("Bathe"),
            Scheme::CentralDifferences => f.write_str("central-differences"),
        }
    }
}

impl FromStr for Scheme {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let argument = |name: &str| text.strip_prefix(name)?.strip_prefix('(')?.strip_suffix(')');
        let points = |name: &str| argument(name)?.parse().ok().filter(|&n: &usize| n >= 1);
        let number = |name: &str| argument(name)?.trim().parse::<f64>().ok();
        let pair = |name: &str| {
            let (first, second) = argument(name)?.split_once(',')?;
            Some((first.trim().parse::<f64>().ok()?, second.trim().parse::<f64>().ok()?))
        };
        let scheme = match text {
            "DGM" => Some(Scheme::DiscreteGradient),
            "trapezoidal" => Some(Scheme::Trapezoidal),
            "Bathe" => Some(Scheme::Bathe),
            "central-differences" => Some(Scheme::CentralDifferences),
            _ => (points("FE").map(Scheme::Standard))
                .or_else(|| points("AS").map(Scheme::AssumedStrain))
                .or_else(|| {
                    let (points, spectral_radius) = argument("AS")?.split_once(',')?;
                    let points = points.trim().parse().ok().filter(|&n: &usize| n >= 1)?;
                    let spectral_radius = spectral_radius.trim().parse().ok()?;
                    Some(Scheme::DissipativeAssumedStrain { points, spectral_radius })
                })
                .or_else(|| {
                    let spectral_radius = number("DGM")?;
                    Some(Scheme::DissipativeDiscreteGradient { spectral_radius })
                })
                .or_else(|| points("Lobatto").map(Scheme::Lobatto))
                .or_else(|| pair("Newmark").map(|(beta, gamma)| Scheme::Newmark { beta, gamma }))
                .or_else(|| number("HHT").map(|alpha| Scheme::HilberHughesTaylor { alpha }))
                .or_else(|| {
                    let radius = number("generalized-alpha")?;
                    Some(Scheme::GeneralizedAlpha { spectral_radius: radius })
                }),
        };
        let scheme = scheme
            .ok_or_else(|| Error::Scheme { scheme: text.to_string(), reason: what_there_is(text).into() })?;
        scheme.check_parameters().map(|()| scheme)
    }
}

/// What to write instead of a text that is not a scheme.
fn what_there_is(text: &str) -> &'static str {
    match text.split('(').next() {
        Some("Newmark") => "not a scheme; write Newmark(beta, gamma), such as Newmark(0.25, 0.5)",
        Some("HHT") => "not a scheme; write HHT(alpha), such as HHT(0.05)",
        Some("generalized-alpha") => {
            "not a scheme; write generalized-alpha(rho), such as generalized-alpha(0.8)"
        }
        _ => {
            "not a scheme; there is FE(n), AS(n), DGM, trapezoidal, Lobatto(n), n a number of points, AS(n, rho) and DGM(rho) that dissipate, and Newmark, HHT, generalized-alpha, Bathe, central-differences"
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scheme_prints_as_it_parses() {
        for text in ["FE(1)", "FE(12)", "AS(5)", "DGM", "trapezoidal", "Lobatto(3)", "Newmark(0.25, 0.5)"] {
            assert_eq!(text.parse::<Scheme>().unwrap().to_string(), text);
        }
        for text in [
            "AS(5, 0.8)",
            "DGM(0)",
            "DGM(0.25)",
            "HHT(0.05)",
            "HHT(0)",
            "generalized-alpha(0.8)",
            "Bathe",
            "central-differences",
        ] {
            assert_eq!(text.parse::<Scheme>().unwrap().to_string(), text);
        }
        assert_eq!("Newmark(.25,5e-1)".parse(), Ok(Scheme::Newmark { beta: 0.25, gamma: 0.5 }));
        for text in
            ["", "FE", "FE(0)", "FE(-1)", "AS(5", "AS 5", "dgm", "FE(1.5)", "FE(99999999999999999999)"]
        {
            assert!(matches!(text.parse::<Scheme>(), Err(Error::Scheme { .. })), "{text}");
        }
    }

    #[test]
    fn parameters_out_of_range_are_refused_with_the_range() {
        for (text, hint) in [
            ("Newmark(0, 0.5)", "central-differences"),
            ("Newmark(-0.25, 0.5)", "(0, 1]"),
            ("Newmark(NaN, 0.5)", "(0, 1]"),
            ("Newmark(0.25, 0.4)", "[0.5, 1]"),
            ("Newmark(0.25)", "Newmark(beta, gamma)"),
            ("Newmark", "Newmark(0.25, 0.5)"),
            ("HHT(-0.05)", "counted positive"),
            ("HHT(0.34)", "[0, 1/3]"),
            ("HHT(inf)", "[0, 1/3]"),
            ("generalized-alpha(1.01)", "[0, 1]"),
            ("DGM(1.5)", "[0, 1]"),
            ("AS(3, -0.1)", "[0, 1]"),
            ("generalized-alpha", "generalized-alpha(0.8)"),
        ] {
            let error = text.parse::<Scheme>().unwrap_err().to_string();
            assert!(error.contains(hint) && error.contains(text), "{error}");
        }
        assert!(Scheme::Newmark { beta: 0.25, gamma: f64::NAN }.check(1).is_err());
        for text in
            ["Newmark(0.25, 0.5)", "HHT(0.05)", "generalized-alpha(0.8)", "Bathe", "central-differences"]
        {
            let scheme: Scheme = text.parse().unwrap();
            assert!(scheme.check(1).is_ok() && scheme.check(2).unwrap_err().to_string().contains("degree 1"));
            assert!(super::super::TimeElement::new(scheme, 1).is_err());
        }
    }

    #[test]
    fn rules_with_too_few_points_are_refused() {
        for (scheme, degree) in
            [("FE(1)", 2), ("AS(2)", 3), ("trapezoidal", 2), ("Lobatto(2)", 2), ("DGM", 0), ("DGM", 9)]
        {
            assert!(scheme.parse::<Scheme>().unwrap().check(degree).is_err(), "{scheme} {degree}");
        }
        for (scheme, degree) in
            [("FE(2)", 2), ("AS(3)", 3), ("trapezoidal", 1), ("Lobatto(3)", 2), ("DGM", 4)]
        {
            scheme.parse::<Scheme>().unwrap().check(degree).unwrap();
        }
    }
}
