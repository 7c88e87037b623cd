//! Kinds of estimators of the local error.

use crate::error::{Error, Result};
use crate::time::TimeElement;

/// How the local error is estimated.
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
    /// By the residual in some steps, and by how sizes and rates have changed in those between.
    Sampled,
    /// By the residual of the reconstructed step.
    Residual,
    /// By a step of the element of degree k + 1.
    Element,
}

/// Estimators: key word, estimator, what it is.
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
    /// The default: differences where they do, else the sampled residual.
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

    /// Checks that the estimator goes with a time element.
    ///
    /// # Errors
    /// [`Error::Adaptivity`]: differences go with degree 1 only, and not with a scheme that dissipates, which has another error.
    pub fn check(self, element: TimeElement) -> Result<()> {
        let degree = element.degree;
        let reason = match self {
            Estimator::Difference if degree != 1 => {
                format!("\"difference\" goes with degree 1 only, not {degree}")
            }
            Estimator::Difference if element.spectral_radius.is_some() => {
                format!(
                    "\"difference\" does not go with {}, whose error is that of its dissipation",
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
