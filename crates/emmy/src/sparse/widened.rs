//! Matrices with couplings beyond their pattern, for factorisations and as rows.

use super::stages::BlockRow;
use super::{BlockCholesky, Couplings, Pattern, StageMatrix, nested_dissection};
use crate::error::Result;

/// A stage matrix whose couplings beyond the pattern are part of a pattern of its own, for factorisations.
///
/// ```
/// use emmy::internals::sparse::{Pattern, StageMatrix, Widened};
/// let pattern = Pattern::new(4, [&[0u32, 1][..], &[2, 3]].into_iter());
/// let mut matrix = StageMatrix::new(&pattern, &pattern.divided(1), 1);
/// matrix.couplings.block_mut(1, 2)[0] = 5.0;
/// let mut widened = Widened::new(&pattern, &matrix.couplings);
/// widened.set(&pattern, &matrix);
/// assert_eq!(widened.pattern.row(2), [1, 2, 3]); // symmetric
/// assert_eq!(widened.matrix.block(widened.pattern.position(1, 2).unwrap())[0], 5.0);
/// ```
#[derive(Debug, Clone)]
pub struct Widened {
    /// The pattern.
    pub pattern: Pattern,
    /// The matrix, as set last.
    pub matrix: StageMatrix,
    /// Place of each position of the narrow pattern.
    places: Vec<usize>,
}

impl Widened {
    /// A pattern with the couplings of a matrix, and their mirror images.
    pub fn new(pattern: &Pattern, couplings: &Couplings) -> Self {
        let pairs: Vec<[u32; 2]> = couplings.iter().map(|(nodes, _)| nodes.map(|node| node as u32)).collect();
        let wide = pattern.with_couplings(&pairs);
        let places = (0..pattern.n_rows())
            .flat_map(|row| pattern.row(row).iter().map(move |&column| (row, column as usize)))
            .map(|(row, column)| wide.coupling(row, column))
            .collect();
        let matrix = StageMatrix::new(&wide, &wide.divided(1), couplings.degree());
        Widened { pattern: wide, matrix, places }
    }

    /// Whether the pattern has all couplings.
    pub fn covers(&self, couplings: &Couplings) -> bool {
        couplings.iter().all(|([row, column], _)| self.pattern.position(row, column).is_some())
    }

    /// Sets the matrix from one on the narrow pattern.
    pub fn set(&mut self, pattern: &Pattern, matrix: &StageMatrix) {
        let size = 9 * matrix.degree() * matrix.degree();
        let Widened { pattern: wide, matrix: own, places } = self;
        let blocks = own.parts_mut()[0].blocks_mut().0.as_flattened_mut();
        blocks.fill(0.0);
        for (from, to) in (0..pattern.n_blocks()).zip(&*places) {
            blocks[to * size..][..size].copy_from_slice(matrix.block(from));
        }
        for ([row, column], coupling) in matrix.couplings.iter() {
            let sums = blocks[wide.coupling(row, column) * size..][..size].iter_mut();
            sums.zip(coupling).for_each(|(sum, entry)| *sum += entry);
        }
    }

    /// Adds to the diagonals of blocks; `entry` by nine times the position in the narrow pattern plus 0, 4 or 8.
    fn add_diagonals(&mut self, entry: impl Fn(usize) -> f64) {
        let blocks = self.matrix.parts_mut()[0].blocks_mut().0;
        for (position, place) in self.places.iter().enumerate() {
            [0, 4, 8].into_iter().for_each(|at| blocks[*place][at] += entry(9 * position + at));
        }
    }
}

/// A Cholesky factorisation of stage matrices of one stage with their couplings.
#[derive(Debug)]
pub(crate) struct CoupledCholesky {
    /// The factorisation.
    pub cholesky: BlockCholesky,
    /// Once a matrix had couplings, its pattern.
    widened: Option<Widened>,
    /// Number of right-hand sides for which memory is reserved.
    n_columns: usize,
}

impl CoupledCholesky {
    /// Symbolic factorisation without couplings; `order[new] = old`.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`], [`crate::Error::Linear`].
    pub(crate) fn new(pattern: &Pattern, fixed: &[bool], order: &[usize]) -> Result<Self> {
        let cholesky = BlockCholesky::new(pattern, 3, fixed, order)?;
        Ok(CoupledCholesky { cholesky, widened: None, n_columns: 0 })
    }

