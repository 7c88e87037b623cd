//! Incomplete Cholesky factorisation without fill, in 3 x 3 blocks.

use std::ops::Range;

use half::bf16;
use rayon::prelude::*;

use super::blocks::{Blocks, transposed_times};
use super::conjugate_gradients::Approximate;
use super::kernel::{Entry, Row};
use super::shifted::{CHUNK, each_row, transposed};
use super::sweep::{SweepOrder, side_by_side};
use super::triangular::{Backward, Forward, Part};

/// Incomplete factor `L L^T` of a symmetric matrix on its own pattern (Meijerink and van der Vorst 1977), in blocks. It
/// need not be accurate: it is computed in single precision, and stored in half precision.
///
/// It is stored as `L = D U`, where D holds the triangular diagonal blocks of L. The diagonal blocks of U are unit
/// matrices, so that a sweep through U waits only for the previous rows. A pivot lost to the omitted fill is replaced
/// by the pivot of the matrix.
#[derive(Debug, Clone)]
pub(crate) struct IncompleteCholesky {
    /// On the couplings of the sweep: left of the diagonal U, right of it U^T.
    factor: Blocks<bf16>,
    /// D^-1 of each row, by columns.
    pivots: Vec<[[f32; 4]; 3]>,
    /// L left of the diagonal of each row, then D^-1, while it is computed.
    lower: Vec<f32>,
    /// Whether each component of a row is fixed, as bits.
    fixed: Vec<u8>,
}

impl IncompleteCholesky {
    /// Memory for a factor.
    pub(crate) fn new(sweep: &SweepOrder) -> Self {
        IncompleteCholesky {
            factor: Blocks::new(sweep.columns.len()),
            pivots: vec![[[0.0; 4]; 3]; sweep.n_rows()],
            lower: vec![0.0; lower_begin(sweep, sweep.n_rows())],
            fixed: vec![0; sweep.n_rows()],
        }
    }

