//! Schemes as values: printed and parsed as in the paper.

#[cfg(test)]
mod tests;

use std::fmt;
use std::str::FromStr;

use super::classic::{BatheStepper, CentralDifferences, NewmarkFamily, NewmarkStepper, StaticStepper};
use super::{BodyFeature, MAX_DEGREE, State, Stepper, TimeElement, TimeElementStepper};
use crate::average::AveragingRule;
use crate::body::Body;
use crate::error::{Error, Result};
use crate::newton::NewtonSettings;

/// Time integration scheme: a time element, or one of the common methods that are not time elements. The conservation
/// properties of time elements are from the paper's Table III.
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
/// A text without a degree has degree 1.
///
/// ```
/// use emmy::prelude::*;
/// let scheme: Scheme = "AS(5), degree 2".parse()?;
/// assert_eq!(scheme, TimeElement::assumed_strain(5, 2)?.into());
/// assert_eq!("AS(5)".parse::<Scheme>()?.with_degree(2)?, scheme);
/// assert_eq!((scheme.to_string(), scheme.name()), ("AS(5), degree 2".to_string(), "AS(5)".to_string()));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scheme {
    /// Time finite element.
    TimeElement(TimeElement),
    /// Newmark's family: Newmark, HHT, generalized-alpha.
    Newmark(NewmarkFamily),
    /// `Bathe`: composite of the trapezoidal rule and the three-point backward Euler method (Bathe and Baig 2005),
    /// split at `2 - sqrt 2` of the step (Bank and others 1985), where both parts have the same matrix.
    Bathe,
    /// `central-differences`: explicit, lumped mass; steps beyond the critical one are rejected.
    CentralDifferences,
    /// `static`: no scheme in time, but the equilibrium under the loads at the end of each step, without inertia. No
    /// input names it; [`crate::equilibrium`] uses it with the load fraction as time.
    Static,
    /// The scheme of a stepper from outside, with its name
    /// ([`Motion::with_stepper`](crate::motion::Motion::with_stepper)).
    Own(&'static str),
}

/// A row of the table of schemes.
#[derive(Debug, Clone, Copy)]
pub struct SchemeRow {
    /// Key word with the names of its arguments, `AS(n,rho)`; n is a number of points.
    pub form: &'static str,
    /// One line for `emmy list schemes`.
    pub description: &'static str,
    /// The scheme of degree 1 with as many arguments as in `form`.
    scheme: fn(&[f64]) -> Scheme,
}

const fn row(form: &'static str, description: &'static str, scheme: fn(&[f64]) -> Scheme) -> SchemeRow {
    SchemeRow { form, description, scheme }
}

