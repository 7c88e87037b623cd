//! Gauss-Seidel sweeps through a matrix, and transfers between levels.

use std::ops::Range;

use rayon::prelude::*;

use super::super::blocks::{Blocks, Rows, minus, times};
use super::super::kernel::{Entry, Kernel, Row, Work};
use super::super::shifted::CHUNK;
use super::super::sweep::{SweepOrder, side_by_side};

/// A vector.
pub(super) type Vector<const C: usize> = Vec<Row<f64, C>>;

/// Gauss-Seidel sweeps in 3 x 3 blocks: forward before the coarser levels and backward after them, so that the V-cycle
/// is symmetric.
#[derive(Debug)]
pub(super) struct Smoother {
    /// Inverses of the diagonal blocks, by columns.
    pub inverses: Vec<[[f64; 4]; 3]>,
}

impl Smoother {
    /// `x = (D + L)^-1 r`, and the residual `t = r - A x = -L^T x`, of no meaning at held components.
    pub(super) fn forward<E: Entry<Number = f64>, const C: usize>(
        &self,
        sweep: &SweepOrder,
        blocks: &Blocks<E>,
        r: &[Row<f64, C>],
        (x, t): (&mut [Row<f64, C>], &mut [Row<f64, C>]),
    ) {
        let (interior, interface) = x.split_at_mut(sweep.n_interior());
        side_by_side(interior, &sweep.interiors, &|row| row, &|x, rows| {
            E::dispatch(Forward { part: self.part(sweep, blocks, r, rows, (&[], 0)), x });
        });
        let interior = &*interior;
        side_by_side(interface, &sweep.interfaces, &|row| row, &|x, rows| {
            E::dispatch(Forward { part: self.part(sweep, blocks, r, rows, (interior, 0)), x });
        });
        let x = &*x;
        t.par_chunks_mut(CHUNK).enumerate().for_each(|(task, t)| {
            E::dispatch(Rest { sweep, blocks, x, first: task * CHUNK, t });
        });
    }

    /// `x += (D + L^T)^-1 (r - A x)`.
    pub(super) fn backward<E: Entry<Number = f64>, const C: usize>(
        &self,
        sweep: &SweepOrder,
        blocks: &Blocks<E>,
        r: &[Row<f64, C>],
        x: &mut [Row<f64, C>],
    ) {
        let n_interior = sweep.n_interior();
        let (interior, interface) = x.split_at_mut(n_interior);
        let others = &*interior;
        side_by_side(interface, &sweep.interfaces, &|row| row, &|x, rows| {
            E::dispatch(Backward { part: self.part(sweep, blocks, r, rows, (others, 0)), x });
        });
        let others = &*interface;
        side_by_side(interior, &sweep.interiors, &|row| row, &|x, rows| {
            E::dispatch(Backward { part: self.part(sweep, blocks, r, rows, (others, n_interior)), x });
        });
    }
}

impl Smoother {
    fn part<'a, E, const C: usize>(
        &'a self,
        sweep: &'a SweepOrder,
        blocks: &'a Blocks<E>,
        r: &'a [Row<f64, C>],
        rows: Range<usize>,
        (others, first_other): (&'a [Row<f64, C>], usize),
    ) -> Part<'a, E, C> {
        Part { smoother: self, sweep, blocks, rows, others, first_other, r }
    }
}

/// Rows of a sweep.
struct Part<'a, E, const C: usize> {
    smoother: &'a Smoother,
    sweep: &'a SweepOrder,
    blocks: &'a Blocks<E>,
    rows: Range<usize>,
    /// Other rows of x, from number `first_other` on.
    others: &'a [Row<f64, C>],
    first_other: usize,
    r: &'a [Row<f64, C>],
}

struct Forward<'a, E, const C: usize> {
    part: Part<'a, E, C>,
    x: &'a mut [Row<f64, C>],
}

impl<E: Entry<Number = f64>, const C: usize> Work<E, C> for Forward<'_, E, C> {
    type Output = ();
    #[inline(always)]
    fn run<K: Kernel<E, C>>(self, kernel: K) {
        let Part { smoother, sweep, blocks, rows, others, first_other, r } = self.part;
        let first = rows.start;
        for row in rows {
            let left = sweep.left(row);
            let x = Rows { own: &*self.x, first, others, first_other };
            let known = blocks.product::<C, false, K>(kernel, left.start, &sweep.columns[left], x);
            self.x[row - first] = times(&smoother.inverses[row], &minus(&r[row], &known));
        }
    }
}

struct Backward<'a, E, const C: usize> {
    part: Part<'a, E, C>,
    x: &'a mut [Row<f64, C>],
}

