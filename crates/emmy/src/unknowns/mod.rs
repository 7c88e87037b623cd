//! Unknowns of a step beside the rates that belong to the whole body: the multipliers of constraints.
//!
//! Unknowns of one cell are eliminated in it: the pressures of projected volumes by [`crate::body`], incompatible
//! modes, which are nodes without mass, by [`crate::sparse::Condensation`].

#![allow(non_snake_case)]

mod affine;
mod attachments;
mod blocks;
mod constraint;
mod constraints;
mod frame;
mod joint;
mod rigid_link;
mod source;

pub(crate) use attachments::Attachments;
pub use attachments::JointEnd;
pub(crate) use blocks::Blocks;
pub(crate) use constraints::{Constraints, Derivatives};
pub(crate) use frame::{Frame, NODES_OF_FRAME};
pub use joint::{Joint, JointKind};
pub use rigid_link::RigidLink;
pub(crate) use source::ConstraintSource;
