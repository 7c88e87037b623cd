//! Matrix blocks for products with vectors.

use super::real::Real;

/// A vector of a solver: three components a row, each with C columns. One column is a real vector; two are the real and the
/// imaginary part of a complex one. `[row][3][C]`.
pub type Row<T, const C: usize> = [[T; C]; 3];

/// 3 x 3 blocks one after another, each by columns. A product loads a column as four numbers, the last of which belongs to the
/// next column and is not used: so three multiplications of whole registers serve a block, and no memory is lost to padding.
#[derive(Debug, Clone)]
pub struct Blocks<T> {
    entries: Vec<T>,
}

impl<T: Real> Blocks<T> {
    /// Zero blocks.
    pub fn new(n_blocks: usize) -> Self {
        Blocks { entries: vec![T::default(); 9 * n_blocks + 1] }
    }

    /// All entries, one block after another, each by columns, and one more.
    pub fn entries(&self) -> &[T] {
        &self.entries
    }

    /// All entries, to be written.
    pub fn entries_mut(&mut self) -> &mut [T] {
        let n = self.entries.len() - 1;
        &mut self.entries[..n]
    }
}

/// `sum A x` over the blocks of a row: `blocks` holds them one after another, and at least one number more.
#[inline(always)]
pub fn products<'a, T: Real, const C: usize>(
    blocks: &[T],
    columns: &[u32],
    x: impl Fn(usize) -> &'a Row<T, C>,
) -> Row<T, C> {
    let mut sum = [T::four([T::default(); 4]); C];
    let mut at = 0;
    for &column in columns {
        let (block, x) = (&blocks[at..at + 10], x(column as usize));
        let a = [four(block, 0), four(block, 3), four(block, 6)];
        for c in 0..C {
            let by = |b: usize| T::four([x[b][c]; 4]);
            sum[c] += a[0] * by(0) + a[1] * by(1) + a[2] * by(2);
        }
        at += 9;
    }
    let sum = sum.map(T::array);
    [0, 1, 2].map(|a| std::array::from_fn(|c| sum[c][a]))
}

#[inline(always)]
fn four<T: Real>(block: &[T], at: usize) -> T::Four {
    T::four([block[at], block[at + 1], block[at + 2], block[at + 3]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_the_blocks() {
        let mut blocks = Blocks::<f64>::new(2);
        blocks.entries_mut().iter_mut().enumerate().for_each(|(at, entry)| *entry = at as f64);
        let x = [[[1.0, -1.0], [2.0, 0.5], [3.0, 2.0]], [[-1.0, 2.0], [0.5, 1.0], [1.0, 0.0]]];
        let sum = products(blocks.entries(), &[1, 0], |column| &x[column]);
        for a in 0..3 {
            for c in 0..2 {
                let block = |first: usize, row: usize| {
                    (0..3).map(|b| (first + 3 * b + a) as f64 * x[row][b][c]).sum::<f64>()
                };
                assert_eq!(sum[a][c], block(0, 1) + block(9, 0));
            }
        }
    }
}