    /// Reserves memory as [`BlockCholesky::reserve`].
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub(crate) fn reserve(&mut self, n_columns: usize) -> Result<()> {
        self.n_columns = n_columns;
        self.cholesky.reserve(n_columns)
    }

    /// Factorises a matrix with something added to the diagonals of its blocks: `diagonal` by nine times the position
    /// plus 0, 4 or 8.
    ///
    /// # Errors
    /// As [`BlockCholesky::factorize`], and as [`CoupledCholesky::new`] where couplings are new.
    pub(crate) fn factorize(
        &mut self,
        (pattern, fixed): (&Pattern, &[bool]),
        matrix: &StageMatrix,
        diagonal: impl Fn(usize) -> f64,
    ) -> Result<()> {
        let has_room = match &self.widened {
            Some(widened) => widened.covers(&matrix.couplings),
            None => matrix.couplings.is_empty(),
        };
        if !has_room {
            let widened = Widened::new(pattern, &matrix.couplings);
            let order = nested_dissection(&widened.pattern)?;
            self.cholesky = BlockCholesky::new(&widened.pattern, 3, fixed, &order)?;
            if self.n_columns > 0 {
                self.cholesky.reserve(self.n_columns)?;
            }
            self.widened = Some(widened);
        }
        let Some(widened) = &mut self.widened else {
            return self.cholesky.factorize(|at| {
                let own = matrix.block(at / 9)[at % 9];
                // Entries 0, 4, 8 are the diagonal of a 3 x 3 block.
                if (at % 9).is_multiple_of(4) { own + diagonal(at) } else { own }
            });
        };
        widened.set(pattern, matrix);
        widened.add_diagonals(diagonal);
        self.cholesky.factorize(|at| widened.matrix.block(at / 9)[at % 9])
    }
}

impl StageMatrix {
    /// The matrix without fixed rows and columns, by rows: their starts, ascending columns, entries. Unknowns are
    /// numbered stage by stage.
    pub fn free_rows(&self, pattern: &Pattern, fixed: &[bool]) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        if !self.couplings.is_empty() {
            let widened = self.widened(pattern);
            return widened.matrix.free_rows(&widened.pattern, fixed);
        }
        let mut number = vec![0; fixed.len()];
        let mut n_free = 0;
        for (number, _) in number.iter_mut().zip(fixed).filter(|(_, fixed)| !**fixed) {
            *number = n_free;
            n_free += 1;
        }
        let k = self.degree();
        let mut begin = vec![0];
        let mut columns = Vec::new();
        let mut values = Vec::new();
        for (i, dof) in (0..k).flat_map(|i| (0..fixed.len()).map(move |dof| (i, dof))) {
            if fixed[dof] {
                continue;
            }
            for j in 0..k {
                for (position, &node) in pattern.range(dof / 3).zip(pattern.row(dof / 3)) {
                    let row = &self.block(position)[9 * (i * k + j) + 3 * (dof % 3)..][..3];
                    let dofs = (3 * node as usize..).zip(row);
                    for (column, value) in dofs.filter(|(column, _)| !fixed[*column]) {
                        columns.push(j * n_free + number[column]);
                        values.push(*value);
                    }
                }
            }
            begin.push(columns.len());
        }
        (begin, columns, values)
    }

    /// The matrix by rows of nodes, stage by stage: row `i n + A` and column `j n + B` for stages i, j and nodes A, B
    /// of n.
    pub fn block_rows(&self, pattern: &Pattern) -> Vec<BlockRow> {
        if !self.couplings.is_empty() {
            let widened = self.widened(pattern);
            return widened.matrix.block_rows(&widened.pattern);
        }
        let k = self.degree();
        let row = |(i, node): (usize, usize)| {
            let stages =
                (0..k).flat_map(|j| pattern.range(node).zip(pattern.row(node)).map(move |at| (j, at)));
            let entry = |(j, (position, &column)): (usize, (usize, &u32))| {
                let blocks = self.block(position).as_chunks::<9>().0;
                ((j * pattern.n_rows()) as u32 + column, blocks[i * k + j])
            };
            stages.map(entry).collect()
        };
        (0..k).flat_map(|i| (0..pattern.n_rows()).map(move |node| (i, node))).map(row).collect()
    }

    fn widened(&self, pattern: &Pattern) -> Widened {
        let mut widened = Widened::new(pattern, &self.couplings);
        widened.set(pattern, self);
        widened
    }
}
