//! Schemes of degree 1, and the same schemes with another degree.

use emmy::time::{AveragingRule, Scheme, TimeElement};

pub(crate) const DGM: Scheme = value(AveragingRule::DiscreteGradient, None);
pub(crate) const TRAPEZOIDAL: Scheme = value(AveragingRule::Trapezoidal, None);

pub(crate) const fn fe(points: usize) -> Scheme {
    value(AveragingRule::Standard(points), None)
}

pub(crate) const fn lobatto(points: usize) -> Scheme {
    value(AveragingRule::Lobatto(points), None)
}

pub(crate) const fn assumed_strain(points: usize) -> Scheme {
    value(AveragingRule::AssumedStrain(points), None)
}

pub(crate) const fn dgm(spectral_radius: f64) -> Scheme {
    value(AveragingRule::DiscreteGradient, Some(spectral_radius))
}

const fn value(rule: AveragingRule, spectral_radius: Option<f64>) -> Scheme {
    Scheme::TimeElement(TimeElement { rule, degree: 1, spectral_radius })
}

/// The time element of a scheme with a degree.
pub(crate) fn element(scheme: Scheme, degree: usize) -> TimeElement {
    at(scheme, degree).time_element().unwrap()
}

/// A scheme with a degree.
pub(crate) fn at(scheme: Scheme, degree: usize) -> Scheme {
    scheme.with_degree(degree).unwrap()
}
