//! The matrix of a step: k x k blocks of one pattern, divided into parts that own contiguous rows.

use std::ops::Range;

use rayon::prelude::*;

use super::{Couplings, Pattern};

/// Rows of the stage system owned by one thread, which alone writes them.
#[derive(Debug, Clone)]
pub struct RowPart {
    rows: Range<usize>,
    first_block: usize,
    degree: usize,
    /// Stage forces, `[k][n_rows][3]`.
    force: Vec<f64>,
    /// Blocks of the stage matrix, `[block][i k + j][3 a + b]`.
    blocks: Vec<f64>,
    product: Vec<f64>,
}

impl RowPart {
    fn new(pattern: &Pattern, rows: Range<usize>, degree: usize) -> Self {
        let n_blocks = rows.clone().map(|row| pattern.range(row).len()).sum::<usize>();
        let first_block = if rows.is_empty() { 0 } else { pattern.range(rows.start).start };
        let force = vec![0.0; 3 * degree * rows.len()];
        let blocks = vec![0.0; 9 * degree * degree * n_blocks];
        RowPart { product: force.clone(), rows, first_block, degree, force, blocks }
    }

    /// Rows (nodes) of the part.
    pub fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }

    /// Number of stages k.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Whether a node belongs to the part's rows.
    pub fn owns(&self, node: u32) -> bool {
        self.rows.contains(&(node as usize))
    }

    /// Adds to the force of a stage at a node of the part.
    #[inline(always)]
    pub fn add_force(&mut self, stage: usize, node: u32, force: [f64; 3]) {
        let at = 3 * (stage * self.rows.len() + node as usize - self.rows.start);
        self.force[at..at + 3].iter_mut().zip(force).for_each(|(sum, f)| *sum += f);
    }

    /// The 3 x 3 block of stages i, j (as `i k + j`) at a position of the pattern within the part's rows.
    #[inline(always)]
    pub fn block_mut(&mut self, position: usize, stages: usize) -> &mut [f64; 9] {
        let at = (position - self.first_block) * self.degree * self.degree + stages;
        &mut self.blocks.as_chunks_mut().0[at]
    }

    /// Blocks of all stages, `[block][i k + j]`, and the number of the first block; the blocks of a position of the
    /// pattern start at `(position - first) k k`.
    #[inline(always)]
    pub fn blocks_mut(&mut self) -> (&mut [[f64; 9]], usize) {
        (self.blocks.as_chunks_mut().0, self.first_block)
    }

    /// Sets the forces to zero.
    pub fn clear_force(&mut self) {
        self.force.fill(0.0);
    }

    /// Sets every block to `coefficients[i k + j] mass[position]` times the unit matrix.
    pub fn set_blocks(&mut self, mass: &[f64], coefficients: &[f64]) {
        if coefficients.iter().all(|coefficient| *coefficient == 0.0) {
            return self.blocks.fill(0.0);
        }
        let stages = coefficients.len();
        for (block, values) in self.blocks.chunks_exact_mut(9 * stages).enumerate() {
            let mass = mass[self.first_block + block];
            for (values, coefficient) in values.chunks_exact_mut(9).zip(coefficients) {
                values.fill(0.0);
                (0..3).for_each(|a| values[4 * a] = coefficient * mass);
            }
        }
    }

    /// Rows of the product with a full vector, into the part's own memory.
    fn multiply(&mut self, pattern: &Pattern, x: &[f64]) {
        let k = self.degree;
        let n_own = self.rows.len();
        let stride = 3 * pattern.n_rows();
        for row in self.rows.clone() {
            let own = row - self.rows.start;
            for i in 0..k {
                let mut sum = [0.0; 3];
                for (position, &column) in pattern.range(row).zip(pattern.row(row)) {
                    let at = 9 * ((position - self.first_block) * k + i) * k;
                    for j in 0..k {
                        let block = &self.blocks[at + 9 * j..at + 9 * j + 9];
                        let x = &x[j * stride + 3 * column as usize..][..3];
                        for a in 0..3 {
                            sum[a] += block[3 * a] * x[0] + block[3 * a + 1] * x[1] + block[3 * a + 2] * x[2];
                        }
                    }
                }
                self.product[3 * (i * n_own + own)..][..3].copy_from_slice(&sum);
            }
        }
    }
}

/// A row of nodes of a sparse matrix: columns in ascending order, with 3x3 blocks row by row.
pub type BlockRow = Vec<(u32, [f64; 9])>;

