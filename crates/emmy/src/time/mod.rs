//! Advancing in time: schemes as values, the time finite element of degree k (sections 3 and 4), the other steppers,
//! one step and its linear solver.

#![allow(non_snake_case)]

mod classic;
mod dissipation;
mod element_stepper;
mod error;
mod followers;
mod iteration;
mod linear;
mod memory;
mod prediction;
mod rigid_step;
mod scheme;
mod stage_coefficients;
mod stage_system;
mod state;
mod stepper;
#[cfg(test)]
mod tests;
mod time_element;

pub use crate::average::AveragingRule;
pub use classic::{BatheStepper, CentralDifferences, NewmarkFamily, NewmarkParameters, NewmarkStepper};
pub use element_stepper::TimeElementStepper;
pub use error::{ESTIMATORS, Estimator, LocalError, Reconstruction};
pub(crate) use iteration::LARGEST_ROUNDING;
pub(crate) use linear::ApproximateTangent;
pub use memory::Memory;
pub use scheme::{BodyFeature, SCHEMES, Scheme, SchemeRow};
pub(crate) use stage_coefficients::StageCoefficients;
pub use state::State;
pub use stepper::{Impulses, StepOutcome, Stepper};
pub use time_element::{MAX_DEGREE, TimeElement};