    /// Factorises `M + modulus K`. `stiffness(position)`: block of K; `mass`: M, both at the positions of the pattern;
    /// `fixed`: omitted components, `[n_rows][3]` in the numbering of the pattern.
    pub(crate) fn factorize<'a>(
        &mut self,
        sweep: &SweepOrder,
        fixed: &[bool],
        modulus: f64,
        mass: &[f64],
        stiffness: impl Fn(usize) -> &'a [f64] + Sync,
    ) {
        for (bits, &old) in self.fixed.iter_mut().zip(&sweep.order) {
            let of_row = &fixed[3 * old as usize..][..3];
            *bits = (0..3).map(|a| u8::from(of_row[a]) << a).sum();
        }
        let fixed = &self.fixed;
        let entry = |position: usize, row: usize| -> [f32; 9] {
            let source = sweep.source[position] as usize;
            let column = sweep.columns[position] as usize;
            let mut block = transposed(stiffness(source)).map(|entry| modulus * entry);
            (0..3).for_each(|a| block[4 * a] += mass[source]);
            if fixed[row] | fixed[column] != 0 {
                let unit = if row == column { 1.0 } else { 0.0 };
                for (a, b) in (0..9).map(|at| (at % 3, at / 3)) {
                    if (fixed[row] >> a | fixed[column] >> b) & 1 == 1 {
                        block[3 * b + a] = if a == b { unit } else { 0.0 };
                    }
                }
            }
            block.map(|entry| entry as f32)
        };
        let begin = |row: usize| lower_begin(sweep, row);
        let (interior, interface) = self.lower.split_at_mut(begin(sweep.n_interior()));
        side_by_side(interior, &sweep.interiors, &begin, &|part, rows| {
            rows.clone().for_each(|row| factorize_row(sweep, row, begin(rows.start), part, &[], &entry));
        });
        let interior = &*interior;
        side_by_side(interface, &sweep.interfaces, &begin, &|part, rows| {
            rows.clone().for_each(|row| factorize_row(sweep, row, begin(rows.start), part, interior, &entry));
        });
        self.finish(sweep);
    }

    /// Computes U from L, and copies it to the right of the diagonal, transposed.
    fn finish(&mut self, sweep: &SweepOrder) {
        let rows = 0..sweep.n_rows();
        let begin = |row: usize| lower_begin(sweep, row);
        each_row(rows.clone(), &begin, &mut self.lower, &mut self.pivots, &|own, pivot, _| {
            let (left, inverse) = own.split_at_mut(own.len() - 9);
            let inverse = &*inverse;
            *pivot = [0, 3, 6].map(|at| [inverse[at], inverse[at + 1], inverse[at + 2], 0.0]);
            left.as_chunks_mut().0.iter_mut().for_each(|block| *block = lower_times(inverse, block));
        });
        let lower = &self.lower;
        let nothing = &mut vec![(); sweep.n_rows()];
        let (left, right) = self.factor.entries_mut().split_at_mut(9 * sweep.right_begin[0]);
        each_row(rows.clone(), &|row| 9 * sweep.left_begin[row], left, nothing, &|own, (), row| {
            for (position, unit) in sweep.left(row).zip(own.as_chunks_mut().0) {
                *unit = to_half(block(lower, 9 * (position + row)));
            }
        });
        each_row(rows, &|row| 9 * sweep.right_begin[row], right, nothing, &|own, (), row| {
            for (position, unit) in sweep.right(row).zip(own[9..].as_chunks_mut().0) {
                let mirror = sweep.mirror[position] + sweep.columns[position];
                *unit = transposed(&to_half(block(lower, 9 * mirror as usize)));
            }
        });
    }

    /// `x = (L L^T)^-1 x`.
    pub(crate) fn sweeps<const C: usize>(&self, sweep: &SweepOrder, x: &mut [Row<f32, C>]) {
        let n_interior = sweep.n_interior();
        let (interior, interface) = x.split_at_mut(n_interior);
        side_by_side(interior, &sweep.interiors, &|row| row, &|x, rows| {
            bf16::dispatch(Forward { part: self.part(sweep, rows, &[], 0), x });
        });
        let interior_done = &*interior;
        side_by_side(interface, &sweep.interfaces, &|row| row, &|x, rows| {
            bf16::dispatch(Forward { part: self.part(sweep, rows.clone(), interior_done, 0), x });
            bf16::dispatch(Backward { part: self.part(sweep, rows, &[], 0), x });
        });
        let interface_done = &*interface;
        side_by_side(interior, &sweep.interiors, &|row| row, &|x, rows| {
            bf16::dispatch(Backward { part: self.part(sweep, rows, interface_done, n_interior), x });
        });
        x.par_chunks_mut(CHUNK).zip(self.pivots.par_chunks(CHUNK)).for_each(|(x, pivots)| {
            x.iter_mut().zip(pivots).for_each(|(x, pivot)| *x = transposed_times(pivot, x));
        });
    }

    fn part<'a, const C: usize>(
        &'a self,
        sweep: &'a SweepOrder,
        rows: Range<usize>,
        others: &'a [Row<f32, C>],
        first_other: usize,
    ) -> Part<'a, C> {
        Part { factor: &self.factor, pivots: &self.pivots, sweep, rows, others, first_other }
    }
}

/// Start of a row of the factor while it is computed: of each previous row, the blocks left of its diagonal and one
/// more.
fn lower_begin(sweep: &SweepOrder, row: usize) -> usize {
    9 * (sweep.left_begin[row] + row)
}

/// A block, by columns.
#[inline(always)]
fn block(entries: &[f32], at: usize) -> &[f32] {
    &entries[at..at + 9]
}

impl<const C: usize> Approximate<f32, C> for IncompleteCholesky {
    fn solve(&mut self, sweep: &SweepOrder, x: &mut [Row<f32, C>]) {
        self.sweeps(sweep, x);
    }
}

