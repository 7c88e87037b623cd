//! Schemes of degree 1, and the same schemes with another degree.

use emmy::time::{AveragingRule, Scheme, TimeElement};

pub const DGM: Scheme = value(AveragingRule::DiscreteGradient, None);
pub const TRAPEZOIDAL: Scheme = value(AveragingRule::Trapezoidal, None);

pub const fn fe(points: usize) -> Scheme {
    value(AveragingRule::Standard(points), None)
}

pub const fn lobatto(points: usize) -> Scheme {
    value(AveragingRule::Lobatto(points), None)
}

pub const fn assumed_strain(points: usize) -> Scheme {
    value(AveragingRule::AssumedStrain(points), None)
}

pub const fn dgm(spectral_radius: f64) -> Scheme {
    value(AveragingRule::DiscreteGradient, Some(spectral_radius))
}

const fn value(rule: AveragingRule, spectral_radius: Option<f64>) -> Scheme {
    Scheme::TimeElement(TimeElement { rule, degree: 1, spectral_radius })
}

/// The time element of a scheme with a degree.
pub fn element(scheme: Scheme, degree: usize) -> TimeElement {
    at(scheme, degree).time_element().unwrap()
}

/// A scheme with a degree.
pub fn at(scheme: Scheme, degree: usize) -> Scheme {
    scheme.with_degree(degree).unwrap()
}
