//! Advancing in time: schemes as data, the time finite element of degree k (sections 3 and 4), the steppers that are not
//! time elements, one step and its linear solver.

#![allow(non_snake_case)]

mod approximate_tangent;
mod classic;
mod decoupling;
mod defect_correction;
mod dissipation;
mod element;
mod element_stepper;
mod estimator;
mod followers;
mod iteration;
mod local_error;
mod memory;
mod prediction;
mod reconstruction;
mod sampling;
mod scheme;
mod shifted_solver;
mod stage_system;
mod state;
mod stepper;
mod straining;
#[cfg(test)]
mod tests;

pub(crate) use approximate_tangent::ApproximateTangent;
pub use classic::{BatheStepper, CentralDifferences, NewmarkParameters, NewmarkStepper};
use dissipation::Dissipation;
pub use element::TimeElement;
pub use element_stepper::TimeElementStepper;
pub use estimator::{ESTIMATORS, Estimator};
pub(crate) use iteration::LARGEST_ROUNDING;
pub use local_error::LocalError;
pub use memory::Memory;
pub use reconstruction::Reconstruction;
pub use scheme::{MAX_DEGREE, SCHEMES, Scheme};
pub(crate) use stage_system::StageForm;
pub use state::State;
pub use stepper::{Impulses, StepOutcome, Stepper};
