//! The nodes of a body: which rank has each, and how it moves.

#![allow(non_snake_case)]

mod coupled_point;
pub(crate) mod drive;
mod driven;
pub(crate) mod geometry;
pub(crate) mod internal_nodes;
mod reactions;
mod reductions;
pub(crate) mod supports;
mod ties;

use std::ops::Range;
use std::sync::Arc;

pub use coupled_point::{CoupledPoint, OffPlane, affine_weights, check_coupling};
pub(crate) use driven::DrivenRates;
pub(crate) use geometry::CellTable;
pub(crate) use internal_nodes::InternalNodes;
pub use reactions::Reaction;
pub use reductions::sum;
pub(crate) use supports::Supports;
pub use ties::TieSummary;
pub(crate) use ties::{RigidFollowers, Ties};

use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::nodal;
use crate::team::Subdomain;

/// The nodes of a body on one rank: own nodes, guests, and the internal nodes of cells; which of their components
/// supports hold or drive; which nodes follow others. All sums and other decisions over nodes are made here, by all
/// ranks together; a body alone is on a team of one.
///
/// Nodal vectors are `[n_nodes][3]`, those of several stages `[k][n_nodes][3]`. Own nodes come first, then guests, then
/// internal nodes.
#[derive(Debug, Clone)]
pub(crate) struct Space {
    mesh: Arc<Mesh>,
    internal: Arc<InternalNodes>,
    ranks: Arc<Subdomain>,
    supports: Supports,
    ties: Arc<Ties>,
    n_dofs_of_ranks: usize,
    has_plane_cells: bool,
}

impl Space {
    /// The nodes of a mesh, on this rank; [`Space::with_sums_of_ranks`] completes it.
    pub(crate) fn new(
        mesh: Arc<Mesh>,
        internal: InternalNodes,
        ranks: Arc<Subdomain>,
        supports: Supports,
        ties: Ties,
    ) -> Self {
        let has_plane_cells = mesh.cells().any(|cell| cell.kind.dimension() == 2);
        let n_dofs_of_ranks = internal.dofs().end;
        let internal = Arc::new(internal);
        Space { mesh, internal, ranks, supports, ties: Arc::new(ties), n_dofs_of_ranks, has_plane_cells }
    }

    /// The same nodes with other supports.
    pub(crate) fn with_supports(&self, supports: Supports) -> Self {
        Space { supports, ..self.clone() }
    }

    /// Replaces what was known of this rank by what is true of all. A call of all ranks.
    pub(crate) fn with_sums_of_ranks(mut self) -> Self {
        let ranks = &*self.ranks;
        let mut n_internal = [self.internal.counted().len() as f64];
        ranks.sum("internal nodes", &mut n_internal);
        self.n_dofs_of_ranks = 3 * (ranks.n_nodes_of_ranks + n_internal[0] as usize);
        [self.has_plane_cells] = ranks.any("plane cells", [self.has_plane_cells]);
        self.supports.sum_ranks(ranks);
        self
    }

    /// The mesh.
    pub(crate) fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// The incompatible modes of cells as nodes.
    pub(crate) fn internal(&self) -> &Arc<InternalNodes> {
        &self.internal
    }

    /// This rank's part of the body; a team of one if the whole body is here.
    pub(crate) fn ranks(&self) -> &Arc<Subdomain> {
        &self.ranks
    }

    /// This rank's part of a body that several ranks compute.
    pub(crate) fn shared(&self) -> Option<&Arc<Subdomain>> {
        self.is_shared().then_some(&self.ranks)
    }

    /// Whether several ranks compute the body.
    pub(crate) fn is_shared(&self) -> bool {
        self.ranks.size() > 1
    }

    /// Checks that the whole body is here.
    ///
    /// # Errors
    /// [`Error::NotOnTeam`].
    pub(crate) fn check_whole(&self, what: impl Into<String>) -> Result<()> {
        if self.is_shared() { Err(Error::NotOnTeam { what: what.into() }) } else { Ok(()) }
    }

    /// Number of degrees of freedom, fixed ones included.
    pub(crate) fn n_dofs(&self) -> usize {
        self.internal.dofs().end
    }

    /// Number of degrees of freedom on all ranks.
    pub(crate) fn n_dofs_of_ranks(&self) -> usize {
        self.n_dofs_of_ranks
    }

    /// Whether some cell, of any rank, is plane. The planes that hold it then also exert couples about x and y, by the
    /// shears yz and xz, which no nodal force shows.
    pub(crate) fn has_plane_cells(&self) -> bool {
        self.has_plane_cells
    }

    /// Whether some cell, of any rank, has internal nodes.
    pub(crate) fn has_internal_nodes(&self) -> bool {
        self.n_dofs_of_ranks > 3 * self.ranks.n_nodes_of_ranks
    }

    /// Own nodes; of a body that is whole also internal ones.
    pub(crate) fn own_nodes(&self) -> Range<usize> {
        if self.guests().is_empty() { 0..self.n_dofs() / 3 } else { 0..self.ranks.n_own }
    }

    /// Nodes that other ranks own.
    pub(crate) fn guests(&self) -> Range<usize> {
        self.ranks.n_own..self.mesh.n_nodes()
    }

    /// The degrees of freedom of internal nodes: at the end, without mass.
    pub(crate) fn internal_dofs(&self) -> Range<usize> {
        self.internal.dofs()
    }

