//! The product `P^T A P`.

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::super::Pattern;
use super::prolongation::{Block, COARSE, Nodes, Prolongation, add_product};

/// A coarse matrix with the memory of its computation.
#[derive(Debug)]
pub(super) struct Galerkin<const M: usize> {
    /// Couplings of the aggregates.
    pub pattern: Pattern,
    /// Blocks at the positions of the pattern.
    pub blocks: Vec<Block<f64, COARSE>>,
    slabs: Vec<Slab<M>>,
}

/// Contribution of some nodes.
#[derive(Debug, Clone, Default)]
struct Slab<const M: usize> {
    /// Coarse rows with a contribution, in the order of their first one, and the start of their blocks.
    rows: Vec<(u32, usize)>,
    /// Index in `rows` of each coarse row.
    index: Vec<u32>,
    blocks: Vec<Block<f64, COARSE>>,
    /// A row of A P: its aggregates, index of each aggregate, and blocks.
    columns: Vec<u32>,
    column_index: Vec<u32>,
    products: Vec<Block<f64, M>>,
}

const NONE: u32 = u32::MAX;

/// Nodes of a slab; contributions are added slab by slab, so that sums do not depend on the number of threads.
const NODES: usize = 1024;

/// Slabs computed side by side.
const SLABS: usize = 8;

impl<const M: usize> Galerkin<M> {
    /// Memory for the product with a prolongation.
    pub(super) fn new(fine: &Pattern, prolongation: &Prolongation<M>) -> Self {
        let n_coarse = prolongation.aggregates.len();
        // Nodes of each aggregate and its neighbours, by the transpose of P.
        let mut begin = vec![0; n_coarse + 1];
        prolongation.columns.iter().for_each(|&column| begin[column as usize + 1] += 1);
        (0..n_coarse).for_each(|row| begin[row + 1] += begin[row]);
        let mut next = begin.clone();
        let mut support = vec![0u32; prolongation.columns.len()];
        for node in 0..fine.n_rows() {
            for &column in prolongation.row(node) {
                support[next[column as usize]] = node as u32;
                next[column as usize] += 1;
            }
        }
        let mut row_begin = vec![0];
        let mut columns = Vec::new();
        let mut seen_nodes = vec![NONE; fine.n_rows()];
        let mut seen = vec![NONE; n_coarse];
        for row in 0..n_coarse {
            let start = columns.len();
            let mark = row as u32;
            for &node in &support[begin[row]..begin[row + 1]] {
                for &other in fine.row(node as usize) {
                    if std::mem::replace(&mut seen_nodes[other as usize], mark) == mark {
                        continue;
                    }
                    for &column in prolongation.row(other as usize) {
                        if std::mem::replace(&mut seen[column as usize], mark) != mark {
                            columns.push(column);
                        }
                    }
                }
            }
            columns[start..].sort_unstable();
            row_begin.push(columns.len());
        }
        let pattern = Pattern::from_rows(row_begin, columns);
        let n_slabs = fine.n_rows().div_ceil(NODES).min(SLABS);
        let slab =
            Slab { index: vec![NONE; n_coarse], column_index: vec![NONE; n_coarse], ..Slab::default() };
        Galerkin {
            blocks: vec![[[0.0; COARSE]; COARSE]; pattern.n_blocks()],
            slabs: vec![slab; n_slabs],
            pattern,
        }
    }

    /// Sets the blocks from A and P; components that P leaves out have a unit diagonal.
    pub(super) fn set(&mut self, fine: &impl Nodes<M>, prolongation: &Prolongation<M>) {
        self.blocks.fill([[0.0; COARSE]; COARSE]);
        let Galerkin { pattern, blocks, slabs } = self;
        let nodes = &prolongation.aggregates.nodes;
        for batch in nodes.chunks(NODES * SLABS) {
            let parts = batch.par_chunks(NODES).zip(&mut *slabs);
            parts.for_each(|(nodes, slab)| {
                Arch::new().dispatch(Add { slab, fine, coarse: pattern, prolongation, nodes });
            });
            for slab in slabs.iter_mut() {
                for &(row, begin) in &slab.rows {
                    let range = pattern.range(row as usize);
                    let added = &slab.blocks[begin..begin + range.len()];
                    for (sum, added) in blocks[range].iter_mut().zip(added) {
                        let sum = sum.as_flattened_mut().iter_mut();
                        sum.zip(added.as_flattened()).for_each(|(sum, added)| *sum += added);
                    }
                    slab.index[row as usize] = NONE;
                }
                slab.rows.clear();
                slab.blocks.clear();
            }
        }
        for (row, is_void) in prolongation.is_void.iter().enumerate() {
            if let Some(position) = pattern.position(row, row) {
                (0..COARSE).filter(|&c| is_void[c]).for_each(|c| blocks[position][c][c] = 1.0);
            }
        }
    }
}

/// Adds the contribution of some nodes to a slab.
struct Add<'a, const M: usize, N> {
    slab: &'a mut Slab<M>,
    fine: &'a N,
    coarse: &'a Pattern,
    prolongation: &'a Prolongation<M>,
    nodes: &'a [u32],
}

impl<const M: usize, N: Nodes<M>> NullaryFnOnce for Add<'_, M, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Add { slab, fine, coarse, prolongation, nodes } = self;
        let pattern = fine.pattern();
        for &node in nodes {
            let node = node as usize;
            slab.columns.clear();
            slab.products.clear();
            for (position, &other) in pattern.range(node).zip(pattern.row(node)) {
                let A = fine.block(position);
                let other = other as usize;
                for block in prolongation.begin[other]..prolongation.begin[other + 1] {
                    let column = prolongation.columns[block];
                    let index = &mut slab.column_index[column as usize];
                    if *index == NONE {
                        *index = slab.columns.len() as u32;
                        slab.columns.push(column);
                        slab.products.push([[0.0; COARSE]; M]);
                    }
                    add_product(&mut slab.products[*index as usize], &A, &prolongation.blocks[block]);
                }
            }
            for block in prolongation.begin[node]..prolongation.begin[node + 1] {
                let row = prolongation.columns[block];
                let index = &mut slab.index[row as usize];
                if *index == NONE {
                    *index = slab.rows.len() as u32;
                    slab.rows.push((row, slab.blocks.len()));
                    let end = slab.blocks.len() + coarse.range(row as usize).len();
                    slab.blocks.resize(end, [[0.0; COARSE]; COARSE]);
                }
                let begin = slab.rows[*index as usize].1;
                let P = &prolongation.blocks[block];
                let columns = coarse.row(row as usize);
                for (column, product) in slab.columns.iter().zip(&slab.products) {
                    let at = columns.partition_point(|other| other < column);
                    add_transposed(&mut slab.blocks[begin + at], P, product);
                }
            }
            slab.columns.iter().for_each(|&column| slab.column_index[column as usize] = NONE);
        }
    }
}

/// `sum += A^T B`.
#[inline(always)]
fn add_transposed<const M: usize>(sum: &mut Block<f64, COARSE>, A: &Block<f32, M>, B: &Block<f64, M>) {
    for (A, B) in A.iter().zip(B) {
        for (sum, &factor) in sum.iter_mut().zip(A) {
            let factor = f64::from(factor);
            sum.iter_mut().zip(B).for_each(|(sum, B)| *sum += factor * B);
        }
    }
}
