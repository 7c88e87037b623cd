//! Matrix blocks for products with vectors.

use super::kernel::{Entry, Kernel, LOADED, Row};
use super::real::Real;
use crate::tensor::inlined;

/// 3 x 3 blocks one after another, each by columns. A product loads more than one block and ignores the part of the
/// next one; no memory is lost to padding.
#[derive(Debug, Clone)]
pub(super) struct Blocks<E> {
    entries: Vec<E>,
}

impl<E: Entry> Blocks<E> {
    /// Zero blocks.
    pub(super) fn new(n_blocks: usize) -> Self {
        Blocks { entries: vec![E::default(); 9 * n_blocks + LOADED - 9] }
    }

    /// All entries, one block after another, each by columns.
    pub(super) fn entries_mut(&mut self) -> &mut [E] {
        let n = self.entries.len() + 9 - LOADED;
        &mut self.entries[..n]
    }

    /// The entries of a block, by columns.
    pub(super) fn block(&self, number: usize) -> &[E] {
        &self.entries[9 * number..9 * number + 9]
    }

    /// `sum A x` over consecutive blocks, from `first` on, one for each column. The last column is added last, or first
    /// if `REVERSED`: a sweep needs the row computed last to come last.
    #[inline(always)]
    pub(super) fn product<const C: usize, const REVERSED: bool, K: Kernel<E, C>>(
        &self,
        kernel: K,
        first: usize,
        columns: &[u32],
        x: Rows<'_, E::Number, C>,
    ) -> Row<E::Number, C> {
        let n = columns.len();
        let entries = &self.entries[9 * first..9 * (first + n) + LOADED - 9];
        // Two sums, so that an addition need not wait for the previous one.
        let mut sums = [kernel.zero(); 2];
        let add = inlined!(|sum: &mut K::Sum, i: usize| {
            let at = if REVERSED { n - 1 - i } else { i };
            if let Some(block) = entries[9 * at..].first_chunk() {
                *sum = kernel.add_product(*sum, block, x.row(columns[at]));
            }
        });
        for pair in 0..n / 2 {
            add(&mut sums[0], 2 * pair);
            add(&mut sums[1], 2 * pair + 1);
        }
        if n % 2 == 1 {
            add(&mut sums[0], n - 1);
        }
        kernel.total(sums)
    }
}

/// Rows of a vector in one or two pieces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rows<'a, T, const C: usize> {
    /// Rows from number `first` on.
    pub own: &'a [Row<T, C>],
    /// Number of the first of these rows.
    pub first: usize,
    /// The other rows.
    pub others: &'a [Row<T, C>],
    /// Number of the first of the other rows.
    pub first_other: usize,
}

impl<'a, T, const C: usize> Rows<'a, T, C> {
    /// All rows in one piece.
    pub(super) fn all(rows: &'a [Row<T, C>]) -> Self {
        Rows { own: rows, first: 0, others: &[], first_other: 0 }
    }

    #[inline(always)]
    fn row(self, number: u32) -> &'a Row<T, C> {
        let number = number as usize;
        match self.own.get(number.wrapping_sub(self.first)) {
            Some(row) => row,
            None => &self.others[number - self.first_other],
        }
    }
}

/// `A x`, A by columns.
#[inline(always)]
pub(super) fn times<T: Real, const C: usize>(A: &[[T; 4]; 3], x: &Row<T, C>) -> Row<T, C> {
    let mut product = [[T::default(); C]; 4];
    for a in 0..4 {
        for c in 0..C {
            product[a][c] = A[0][a] * x[0][c] + A[1][a] * x[1][c] + A[2][a] * x[2][c];
        }
    }
    product
}

/// `A^T x`, A by columns.
#[inline(always)]
pub(super) fn transposed_times<const C: usize>(A: &[[f32; 4]; 3], x: &Row<f32, C>) -> Row<f32, C> {
    let mut product = [[0.0; C]; 4];
    for a in 0..3 {
        for c in 0..C {
            product[a][c] = A[a][0] * x[0][c] + A[a][1] * x[1][c] + A[a][2] * x[2][c];
        }
    }
    product
}

/// `x - y`.
#[inline(always)]
pub(super) fn minus<T: Real, const C: usize>(x: &Row<T, C>, y: &Row<T, C>) -> Row<T, C> {
    let mut difference = *x;
    for a in 0..4 {
        for c in 0..C {
            difference[a][c] -= y[a][c];
        }
    }
    difference
}

#[cfg(test)]
mod tests {
    use half::bf16;

    use super::super::kernel::{Portable, Work};
    use super::super::real::Real;
    use super::*;

    /// Sums of products with the columns 1, 0, 2 in both directions.
    struct Sums<'a, E: Entry, const C: usize> {
        blocks: &'a Blocks<E>,
        x: &'a [Row<E::Number, C>],
    }

    impl<E: Entry, const C: usize> Work<E, C> for Sums<'_, E, C> {
        type Output = [Row<E::Number, C>; 2];
        fn run<K: Kernel<E, C>>(self, kernel: K) -> Self::Output {
            let x = Rows { own: &self.x[1..], first: 1, others: &self.x[..1], first_other: 0 };
            let forward = self.blocks.product::<C, false, K>(kernel, 1, &[1, 0, 2], x);
            [forward, self.blocks.product::<C, true, K>(kernel, 1, &[1, 0, 2], x)]
        }
    }

    fn products_are_those_of_the_blocks<E: Entry, const C: usize>() {
        // Whole numbers representable in every type, so that sums are exact in any order.
        let mut blocks = Blocks::<E>::new(5);
        blocks.entries_mut().iter_mut().enumerate().for_each(|(at, entry)| *entry = E::of(at as f64));
        let value = |row: usize, b: usize, c: usize| (5 * row + 2 * b) as f64 - (7 * c) as f64;
        let x = [0, 1, 2].map(|row| {
            let mut x = [[E::Number::default(); C]; 4];
            (0..3).for_each(|b| (0..C).for_each(|c| x[b][c] = E::Number::of(value(row, b, c))));
            x
        });
        let sums = || Sums { blocks: &blocks, x: &x };
        let mut results = vec![sums().run(Portable), E::dispatch(sums())];
        results.extend(E::narrower(sums()));
        for (a, c) in (0..3).flat_map(|a| (0..C).map(move |c| (a, c))) {
            let block = |number: usize, row: usize| {
                (0..3).map(|b| (9 * number + 3 * b + a) as f64 * value(row, b, c)).sum::<f64>()
            };
            let sum = block(1, 1) + block(2, 0) + block(3, 2);
            assert!(results.iter().flatten().all(|row| row[a][c].wide() == sum), "{results:?} {sum}");
        }
        assert!(results.iter().flatten().all(|row| row[3] == [E::Number::default(); C]));
    }

    #[test]
    fn products_in_every_instruction_set() {
        products_are_those_of_the_blocks::<f64, 1>();
        products_are_those_of_the_blocks::<f64, 2>();
        products_are_those_of_the_blocks::<f32, 1>();
        products_are_those_of_the_blocks::<f32, 2>();
        products_are_those_of_the_blocks::<bf16, 1>();
        products_are_those_of_the_blocks::<bf16, 2>();
    }
}