impl<E: Entry<Number = f64>, const C: usize> Work<E, C> for Backward<'_, E, C> {
    type Output = ();
    #[inline(always)]
    fn run<K: Kernel<E, C>>(self, kernel: K) {
        let Part { smoother, sweep, blocks, rows, others, first_other, r } = self.part;
        let first = rows.start;
        for row in rows.rev() {
            let x = Rows { own: &*self.x, first, others, first_other };
            let (left, right) = (sweep.left(row), sweep.right(row));
            let left = blocks.product::<C, false, K>(kernel, left.start, &sweep.columns[left], x);
            let right = blocks.product::<C, true, K>(kernel, right.start, &sweep.columns[right], x);
            let rest = minus(&minus(&r[row], &left), &right);
            self.x[row - first] = times(&smoother.inverses[row], &rest);
        }
    }
}

/// `t = -L^T x`.
struct Rest<'a, E, const C: usize> {
    sweep: &'a SweepOrder,
    blocks: &'a Blocks<E>,
    x: &'a [Row<f64, C>],
    first: usize,
    t: &'a mut [Row<f64, C>],
}

impl<E: Entry<Number = f64>, const C: usize> Work<E, C> for Rest<'_, E, C> {
    type Output = ();
    #[inline(always)]
    fn run<K: Kernel<E, C>>(self, kernel: K) {
        let Rest { sweep, blocks, x, first, t } = self;
        for (row, t) in (first..).zip(t) {
            let right = sweep.right(row);
            let columns = &sweep.columns[right.clone()];
            let product = blocks.product::<C, false, K>(kernel, right.start, columns, Rows::all(x));
            *t = minus(&[[0.0; C]; 4], &product);
        }
    }
}

/// A rectangular matrix of 3 x 3 blocks.
#[derive(Debug)]
pub(super) struct Transfer {
    begin: Vec<usize>,
    columns: Vec<u32>,
    /// Source of each block.
    sources: Vec<u32>,
    blocks: Blocks<f32>,
}

impl Transfer {
    /// Memory for a matrix with entries (row, column, source).
    pub(super) fn new(n_rows: usize, mut entries: Vec<(u32, u32, u32)>) -> Self {
        entries.sort_unstable();
        let mut begin = vec![0; n_rows + 1];
        entries.iter().for_each(|&(row, ..)| begin[row as usize + 1] += 1);
        (0..n_rows).for_each(|row| begin[row + 1] += begin[row]);
        Transfer {
            begin,
            columns: entries.iter().map(|&(_, column, _)| column).collect(),
            sources: entries.iter().map(|&(.., source)| source).collect(),
            blocks: Blocks::new(entries.len()),
        }
    }

    /// Sets the blocks, by columns, from their sources.
    pub(super) fn set(&mut self, block: impl Fn(usize) -> [f32; 9] + Sync) {
        let blocks = self.blocks.entries_mut().as_chunks_mut::<9>().0;
        let pairs = blocks.par_iter_mut().with_min_len(CHUNK).zip(&self.sources);
        pairs.for_each(|(own, &source)| *own = block(source as usize));
    }

    /// `y = A x`.
    pub(super) fn set_product<const C: usize>(&self, x: &[Row<f64, C>], y: &mut [Row<f64, C>]) {
        self.multiply(x, y, false);
    }

    /// `y += A x`.
    pub(super) fn add_product<const C: usize>(&self, x: &[Row<f64, C>], y: &mut [Row<f64, C>]) {
        self.multiply(x, y, true);
    }

    fn multiply<const C: usize>(&self, x: &[Row<f64, C>], y: &mut [Row<f64, C>], adds: bool) {
        y.par_chunks_mut(CHUNK).enumerate().for_each(|(task, y)| {
            f32::dispatch(Multiply { matrix: self, x, first: task * CHUNK, y, adds });
        });
    }
}

struct Multiply<'a, const C: usize> {
    matrix: &'a Transfer,
    x: &'a [Row<f64, C>],
    first: usize,
    y: &'a mut [Row<f64, C>],
    adds: bool,
}

impl<const C: usize> Work<f32, C> for Multiply<'_, C> {
    type Output = ();
    #[inline(always)]
    fn run<K: Kernel<f32, C>>(self, kernel: K) {
        let Multiply { matrix, x, first, y, adds } = self;
        for (row, y) in (first..).zip(y) {
            let begin = matrix.begin[row];
            let columns = &matrix.columns[begin..matrix.begin[row + 1]];
            let product = matrix.blocks.product::<C, false, K>(kernel, begin, columns, Rows::all(x));
            let old = if adds { *y } else { [[0.0; C]; 4] };
            (0..4).for_each(|a| (0..C).for_each(|c| y[a][c] = old[a][c] + product[a][c]));
        }
    }
}
