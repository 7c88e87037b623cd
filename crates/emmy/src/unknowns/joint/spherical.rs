//! The spherical joint: `p - r = 0`.

use super::{Constraint, Ends, Result};

pub(super) fn constraints(ends: &Ends<'_>) -> Result<Vec<Constraint>> {
    ends.meet()
}
