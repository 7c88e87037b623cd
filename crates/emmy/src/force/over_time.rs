//! What is given over time.

use std::sync::Arc;

use super::force::Force;
use super::signal::Signal;
use crate::team::Subdomain;

/// What a force has that is given over time: a load.
pub(crate) trait OverTime {
    /// Number of the load.
    fn number(&self) -> usize;

    /// The first time after another with a kink or a jump; of a measured table only its corners count.
    fn next_corner(&self, after: f64) -> Option<f64>;

    /// The smooth functions of time in it. A call of all ranks.
    fn signals(&self, ranks: &Subdomain) -> Vec<Signal>;

    /// The load of a time, before a jump there, in proportion to a fraction from 0 to 1 that takes the place of time.
    fn in_proportion(&self, time: f64, n_dofs: usize) -> Arc<dyn Force>;

    /// Adds the force at factor 1 in the reference configuration, `force: [n_nodes][3]`; of a field, with its time
    /// function, at t = 0, or NaN if it is not finite there.
    fn add_unit_force(&self, force: &mut [f64]);

    /// A point and a time of a span at which a field is not a finite number.
    fn find_not_finite(&self, _span: [f64; 2]) -> Option<([f64; 3], f64)> {
        None
    }
}
