//! The constraints of a body.

use super::constraint::Constraint;
use crate::nodal;

/// The constraints of a body, with the nodes that they join. Gradients have unit length in the reference configuration,
/// so that constraints of any kind compare.
#[derive(Debug, Default)]
pub(crate) struct Constraints {
    rows: Vec<Constraint>,
    /// Nodes of the constraints, and of forces between joint nodes, ascending.
    nodes: Vec<u32>,
    /// Size of the body \[length\].
    size: f64,
    is_grounded: bool,
    /// When some of them end: a joint is released.
    release: Option<f64>,
}

impl Constraints {
    /// Some constraints of a body of some size; `further`: nodes of forces that are taken with them; `is_grounded`:
    /// whether one of them joins the body to the ground; `release`: when the first of them end.
    pub(crate) fn new(
        rows: impl Iterator<Item = Constraint>,
        further: impl Iterator<Item = u32>,
        size: f64,
        is_grounded: bool,
        release: Option<f64>,
    ) -> Self {
        let rows: Vec<Constraint> = rows.map(Constraint::normalised).collect();
        let mut nodes: Vec<u32> = rows.iter().flat_map(Constraint::nodes).collect();
        if !rows.is_empty() {
            nodes.extend(further);
        }
        nodes.sort_unstable();
        nodes.dedup();
        Constraints { rows, nodes, size, is_grounded, release }
    }

    /// Number of constraints.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The constraints.
    pub(crate) fn rows(&self) -> &[Constraint] {
        &self.rows
    }

    /// Whether one of them joins the body to the ground: then their forces have a resultant.
    pub(crate) fn is_grounded(&self) -> bool {
        self.is_grounded
    }

    /// Whether velocities must be made those that are allowed at some time: the rate of a given motion jumps, or a
    /// joint is released.
    pub(crate) fn have_kinks(&self) -> bool {
        let mut drives = self.rows.iter().filter_map(|row| row.drive.as_ref());
        self.release.is_some() || drives.any(|drive| drive.has_kink(f64::NEG_INFINITY, f64::INFINITY))
    }

    /// When some of them end.
    pub(crate) fn release(&self) -> Option<f64> {
        self.release
    }

    /// Size of the body \[length\].
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// The joint nodes, ascending.
    pub(crate) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Number of degrees of freedom of the joint nodes.
    pub(crate) fn n_dofs(&self) -> usize {
        3 * self.nodes.len()
    }

    /// Degrees of freedom of the joint nodes.
    pub(crate) fn dofs(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().flat_map(|&node| nodal::dofs(node as usize))
    }

    /// Number of a degree of freedom among those of the joint nodes.
    pub(crate) fn local_dof(&self, dof: usize) -> usize {
        match self.nodes.binary_search(&((dof / 3) as u32)) {
            Ok(node) | Err(node) => nodal::dof(node, dof % 3),
        }
    }
}
