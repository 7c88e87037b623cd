//! Cholesky factorisation of a symmetric block matrix on a pattern, with some rows left out.

use super::Pattern;
use super::factor::Factor;
use super::lower::Lower;
use crate::error::Result;

/// Factorisation of a symmetric matrix of small square blocks, restricted to its free rows: `L L^T`, or `L B L^T` if it
/// is indefinite.
#[derive(Debug)]
pub struct BlockCholesky {
    lower: Lower,
    factor: Factor<f64>,
}

/// Largest number of right-hand sides solved at once, unless more are reserved.
const MAX_COLUMNS: usize = 3;

impl BlockCholesky {
    /// Symbolic factorisation. `components`: rows per block; `fixed: [n_rows components]`; `order[new] = old` of block
    /// rows.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`], [`crate::Error::Linear`].
    pub fn new(pattern: &Pattern, components: usize, fixed: &[bool], order: &[usize]) -> Result<Self> {
        let lower = Lower::new(pattern, components, fixed, order)?;
        Ok(BlockCholesky { factor: Factor::new(&lower, MAX_COLUMNS)?, lower })
    }

    /// Reserves memory for the solution of `n_columns` right-hand sides at once; without it, there are three.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub fn reserve(&mut self, n_columns: usize) -> Result<()> {
        self.factor.reserve(&self.lower, n_columns)
    }

    /// Numerical factorisation; `entry` returns an entry of the matrix by `position components^2 + components a + b`.
    ///
    /// # Errors
    /// [`crate::Error::Linear`] if an entry is not finite or there is not enough memory.
    pub fn factorize(&mut self, entry: impl Fn(usize) -> f64) -> Result<()> {
        if !self.factor.factorize(&self.lower, |source| [entry(source), 0.0])? {
            self.factor.factorize_indefinite(&self.lower)?;
        }
        Ok(())
    }

    /// Whether the last matrix was positive definite.
    pub fn is_definite(&self) -> bool {
        !self.factor.is_indefinite()
    }

    /// Cost of a factorisation, in solutions.
    pub fn cost_over_solution(&self) -> f64 {
        self.lower.cost_over_solution()
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
        let read = |state: &S, column: usize, row: usize| [read(state, column, row), 0.0];
        let write = |state: &mut S, column: usize, row: usize, [value, _]: [f64; 2]| {
            write(state, column, row, value);
        };
        self.factor.solve(&self.lower, n_columns, state, read, write);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

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

    /// A chain of rows, its factorisation, and entries of the tridiagonal matrix (-1, d, -1).
    fn chain(n: u32) -> (Pattern, BlockCholesky) {
        let lists: Vec<[u32; 2]> = (1..n).map(|row| [row - 1, row]).collect();
        let pattern = Pattern::new(n as usize, lists.iter().map(|list| &list[..]));
        let backwards: Vec<usize> = (0..n as usize).rev().collect();
        let factor = BlockCholesky::new(&pattern, 1, &vec![false; n as usize], &backwards).unwrap();
        (pattern, factor)
    }

    fn tridiagonal(pattern: &Pattern, d: f64) -> impl Fn(usize) -> f64 {
        let diagonal: Vec<_> = (0..pattern.n_rows()).map(|row| pattern.position(row, row)).collect();
        move |source| if diagonal.contains(&Some(source)) { d } else { -1.0 }
    }

    #[test]
    fn definite_and_indefinite_systems_are_solved() {
        let n = 50;
        let (pattern, mut factor) = chain(n as u32);
        for (d, definite) in [(2.5, true), (0.3, false)] {
            factor.factorize(tridiagonal(&pattern, d)).unwrap();
            assert_eq!(factor.is_definite(), definite);
            let x: Vec<f64> = (0..2 * n).map(|i| (i as f64).sin()).collect();
            let mut rhs = vec![0.0; 2 * n];
            for c in 0..2 {
                let at = |i: usize| x[c * n + i];
                for i in 0..n {
                    let left = if i > 0 { at(i - 1) } else { 0.0 };
                    let right = if i + 1 < n { at(i + 1) } else { 0.0 };
                    rhs[c * n + i] = d * at(i) - left - right;
                }
            }
            factor.solve(2, &mut rhs, |b, c, row| b[c * n + row], |b, c, row, value| b[c * n + row] = value);
            assert!(rhs.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-11));
        }
    }

    #[test]
    fn entries_must_be_finite() {
        let (pattern, mut factor) = chain(3);
        let entry = tridiagonal(&pattern, 2.0);
        let outcome = factor.factorize(|source| if source == 0 { f64::NAN } else { entry(source) });
        assert!(matches!(outcome, Err(Error::Linear { .. })));
    }
}
