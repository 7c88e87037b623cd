//! The planar joint: `(p - r) . a^B = 0`, `a^A . e_1^B = a^A . e_2^B = 0`.

use super::{Constraint, Ends, Result, Triad};

pub(super) fn constraints(ends: &Ends<'_>, [a, first, second]: Triad) -> Result<Vec<Constraint>> {
    Ok([ends.no_offset_along(&[a])?, ends.keep_angles(&[(a, first), (a, second)])?].concat())
}
