//! The revolute joint, a hinge: `p - r = 0`, `a^A . e_1^B = a^A . e_2^B = 0`.

use super::{Constraint, Ends, Result, Triad};

pub(super) fn constraints(ends: &Ends<'_>, [a, first, second]: Triad) -> Result<Vec<Constraint>> {
    Ok([ends.meet()?, ends.keep_angles(&[(a, first), (a, second)])?].concat())
}
