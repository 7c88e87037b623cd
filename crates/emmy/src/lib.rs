//! Non-linear elastodynamics by time finite elements that conserve energy and angular momentum.

pub mod error;
pub mod mesh;

pub use error::{Error, Result};
