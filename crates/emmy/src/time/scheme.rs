//! Schemes as data: printed and parsed as in the paper.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// The rule by which a time element averages the stress over a step. What it conserves is that of the paper's Table III.
///
/// | scheme | angular momentum | energy, St. Venant-Kirchhoff | energy, in general |
/// |---|---|---|---|
/// | `FE(k)` at degree k | yes | no | no |
/// | `FE(n)`, n > k | no | up to its quadrature | up to its quadrature |
/// | `AS(k)` | yes | yes | no |
/// | `AS(n)`, n > k | yes | yes | up to its quadrature |
/// | `DGM` | yes | yes | yes |
///
/// ```
/// use emmy::time::Scheme;
/// let scheme: Scheme = "AS(5)".parse()?;
/// assert_eq!(scheme, Scheme::AssumedStrain(5));
/// assert_eq!(scheme.to_string(), "AS(5)");
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// `FE(n)`: standard time finite element with n Gauss points (section 4.4.1).
    Standard(usize),
    /// `AS(n)`: assumed strain method in time with n inner Gauss points (equation (62)).
    AssumedStrain(usize),
    /// `DGM`: discrete gradient method (equations (63)-(65)).
    DiscreteGradient,
    /// `trapezoidal`: standard element with the trapezoidal rule; at degree 1 the average acceleration method.
    Trapezoidal,
    /// `Lobatto(n)`: standard element with n Lobatto points.
    Lobatto(usize),
}

/// One line for each scheme: key word and what it is. The order is that of `emmy list schemes`.
pub const SCHEMES: [(&str, &str); 5] = [
    ("FE(n)", "standard time finite element, n Gauss points (n >= degree); FE(1) is the mid-point rule"),
    (
        "AS(n)",
        "assumed strain in time, n inner Gauss points (n >= degree); conserves momentum, energy up to the inner rule",
    ),
    ("DGM", "discrete gradient method; conserves momentum and energy for every material"),
    ("trapezoidal", "trapezoidal rule (degree 1): the average acceleration method"),
    ("Lobatto(n)", "standard time finite element, n Lobatto points (n >= degree + 1)"),
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
            Scheme::Standard(n) | Scheme::AssumedStrain(n) if n < degree => {
                fail(format!("degree {degree} needs at least {degree} points: the step would be singular"))
            }
            Scheme::Lobatto(n) if n < degree + 1 => {
                fail(format!("degree {degree} needs at least {} Lobatto points", degree + 1))
            }
            Scheme::Trapezoidal if degree != 1 => fail(format!(
                "it goes with degree 1 only, not {degree}; Lobatto(n) is its kin for higher degrees"
            )),
            Scheme::Standard(n) | Scheme::AssumedStrain(n) | Scheme::Lobatto(n) if n > MAX_POINTS => {
                fail(format!("at most {MAX_POINTS} points"))
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
            Scheme::Trapezoidal => f.write_str("trapezoidal"),
            Scheme::Lobatto(n) => write!(f, "Lobatto({n})"),
        }
    }
}

impl FromStr for Scheme {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let points = |name: &str| -> Option<usize> {
            let digits = text.strip_prefix(name)?.strip_prefix('(')?.strip_suffix(')')?;
            digits.parse().ok().filter(|&n| n >= 1)
        };
        let scheme = match text {
            "DGM" => Some(Scheme::DiscreteGradient),
            "trapezoidal" => Some(Scheme::Trapezoidal),
            _ => (points("FE").map(Scheme::Standard))
                .or_else(|| points("AS").map(Scheme::AssumedStrain))
                .or_else(|| points("Lobatto").map(Scheme::Lobatto)),
        };
        scheme.ok_or_else(|| {
            let reason =
                "not a scheme; there is FE(n), AS(n), DGM, trapezoidal, Lobatto(n), n a number of points";
            Error::Scheme { scheme: text.to_string(), reason: reason.to_string() }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scheme_prints_as_it_parses() {
        for text in ["FE(1)", "FE(12)", "AS(5)", "DGM", "trapezoidal", "Lobatto(3)"] {
            assert_eq!(text.parse::<Scheme>().unwrap().to_string(), text);
        }
        for text in
            ["", "FE", "FE(0)", "FE(-1)", "AS(5", "AS 5", "dgm", "FE(1.5)", "FE(99999999999999999999)"]
        {
            assert!(matches!(text.parse::<Scheme>(), Err(Error::Scheme { .. })), "{text}");
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