/// Factorises a row: `part` holds the numbers from `first` on, `interior` those of the interiors.
fn factorize_row(
    sweep: &SweepOrder,
    row: usize,
    first: usize,
    part: &mut [f32],
    interior: &[f32],
    entry: &impl Fn(usize, usize) -> [f32; 9],
) {
    let known = |part: &[f32], at: usize| -> [f32; 9] {
        let block = if at < first { block(interior, at) } else { block(part, at - first) };
        std::array::from_fn(|entry| block[entry])
    };
    let left = sweep.left(row);
    let mut at = lower_begin(sweep, row) - first;
    for position in left.clone().chain([sweep.diagonal(row)]) {
        let column = sweep.columns[position] as usize;
        let original = entry(position, row);
        let mut work = original;
        // L_ij = (A_ij - sum_k L_ik L_jk^T) L_jj^-T
        let end = left.end.min(position);
        let (mut own, others) = (left.start, sweep.left(column));
        let mut other = others.start;
        while own < end && other < others.end {
            let [k, l] = [own, other].map(|position| sweep.columns[position]);
            if k == l {
                let known = known(part, 9 * (other + column));
                subtract_product(&mut work, block(part, 9 * (own + row) - first), &known);
            }
            own += usize::from(k <= l);
            other += usize::from(l <= k);
        }
        let result = if column < row {
            times_lower_transposed(&work, &known(part, 9 * (others.end + column)))
        } else {
            inverse_factor(work, [original[0], original[4], original[8]])
        };
        part[at..at + 9].copy_from_slice(&result);
        at += 9;
    }
}

/// `A -= B C^T`.
#[inline(always)]
fn subtract_product(A: &mut [f32; 9], B: &[f32], C: &[f32]) {
    let (B, C) = (&B[..9], &C[..9]);
    for b in 0..3 {
        for a in 0..3 {
            A[3 * b + a] -= B[a] * C[b] + B[3 + a] * C[3 + b] + B[6 + a] * C[6 + b];
        }
    }
}

/// `A I^T` with lower triangular I.
#[inline(always)]
fn times_lower_transposed(A: &[f32; 9], inverse: &[f32]) -> [f32; 9] {
    let mut product = [0.0; 9];
    for a in 0..3 {
        for b in 0..3 {
            product[3 * b + a] = (0..=b).map(|c| A[3 * c + a] * inverse[3 * c + b]).sum();
        }
    }
    product
}

/// `I A` with lower triangular I.
#[inline(always)]
fn lower_times(inverse: &[f32], A: &[f32]) -> [f32; 9] {
    let mut product = [0.0; 9];
    for a in 0..3 {
        for b in 0..3 {
            product[3 * b + a] = (0..=a).map(|c| inverse[3 * c + a] * A[3 * b + c]).sum();
        }
    }
    product
}

/// Inverse of the Cholesky factor of a block; a pivot lost to the omitted fill is replaced by the pivot of the original
/// diagonal.
fn inverse_factor(A: [f32; 9], original: [f32; 3]) -> [f32; 9] {
    const SMALLEST: f32 = 1e-3;
    let mut L = [[0f32; 3]; 3];
    for a in 0..3 {
        for b in 0..=a {
            let known: f32 = (0..b).map(|c| L[a][c] * L[b][c]).sum();
            let rest = A[3 * b + a] - known;
            L[a][b] = if a > b {
                rest / L[b][b]
            } else if rest > SMALLEST * original[a].abs() {
                rest.sqrt()
            } else {
                original[a].abs().sqrt()
            };
        }
    }
    let [i0, i1, i2] = [1.0 / L[0][0], 1.0 / L[1][1], 1.0 / L[2][2]];
    let i10 = -L[1][0] * i0 * i1;
    let i21 = -L[2][1] * i1 * i2;
    [i0, i10, -(L[2][0] * i0 + L[2][1] * i10) * i2, 0.0, i1, i21, 0.0, 0.0, i2]
}

