//! Non-linear elastodynamics by time finite elements that conserve energy and angular momentum.
//!
//! The method is due to P. Betsch and P. Steinmann, *Conservation properties of a time FE method. Part II:
//! Time-stepping schemes for non-linear elastodynamics*, Int. J. Numer. Meth. Engng 50, 1931-1955 (2001); it has any
//! degree in time.
//!
//! A [`body::Body`] consists of a [`mesh::Mesh`], regions of [`material`]s, supports and loads. A [`motion::Motion`]
//! advances its [`time::State`] by a [`time::Scheme`] and records the balances of energy and momentum of every step.
//! Time elements differ only in their [`average::Rule`]; common methods that are not time elements are also available
//! as [`time::Stepper`]s.

pub mod adjoint;
pub mod average;
pub mod body;
pub mod element;
pub mod error;
pub mod material;
pub mod mesh;
pub mod motion;
pub mod newton;
pub mod number;
pub mod polynomial;
pub mod prelude;
pub mod quadrature;
pub mod sparse;
pub mod tensor;
pub mod time;

pub use error::{Error, Result};
