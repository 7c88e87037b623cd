//! Rows of other ranks in an iterative solver.

use std::sync::Arc;

use super::kernel::Row;
use super::real::Real;
use super::sweep::SweepOrder;
use crate::team::Subdomain;

/// The other ranks of a team, as conjugate gradients see them. Rows of guests are fixed in matrix and preconditioner;
/// their entries in a direction come from their owners, and in a residual they are zero.
#[derive(Debug, Clone)]
pub(crate) struct SharedRows {
    subdomain: Arc<Subdomain>,
    /// Number of each node in the sweep.
    number: Vec<u32>,
}

impl SharedRows {
    /// The ranks that share the rows of a sweep.
    pub(crate) fn new(subdomain: Arc<Subdomain>, sweep: &SweepOrder) -> Self {
        let mut number = vec![0; sweep.n_rows()];
        sweep.order.iter().zip(0..).for_each(|(&old, new)| number[old as usize] = new);
        SharedRows { subdomain, number }
    }

    /// The part of this rank.
    pub(super) fn subdomain(&self) -> &Subdomain {
        &self.subdomain
    }

    /// Sums of products over all ranks.
    pub(super) fn sum<const N: usize>(&self, own: [f64; N]) -> [f64; N] {
        let mut sum = own;
        self.subdomain.sum("products of conjugate gradients", &mut sum);
        sum
    }

    /// Largest number of all ranks.
    pub(super) fn largest(&self, own: f64) -> f64 {
        let mut most = [own];
        self.subdomain.largest("size of a right-hand side", &mut most);
        most[0]
    }

    /// Takes the rows of guests from their owners.
    pub(super) fn exchange<T: Real, const C: usize>(&self, rows: &mut [Row<T, C>]) {
        let at = |node: usize| self.number[node] as usize;
        let read = |rows: &[Row<T, C>], node: usize, numbers: &mut [f64]| {
            let components = rows[at(node)][..3].as_flattened();
            numbers.iter_mut().zip(components).for_each(|(number, x)| *number = x.wide());
        };
        let write = |rows: &mut [Row<T, C>], node: usize, numbers: &[f64]| {
            let components = rows[at(node)][..3].as_flattened_mut();
            components.iter_mut().zip(numbers).for_each(|(x, number)| *x = T::of(*number));
        };
        self.subdomain.exchange("direction of conjugate gradients", 3 * C, rows, read, write);
    }
}
