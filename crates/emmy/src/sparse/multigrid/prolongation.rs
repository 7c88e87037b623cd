//! The prolongation from aggregates to their nodes.

use std::ops::Range;

use rayon::prelude::*;

use super::super::Pattern;
use super::super::reduce::dot;
use super::aggregates::Aggregates;

/// Components of a coarse node: one for each rigid mode.
pub(super) const COARSE: usize = 6;

/// A block of a prolongation: M components of a node by those of an aggregate.
pub(super) type Block<T, const M: usize> = [[T; COARSE]; M];

/// A matrix by nodes of M components, with its rigid modes.
pub(super) trait Nodes<const M: usize>: Sync {
    /// Couplings of the nodes.
    fn pattern(&self) -> &Pattern;

    /// The block at a position of the pattern.
    fn block(&self, position: usize) -> [[f64; M]; M];

    /// Whether a component of a node is fixed.
    fn is_held(&self, node: usize, component: usize) -> bool;

    /// Position of a node.
    fn position(&self, node: usize) -> [f64; 3];

    /// Translations and rotations about the origin, at a node.
    fn modes(&self, node: usize) -> Block<f64, M>;
}

/// Smoothed prolongation (Vanek, Mandel and Brezina 1996): the rigid modes of the aggregates, after a block Jacobi
/// step.
///
/// ```math
/// P = (1 - omega D^-1 A) T,    omega = 4/3 / rho(D^-1 A)
/// ```
#[derive(Debug)]
pub(super) struct Prolongation<const M: usize> {
    pub aggregates: Aggregates,
    /// Start of the blocks of each node, `[n_nodes + 1]`.
    pub begin: Vec<usize>,
    /// Aggregate of each block, ascending for each node.
    pub columns: Vec<u32>,
    /// The blocks of P.
    pub blocks: Vec<Block<f32, M>>,
    /// T of each node, in the column of its aggregate; in the order of [`Aggregates::nodes`].
    tentative: Vec<Block<f32, M>>,
    /// D^-1.
    inverse_diagonals: Vec<[[f64; M]; M]>,
    /// Position and rigid modes of each aggregate.
    pub coarse_modes: Vec<([f64; 3], Block<f64, COARSE>)>,
    /// Columns of T that vanish, because an aggregate has fewer than six rigid modes.
    pub is_void: Vec<[bool; COARSE]>,
    work: [Vec<[f64; M]>; 2],
}

impl<const M: usize> Prolongation<M> {
    /// Memory for the prolongation of a pattern.
    pub(super) fn new(pattern: &Pattern) -> Self {
        let aggregates = Aggregates::new(pattern);
        let n = pattern.n_rows();
        let mut begin = vec![0];
        let mut columns = Vec::new();
        for node in 0..n {
            let start = columns.len();
            columns.extend(pattern.row(node).iter().map(|&other| aggregates.of_node[other as usize]));
            columns[start..].sort_unstable();
            let mut kept = start;
            for at in start..columns.len() {
                if at == start || columns[at] != columns[kept - 1] {
                    columns[kept] = columns[at];
                    kept += 1;
                }
            }
            columns.truncate(kept);
            begin.push(kept);
        }
        columns.shrink_to_fit();
        let n_coarse = aggregates.len();
        Prolongation {
            blocks: vec![[[0.0; COARSE]; M]; columns.len()],
            tentative: vec![[[0.0; COARSE]; M]; n],
            inverse_diagonals: vec![[[0.0; M]; M]; n],
            coarse_modes: vec![([0.0; 3], [[0.0; COARSE]; COARSE]); n_coarse],
            is_void: vec![[false; COARSE]; n_coarse],
            work: [vec![[0.0; M]; n], vec![[0.0; M]; n]],
            aggregates,
            begin,
            columns,
        }
    }

    /// Aggregates of the blocks of a node.
    pub(super) fn row(&self, node: usize) -> &[u32] {
        &self.columns[self.begin[node]..self.begin[node + 1]]
    }

    /// Sets P from a matrix and its rigid modes.
    pub(super) fn set(&mut self, fine: &impl Nodes<M>) {
        self.set_tentative(fine);
        let diagonals = self.inverse_diagonals.par_iter_mut().with_min_len(NODES).enumerate();
        diagonals.for_each(|(node, inverse)| {
            let diagonal = fine.pattern().position(node, node).map_or([[0.0; M]; M], |at| fine.block(at));
            *inverse = inverse_of_free(diagonal, |a| fine.is_held(node, a));
        });
        let omega = 4.0 / 3.0 / self.largest_eigenvalue(fine);
        self.smooth(fine, omega);
    }

