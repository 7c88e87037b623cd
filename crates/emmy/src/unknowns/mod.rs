//! Unknowns of a step beside the rates that belong to the whole body: the multipliers of constraints.
//!
//! Unknowns of one cell are eliminated in it: the pressures of projected volumes by [`crate::body`], incompatible
//! modes, which are nodes without mass, by [`crate::sparse::Condensation`].

#![allow(non_snake_case)]

mod affine;
mod blocks;
mod constraint;
mod constraints;
mod rigid_link;

pub(crate) use blocks::Blocks;
pub(crate) use constraint::ConstraintSource;
pub(crate) use constraints::{Constraints, Derivatives};
pub use rigid_link::RigidLink;
