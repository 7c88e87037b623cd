//! A pattern with further couplings.

use super::stages::BlockRow;
use super::{Couplings, Pattern, StageMatrix};

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

    /// The block at a position of the narrow pattern.
    pub fn block_mut(&mut self, position: usize) -> &mut [f64] {
        let size = 9 * self.matrix.degree() * self.matrix.degree();
        let place = self.places[position] * size;
        &mut self.matrix.parts_mut()[0].blocks_mut().0.as_flattened_mut()[place..place + size]
    }

    /// Values of the positions of the narrow pattern, with zeros elsewhere.
    pub fn spread(&self, values: &[f64]) -> Vec<f64> {
        let mut spread = vec![0.0; self.pattern.n_blocks()];
        self.places.iter().zip(values).for_each(|(place, value)| spread[*place] = *value);
        spread
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