    /// Orthonormal rigid modes of each aggregate, and their coefficients in those of the level.
    fn set_tentative(&mut self, fine: &impl Nodes<M>) {
        let Prolongation { aggregates, tentative, coarse_modes, is_void, .. } = self;
        let center = |aggregate: usize| {
            let nodes = aggregates.nodes(aggregate);
            let share = 1.0 / nodes.len() as f64;
            [0, 1, 2].map(|a| nodes.iter().map(|&node| fine.position(node as usize)[a]).sum::<f64>() * share)
        };
        let set = |own: &mut Vec<Block<f64, M>>, aggregate: usize, tentative: &mut [Block<f32, M>]| {
            let center = center(aggregate);
            own.clear();
            own.extend(aggregates.nodes(aggregate).iter().map(|&node| {
                let mut block = about(&fine.modes(node as usize), &center);
                for a in (0..M).filter(|&a| fine.is_held(node as usize, a)) {
                    block[a] = [0.0; COARSE];
                }
                block
            }));
            orthonormalize(own);
            for (tentative, block) in tentative.iter_mut().zip(&*own) {
                *tentative = block.map(|row| row.map(|entry| entry as f32));
            }
        };
        each_part(&aggregates.begin, 0..aggregates.len(), tentative, &set);
        let coarse = coarse_modes.par_iter_mut().zip(is_void).with_min_len(NODES).enumerate();
        coarse.for_each(|(aggregate, ((position, coarse), is_void))| {
            *position = center(aggregate);
            *coarse = [[0.0; COARSE]; COARSE];
            let own = &tentative[aggregates.begin[aggregate]..aggregates.begin[aggregate + 1]];
            for (block, &node) in own.iter().zip(aggregates.nodes(aggregate)) {
                for (own, row) in block.iter().zip(&fine.modes(node as usize)) {
                    for (coarse, &factor) in coarse.iter_mut().zip(own) {
                        coarse.iter_mut().zip(row).for_each(|(sum, value)| *sum += f64::from(factor) * value);
                    }
                }
            }
            *is_void = std::array::from_fn(|c| own.iter().flatten().all(|row| row[c] == 0.0));
        });
    }

    /// Largest eigenvalue of D^-1 A, a tenth above its Rayleigh quotient after some power iterations.
    fn largest_eigenvalue(&mut self, fine: &impl Nodes<M>) -> f64 {
        let pattern = fine.pattern();
        let inverses = &self.inverse_diagonals;
        let [x, y] = &mut self.work;
        // Equidistributed numbers: every eigenvector has a part in them.
        let number = |at: usize| (at as f64 * 0.618_033_988_749_895).fract() - 0.5;
        for (node, (x, inverse)) in x.iter_mut().zip(inverses).enumerate() {
            *x = std::array::from_fn(|a| if inverse[a][a] == 0.0 { 0.0 } else { number(M * node + a + 1) });
        }
        let mut largest: f64 = 1.0;
        // x . D x
        let mut square = None;
        for _ in 0..POWER_ITERATIONS {
            y.par_iter_mut().with_min_len(NODES).enumerate().for_each(|(node, y)| {
                *y = [0.0; M];
                for (position, &other) in pattern.range(node).zip(pattern.row(node)) {
                    let A = fine.block(position);
                    let x = &x[other as usize];
                    for (sum, A) in y.iter_mut().zip(&A) {
                        *sum += A.iter().zip(x).map(|(A, x)| A * x).sum::<f64>();
                    }
                }
            });
            if let Some(square) = square {
                largest = dot(x.as_flattened(), y.as_flattened()) / square;
            }
            let norm = dot(y.as_flattened(), y.as_flattened()).sqrt();
            x.par_iter_mut().with_min_len(NODES).zip(&*y).zip(inverses).for_each(|((x, y), inverse)| {
                *x = std::array::from_fn(|a| inverse[a].iter().zip(y).map(|(i, y)| i * y / norm).sum());
            });
            square = Some(dot(x.as_flattened(), y.as_flattened()) / norm);
        }
        if largest.is_finite() { 1.1 * largest.max(1.0) } else { 2.0 }
    }

    fn smooth(&mut self, fine: &impl Nodes<M>, omega: f64) {
        let pattern = fine.pattern();
        let Prolongation { aggregates, begin, columns, blocks, tentative, inverse_diagonals, .. } = self;
        let smooth_node = |sums: &mut Vec<Block<f64, M>>, node: usize, blocks: &mut [Block<f32, M>]| {
            let columns = &columns[begin[node]..begin[node + 1]];
            sums.clear();
            sums.resize(columns.len(), [[0.0; COARSE]; M]);
            for (position, &other) in pattern.range(node).zip(pattern.row(node)) {
                let aggregate = aggregates.of_node[other as usize];
                let column = columns.partition_point(|&column| column < aggregate);
                let T = &tentative[aggregates.place[other as usize] as usize];
                add_product(&mut sums[column], &fine.block(position), T);
            }
            let inverse = inverse_diagonals[node].map(|row| row.map(|entry| -omega * entry));
            for ((block, sum), &column) in blocks.iter_mut().zip(&*sums).zip(columns) {
                let is_own = column == aggregates.of_node[node];
                let T = &tentative[aggregates.place[node] as usize];
                let mut value = if is_own { T.map(|row| row.map(f64::from)) } else { [[0.0; COARSE]; M] };
                add_product(&mut value, &inverse, sum);
                *block = value.map(|row| row.map(|entry| entry as f32));
            }
        };
        each_part(begin, 0..pattern.n_rows(), blocks, &smooth_node);
    }
}