/// All schemes, in the order of `emmy list schemes`.
pub const SCHEMES: [SchemeRow; 12] = [
    row(
        "FE(n)",
        "standard time finite element, n Gauss points (n >= degree); FE(1) is the mid-point rule",
        |a| element(AveragingRule::Standard(a[0] as usize), None),
    ),
    row(
        "AS(n)",
        "assumed strain in time, n inner Gauss points (n >= degree); conserves the momenta, and energy up to the error of the inner rule",
        |a| element(AveragingRule::AssumedStrain(a[0] as usize), None),
    ),
    row("DGM", "discrete gradient method; conserves momentum and energy for every material", |_| {
        element(AveragingRule::DiscreteGradient, None)
    }),
    row(
        "AS(n,rho)",
        "AS(n) with numerical dissipation of unresolved motions, rho from 1 (none) to 0 (most); order 2 degree - 1",
        |a| element(AveragingRule::AssumedStrain(a[0] as usize), Some(a[1])),
    ),
    row(
        "DGM(rho)",
        "DGM with numerical dissipation of unresolved motions, rho from 1 (none) to 0 (most); order 2 degree - 1",
        |a| element(AveragingRule::DiscreteGradient, Some(a[0])),
    ),
    row("trapezoidal", "trapezoidal rule (degree 1): the average acceleration method", |_| {
        element(AveragingRule::Trapezoidal, None)
    }),
    row("Lobatto(n)", "standard time finite element, n Lobatto points (n >= degree + 1)", |a| {
        element(AveragingRule::Lobatto(a[0] as usize), None)
    }),
    row(
        "Newmark(beta,gamma)",
        "Newmark's method (degree 1); Newmark(0.25, 0.5) is average acceleration",
        |a| Scheme::Newmark(NewmarkFamily::Newmark { beta: a[0], gamma: a[1] }),
    ),
    row("HHT(alpha)", "Hilber, Hughes and Taylor (degree 1), alpha from 0 (no dissipation) to 1/3", |a| {
        Scheme::Newmark(NewmarkFamily::HilberHughesTaylor { alpha: a[0] })
    }),
    row(
        "generalized-alpha(rho)",
        "Chung and Hulbert (degree 1), spectral radius rho at high frequencies from 1 (no dissipation) to 0",
        |a| Scheme::Newmark(NewmarkFamily::GeneralizedAlpha { spectral_radius: a[0] }),
    ),
    row("Bathe", "trapezoidal rule and three-point backward Euler (degree 1); high modes vanish", |_| {
        Scheme::Bathe
    }),
    row(
        "central-differences",
        "explicit with lumped mass (degree 1); conserves momentum; small steps only",
        |_| Scheme::CentralDifferences,
    ),
];

fn element(rule: AveragingRule, spectral_radius: Option<f64>) -> Scheme {
    Scheme::TimeElement(TimeElement { rule, degree: 1, spectral_radius })
}

impl Scheme {
    /// The time element, if the scheme is one.
    pub fn time_element(self) -> Option<TimeElement> {
        match self {
            Scheme::TimeElement(element) => Some(element),
            Scheme::Newmark(_)
            | Scheme::Bathe
            | Scheme::CentralDifferences
            | Scheme::Static
            | Scheme::Own(_) => None,
        }
    }

    /// Whether the scheme is a time element.
    pub fn is_time_element(self) -> bool {
        self.time_element().is_some()
    }

    /// Degree of the time element; 1 for other methods.
    pub fn degree(self) -> usize {
        self.time_element().map_or(1, |element| element.degree)
    }

    /// Spectral radius at infinite frequency of a dissipative time element.
    pub fn dissipation(self) -> Option<f64> {
        self.time_element().and_then(|element| element.spectral_radius)
    }

    /// The scheme as written in an input, without the degree: `DGM(0.8)`.
    pub fn name(self) -> String {
        match self {
            Scheme::TimeElement(element) => element.name(),
            Scheme::Newmark(family) => family.name(),
            Scheme::Bathe => "Bathe".to_string(),
            Scheme::CentralDifferences => "central-differences".to_string(),
            Scheme::Static => "static".to_string(),
            Scheme::Own(name) => name.to_string(),
        }
    }

    /// The scheme of degree 1 with a name as written in an input; upper and lower case make no difference.
    ///
    /// # Errors
    /// [`Error::Scheme`] with the possible forms.
    pub fn from_name(name: &str) -> Result<Scheme> {
        let scheme = SCHEMES.iter().find_map(|row| row.parse(name));
        let scheme = scheme.ok_or_else(|| unknown(name, suggestion(name)))?;
        scheme.check_parameters().map(|()| scheme)
    }

    /// The scheme without its dissipation.
    pub fn conserving(self) -> Scheme {
        self.time_element().map_or(self, |element| Scheme::TimeElement(element.conserving()))
    }

    /// The scheme with another degree and the same points.
    ///
    /// # Errors
    /// [`Error::Scheme`] if the scheme does not exist for the degree.
    pub fn with_degree(self, degree: usize) -> Result<Scheme> {
        let scheme = self.time_element().map_or(self, |element| TimeElement { degree, ..element }.into());
        scheme.check_degree(degree)?;
        scheme.check().map(|()| scheme)
    }

