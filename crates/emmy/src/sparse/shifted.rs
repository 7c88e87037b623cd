//! Matrices `M + lambda K` with real or complex lambda, symmetric, on the rows of a pattern.

use rayon::prelude::*;

use super::blocks::{Blocks, Row, products};
use super::real::Real;
use super::sweep::SweepOrder;

/// The matrix `M + lambda K`; K has 3 x 3 blocks, M a number for each coupling.
#[derive(Debug, Clone)]
pub struct ShiftedMatrix<T, const C: usize> {
    /// With one column the blocks of `M + lambda K`, with two those of K.
    blocks: Blocks<T>,
    /// M, with two columns.
    mass: Vec<T>,
    shift: [T; 2],
    /// Components that are held: rows of which are left out, `[3 row + component]` in the order of the sweep.
    fixed: Vec<u32>,
}

/// Rows that one task works on.
pub const CHUNK: usize = 2048;

impl<T: Real, const C: usize> ShiftedMatrix<T, C> {
    /// Memory for a matrix; `fixed: [n_rows][3]` in the numbers of the pattern.
    pub fn new(sweep: &SweepOrder, fixed: &[bool]) -> Self {
        let held = sweep.order.iter().enumerate().flat_map(|(new, &old)| {
            (0..3).filter(move |a| fixed[3 * old as usize + a]).map(move |a| (3 * new + a) as u32)
        });
        ShiftedMatrix {
            blocks: Blocks::new(sweep.columns.len()),
            mass: vec![T::default(); if C == 2 { sweep.columns.len() } else { 0 }],
            shift: [T::default(); 2],
            fixed: held.collect(),
        }
    }

    /// Sets the matrix. `stiffness(position)`: block of K; `mass`: M, both in the positions of the pattern.
    pub fn set<'a>(
        &mut self,
        sweep: &SweepOrder,
        shift: [f64; 2],
        mass: &[f64],
        stiffness: impl Fn(usize) -> &'a [f64] + Sync,
    ) {
        self.shift = shift.map(T::of);
        let factor = if C == 2 { 1.0 } else { shift[0] };
        let set = |(block, &source): (&mut [T], &u32)| {
            let values = stiffness(source as usize);
            let m = if C == 2 { 0.0 } else { mass[source as usize] };
            for (at, value) in block.iter_mut().enumerate() {
                // by columns
                let entry = factor * values[3 * (at % 3) + at / 3];
                *value = T::of(entry + if at % 4 == 0 { m } else { 0.0 });
            }
        };
        let blocks = self.blocks.entries_mut().par_chunks_exact_mut(9);
        blocks.zip(&sweep.source).with_min_len(4096).for_each(set);
        self.mass.iter_mut().zip(&sweep.source).for_each(|(m, &source)| *m = T::of(mass[source as usize]));
    }

    /// `y = (M + lambda K) x`, on rows that are free; held ones stay zero. Returns `x^T y` (not conjugated).
    pub fn multiply(
        &self,
        sweep: &SweepOrder,
        x: &[Row<T, C>],
        y: &mut [Row<T, C>],
        partial: &mut [[f64; 2]],
    ) -> [f64; 2] {
        let tasks = y.par_chunks_mut(CHUNK).zip(partial.par_iter_mut()).enumerate();
        tasks.for_each(|(task, (y, partial))| {
            self.multiply_rows(sweep, task * CHUNK, x, y);
            let first = (3 * CHUNK * task) as u32;
            let held = self.fixed.partition_point(|&at| at < first)
                ..self.fixed.partition_point(|&at| at < first + 3 * y.len() as u32);
            self.fixed[held].iter().for_each(|&at| {
                let at = (at - first) as usize;
                y[at / 3][at % 3] = [T::default(); C];
            });
            *partial = dot(&x[CHUNK * task..CHUNK * task + y.len()], y);
        });
        summed(partial)
    }

    fn multiply_rows(&self, sweep: &SweepOrder, first: usize, x: &[Row<T, C>], y: &mut [Row<T, C>]) {
        for (index, y) in y.iter_mut().enumerate() {
            let row = first + index;
            let (begin, end) = (sweep.row_begin[row], sweep.row_begin[row + 1]);
            let columns = &sweep.columns[begin..end];
            let stiff = products(&self.blocks.entries()[9 * begin..=9 * end], columns, |column| &x[column]);
            if C == 1 {
                *y = stiff;
                continue;
            }
            let mut inert = [[T::default(); C]; 3];
            for (&m, &column) in self.mass[begin..end].iter().zip(&sweep.columns[begin..end]) {
                let x = &x[column as usize];
                (0..3).for_each(|a| (0..C).for_each(|c| inert[a][c] += m * x[a][c]));
            }
            let [re, im] = self.shift;
            for a in 0..3 {
                let [k_re, k_im] = [stiff[a][0], stiff[a][C - 1]];
                y[a][0] = inert[a][0] + re * k_re - im * k_im;
                y[a][C - 1] = inert[a][C - 1] + re * k_im + im * k_re;
            }
        }
    }
}

/// `x^T y`, not conjugated, as (real, imaginary).
pub fn dot<T: Real, const C: usize>(x: &[Row<T, C>], y: &[Row<T, C>]) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for (x, y) in x.iter().zip(y) {
        for a in 0..3 {
            if C == 1 {
                sum[0] += x[a][0].wide() * y[a][0].wide();
            } else {
                let [xr, xi] = [x[a][0].wide(), x[a][C - 1].wide()];
                let [yr, yi] = [y[a][0].wide(), y[a][C - 1].wide()];
                sum[0] += xr * yr - xi * yi;
                sum[1] += xr * yi + xi * yr;
            }
        }
    }
    sum
}

/// Sum of the parts, in their order: the same for any number of threads.
pub fn summed(partial: &[[f64; 2]]) -> [f64; 2] {
    partial.iter().fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]])
}
