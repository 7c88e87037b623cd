//! The time finite element (sections 3 and 4): schemes as data, the element of degree k, one step and its linear solver.

#![allow(non_snake_case)]

mod element;
mod preconditioner;
mod scheme;
mod stage_system;
mod state;
mod stepper;
#[cfg(test)]
mod tests;

pub use element::TimeElement;
pub use scheme::{MAX_DEGREE, SCHEMES, Scheme};
pub use state::State;
pub use stepper::{Impulses, StepOutcome, Stepper};