/// Stage forces and stage matrix of a step, in parts by rows.
#[derive(Debug, Clone)]
pub struct StageMatrix {
    parts: Vec<RowPart>,
    degree: usize,
    n_rows: usize,
    /// Blocks beyond the pattern.
    pub couplings: Couplings,
    /// The blocks of rows that no part owns.
    zero: Vec<f64>,
    /// Memory for blocks that move.
    folded: Vec<f64>,
}

impl StageMatrix {
    /// Memory for k stages on a pattern, divided into parts. The rows after the last part are zero: those of nodes that
    /// another rank owns.
    pub fn new(pattern: &Pattern, parts: &[Range<usize>], degree: usize) -> Self {
        let parts = parts.iter().map(|rows| RowPart::new(pattern, rows.clone(), degree)).collect();
        let zero = vec![0.0; 9 * degree * degree];
        StageMatrix {
            parts,
            degree,
            n_rows: pattern.n_rows(),
            couplings: Couplings::new(degree),
            folded: Vec::with_capacity(zero.len()),
            zero,
        }
    }

    /// Parts by rows.
    pub fn parts_mut(&mut self) -> &mut [RowPart] {
        &mut self.parts
    }

    /// Copies the stage forces to `force: [k][n_rows][3]`.
    pub fn copy_force(&self, force: &mut [f64]) {
        self.scatter(force, |part| &part.force);
    }

    /// Moves the forces of a row to others, times weights.
    pub fn fold_force(&mut self, row: usize, others: &[(u32, f64)]) {
        for stage in 0..self.degree {
            let own = std::mem::take(self.force_mut(stage, row));
            for &(other, weight) in others {
                let sum = self.force_mut(stage, other as usize);
                (0..3).for_each(|d| sum[d] += weight * own[d]);
            }
        }
    }

    fn force_mut(&mut self, stage: usize, row: usize) -> &mut [f64; 3] {
        let part = self.parts.partition_point(|part| part.rows.end <= row);
        let part = &mut self.parts[part];
        let at = stage * part.rows.len() + row - part.rows.start;
        &mut part.force.as_chunks_mut().0[at]
    }

    /// Moves the blocks of a row to other rows that have its columns, times weights.
    pub fn fold_row(&mut self, pattern: &Pattern, row: usize, others: &[(u32, f64)]) {
        for (from, &column) in pattern.range(row).zip(pattern.row(row)) {
            let to = |other: u32| pattern.coupling(other as usize, column as usize);
            self.fold_block(from, others.iter().map(|&(other, weight)| (to(other), weight)));
        }
    }

    /// Moves the blocks of a column to other columns that have its rows, times weights; the pattern is symmetric.
    pub fn fold_column(&mut self, pattern: &Pattern, column: usize, others: &[(u32, f64)]) {
        for row in pattern.row(column).iter().map(|&row| row as usize) {
            let to = |other: u32| pattern.coupling(row, other as usize);
            let from = pattern.coupling(row, column);
            self.fold_block(from, others.iter().map(|&(other, weight)| (to(other), weight)));
        }
    }

    /// Moves the blocks of all stages from one position to others, times weights.
    fn fold_block(&mut self, from: usize, to: impl Iterator<Item = (usize, f64)>) {
        let mut own = std::mem::take(&mut self.folded);
        own.clear();
        own.extend_from_slice(self.block(from));
        self.block_mut(from).fill(0.0);
        for (position, weight) in to {
            let sums = self.block_mut(position).iter_mut().zip(&own);
            sums.for_each(|(sum, entry)| *sum += weight * entry);
        }
        self.folded = own;
    }

    /// The blocks of all stages at a position of the pattern, `[i k + j][3 a + b]`.
    #[inline]
    pub fn block(&self, position: usize) -> &[f64] {
        let size = 9 * self.degree * self.degree;
        let part = match &self.parts[..] {
            [part] => part,
            parts => &parts[parts.partition_point(|part| part.first_block <= position) - 1],
        };
        let at = (position - part.first_block) * size;
        part.blocks.get(at..at + size).unwrap_or(&self.zero)
    }

    /// Replaces the matrix by its transpose; the pattern is symmetric.
    pub fn transpose(&mut self, pattern: &Pattern) {
        self.couplings.transpose();
        for row in 0..self.n_rows {
            for (position, &column) in pattern.range(row).zip(pattern.row(row)) {
                let Some(mirrored) = pattern.position(column as usize, row) else { continue };
                if column as usize >= row {
                    let (block, other) = (self.transposed(position), self.transposed(mirrored));
                    self.block_mut(position).copy_from_slice(&other);
                    self.block_mut(mirrored).copy_from_slice(&block);
                }
            }
        }
    }

