//! Quadrature in time of contact forces.

use super::{FollowerRule, Kind, Rule};

/// How a scheme takes the forces of contact.
#[derive(Debug, Clone)]
pub enum ContactRule {
    /// By a discrete gradient, which changes the energy exactly: energy-momentum rules.
    Conserving,
    /// By the gradient of the energy at the points of a standard rule.
    Points(Box<FollowerRule>),
}

impl ContactRule {
    /// The quadrature of a rule.
    ///
    /// ```
    /// use emmy::internals::average::{ContactRule, Rule};
    /// assert!(matches!(ContactRule::new(&Rule::assumed_strain(2, 2)), ContactRule::Conserving));
    /// ```
    pub fn new(rule: &Rule) -> Self {
        match rule.kind {
            Kind::EnergyMomentum(_) => ContactRule::Conserving,
            Kind::Standard => ContactRule::Points(Box::new(FollowerRule::new(rule))),
        }
    }

    /// Integrals of the basis of a rule, `[k]` each, up to its stages or to the points, and up to the end.
    pub fn integrals<'a>(&'a self, rule: &'a Rule) -> impl Iterator<Item = &'a [f64]> {
        let k = rule.degree();
        let n = match self {
            ContactRule::Conserving => k,
            ContactRule::Points(points) => points.n_points(),
        };
        let inside = (0..n).map(move |m| match self {
            ContactRule::Conserving => &rule.coefficients()[m * k..(m + 1) * k],
            ContactRule::Points(points) => points.integrals(m),
        });
        inside.chain(std::iter::once(rule.weights()))
    }
}
