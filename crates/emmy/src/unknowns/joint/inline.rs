//! A point on an axis: `(p - r) . e_1^B = (p - r) . e_2^B = 0`.

use super::{Constraint, Ends, Result, Triad};

pub(super) fn constraints(ends: &Ends<'_>, [_, first, second]: Triad) -> Result<Vec<Constraint>> {
    ends.no_offset_along(&[first, second])
}
