//! Common methods that are not time elements. They share body, Newton's iteration and marching with the time elements.
//!
//! An implicit method solves equations of the form of a time element of degree 1, with other coefficients and another
//! known vector; its rule evaluates the internal force at configurations of the step instead of averaging the stress
//! over it.
//!
//! [`super::Impulses`] defines work and impulses for these methods.

mod bathe;
mod central_differences;
mod forces;
mod newmark;
mod statics;

pub use bathe::BatheStepper;
pub use central_differences::CentralDifferences;
pub use forces::PointForces;
pub(super) use forces::Start;
pub(crate) use forces::{Forces, static_reactions};
pub use newmark::{NewmarkFamily, NewmarkParameters, NewmarkStepper};
pub use statics::StaticStepper;
pub(crate) use statics::solve_stiffness;

use super::stage_coefficients::StageCoefficients;
use crate::average::Rule;
use crate::force::Sampling;
use crate::quadrature::Quadrature;

/// Rule that evaluates the internal force at configurations of the step: `sum_s w_s f(u_1 + alpha_s x)`, given as
/// `(alpha_s, w_s)` with weights that sum to 1.
fn configurations(points: &[(f64, f64)]) -> Rule {
    let (points, weights) = points.iter().map(|&(alpha, weight)| ([alpha], weight)).unzip();
    Rule::standard(1, &Quadrature { points, weights })
}

/// Equations of a step `c M x - g + s^2 (f - F) = 0` with the force of a rule whose derivative by x is `w K`.
fn stage_coefficients(rule: Rule, c: f64, w: f64) -> StageCoefficients {
    StageCoefficients {
        rule,
        sampling: Sampling::Points,
        mass: vec![c],
        mass_low: vec![0.0],
        inverse_mass: vec![if c == 0.0 { 0.0 } else { 1.0 / c }],
        response: vec![w],
        damping: None,
    }
}
