//! Matrices `M + lambda K` with real or complex lambda, symmetric, on the rows of a pattern.

use std::ops::Range;

use rayon::prelude::*;

use super::Couplings;
use super::blocks::{Blocks, Rows, times};
use super::kernel::{Entry, Kernel, Row, Work};
use super::real::Real;
use super::row_couplings::{CouplingScale, RowCouplings};
use super::sweep::SweepOrder;

/// The matrix `M + lambda K`; K has 3 x 3 blocks, M a number for each coupling.
#[derive(Debug, Clone)]
pub(crate) struct ShiftedMatrix<E: Entry, const C: usize> {
    /// The blocks of `M + lambda K` with one column, the blocks of K with two columns.
    pub(super) blocks: Blocks<E>,
    /// Rounding errors of the blocks of a row, added to its diagonal block: otherwise, the rounding of the neighbours
    /// would give energy to a motion without strain.
    pub(super) remainders: Vec<[[E::Number; 4]; 3]>,
    /// M, with two columns only.
    mass: Vec<E::Number>,
    shift: [E::Number; 2],
    /// Fixed components, whose rows are omitted, `[3 row + component]` in the order of the sweep.
    fixed: Vec<u32>,
    /// Couplings beyond the pattern.
    couplings: RowCouplings<E::Number>,
}

/// Rows of one task.
pub(super) const CHUNK: usize = 2048;

impl<E: Entry, const C: usize> ShiftedMatrix<E, C> {
    /// Memory for a matrix; `fixed: [n_rows][3]` in the numbering of the pattern.
    pub(crate) fn new(sweep: &SweepOrder, fixed: &[bool]) -> Self {
        let held = sweep.order.iter().enumerate().flat_map(|(new, &old)| {
            (0..3).filter(move |a| fixed[3 * old as usize + a]).map(move |a| (3 * new + a) as u32)
        });
        let zero = E::Number::default();
        ShiftedMatrix {
            blocks: Blocks::new(sweep.columns.len()),
            remainders: vec![[[zero; 4]; 3]; sweep.n_rows()],
            mass: vec![zero; if C == 2 { sweep.columns.len() } else { 0 }],
            shift: [zero; 2],
            fixed: held.collect(),
            couplings: RowCouplings::default(),
        }
    }

    /// Sets the matrix. `stiffness(position)`: block of K; `mass`: M, both at the positions of the pattern.
    pub(crate) fn set<'a>(
        &mut self,
        sweep: &SweepOrder,
        shift: [f64; 2],
        mass: &[f64],
        stiffness: impl Fn(usize) -> &'a [f64] + Sync,
    ) {
        self.shift = shift.map(E::Number::of);
        let factor = if C == 2 { 1.0 } else { shift[0] };
        self.remainders.fill([[E::Number::default(); 4]; 3]);
        let n_left = sweep.right_begin[0];
        let (left, right) = self.blocks.entries_mut().split_at_mut(9 * n_left);
        for (begin, entries) in [(&sweep.left_begin, left), (&sweep.right_begin, right)] {
            each_row(
                0..sweep.n_rows(),
                &|row| 9 * begin[row],
                entries,
                &mut self.remainders,
                &|blocks, remainder, row| {
                    let sources = &sweep.source[begin[row]..begin[row + 1]];
                    E::dispatch::<C, _>(SetRow {
                        blocks,
                        remainder,
                        sources,
                        factor,
                        mass,
                        stiffness: &stiffness,
                    });
                },
            );
        }
        self.mass
            .iter_mut()
            .zip(&sweep.source)
            .for_each(|(m, &source)| *m = E::Number::of(mass[source as usize]));
    }

    /// Sets the couplings beyond the pattern, as [`RowCouplings::set`].
    pub(super) fn couple(&mut self, sweep: &SweepOrder, couplings: &Couplings, scale: CouplingScale<'_>) {
        self.couplings.set(sweep, couplings, scale);
    }

    /// `y = (M + lambda K) x` with the couplings on the free rows; fixed ones stay zero. Returns `x^T y`, not
    /// conjugated.
    pub(crate) fn multiply(
        &self,
        sweep: &SweepOrder,
        x: &[Row<E::Number, C>],
        y: &mut [Row<E::Number, C>],
        partial: &mut [[f64; 2]],
    ) -> [f64; 2] {
        let tasks = y.par_chunks_mut(CHUNK).zip(partial.par_iter_mut()).enumerate();
        tasks.for_each(|(task, (y, partial))| {
            let first = task * CHUNK;
            *partial = E::dispatch(Multiply { matrix: self, sweep, first, x, y });
        });
        summed(partial)
    }

    /// Sets the fixed rows to zero; y: rows from `first_row` on.
    fn hold(&self, first_row: usize, y: &mut [Row<E::Number, C>]) {
        let first = 3 * first_row as u32;
        let begin = self.fixed.partition_point(|&at| at < first);
        let end = self.fixed.partition_point(|&at| at < first + 3 * y.len() as u32);
        self.fixed[begin..end].iter().for_each(|&at| {
            let at = (at - first) as usize;
            y[at / 3][at % 3] = [E::Number::default(); C];
        });
    }
}

/// Sets the blocks of a row to `factor K`, with M beside one column, and adds half of their rounding errors and of the
/// transposed ones to its remainder.
struct SetRow<'a, E: Entry, F> {
    blocks: &'a mut [E],
    remainder: &'a mut [[E::Number; 4]; 3],
    sources: &'a [u32],
    factor: f64,
    mass: &'a [f64],
    stiffness: &'a F,
}

