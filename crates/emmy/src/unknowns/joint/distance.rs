//! The distance of two points: `(|p - r|^2 - L^2) / 2 = 0`.

use super::{Constraint, Ends, Result, dot3};

pub(super) fn constraints(ends: &Ends<'_>, to: [f64; 3]) -> Result<Vec<Constraint>> {
    let arm = ends.point(0, ends.joint.at)?.less(&ends.point(1, to)?);
    let square = dot3(arm.reference, arm.reference);
    Ok(vec![Constraint::new(vec![(arm.clone(), arm, 0.5)], 0.5 * square)])
}