    /// Nodes that count in sums, two ranges that ascend: own ones, and internal ones of cells that count here. Each
    /// node counts on one rank.
    pub(crate) fn counted_ranges(&self) -> [Range<usize>; 2] {
        match self.guests().is_empty() {
            // One sum over all nodes has the bits of the whole body.
            true => [0..self.n_dofs() / 3, self.n_dofs() / 3..self.n_dofs() / 3],
            false => [0..self.guests().start, self.internal.counted()],
        }
    }

    /// The nodes of [`Space::counted_ranges`].
    pub(crate) fn counted_nodes(&self) -> impl Iterator<Item = usize> + use<> {
        self.counted_ranges().into_iter().flatten()
    }

    /// Their degrees of freedom.
    pub(crate) fn counted_dofs(&self) -> impl Iterator<Item = usize> + use<> {
        self.counted_ranges().into_iter().flat_map(|nodes| 3 * nodes.start..3 * nodes.end)
    }

    /// Number of a degree of freedom in the whole body.
    pub(crate) fn dof_of_ranks(&self, dof: usize) -> usize {
        let node = self.ranks.nodes.get(dof / 3).map_or(dof / 3, |&node| node as usize);
        nodal::dof(node, dof % 3)
    }

    /// Reference position of every node: those of the mesh, then the internal ones.
    pub(crate) fn points(&self) -> impl Iterator<Item = &[f64; 3]> {
        self.mesh.points().iter().chain(self.internal.points())
    }

    /// Reference position of a node.
    pub(crate) fn point(&self, node: usize) -> [f64; 3] {
        let n = self.mesh.n_nodes();
        if node < n { self.mesh.points()[node] } else { self.internal.points()[node - n] }
    }

    /// Position of a node at a displacement.
    pub(crate) fn position(&self, displacement: &[f64], node: usize) -> [f64; 3] {
        let X = self.point(node);
        [0, 1, 2].map(|d| X[d] + displacement[nodal::dof(node, d)])
    }

    /// The nodes that follow others.
    pub(crate) fn ties(&self) -> &Ties {
        &self.ties
    }

    /// Sets nodal vectors at tied nodes to those of the nodes that they follow, `[k][n_nodes][3]`.
    pub(crate) fn follow(&self, vectors: &mut [f64]) {
        self.ties.follow(vectors, self.n_dofs());
    }

    /// Moves forces at tied nodes to the nodes that they follow, `[k][n_nodes][3]`.
    pub(crate) fn gather(&self, forces: &mut [f64]) {
        self.ties.gather(forces, self.n_dofs());
    }

    /// Completes nodal vectors without the values of tied nodes and guests, `[k][n_nodes][3]`.
    pub(crate) fn complete(&self, name: &'static str, vectors: &mut [f64]) {
        self.update_guests(name, vectors);
        self.follow(vectors);
    }

    /// Which degrees of freedom are given: fixed at rest, driven, or tied.
    pub(crate) fn fixed(&self) -> &[bool] {
        &self.supports.fixed
    }

    /// Which degrees of freedom have no equation here: fixed ones, and those of guests.
    pub(crate) fn inactive(&self) -> &[bool] {
        &self.supports.inactive
    }

    /// Axes along which some node is fixed.
    pub(crate) fn held_axes(&self) -> [bool; 3] {
        self.supports.held_axes
    }

    /// Whether some node is fixed in some direction.
    pub(crate) fn is_supported(&self) -> bool {
        self.held_axes() != [false; 3]
    }

    /// Sets the entries of the degrees of freedom without an equation to zero.
    pub(crate) fn clear_inactive(&self, vectors: &mut [f64]) {
        for stage in vectors.chunks_exact_mut(self.n_dofs()) {
            let entries = stage.iter_mut().zip(self.inactive());
            entries.filter(|(_, inactive)| **inactive).for_each(|(value, _)| *value = 0.0);
        }
    }

    /// Sets a nodal field without modes: at internal nodes the mean over the corners of their cells.
    pub(crate) fn set_internal_means(&self, field: &mut [f64]) {
        self.internal.set_means(&self.mesh, field);
    }

    /// Adds the forces on the internal nodes to the nodes of their cells, in equal parts.
    pub(crate) fn share_internal_forces(&self, force: &mut [f64]) {
        self.internal.share(&self.mesh, force);
    }

    /// Fits a field of the nodes of the mesh, perhaps with other internal nodes, to the body, without modes.
    pub(crate) fn fit_without_modes(&self, field: &mut Vec<f64>) {
        field.resize(self.mesh.n_dofs(), 0.0);
        field.resize(self.n_dofs(), 0.0);
        self.set_internal_means(field);
    }

    /// Sets a velocity at the nodes without mass to the end of the polynomial of its rates, `sum_j weights_j x_j / h`
    /// with the basis at the end of the step as weights; `rates: [k][n_nodes][3]`. No momentum determines it, and
    /// nothing but predictions and estimates of errors depends on it.
    pub(crate) fn set_internal_velocity(
        &self,
        weights: &[f64],
        rates: &[f64],
        step_size: f64,
        velocity: &mut [f64],
    ) {
        let n = self.n_dofs();
        for dof in self.internal_dofs() {
            let rates = rates[dof..].iter().step_by(n);
            velocity[dof] = rates.zip(weights).map(|(x, b)| b * x).sum::<f64>() / step_size;
        }
    }
}
