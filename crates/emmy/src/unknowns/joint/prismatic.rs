//! The prismatic joint, a slider: the cylindrical joint, and `e_1^A . e_2^B = 0`.

use super::{Constraint, Ends, Result, Triad, cylindrical};

pub(super) fn constraints(ends: &Ends<'_>, triad: Triad) -> Result<Vec<Constraint>> {
    let [_, first, second] = triad;
    Ok([cylindrical::constraints(ends, triad)?, ends.keep_angles(&[(first, second)])?].concat())
}
