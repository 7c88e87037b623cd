//! Kinds of estimators of the local error.

use crate::error::{Error, Result};
use crate::time::TimeElement;

/// Estimators of the local error.
///
/// ```
/// use emmy::time::{Estimator, TimeElement};
/// assert_eq!(Estimator::of(TimeElement::discrete_gradient(1)?), Estimator::Difference);
/// assert_eq!(Estimator::of(TimeElement::discrete_gradient(2)?), Estimator::Sampled);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Estimator {
    /// By differences of velocities, for degree 1.
    Difference,
    /// By the residual in some steps, extrapolated to the steps between by step size and rates.
    Sampled,
    /// By the residual of the reconstructed step.
    Residual,
    /// By a step of the element of degree k + 1.
    Element,
}

/// Estimators: key word, estimator, description.
pub const ESTIMATORS: [(&str, Estimator, &str); 4] = [
    ("difference", Estimator::Difference, "differences of velocities, for degree 1; costs nothing"),
    (
        "sampled",
        Estimator::Sampled,
        "the residual in one of up to 17 steps, extrapolated by the change of sizes and rates; costs little",
    ),
    (
        "residual",
        Estimator::Residual,
        "the residual of the step's reconstruction of degree k + 1; costs a few corrections",
    ),
    ("element", Estimator::Element, "the element of degree k + 1 beside the motion; costs a step of it"),
];

impl Estimator {
    /// The default: differences if they apply, else the sampled residual.
    pub fn of(element: TimeElement) -> Self {
        match Estimator::Difference.check(element) {
            Ok(()) => Estimator::Difference,
            Err(_) => Estimator::Sampled,
        }
    }

    /// Key word.
    pub fn name(self) -> &'static str {
        ESTIMATORS.into_iter().find(|(_, own, _)| *own == self).map_or("", |(name, ..)| name)
    }

    /// Checks that the estimator fits a time element.
    ///
    /// # Errors
    /// [`Error::Adaptivity`]: differences need degree 1 and a scheme without dissipation, which has another error.
    pub fn check(self, element: TimeElement) -> Result<()> {
        let degree = element.degree;
        let reason = match self {
            Estimator::Difference if degree != 1 => {
                format!("\"difference\" needs degree 1, not {degree}")
            }
            Estimator::Difference if element.spectral_radius.is_some() => {
                format!(
                    "\"difference\" cannot be used with {}, whose error comes from its dissipation",
                    element.name()
                )
            }
            Estimator::Difference | Estimator::Sampled | Estimator::Residual | Estimator::Element => {
                return Ok(());
            }
        };
        Err(Error::Adaptivity { setting: "estimator", reason })
    }
}