    /// The scheme with another degree, and more points if that degree needs them.
    ///
    /// # Errors
    /// [`Error::Scheme`] if the scheme does not exist for the degree.
    pub fn at_degree(self, degree: usize) -> Result<Scheme> {
        match self.time_element() {
            Some(element) => element.at_degree(degree).map(Scheme::TimeElement),
            None => self.with_degree(degree),
        }
    }

    /// Checks that degree and parameters are compatible, and that the scheme is one of the library.
    ///
    /// # Errors
    /// [`Error::Scheme`].
    pub fn check(self) -> Result<()> {
        match self {
            Scheme::TimeElement(element) => element.check(),
            Scheme::Newmark(family) => family.check(),
            Scheme::Bathe | Scheme::CentralDifferences | Scheme::Static => Ok(()),
            Scheme::Own(_) => Err(self.without_stepper()),
        }
    }

    /// The error of a scheme whose name alone gives no stepper.
    fn without_stepper(self) -> Error {
        let reason = "only `Motion::with_stepper` has a stepper from outside".to_string();
        Error::Scheme { scheme: self.name(), reason }
    }

    /// Checks the parameters that are real numbers.
    fn check_parameters(self) -> Result<()> {
        match self {
            Scheme::TimeElement(element) => {
                let checked = element.check_spectral_radius();
                checked.map_err(|reason| Error::Scheme { scheme: self.name(), reason })
            }
            Scheme::Newmark(family) => family.check(),
            Scheme::Bathe | Scheme::CentralDifferences | Scheme::Static | Scheme::Own(_) => Ok(()),
        }
    }

    /// Checks the degree of a method that is not a time element.
    fn check_degree(self, degree: usize) -> Result<()> {
        let reason = match self.time_element() {
            Some(_) => return Ok(()),
            None if degree == 1 => return Ok(()),
            None if !(1..=MAX_DEGREE).contains(&degree) => {
                format!("the degree must be between 1 and {MAX_DEGREE}, not {degree}")
            }
            None => format!("it is not a time element and has degree 1 only, not {degree}"),
        };
        Err(Error::Scheme { scheme: self.name(), reason })
    }

    /// Checks that the scheme can integrate a body with a feature.
    ///
    /// # Errors
    /// [`Error::Scheme`].
    pub fn check_feature(self, feature: BodyFeature) -> Result<()> {
        let reason = match (feature, self) {
            (BodyFeature::Joints | BodyFeature::ForcesWithHistory, Scheme::TimeElement(_))
            | (BodyFeature::Joints | BodyFeature::TurningObserver, Scheme::Static)
            | (BodyFeature::Ties, _) => return Ok(()),
            (BodyFeature::Joints, _) => "joints and rigid bodies need a time element, such as DGM",
            (BodyFeature::ForcesWithHistory, _) => "forces with a history need a time element, such as DGM",
            (BodyFeature::TurningObserver, _) => {
                "the load `rotation` is for equilibria and their modes; in a motion the body itself turns: by its initial \
                 angular velocity, or by a support that turns"
            }
            // An equilibrium has no velocity, and no damping; a stepper from outside says itself what it integrates.
            (
                _,
                Scheme::TimeElement(TimeElement { spectral_radius: None, .. })
                | Scheme::Static
                | Scheme::Own(_),
            )
            | (BodyFeature::Damping, Scheme::TimeElement(_))
            | (BodyFeature::IncompatibleModes, Scheme::TimeElement(_) | Scheme::Newmark(_) | Scheme::Bathe) =>
            {
                return Ok(());
            }
            (BodyFeature::IncompatibleModes, Scheme::CentralDifferences) => {
                "incompatible modes have no mass; take an implicit scheme, such as AS(5) or DGM"
            }
            (BodyFeature::PrescribedMotion, Scheme::TimeElement(_)) => {
                "a prescribed motion needs a scheme without dissipation"
            }
            (BodyFeature::PrescribedMotion, _) => "a prescribed motion needs a time element",
            (BodyFeature::Damping, _) => "viscosity and drag need a time element",
        };
        Err(Error::Scheme { scheme: self.name(), reason: reason.to_string() })
    }