    /// Replaces the matrix by its symmetric part; the pattern is symmetric.
    pub fn symmetrize(&mut self, pattern: &Pattern) {
        let matrix = self.clone();
        self.transpose(pattern);
        self.couplings = matrix.couplings.clone();
        self.couplings.symmetrize();
        for (part, other) in self.parts.iter_mut().zip(&matrix.parts) {
            part.blocks.iter_mut().zip(&other.blocks).for_each(|(own, other)| *own = 0.5 * (*own + other));
        }
    }

    /// Number of stages k.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The blocks of all stages at a position, transposed in stages and components.
    fn transposed(&self, position: usize) -> Vec<f64> {
        let k = self.degree;
        let block = self.block(position);
        let entry = |at: usize| {
            let stages = at / 9;
            let entry = at % 9;
            block[9 * (stages % k * k + stages / k) + 3 * (entry % 3) + entry / 3]
        };
        (0..block.len()).map(entry).collect()
    }

    fn block_mut(&mut self, position: usize) -> &mut [f64] {
        let size = 9 * self.degree * self.degree;
        let part = self.parts.partition_point(|part| part.first_block <= position) - 1;
        let part = &mut self.parts[part];
        let at = (position - part.first_block) * size;
        &mut part.blocks[at..at + size]
    }

    /// Product `y = A x`; `x`, `y`: `[k][n_rows][3]`.
    pub fn multiply(&mut self, pattern: &Pattern, x: &[f64], y: &mut [f64]) {
        if self.parts.len() == 1 {
            self.parts[0].multiply(pattern, x);
        } else {
            self.parts.par_iter_mut().for_each(|part| part.multiply(pattern, x));
        }
        self.scatter(y, |part| &part.product);
        self.couplings.add_product(x, y);
    }

    fn scatter(&self, target: &mut [f64], source: impl Fn(&RowPart) -> &Vec<f64>) {
        for part in &self.parts {
            let n_own = 3 * part.rows.len();
            for stage in 0..self.degree {
                let to = 3 * (stage * self.n_rows + part.rows.start);
                target[to..to + n_own].copy_from_slice(&source(part)[stage * n_own..(stage + 1) * n_own]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(n_parts: usize) -> (Pattern, StageMatrix) {
        let lists: Vec<[u32; 3]> = (0..8).map(|i| [i, i + 1, i + 2]).collect();
        let pattern = Pattern::new(10, lists.iter().map(|list| &list[..]));
        let mut matrix = StageMatrix::new(&pattern, &pattern.divided(n_parts), 2);
        for part in matrix.parts_mut() {
            for position in part.rows().flat_map(|row| pattern.range(row)) {
                for stages in 0..4 {
                    for (entry, value) in part.block_mut(position, stages).iter_mut().enumerate() {
                        *value = ((position * 36 + stages * 9 + entry) as f64).sin();
                    }
                }
            }
        }
        (pattern, matrix)
    }

    #[test]
    fn products_with_the_transposed_matrix_are_adjoint() {
        for n_parts in [1, 3] {
            let (pattern, mut matrix) = matrix(n_parts);
            let x: Vec<f64> = (0..60).map(|i| (i as f64).cos()).collect();
            let y: Vec<f64> = (0..60).map(|i| (1.7 * i as f64).sin()).collect();
            let [mut Ax, mut Ay] = [vec![0.0; 60], vec![0.0; 60]];
            matrix.multiply(&pattern, &x, &mut Ax);
            matrix.transpose(&pattern);
            matrix.multiply(&pattern, &y, &mut Ay);
            let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
            assert!((dot(&Ax, &y) - dot(&x, &Ay)).abs() < 1e-12);
        }
    }

    #[test]
    fn product_does_not_depend_on_the_parts() {
        let x: Vec<f64> = (0..60).map(|i| (i as f64).cos()).collect();
        let product = |n_parts| {
            let (pattern, mut matrix) = matrix(n_parts);
            let mut y = vec![0.0; 60];
            matrix.multiply(&pattern, &x, &mut y);
            y
        };
        let y = product(1);
        assert!((2..12).all(|n_parts| product(n_parts) == y));
        // One row by hand: stage 1, node 0, component 2.
        let expected: f64 = (0..3)
            .flat_map(|column| (0..2).flat_map(move |j| (0..3).map(move |b| (column, j, b))))
            .map(|(column, j, b)| {
                let value = ((column * 36 + (2 + j) * 9 + 6 + b) as f64).sin();
                value * x[j * 30 + 3 * column + b]
            })
            .sum();
        assert!((y[30 + 2] - expected).abs() < 1e-14);
    }
}
