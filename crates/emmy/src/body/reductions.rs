//! Sums over nodes and cells, and other decisions that all ranks of a team make together.
//!
//! On a team every method here is a call of all ranks; own nodes come first, and guests do not count.

use std::ops::Range;
use std::sync::Arc;

use super::reactions::Reaction;
use super::system::Body;
use crate::element::CellKind;
use crate::error::Result;
use crate::force::StrainState;
use crate::sparse::reduce;
use crate::team::Subdomain;

impl Body {
    /// This rank's part of a body that a team computes; `None`: the whole body is here.
    pub fn subdomain(&self) -> Option<&Arc<Subdomain>> {
        self.subdomain.as_ref()
    }

    /// This rank's part of a body that several ranks compute.
    pub(crate) fn shared_part(&self) -> Option<&Arc<Subdomain>> {
        self.subdomain().filter(|part| part.size() > 1)
    }

    /// Whether some cell, of any rank, is plane. The planes that hold it then also exert couples about x and y, by the
    /// shears yz and xz, which no nodal force shows.
    pub(crate) fn has_plane_cells(&self) -> bool {
        self.has_plane_cells
    }

    /// Number of degrees of freedom on all ranks of a team; [`Body::n_dofs`] of a body that is whole.
    pub fn n_dofs_of_ranks(&self) -> usize {
        self.n_dofs_of_ranks
    }

    /// Whether some cell, of any rank, has internal nodes.
    pub(crate) fn has_internal_nodes(&self) -> bool {
        let n_nodes = self.subdomain().map_or(self.mesh().n_nodes(), |subdomain| subdomain.n_nodes_of_ranks);
        self.n_dofs_of_ranks > 3 * n_nodes
    }

    /// Nodes that other ranks own.
    pub(super) fn guests(&self) -> Range<usize> {
        let n = self.mesh().n_nodes();
        self.subdomain().map_or(n, |subdomain| subdomain.n_own)..n
    }

    /// Nodes that count in sums, two ranges that ascend: own ones, and internal ones of cells that count here. Each node
    /// counts on one rank.
    pub(crate) fn counted_ranges(&self) -> [Range<usize>; 2] {
        match self.guests().is_empty() {
            // One sum over all nodes has the bits of the whole body.
            true => [0..self.n_dofs() / 3, self.n_dofs() / 3..self.n_dofs() / 3],
            false => [0..self.guests().start, self.internal.counted()],
        }
    }

    /// The nodes of [`Body::counted_ranges`].
    pub(crate) fn counted_nodes(&self) -> impl Iterator<Item = usize> + use<> {
        self.counted_ranges().into_iter().flatten()
    }

    /// Their degrees of freedom.
    pub(crate) fn counted_dofs(&self) -> impl Iterator<Item = usize> + use<> {
        self.counted_ranges().into_iter().flat_map(|nodes| 3 * nodes.start..3 * nodes.end)
    }

    /// Number of a degree of freedom in the whole body.
    pub(crate) fn dof_of_ranks(&self, dof: usize) -> usize {
        self.subdomain().map_or(dof, |subdomain| 3 * subdomain.nodes[dof / 3] as usize + dof % 3)
    }

    /// Own nodes; of the whole body also internal ones.
    pub(crate) fn own_nodes(&self) -> Range<usize> {
        0..self.subdomain().map_or(self.n_dofs() / 3, |subdomain| subdomain.n_own)
    }

    /// Which degrees of freedom have no equation here: fixed ones, and those of guests, `[n_nodes][3]`.
    pub(crate) fn inactive(&self) -> &[bool] {
        &self.inactive
    }

    /// Sets the entries of the degrees of freedom without an equation to zero, `[k][n_nodes][3]`.
    pub(crate) fn clear_inactive(&self, vectors: &mut [f64]) {
        for stage in vectors.chunks_exact_mut(self.n_dofs()) {
            let entries = stage.iter_mut().zip(&self.inactive);
            entries.filter(|(_, inactive)| **inactive).for_each(|(value, _)| *value = 0.0);
        }
    }

