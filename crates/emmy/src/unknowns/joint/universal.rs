//! The universal joint: `p - r = 0`, `a^A . b^B` constant.

use super::{Constraint, Ends, Result};
use crate::tensor::cross;

/// Sine of the angle below which two axes are parallel.
const PARALLEL: f64 = 1e-6;

pub(super) fn constraints(ends: &Ends<'_>, axes: [[f64; 3]; 2]) -> Result<Vec<Constraint>> {
    let [a, b] = [ends.unit(axes[0])?, ends.unit(axes[1])?];
    if cross(a, b).iter().map(|x| x * x).sum::<f64>().sqrt() < PARALLEL {
        return Err(ends.fault("its axes are parallel; a universal joint needs an angle between them"));
    }
    Ok([ends.meet()?, ends.keep_angles(&[(a, b)])?].concat())
}
