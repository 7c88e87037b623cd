//! Kinds of estimators of the local error.

use super::Scheme;
use crate::error::{Error, Result};

/// How the local error is estimated.
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
        "the residual in one of up to 17 steps, carried on by how sizes and rates change; costs little",
    ),
    (
        "residual",
        Estimator::Residual,
        "the residual of the step's reconstruction of degree k + 1; costs a few corrections",
    ),
    ("element", Estimator::Element, "the element of degree k + 1 beside the motion; costs a step of it"),
];

impl Estimator {
    /// The estimator that is taken where none is asked for: differences where they do, else the sampled residual.
    pub fn of(scheme: Scheme, degree: usize) -> Self {
        match Estimator::Difference.check(scheme, degree) {
            Ok(()) => Estimator::Difference,
            Err(_) => Estimator::Sampled,
        }
    }

    /// Key word.
    pub fn name(self) -> &'static str {
        ESTIMATORS.into_iter().find(|(_, own, _)| *own == self).map_or("", |(name, ..)| name)
    }

    /// Checks that the estimator goes with a scheme and a degree.
    ///
    /// # Errors
    /// [`Error::Adaptivity`]: differences go with degree 1 only, and not with a scheme that dissipates, which has another error.
    pub fn check(self, scheme: Scheme, degree: usize) -> Result<()> {
        let reason = match self {
            Estimator::Difference if degree != 1 => {
                format!("\"difference\" goes with degree 1 only, not {degree}")
            }
            Estimator::Difference if scheme.dissipation().is_some() => {
                format!("\"difference\" does not go with {scheme}, whose error is that of its dissipation")
            }
            _ => return Ok(()),
        };
        Err(Error::Adaptivity { setting: "estimator", reason })
    }
}
