//! Unknowns of a step beside the rates that belong to the whole body: the multipliers of constraints.
//!
//! Unknowns of one cell are eliminated in it: the pressures of projected volumes by [`crate::body`], incompatible
//! modes, which are nodes without mass, by [`crate::sparse::Condensation`].

#![allow(non_snake_case)]

mod affine;
mod attachments;
mod blocks;
mod carrier;
mod component;
mod constraint;
mod constraint_equations;
mod constraint_step;
mod constraints;
mod frame;
mod joint;
mod joint_force;
mod joint_output;
mod linear_constraints;
mod mechanism;
mod range;
mod rank;

pub(crate) use blocks::Blocks;
pub(crate) use carrier::Carrier;
pub(crate) use component::Component;
pub(crate) use constraint_equations::Derivatives;
pub(crate) use constraint_step::{ConstraintStep, Held};
pub(crate) use constraints::Constraints;
pub(crate) use frame::Frame;
pub use frame::RigidMotion;
pub use joint_output::JointState;
pub(crate) use linear_constraints::LinearConstraints;
pub(crate) use mechanism::Mechanism;
pub use mechanism::Mobility;
