//! A level of a hierarchy of matrices.

use rayon::prelude::*;

use super::super::Pattern;
use super::super::blocks::Blocks;
use super::super::kernel::Entry;
use super::super::shifted::CHUNK;
use super::super::sweep::SweepOrder;
use super::galerkin::Galerkin;
use super::prolongation::{Block, COARSE, Nodes, Prolongation, inverse_of_free};
use super::smoother::{Smoother, Transfer, Vector};

/// A level with nodes of M components: rows of three in the order of a sweep, its smoother, and the way to the next
/// level.
#[derive(Debug)]
pub(super) struct Level<const M: usize> {
    pub smoother: Smoother,
    prolongation: Prolongation<M>,
    /// The matrix of the next level.
    pub galerkin: Galerkin<M>,
    /// R = P^T and P, in the orders of the sweeps.
    pub down: Transfer,
    pub up: Transfer,
}

/// Vectors of a level: right-hand side, solution, residual.
#[derive(Debug, Clone)]
pub(super) struct Vectors<const C: usize> {
    pub r: Vector<C>,
    pub x: Vector<C>,
    pub t: Vector<C>,
}

impl<const C: usize> Vectors<C> {
    pub(super) fn new(n_rows: usize) -> Self {
        let zero = vec![[[0.0; C]; 4]; n_rows];
        Vectors { r: zero.clone(), x: zero.clone(), t: zero }
    }
}

/// The matrix of a level below the first: the one of [`Galerkin`] by rows of three, in the order of a sweep.
#[derive(Debug)]
pub(super) struct CoarseMatrix {
    pub sweep: SweepOrder,
    pub blocks: Blocks<f64>,
    /// Position of the 6 x 6 block of each 3 x 3 block, times four, plus its place in it.
    sources: Vec<u32>,
}

impl CoarseMatrix {
    /// Memory for a matrix on a pattern of nodes.
    pub(super) fn new(nodes: &Pattern) -> Self {
        let mut begin = vec![0];
        let mut columns = Vec::with_capacity(4 * nodes.n_blocks());
        let mut places = Vec::with_capacity(4 * nodes.n_blocks());
        for row in 0..2 * nodes.n_rows() {
            for (position, &column) in nodes.range(row / 2).zip(nodes.row(row / 2)) {
                columns.extend([2 * column, 2 * column + 1]);
                places.extend([0, 1].map(|half| (4 * position + 2 * (row % 2) + half) as u32));
            }
            begin.push(columns.len());
        }
        let sweep = SweepOrder::new(&Pattern::from_rows(begin, columns));
        let sources = sweep.source.iter().map(|&source| places[source as usize]).collect();
        CoarseMatrix { blocks: Blocks::new(sweep.columns.len()), sweep, sources }
    }

    /// Sets the blocks.
    pub(super) fn set(&mut self, blocks: &[[[f64; COARSE]; COARSE]]) {
        let own = self.blocks.entries_mut().as_chunks_mut::<9>().0;
        own.par_iter_mut().with_min_len(CHUNK).zip(&self.sources).for_each(|(own, &source)| {
            let source = source as usize;
            let block = &blocks[source / 4];
            let [row, column] = [3 * (source / 2 % 2), 3 * (source % 2)];
            *own = std::array::from_fn(|at| block[row + at % 3][column + at / 3]);
        });
    }
}

/// A matrix of [`Galerkin`] by nodes, with its rigid modes.
pub(super) struct Coarse<'a> {
    pattern: &'a Pattern,
    pub blocks: &'a [Block<f64, COARSE>],
    modes: &'a [([f64; 3], Block<f64, COARSE>)],
}

impl Nodes<COARSE> for Coarse<'_> {
    fn pattern(&self) -> &Pattern {
        self.pattern
    }

    fn block(&self, position: usize) -> Block<f64, COARSE> {
        self.blocks[position]
    }

    fn is_held(&self, _: usize, _: usize) -> bool {
        false
    }

    fn position(&self, node: usize) -> [f64; 3] {
        self.modes[node].0
    }

    fn modes(&self, node: usize) -> Block<f64, COARSE> {
        self.modes[node].1
    }
}

