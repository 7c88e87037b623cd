//! Sums over nodes, and other decisions that all ranks of a team make together.
//!
//! Every method here is a call of all ranks; own nodes come first, and guests do not count.

use super::Space;
use crate::element::CellKind;
use crate::error::Result;
use crate::sparse::reduce;
use crate::tensor::cross;

/// Sum of a nodal vector, `[n_nodes][3]`.
pub fn sum(vector: &[f64]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for v in vector.chunks_exact(3) {
        (0..3).for_each(|i| sum[i] += v[i]);
    }
    sum
}

impl Space {
    /// Sums over all ranks.
    pub(crate) fn sum_ranks(&self, name: &'static str, values: &mut [f64]) {
        self.ranks.sum(name, values);
    }

    /// Largest numbers of all ranks; NaN exceeds every number.
    pub(crate) fn largest_of_ranks(&self, name: &'static str, values: &mut [f64]) {
        self.ranks.largest(name, values);
    }

    /// The same outcome on all ranks.
    pub(crate) fn agree<T>(&self, outcome: Result<T>) -> Result<T> {
        self.ranks.agree(outcome)
    }

    /// Scalar product of nodal vectors, `[k][n_nodes][3]`.
    pub(crate) fn dot(&self, x: &[f64], y: &[f64]) -> f64 {
        let mut sum = [self.own_dot(x, y)];
        self.sum_ranks("scalar product", &mut sum);
        sum[0]
    }

