//! Sources of constraints.

use std::fmt;

use super::attachments::Attachments;
use super::constraint::Constraint;
use crate::error::Result;

/// Data of constraints: a kind of joint in a file of its own.
pub trait ConstraintSource: fmt::Debug + Send + Sync {
    /// The constraints on a body.
    ///
    /// # Errors
    /// Whatever is wrong with the data.
    fn constraints(&self, attachments: &Attachments<'_>) -> Result<Vec<Constraint>>;

    /// Whether they join the body to the ground.
    fn is_grounded(&self) -> bool;
}