impl<const M: usize> Level<M> {
    /// Memory for a level; [`Level::connect`] completes it.
    pub(super) fn new(pattern: &Pattern) -> Self {
        let prolongation = Prolongation::new(pattern);
        let galerkin = Galerkin::new(pattern, &prolongation);
        let nothing = || Transfer::new(0, Vec::new());
        Level {
            smoother: Smoother { inverses: vec![[[0.0; 4]; 3]; pattern.n_rows() * M / 3] },
            prolongation,
            galerkin,
            down: nothing(),
            up: nothing(),
        }
    }

    /// Connects the rows of this level with those of the next one; `order[new] = old` of both.
    pub(super) fn connect(&mut self, order: &[u32], coarse_order: &[u32]) {
        let number = inverse(order);
        let coarse_number = inverse(coarse_order);
        let mut entries = Vec::with_capacity(2 * M / 3 * self.prolongation.columns.len());
        for node in 0..self.prolongation.begin.len() - 1 {
            for block in self.prolongation.begin[node]..self.prolongation.begin[node + 1] {
                let column = self.prolongation.columns[block] as usize;
                for (h, g) in (0..M / 3).flat_map(|h| [(h, 0), (h, 1)]) {
                    let source = (block * M / 3 + h) * 2 + g;
                    entries.push((number[node * M / 3 + h], coarse_number[2 * column + g], source as u32));
                }
            }
        }
        self.up = Transfer::new(order.len(), entries.clone());
        entries.iter_mut().for_each(|(row, column, _)| std::mem::swap(row, column));
        self.down = Transfer::new(coarse_order.len(), entries);
    }

    /// Number of nodes of the next level.
    pub(super) fn n_coarse(&self) -> usize {
        self.prolongation.aggregates.len()
    }

    /// The next matrix.
    pub(super) fn coarse(&self) -> Coarse<'_> {
        Coarse {
            pattern: &self.galerkin.pattern,
            blocks: &self.galerkin.blocks,
            modes: &self.prolongation.coarse_modes,
        }
    }

    /// Sets the transfers and the next matrix from the one of this level.
    pub(super) fn set(&mut self, fine: &impl Nodes<M>) {
        self.prolongation.set(fine);
        self.galerkin.set(fine, &self.prolongation);
        let blocks = &self.prolongation.blocks;
        let part = |source: usize, is_transposed: bool| -> [f32; 9] {
            let block = &blocks[source / 2 / (M / 3)];
            let [row, column] = [3 * (source / 2 % (M / 3)), 3 * (source % 2)];
            std::array::from_fn(|at| match is_transposed {
                false => block[row + at % 3][column + at / 3],
                true => block[row + at / 3][column + at % 3],
            })
        };
        self.up.set(|source| part(source, false));
        self.down.set(|source| part(source, true));
    }

    /// Sets the smoother from the blocks of the matrix in the order of the sweep; `rounding`: added to diagonal blocks.
    pub(super) fn set_smoother<E: Entry<Number = f64>>(
        &mut self,
        sweep: &SweepOrder,
        blocks: &Blocks<E>,
        rounding: impl Fn(usize) -> [[f64; 4]; 3] + Sync,
        is_held: impl Fn(usize, usize) -> bool + Sync,
    ) {
        let rows = self.smoother.inverses.par_iter_mut().with_min_len(CHUNK).enumerate();
        rows.for_each(|(row, own)| {
            let (stored, added) = (blocks.block(sweep.diagonal(row)), rounding(row));
            let block = [0, 1, 2].map(|a| [0, 1, 2].map(|b| stored[3 * b + a].number() + added[b][a]));
            let inverse = inverse_of_free(block, |a| is_held(sweep.order[row] as usize, a));
            *own = [0, 1, 2].map(|b| [inverse[0][b], inverse[1][b], inverse[2][b], 0.0]);
        });
    }
}

fn inverse(order: &[u32]) -> Vec<u32> {
    let mut number = vec![0; order.len()];
    order.iter().enumerate().for_each(|(new, &old)| number[old as usize] = new as u32);
    number
}