    /// Checks that the scheme can integrate a body.
    ///
    /// # Errors
    /// [`Error::Scheme`].
    pub fn check_body(self, body: &Body) -> Result<()> {
        BodyFeature::of(body).try_for_each(|feature| self.check_feature(feature))
    }

    /// The body as the scheme moves it, with loads on the mass that the scheme has: [`Body::lumped`] for central
    /// differences, else the body itself.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
    /// assert!(std::ptr::eq("DGM".parse::<emmy::time::Scheme>()?.body(&body), &body));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn body(self, body: &Body) -> &Body {
        if self == Scheme::CentralDifferences { body.lumped() } else { body }
    }

    /// The stepper of the scheme, for a state. A scheme with its own mass matrix sets the momentum of the state with
    /// it.
    ///
    /// # Errors
    /// [`Error::Scheme`] if the scheme is impossible, or cannot integrate the body; [`Error::Linear`],
    /// [`Error::Inverted`].
    pub fn stepper<'a>(
        self,
        body: &'a Body,
        settings: NewtonSettings,
        state: &mut State,
    ) -> Result<Box<dyn Stepper + 'a>> {
        self.check()?;
        self.check_body(body)?;
        Ok(match self {
            Scheme::TimeElement(element) => Box::new(TimeElementStepper::new(body, element, settings)?),
            Scheme::Newmark(family) => {
                Box::new(NewmarkStepper::new(body, family.parameters(), settings, state)?)
            }
            Scheme::Bathe => Box::new(BatheStepper::new(body, settings, state)?),
            Scheme::CentralDifferences => Box::new(CentralDifferences::new(body, state)?),
            Scheme::Static => Box::new(StaticStepper::new(body, settings, state)?),
            Scheme::Own(_) => return Err(self.without_stepper()),
        })
    }
}

impl From<TimeElement> for Scheme {
    fn from(element: TimeElement) -> Self {
        Scheme::TimeElement(element)
    }
}

impl From<NewmarkFamily> for Scheme {
    fn from(family: NewmarkFamily) -> Self {
        Scheme::Newmark(family)
    }
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.time_element() {
            Some(element) => element.fmt(f),
            None => f.write_str(&self.name()),
        }
    }
}

impl FromStr for Scheme {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if let Some((name, degree)) = text.split_once(", degree ") {
            let degree = degree.parse().map_err(|_| unknown(text, "the degree must be a whole number"))?;
            return Scheme::from_name(name)?.with_degree(degree);
        }
        Scheme::from_name(text)
    }
}

impl SchemeRow {
    /// Parses a scheme of this row from its name and arguments.
    fn parse(&self, text: &str) -> Option<Scheme> {
        let (word, parameters) = word_and_arguments(self.form)?;
        let (own_word, arguments) = word_and_arguments(text)?;
        if !own_word.eq_ignore_ascii_case(word) || arguments.len() != parameters.len() {
            return None;
        }
        let number = |(name, text): (&&str, &&str)| match *name {
            "n" => text.parse::<usize>().ok().filter(|n| *n >= 1).map(|n| n as f64),
            _ => text.parse::<f64>().ok(),
        };
        let numbers: Option<Vec<f64>> = parameters.iter().zip(&arguments).map(number).collect();
        numbers.map(|numbers| (self.scheme)(&numbers))
    }
}

/// The word before the brackets and the arguments.
fn word_and_arguments(text: &str) -> Option<(&str, Vec<&str>)> {
    match text.split_once('(') {
        None => Some((text, Vec::new())),
        Some((word, rest)) => Some((word, rest.strip_suffix(')')?.split(',').map(str::trim).collect())),
    }
}

fn unknown(text: &str, reason: &str) -> Error {
    Error::Scheme { scheme: text.to_string(), reason: reason.to_string() }
}

/// Suggestions for a text that is not a scheme.
fn suggestion(text: &str) -> &'static str {
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
