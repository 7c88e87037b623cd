//! Sweeps through a triangular factor `D U`, row by row.

use std::ops::Range;

use half::bf16;

use super::blocks::{Blocks, Rows, minus, times};
use super::kernel::{Kernel, Row, Work};
use super::sweep::SweepOrder;

/// Rows of a sweep.
pub(super) struct Part<'a, const C: usize> {
    /// Left of the diagonal U, right of it U^T.
    pub factor: &'a Blocks<bf16>,
    /// D^-1 of each row, by columns.
    pub pivots: &'a [[[f32; 4]; 3]],
    /// Order of the rows.
    pub sweep: &'a SweepOrder,
    /// The rows.
    pub rows: Range<usize>,
    /// Results of other rows, from number `first_other` on.
    pub others: &'a [Row<f32, C>],
    /// Number of the first of them.
    pub first_other: usize,
}

/// `x = U^-1 D^-1 x`.
pub(super) struct Forward<'a, const C: usize> {
    /// Rows, and the data of the sweep.
    pub part: Part<'a, C>,
    /// The vector at these rows.
    pub x: &'a mut [Row<f32, C>],
}

impl<const C: usize> Work<bf16, C> for Forward<'_, C> {
    type Output = ();
    #[inline(always)]
    fn run<K: Kernel<bf16, C>>(self, kernel: K) {
        let Part { factor, pivots, sweep, rows, others, first_other } = self.part;
        let first = rows.start;
        for row in rows {
            let columns = sweep.left(row);
            let begin = columns.start;
            let columns = &sweep.columns[columns];
            let x = Rows { own: &*self.x, first, others, first_other };
            let known = factor.product::<C, false, K>(kernel, begin, columns, x);
            // The product with the pivot does not wait for the previous rows.
            let x = &mut self.x[row - first];
            *x = minus(&times(&pivots[row], x), &known);
        }
    }
}

/// `x = U^-T x`.
pub(super) struct Backward<'a, const C: usize> {
    /// Rows, and the data of the sweep.
    pub part: Part<'a, C>,
    /// The vector at these rows.
    pub x: &'a mut [Row<f32, C>],
}

impl<const C: usize> Work<bf16, C> for Backward<'_, C> {
    type Output = ();
    #[inline(always)]
    fn run<K: Kernel<bf16, C>>(self, kernel: K) {
        let Part { factor, sweep, rows, others, first_other, .. } = self.part;
        let first = rows.start;
        for row in rows.rev() {
            let columns = sweep.right(row);
            let begin = columns.start;
            let columns = &sweep.columns[columns];
            let x = Rows { own: &*self.x, first, others, first_other };
            let known = factor.product::<C, true, K>(kernel, begin, columns, x);
            let x = &mut self.x[row - first];
            *x = minus(x, &known);
        }
    }
}