    /// Scalar products of nodal vectors with another one, `[k][n_nodes][3]`, in one sum.
    pub(crate) fn dots<'v>(&self, x: impl Iterator<Item = &'v [f64]>, y: &[f64], products: &mut [f64]) {
        products.iter_mut().zip(x).for_each(|(product, x)| *product = self.own_dot(x, y));
        self.sum_ranks("scalar products", products);
    }

    /// Part of this rank of a scalar product, for a sum over all ranks.
    pub(crate) fn own_dot(&self, x: &[f64], y: &[f64]) -> f64 {
        if self.guests().is_empty() {
            return reduce::dot(x, y);
        }
        let n = self.n_dofs();
        let ranges = self.counted_ranges().map(|nodes| 3 * nodes.start..3 * nodes.end);
        let of_stage = |x: &[f64], y: &[f64]| -> f64 {
            ranges.iter().map(|dofs| reduce::dot(&x[dofs.clone()], &y[dofs.clone()])).sum()
        };
        x.chunks_exact(n).zip(y.chunks_exact(n)).map(|(x, y)| of_stage(x, y)).sum()
    }

    /// Norm of nodal vectors, `[k][n_nodes][3]`.
    pub(crate) fn norm(&self, x: &[f64]) -> f64 {
        self.dot(x, x).sqrt()
    }

    /// Sum of a nodal vector, `[n_nodes][3]`, which may lack internal nodes.
    pub(crate) fn sum(&self, vector: &[f64]) -> [f64; 3] {
        let [own, internal] = self.counted_ranges().map(|nodes| {
            let [start, end] = [nodes.start, nodes.end].map(|node| (3 * node).min(vector.len()));
            sum(&vector[start..end])
        });
        let mut sum = [0, 1, 2].map(|d| own[d] + internal[d]);
        self.sum_ranks("sum of a nodal vector", &mut sum);
        sum
    }

    /// Moment `sum_A q_A x v_A` about the origin of a nodal vector at a displacement, both `[n_nodes][3]`.
    pub(crate) fn moment(&self, displacement: &[f64], vector: &[f64]) -> [f64; 3] {
        let mut moment = [0.0; 3];
        let (u, v) = (displacement.as_chunks::<3>().0, vector.as_chunks::<3>().0);
        for node in self.counted_nodes().take_while(|&node| node < u.len().min(v.len())) {
            let (X, u) = (self.point(node), u[node]);
            let q = [X[0] + u[0], X[1] + u[1], X[2] + u[2]];
            let arm_cross_v = cross(q, v[node]);
            (0..3).for_each(|i| moment[i] += arm_cross_v[i]);
        }
        self.sum_ranks("moment", &mut moment);
        moment
    }

    /// Takes nodal values of guests from their owners, `[k][n_nodes][3]`.
    pub(crate) fn update_guests(&self, name: &'static str, vectors: &mut [f64]) {
        if !self.is_shared() {
            return;
        }
        let n = self.n_dofs();
        let read = |vectors: &[f64], node: usize, numbers: &mut [f64]| {
            for (numbers, stage) in numbers.chunks_exact_mut(3).zip(vectors.chunks_exact(n)) {
                numbers.copy_from_slice(&stage[3 * node..3 * node + 3]);
            }
        };
        let write = |vectors: &mut [f64], node: usize, numbers: &[f64]| {
            for (numbers, stage) in numbers.chunks_exact(3).zip(vectors.chunks_exact_mut(n)) {
                stage[3 * node..3 * node + 3].copy_from_slice(numbers);
            }
        };
        self.ranks.exchange(name, 3 * (vectors.len() / n), vectors, read, write);
    }

    /// Sets a nodal vector to zero at guests, `[n_nodes][3]`.
    pub(crate) fn clear_guests(&self, vector: &mut [f64]) {
        let guests = self.guests();
        vector[3 * guests.start..3 * guests.end].fill(0.0);
    }

    /// The displacement of the first node of the first rank.
    pub(crate) fn first_displacement(&self, displacement: &[f64]) -> [f64; 3] {
        let mut first = displacement.first_chunk().copied().unwrap_or_default();
        self.ranks.take_from(0, "first node", &mut first);
        first
    }

    /// A point and a time of the lowest rank that has them.
    pub(crate) fn of_lowest_rank(&self, own: Option<([f64; 3], f64)>) -> Option<([f64; 3], f64)> {
        let rank = self.ranks.lowest("rank of a point", own.map(|_| self.ranks.rank()))?;
        let mut numbers = own.map_or([0.0; 4], |([x, y, z], time)| [x, y, z, time]);
        self.ranks.take_from(rank, "point", &mut numbers);
        let [x, y, z, time] = numbers;
        Some(([x, y, z], time))
    }

    /// The lowest number in the whole mesh among some own nodes, one of each rank at most.
    pub(crate) fn lowest_node(&self, own: Option<usize>) -> Option<usize> {
        self.ranks.lowest("node", own.map(|node| self.dof_of_ranks(3 * node) / 3))
    }

    /// The own node with the largest size of all ranks, as its number in the whole mesh, and that size; the first of
    /// several.
    pub(crate) fn largest_node(&self, sizes: impl Iterator<Item = f64>) -> (usize, f64) {
        let own = sizes.take(self.own_nodes().end).enumerate();
        let (node, size) = own.fold((0, 0.0), |most, own| if own.1 > most.1 { own } else { most });
        if !self.is_shared() {
            return (node, size);
        }
        let mut most = [size];
        self.ranks.largest("largest size of a node", &mut most);
        (self.lowest_node((size == most[0]).then_some(node)).unwrap_or(0), most[0])
    }

    /// A vector at a node of the whole mesh, `of_node(node)` on the rank that owns it.
    pub(crate) fn at_node(&self, node: usize, of_node: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
        if !self.is_shared() {
            return of_node(node);
        }
        let mut vector = self.ranks.own_node(node).map_or([0.0; 3], of_node);
        self.ranks.sum("vector at a node", &mut vector);
        vector
    }

    /// Kind of a cell of the whole mesh and the mean of its nodes, with `of_node(node)` for each; `None` if there is no
    /// such cell.
    pub(crate) fn at_cell(
        &self,
        cell: usize,
        of_node: impl Fn(usize) -> [f64; 3],
    ) -> Option<(CellKind, [f64; 3])> {
        let own = self.ranks.cells.iter().position(|&whole| whole as usize == cell);
        let found = own.map(|cell| {
            let found = self.mesh().cell(cell);
            let mut centre = [0.0; 3];
            for corner in found.nodes.iter().map(|&node| of_node(node as usize)) {
                (0..3).for_each(|d| centre[d] += corner[d] / found.nodes.len() as f64);
            }
            (found.kind, centre)
        });
        let rank = self.ranks.lowest("rank of a cell", found.map(|_| self.ranks.rank()))?;
        let number = |kind: CellKind| CellKind::ALL.iter().position(|own| *own == kind).unwrap_or(0) as f64;
        let mut numbers = found.map_or([0.0; 4], |(kind, [x, y, z])| [number(kind), x, y, z]);
        self.ranks.take_from(rank, "cell", &mut numbers);
        let [kind, x, y, z] = numbers;
        Some((CellKind::ALL[kind as usize], [x, y, z]))
    }
}
