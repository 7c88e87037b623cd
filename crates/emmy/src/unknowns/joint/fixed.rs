//! The fixed joint: `p - r = 0`, `x^A . y^B = y^A . z^B = z^A . x^B = 0`.

use super::{Constraint, Ends, Result};

pub(super) fn constraints(ends: &Ends<'_>) -> Result<Vec<Constraint>> {
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Ok([ends.meet()?, ends.keep_angles(&[(x, y), (y, z), (z, x)])?].concat())
}