impl<'k, E: Entry, F: Fn(usize) -> &'k [f64], const C: usize> Work<E, C> for SetRow<'_, E, F> {
    type Output = ();
    #[inline(always)]
    fn run<K: Kernel<E, C>>(self, _: K) {
        let SetRow { blocks, remainder, sources, factor, mass, stiffness } = self;
        let mut lost = [0.0; 9];
        for (block, &source) in blocks.as_chunks_mut::<9>().0.iter_mut().zip(sources) {
            let mut entries = transposed(stiffness(source as usize)).map(|entry| factor * entry);
            if C == 1 {
                (0..3).for_each(|a| entries[4 * a] += mass[source as usize]);
            }
            for at in 0..9 {
                block[at] = E::of(entries[at]);
                lost[at] += entries[at] - block[at].number().wide();
            }
        }
        let transposed = transposed(&lost);
        for at in 0..9 {
            remainder[at / 3][at % 3] += E::Number::of(0.5 * (lost[at] + transposed[at]));
        }
    }
}

/// A 3 x 3 block by columns instead of rows.
#[inline(always)]
pub(super) fn transposed<T: Copy>(A: &[T]) -> [T; 9] {
    let A = &A[..9];
    [A[0], A[3], A[6], A[1], A[4], A[7], A[2], A[5], A[8]]
}

/// `y = (M + lambda K) x` for consecutive rows; returns their part of `x^T y`.
struct Multiply<'a, E: Entry, const C: usize> {
    matrix: &'a ShiftedMatrix<E, C>,
    sweep: &'a SweepOrder,
    first: usize,
    x: &'a [Row<E::Number, C>],
    y: &'a mut [Row<E::Number, C>],
}

impl<E: Entry, const C: usize> Work<E, C> for Multiply<'_, E, C> {
    type Output = [f64; 2];
    #[inline(always)]
    fn run<K: Kernel<E, C>>(self, kernel: K) -> [f64; 2] {
        let Multiply { matrix, sweep, first, x, y } = self;
        for index in 0..y.len() {
            let row = first + index;
            let mut stiff = times(&matrix.remainders[row], &x[row]);
            for half in sweep.halves(row) {
                let columns = &sweep.columns[half.clone()];
                let product = matrix.blocks.product::<C, false, K>(kernel, half.start, columns, Rows::all(x));
                (0..4).for_each(|a| (0..C).for_each(|c| stiff[a][c] += product[a][c]));
            }
            y[index] = if C == 1 { stiff } else { shifted(matrix, (sweep, row), x, &stiff) };
        }
        matrix.couplings.add_product(x, first, y);
        matrix.hold(first, y);
        dot(&x[first..first + y.len()], y)
    }
}

/// A row of `M x + lambda (K x)`.
#[inline(always)]
fn shifted<E: Entry, const C: usize>(
    matrix: &ShiftedMatrix<E, C>,
    (sweep, row_number): (&SweepOrder, usize),
    x: &[Row<E::Number, C>],
    stiff: &Row<E::Number, C>,
) -> Row<E::Number, C> {
    let mut row = [[E::Number::default(); C]; 4];
    for half in sweep.halves(row_number) {
        for (&m, &column) in matrix.mass[half.clone()].iter().zip(&sweep.columns[half]) {
            let x = &x[column as usize];
            (0..4).for_each(|a| (0..C).for_each(|c| row[a][c] += m * x[a][c]));
        }
    }
    let [re, im] = matrix.shift;
    for a in 0..3 {
        let [k_re, k_im] = [stiff[a][0], stiff[a][C - 1]];
        row[a][0] += re * k_re - im * k_im;
        row[a][C - 1] += re * k_im + im * k_re;
    }
    row
}

/// Works on the blocks of each row and other data of the row, recursively in parallel halves; `blocks`: blocks of
/// `rows`; `at(row)`: start of a row in the blocks of all rows.
pub(super) fn each_row<E: Send, R: Send>(
    rows: Range<usize>,
    at: &(impl Fn(usize) -> usize + Sync),
    blocks: &mut [E],
    remainders: &mut [R],
    work: &(impl Fn(&mut [E], &mut R, usize) + Sync),
) {
    let begin = |row: usize| at(row) - at(rows.start);
    if rows.len() <= CHUNK {
        for (row, remainder) in rows.clone().zip(remainders) {
            work(&mut blocks[begin(row)..begin(row + 1)], remainder, row);
        }
        return;
    }
    let middle = rows.start + rows.len() / 2;
    let (low, high) = blocks.split_at_mut(begin(middle));
    let (before, after) = remainders.split_at_mut(middle - rows.start);
    rayon::join(
        || each_row(rows.start..middle, at, low, before, work),
        || each_row(middle..rows.end, at, high, after, work),
    );
}

/// `x^T y`, not conjugated, as (real, imaginary).
#[inline(always)]
pub(super) fn dot<T: Real, const C: usize>(x: &[Row<T, C>], y: &[Row<T, C>]) -> [f64; 2] {
    // A sum for each component, so that an addition need not wait for the previous one.
    let mut sums = [[0.0; 4]; 2];
    for (x, y) in x.iter().zip(y) {
        for a in 0..4 {
            if C == 1 {
                sums[0][a] += x[a][0].wide() * y[a][0].wide();
            } else {
                let [xr, xi] = [x[a][0].wide(), x[a][C - 1].wide()];
                let [yr, yi] = [y[a][0].wide(), y[a][C - 1].wide()];
                sums[0][a] += xr * yr - xi * yi;
                sums[1][a] += xr * yi + xi * yr;
            }
        }
    }
    sums.map(|sum| sum.iter().sum())
}

/// Sum of the parts, in their order: the same for any number of threads.
pub(super) fn summed(partial: &[[f64; 2]]) -> [f64; 2] {
    partial.iter().fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]])
}
