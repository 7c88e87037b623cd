//! Cholesky factorisation of a symmetric block matrix on a pattern, with some rows left out.

use super::{Cholesky, Pattern};
use crate::error::Result;

/// Factorisation of a symmetric matrix of small square blocks, restricted to its free rows.
#[derive(Debug)]
pub struct BlockCholesky {
    factor: Cholesky,
    /// Source of each entry of the lower triangle: `position components^2 + entry`.
    sources: Vec<usize>,
    /// Free scalar rows, ascending.
    free: Vec<usize>,
    values: Vec<f64>,
    packed: Vec<f64>,
}

impl BlockCholesky {
    /// Symbolic factorisation. `components`: rows per block; `fixed: [n_rows components]`; `order[new] = old` of block
    /// rows.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub fn new(pattern: &Pattern, components: usize, fixed: &[bool], order: &[usize]) -> Result<Self> {
        let free: Vec<usize> = (0..fixed.len()).filter(|&row| !fixed[row]).collect();
        let mut number = vec![usize::MAX; fixed.len()];
        free.iter().enumerate().for_each(|(index, &row)| number[row] = index);
        let mut begin = vec![0];
        let mut rows = Vec::new();
        let mut sources = Vec::new();
        for &column in &free {
            let node = column / components;
            let b = column % components;
            for (position, &other) in pattern.range(node).zip(pattern.row(node)) {
                for a in 0..components {
                    let row = other as usize * components + a;
                    if row >= column && !fixed[row] {
                        rows.push(number[row]);
                        // The block of row `node`, transposed: symmetric matrices only.
                        sources.push((position * components + b) * components + a);
                    }
                }
            }
            begin.push(rows.len());
        }
        let order = order.iter().flat_map(|&node| (0..components).map(move |a| node * components + a));
        let order = order.filter(|&row| !fixed[row]).map(|row| number[row]).collect();
        let factor = Cholesky::new(begin, rows, order)?;
        Ok(BlockCholesky { factor, values: vec![0.0; sources.len()], sources, packed: Vec::new(), free })
    }

    /// Reserves memory for the solution of `n_columns` right-hand sides at once; without it, there are three.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub fn reserve(&mut self, n_columns: usize) -> Result<()> {
        self.factor.reserve(n_columns)
    }

    /// Numerical factorisation; `entry` returns an entry of the matrix by `position components^2 + components a + b`.
    ///
    /// # Errors
    /// [`crate::Error::Linear`] if an entry is not finite or there is not enough memory.
    pub fn factorize(&mut self, entry: impl Fn(usize) -> f64) -> Result<()> {
        self.values.iter_mut().zip(&self.sources).for_each(|(value, &source)| *value = entry(source));
        self.factor.factorize(&self.values)
    }

    /// Cost of a factorisation, in solutions.
    pub fn cost_over_solution(&self) -> f64 {
        // A column with c entries takes c^2 operations in cache, and 2 c words from memory in a solution.
        let entries_of_column = self.factor.n_entries() as f64 / self.free.len().max(1) as f64;
        (0.04 * entries_of_column).max(4.0)
    }

    /// The factor itself.
    pub fn factor(&self) -> &Cholesky {
        &self.factor
    }

    /// Solves for several right-hand sides at once, each given by access to the scalar rows: `read(column, row)` and
    /// `write(column, row, value)`; fixed rows are unchanged.
    pub fn solve<S>(
        &mut self,
        n_columns: usize,
        state: &mut S,
        read: impl Fn(&S, usize, usize) -> f64,
        mut write: impl FnMut(&mut S, usize, usize, f64),
    ) {
        self.packed.clear();
        for column in 0..n_columns {
            self.packed.extend(self.free.iter().map(|&row| read(state, column, row)));
        }
        self.factor.solve(&mut self.packed, n_columns);
        for column in 0..n_columns {
            let solution = &self.packed[column * self.free.len()..];
            for (&row, &value) in self.free.iter().zip(solution) {
                write(state, column, row, value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_rows_are_solved_and_fixed_ones_left_alone() {
        // Three nodes with two components; blocks 4 I on the diagonal, -[[1, 0.5], [0.5, 1]] beside it.
        let lists = [[0u32, 1], [1, 2]];
        let pattern = Pattern::new(3, lists.iter().map(|list| &list[..]));
        let mut fixed = vec![false; 6];
        fixed[3] = true;
        let mut factor = BlockCholesky::new(&pattern, 2, &fixed, &[2, 0, 1]).unwrap();
        let block = |row: usize, column: usize, a: usize, b: usize| match (row == column, a == b) {
            (true, true) => 4.0,
            (true, false) => 0.0,
            (false, true) => -1.0,
            (false, false) => -0.5,
        };
        let entry = |source: usize| {
            let position = source / 4;
            let row = (0..3).find(|&row| pattern.range(row).contains(&position)).unwrap();
            let column = pattern.row(row)[position - pattern.range(row).start] as usize;
            block(row, column, source / 2 % 2, source % 2)
        };
        factor.factorize(entry).unwrap();
        let x = [1.0, 2.0, 3.0, 0.0, 5.0, 6.0];
        let mut b: Vec<f64> = (0..6)
            .map(|row: usize| {
                (0..6usize)
                    .filter(|&c| (row / 2).abs_diff(c / 2) < 2)
                    .map(|c| block(row / 2, c / 2, row % 2, c % 2) * x[c])
                    .sum()
            })
            .collect();
        b[3] = 77.0;
        factor.solve(1, &mut b, |b, _, row| b[row], |b, _, row, value| b[row] = value);
        for (row, (value, expected)) in b.iter().zip(x).enumerate() {
            let expected = if row == 3 { 77.0 } else { expected };
            assert!((value - expected).abs() < 1e-14);
        }
    }
}
