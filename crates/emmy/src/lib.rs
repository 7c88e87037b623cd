//! Non-linear elastodynamics by time finite elements that conserve energy and angular momentum.

pub mod average;
pub mod element;
pub mod error;
pub mod material;
pub mod mesh;
pub mod polynomial;
pub mod quadrature;
pub mod sparse;
pub mod tensor;

pub use error::{Error, Result};