fn to_half(A: &[f32]) -> [bf16; 9] {
    std::array::from_fn(|at| bf16::from_f32(A[at]))
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::Pattern;
    use super::super::shifted::ShiftedMatrix;
    use super::super::sweep::tests::grid;
    use super::*;

    /// Mass of a box and a stiffness that is coupled in all components; `(mass, stiffness)`.
    pub(crate) fn elastic(pattern: &Pattern) -> (Vec<f64>, Vec<f64>) {
        let mut mass = vec![0.0; pattern.n_blocks()];
        let mut stiffness = vec![0.0; 9 * pattern.n_blocks()];
        for row in 0..pattern.n_rows() {
            let n = pattern.row(row).len() as f64;
            for (position, &column) in pattern.range(row).zip(pattern.row(row)) {
                let is_diagonal = column as usize == row;
                mass[position] = if is_diagonal { 8.0 } else { 0.2 };
                for a in 0..3 {
                    for b in 0..3 {
                        let off = if a == b { -1.0 } else { 0.3 };
                        let value = if is_diagonal && a == b {
                            n + 1.0
                        } else if is_diagonal {
                            0.0
                        } else {
                            off
                        };
                        stiffness[9 * position + 3 * a + b] = value;
                    }
                }
            }
        }
        (mass, stiffness)
    }

    #[test]
    fn without_fill_it_is_the_factor_itself() {
        // A chain has no fill: the incomplete factor is exact, to its 8 stored bits.
        let lists: Vec<[u32; 2]> = (0..39).map(|i| [i, i + 1]).collect();
        let pattern = Pattern::new(40, lists.iter().map(|list| &list[..]));
        let (mass, stiffness) = elastic(&pattern);
        let sweep = SweepOrder::new(&pattern);
        let mut fixed = vec![false; 120];
        (fixed[7], fixed[60], fixed[61]) = (true, true, true);
        let mut factor = IncompleteCholesky::new(&sweep);
        let block = |position: usize| &stiffness[9 * position..9 * position + 9];
        factor.factorize(&sweep, &fixed, 0.7, &mass, block);
        let mut matrix = ShiftedMatrix::<f64, 1>::new(&sweep, &fixed);
        matrix.set(&sweep, [0.7, 0.0], &mass, block);
        let free = |new: usize, a: usize| !fixed[3 * sweep.order[new] as usize + a];
        let x: Vec<Row<f64, 1>> = (0..40)
            .map(|i| {
                [0, 1, 2, 3].map(|a| [if a < 3 && free(i, a) { (i as f64 + a as f64).sin() } else { 0.0 }])
            })
            .collect();
        let mut b = x.clone();
        matrix.multiply(&sweep, &x, &mut b, &mut [[0.0; 2]]);
        let mut solution: Vec<Row<f32, 1>> = b.iter().map(|b| b.map(|b| [b[0] as f32])).collect();
        factor.sweeps(&sweep, &mut solution);
        for (x, solution) in x.iter().zip(&solution) {
            (0..3).for_each(|a| assert!((x[a][0] - f64::from(solution[a][0])).abs() < 1.0 / 128.0));
        }
    }

    #[test]
    fn chunks_do_not_change_the_factor_of_their_own_rows() {
        // Several chunks: the factor times its transpose agrees with the matrix on the pattern of every row without
        // fill.
        let pattern = grid([6, 6, 280]);
        let (mass, stiffness) = elastic(&pattern);
        let sweep = SweepOrder::new(&pattern);
        assert!(sweep.interiors.len() > 1);
        let fixed = vec![false; 3 * pattern.n_rows()];
        let mut factor = IncompleteCholesky::new(&sweep);
        factor.factorize(&sweep, &fixed, 1.0, &mass, |position| &stiffness[9 * position..9 * position + 9]);
        let mut x = vec![[[1f32], [1.0], [1.0], [0.0]]; sweep.n_rows()];
        factor.sweeps(&sweep, &mut x);
        let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let mut y = vec![[[1f32], [1.0], [1.0], [0.0]]; sweep.n_rows()];
        one_thread.install(|| factor.sweeps(&sweep, &mut y));
        assert!(x == y && x.iter().all(|x| x[..3].iter().all(|x| x[0].is_finite() && x[0] > 0.0)));
    }
}
