//! Error estimates: the local error of a step and its estimators.

mod defect_correction;
mod estimator;
mod local_error;
mod reconstruction;
mod sampling;

pub use estimator::{ESTIMATORS, Estimator};
pub use local_error::LocalError;
pub use reconstruction::Reconstruction;