    /// Axes along which some node is fixed.
    pub(crate) fn held_axes(&self) -> [bool; 3] {
        self.held_axes
    }

    /// Sums over all ranks.
    pub(crate) fn sum_ranks(&self, name: &'static str, values: &mut [f64]) {
        if let Some(subdomain) = self.subdomain() {
            subdomain.sum(name, values);
        }
    }

    /// Largest numbers of all ranks; NaN exceeds every number.
    pub(crate) fn largest_of_ranks(&self, name: &'static str, values: &mut [f64]) {
        if let Some(subdomain) = self.subdomain() {
            subdomain.largest(name, values);
        }
    }

    /// The same outcome on all ranks.
    pub(crate) fn agree<T>(&self, outcome: Result<T>) -> Result<T> {
        match self.subdomain() {
            Some(subdomain) => subdomain.agree(outcome),
            None => outcome,
        }
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
            super::sum(&vector[start..end])
        });
        let mut sum = [0, 1, 2].map(|d| own[d] + internal[d]);
        self.sum_ranks("sum of a nodal vector", &mut sum);
        sum
    }

    /// Total of the lumped masses \[mass\].
    pub(crate) fn total_lumped_mass(&self) -> f64 {
        let mut sum = [self.lumped_mass()[self.own_nodes()].iter().sum()];
        self.sum_ranks("lumped mass", &mut sum);
        sum[0]
    }

    /// Total of the consistent mass \[mass\].
    pub(crate) fn total_mass(&self) -> f64 {
        let end = self.pattern().range(self.own_nodes().end - 1).end;
        let mut sum = [self.mass()[..end].iter().sum()];
        self.sum_ranks("mass", &mut sum);
        sum[0]
    }

    /// Takes nodal values of guests from their owners, `[k][n_nodes][3]`.
    pub(crate) fn update_guests(&self, name: &'static str, vectors: &mut [f64]) {
        let Some(subdomain) = self.subdomain() else { return };
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
        subdomain.exchange(name, 3 * (vectors.len() / n), vectors, read, write);
    }

    /// Sets a nodal vector to zero at guests, `[n_nodes][3]`.
    pub(crate) fn clear_guests(&self, vector: &mut [f64]) {
        let guests = self.guests();
        vector[3 * guests.start..3 * guests.end].fill(0.0);
    }

    /// The strain state of all ranks from that of the cells that count here; the cell is one of the whole mesh.
    pub(super) fn strain_state_of_ranks(&self, own: StrainState) -> StrainState {
        let Some(subdomain) = self.subdomain() else { return own };
        let mut energy = [own.strain_energy];
        subdomain.sum("strain energy", &mut energy);
        let negative = -own.smallest_determinant;
        let mut most = [negative];
        subdomain.largest("smallest determinant", &mut most);
        let is_here = negative == most[0] || negative.is_nan();
        // A rank without cells has none that counts.
        let cell = subdomain.cells.get(own.smallest_cell).filter(|_| is_here).map(|&cell| cell as usize);
        let smallest_cell = subdomain.lowest("cell of the smallest determinant", cell).unwrap_or(0);
        StrainState { strain_energy: energy[0], smallest_determinant: -most[0], smallest_cell }
    }

    /// Reactions of all ranks from those at own nodes.
    pub(crate) fn sum_reactions(&self, reactions: &mut [Reaction]) {
        if let Some(subdomain) = self.subdomain().filter(|_| !reactions.is_empty()) {
            let parts = |reaction: &Reaction| [reaction.force, reaction.moment].concat();
            let mut sums: Vec<f64> = reactions.iter().flat_map(parts).collect();
            subdomain.sum("reactions", &mut sums);
            for (reaction, sums) in reactions.iter_mut().zip(sums.as_chunks::<6>().0) {
                let [fx, fy, fz, mx, my, mz] = *sums;
                *reaction = Reaction { force: [fx, fy, fz], moment: [mx, my, mz] };
            }
        }
    }

    /// The displacement of the first node of the first rank.
    pub(crate) fn first_displacement(&self, displacement: &[f64]) -> [f64; 3] {
        let mut first = displacement.first_chunk().copied().unwrap_or_default();
        if let Some(subdomain) = self.subdomain() {
            subdomain.take_from(0, "first node", &mut first);
        }
        first
    }

    /// A point and a time of the lowest rank that has them.
    pub(super) fn of_lowest_rank(&self, own: Option<([f64; 3], f64)>) -> Option<([f64; 3], f64)> {
        let Some(subdomain) = self.subdomain() else { return own };
        let rank = subdomain.lowest("rank of a point", own.map(|_| subdomain.rank()))?;
        let mut numbers = own.map_or([0.0; 4], |([x, y, z], time)| [x, y, z, time]);
        subdomain.take_from(rank, "point", &mut numbers);
        let [x, y, z, time] = numbers;
        Some(([x, y, z], time))
    }

    /// The lowest number in the whole mesh among some own nodes, one of each rank at most.
    pub(crate) fn lowest_node(&self, own: Option<usize>) -> Option<usize> {
        match self.subdomain() {
            Some(subdomain) => subdomain.lowest("node", own.map(|node| subdomain.nodes[node] as usize)),
            None => own,
        }
    }

    /// The own node with the largest size of all ranks, as its number in the whole mesh, and that size; the first of
    /// several.
    pub(crate) fn largest_node(&self, sizes: impl Iterator<Item = f64>) -> (usize, f64) {
        let own = sizes.take(self.own_nodes().end).enumerate();
        let (node, size) = own.fold((0, 0.0), |most, own| if own.1 > most.1 { own } else { most });
        let Some(subdomain) = self.subdomain() else { return (node, size) };
        let mut most = [size];
        subdomain.largest("largest size of a node", &mut most);
        (self.lowest_node((size == most[0]).then_some(node)).unwrap_or(0), most[0])
    }

    /// A vector at a node of the whole mesh, `of_node(node)` on the rank that owns it.
    pub(crate) fn at_node(&self, node: usize, of_node: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
        let Some(subdomain) = self.subdomain() else { return of_node(node) };
        let mut vector = subdomain.own_node(node).map_or([0.0; 3], of_node);
        subdomain.sum("vector at a node", &mut vector);
        vector
    }

    /// Kind of a cell of the whole mesh and the mean of its nodes, with `of_node(node)` for each; `None` if there is no such
    /// cell.
    pub(crate) fn at_cell(
        &self,
        cell: usize,
        of_node: impl Fn(usize) -> [f64; 3],
    ) -> Option<(CellKind, [f64; 3])> {
        let own = match self.subdomain() {
            Some(subdomain) => subdomain.cells.iter().position(|&whole| whole as usize == cell),
            None => (cell < self.mesh().n_cells()).then_some(cell),
        };
        let found = own.map(|cell| {
            let found = self.mesh().cell(cell);
            let mut centre = [0.0; 3];
            for corner in found.nodes.iter().map(|&node| of_node(node as usize)) {
                (0..3).for_each(|d| centre[d] += corner[d] / found.nodes.len() as f64);
            }
            (found.kind, centre)
        });
        let Some(subdomain) = self.subdomain() else { return found };
        let rank = subdomain.lowest("rank of a cell", found.map(|_| subdomain.rank()))?;
        let number = |kind: CellKind| CellKind::ALL.iter().position(|own| *own == kind).unwrap_or(0) as f64;
        let mut numbers = found.map_or([0.0; 4], |(kind, [x, y, z])| [number(kind), x, y, z]);
        subdomain.take_from(rank, "cell", &mut numbers);
        let [kind, x, y, z] = numbers;
        Some((CellKind::ALL[kind as usize], [x, y, z]))
    }
}
