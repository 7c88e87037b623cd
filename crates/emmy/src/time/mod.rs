//! Advancing in time: schemes as values, the time finite element of degree k (sections 3 and 4), the other steppers,
//! one step and its linear solver.

#![allow(non_snake_case)]

mod best_fit;
pub(crate) mod classic;
mod configuration;
pub(crate) mod element_stepper;
mod equations;
pub(crate) mod error;
mod implicit;
mod iteration;
mod linear;
pub(crate) mod memory;
mod prediction;
mod rigid_step;
pub(crate) mod scheme;
mod scheme_force;
mod stage_coefficients;
mod stage_system;
mod state;
pub(crate) mod stepper;
#[cfg(test)]
mod tests;
mod time_element;

pub use crate::average::AveragingRule;
pub use crate::force::StrainState;
pub use crate::newton::Outcome as NewtonOutcome;
pub use classic::{NewmarkFamily, NewmarkParameters, PointForces};
pub use configuration::Prescribed;
pub(crate) use element_stepper::TimeElementStepper;
pub use error::Estimator;
pub(crate) use error::LocalError;
pub(crate) use iteration::LARGEST_ROUNDING;
pub(crate) use linear::ApproximateTangent;
pub use memory::Memory;
pub(crate) use rigid_step::spin as fitted_spin;
pub use scheme::Scheme;
pub(crate) use stage_coefficients::StageCoefficients;
pub use state::State;
pub use stepper::{BodyFeature, Impulses, StepOutcome, Stepper};
pub use time_element::{MAX_DEGREE, TimeElement};
