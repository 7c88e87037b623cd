//! Adaptive steps: settings, and the control of sizes and degrees by the error of each step.
//!
//! [`Control`] holds the estimator of the error, the controller of the size and the choice of the degree.

mod adaptivity;
mod control;
mod degree_choice;

pub use adaptivity::Adaptivity;
pub(super) use adaptivity::Controller;
pub(super) use control::{AFTER_KINK, Control, FIRST};
pub(super) use degree_choice::{DegreeChoice, MAX_WORK_RATIO, MIN_TELLING_ERROR, degree_of, size_of};