/// Iterations for the largest eigenvalue, which a tenth more or less does not matter.
const POWER_ITERATIONS: usize = 6;

/// Smallest number of nodes of a task.
const NODES: usize = 512;

/// Works on the blocks of each part, `begin[part]..begin[part + 1]`, recursively in parallel halves.
fn each_part<T: Send, S: Default>(
    begin: &[usize],
    parts: Range<usize>,
    blocks: &mut [T],
    work: &(impl Fn(&mut S, usize, &mut [T]) + Sync),
) {
    let at = |part: usize| begin[part] - begin[parts.start];
    if parts.len() <= NODES {
        let mut scratch = S::default();
        for part in parts.clone() {
            work(&mut scratch, part, &mut blocks[at(part)..at(part + 1)]);
        }
        return;
    }
    let middle = parts.start + parts.len() / 2;
    let (low, high) = blocks.split_at_mut(at(middle));
    rayon::join(
        || each_part(begin, parts.start..middle, low, work),
        || each_part(begin, middle..parts.end, high, work),
    );
}

/// `sum += A B`.
#[inline(always)]
pub(super) fn add_product<T: Copy + Into<f64>, const M: usize>(
    sum: &mut Block<f64, M>,
    A: &[[f64; M]; M],
    B: &Block<T, M>,
) {
    for (sum, A) in sum.iter_mut().zip(A) {
        for (&factor, B) in A.iter().zip(B) {
            sum.iter_mut().zip(B).for_each(|(sum, &B)| *sum += factor * B.into());
        }
    }
}

/// Rigid modes with rotations about a point in place of the origin.
fn about<const M: usize>(modes: &Block<f64, M>, center: &[f64; 3]) -> Block<f64, M> {
    let [x, y, z] = *center;
    modes.map(|row| {
        let [a, b, c, ..] = row;
        [a, b, c, row[3] - (b * -z + c * y), row[4] - (a * z + c * -x), row[5] - (a * -y + b * x)]
    })
}

/// Orthonormalises the columns by Gram-Schmidt, twice; columns that depend on the previous ones vanish.
fn orthonormalize<const M: usize>(blocks: &mut [Block<f64, M>]) {
    let product = |blocks: &[Block<f64, M>], c: usize, d: usize| {
        blocks.iter().flatten().map(|row| row[c] * row[d]).sum::<f64>()
    };
    let largest = (0..COARSE).map(|c| product(blocks, c, c)).fold(0.0, f64::max).sqrt();
    for c in 0..COARSE {
        let before = product(blocks, c, c).sqrt();
        for d in (0..c).chain(0..c) {
            let part = product(blocks, c, d);
            blocks.iter_mut().flatten().for_each(|row| row[c] -= part * row[d]);
        }
        let after = product(blocks, c, c).sqrt();
        let is_independent = after > DEPENDENT * before && after > DEPENDENT * DEPENDENT * largest;
        let factor = if is_independent { 1.0 / after } else { 0.0 };
        blocks.iter_mut().flatten().for_each(|row| row[c] *= factor);
    }
}

/// Part of a column that is left of it where it depends on others.
const DEPENDENT: f64 = 1e-6;

/// The inverse of a block on its free components; zero for the others.
pub(super) fn inverse_of_free<const M: usize>(
    mut block: [[f64; M]; M],
    is_held: impl Fn(usize) -> bool,
) -> [[f64; M]; M] {
    let is_left_out: [bool; M] = std::array::from_fn(|a| is_held(a) || block[a][a] == 0.0);
    for (a, b) in (0..M * M).map(|at| (at / M, at % M)) {
        if is_left_out[a] || is_left_out[b] {
            block[a][b] = if a == b { 1.0 } else { 0.0 };
        }
    }
    let mut inverse = std::array::from_fn(|a| std::array::from_fn(|b| if a == b { 1.0 } else { 0.0 }));
    // The block of a positive definite matrix: elimination without pivots.
    for a in 0..M {
        let factor = 1.0 / block[a][a];
        (0..M).for_each(|c| (block[a][c], inverse[a][c]) = (block[a][c] * factor, inverse[a][c] * factor));
        for b in (0..M).filter(|&b| b != a) {
            let factor = block[b][a];
            for c in 0..M {
                block[b][c] -= factor * block[a][c];
                inverse[b][c] -= factor * inverse[a][c];
            }
        }
    }
    (0..M).filter(|&a| is_left_out[a]).for_each(|a| inverse[a][a] = 0.0);
    inverse
}
