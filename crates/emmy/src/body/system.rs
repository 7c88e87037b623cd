//! The body: its tables.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use crate::error::{Error, Result};
use crate::force::Forces;
use crate::input::{Joint, Region, RigidBody, Viscosity};
use crate::mass::RegionSummary;
use crate::mesh::Mesh;
use crate::nodal;
use crate::space::{CoupledPoint, Space, TieSummary};
use crate::sparse::{Condensation, Pattern, nested_dissection};
use crate::team::Subdomain;
use crate::unknowns::{Carrier, Component, Constraints, Frame, Mechanism, Mobility};

/// An elastic body, discretised in space: everything but its state of motion.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let body = Body::builder(mesh::l_block(1.0)?).region(Region::new(rubber, 0.5)).build()?;
/// assert!((body.regions()[0].mass - 0.5 * 117.0).abs() < 1e-12);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Body {
    /// Whose each node is, and how it moves.
    pub(crate) space: Space,
    pub(super) regions: Vec<RegionSummary>,
    pub(super) region_of_cell: Vec<u32>,
    /// The regions as they were given.
    pub(super) made_of: Arc<Vec<Region>>,
    pub(crate) mechanism: Arc<Mechanism>,
    pub(super) forces: Forces,
    /// Whether some cell, of any rank, has pressures.
    pub(super) has_local: bool,
    pub(super) pattern: Arc<Pattern>,
    pub(super) parts: Vec<Range<usize>>,
    /// Computed on first use.
    pub(super) node_order: Arc<OnceLock<Result<Vec<usize>>>>,
    pub(super) mass: Arc<Vec<f64>>,
    /// The same with the carriers of massless directions.
    pub(super) carried_mass: Arc<Vec<f64>>,
    pub(super) viscous_time: f64,
    pub(super) lumped_mass: Vec<f64>,
    /// The body with loads and ground that act on the lumped mass, if that makes a difference.
    pub(super) lumped: Option<Box<Body>>,
    /// When supports or joints are released first, and the body afterwards.
    pub(super) release: Option<(f64, Box<Body>)>,
}

impl Body {
    /// When the next supports or joints are released, and the body afterwards.
    pub fn release(&self) -> Option<(f64, &Body)> {
        self.release.as_ref().map(|(time, body)| (*time, &**body))
    }

    /// The body without the supports and joints that are released by a time.
    pub(super) fn at(&self, time: f64) -> &Body {
        match self.release() {
            Some((until, released)) if until <= time => released.at(time),
            _ => self,
        }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        self.space.mesh()
    }

    /// This rank's part of the body; a team of one if the whole body is here.
    pub fn ranks(&self) -> &Arc<Subdomain> {
        self.space.ranks()
    }

    /// Number of degrees of freedom, fixed ones included: three for each node of the mesh, then three for each
    /// incompatible mode, which is held as a node without mass inside its cell. Vectors `[n_nodes][3]` of a state, a
    /// force or a mode of vibration have this length; the nodes of the mesh come first.
    ///
    /// ```
    /// use emmy::body::Formulation;
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0).with_formulation(Formulation::IncompatibleModes);
    /// let body = Body::builder(mesh::block([1.0; 3], [2, 1, 1])?).region(rubber).build()?;
    /// assert_eq!(body.n_dofs(), 3 * (12 + 2 * 3));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn n_dofs(&self) -> usize {
        self.space.n_dofs()
    }

    /// Number of degrees of freedom on all ranks of a team; [`Body::n_dofs`] of a body that is whole.
    pub fn n_dofs_of_ranks(&self) -> usize {
        self.space.n_dofs_of_ranks()
    }

    /// A summary of each tie, in their order.
    pub fn ties(&self) -> &[TieSummary] {
        self.space.ties().summaries()
    }

    /// The points of the distributing couplings, in their order.
    pub fn couplings(&self) -> &[CoupledPoint] {
        self.space.ties().points()
    }

    /// Whether nodes follow others, those of rigid bodies aside.
    pub(crate) fn has_ties(&self) -> bool {
        !(self.ties().is_empty() && self.couplings().is_empty())
    }

    /// The rigid bodies; those of a group with their centre.
    pub fn rigid_bodies(&self) -> impl ExactSizeIterator<Item = &RigidBody> {
        self.mechanism.frames.iter().map(Frame::body)
    }

    /// Nodes of a rigid body: its centre, and the ends of its axes unless it is a point mass.
    pub fn nodes_of_rigid_body(&self, name: &str) -> Option<Range<u32>> {
        self.mechanism.frames.iter().find(|frame| frame.name() == name).map(Frame::nodes)
    }

    /// The joints.
    pub fn joints(&self) -> &[Joint] {
        &self.mechanism.joints
    }

    /// Number of the constraints of all joints, drives included.
    pub fn n_constraints(&self) -> usize {
        self.mechanism.n_constraints()
    }

    /// Whether it has cells: rigid bodies alone need no mesh.
    pub(crate) fn has_cells(&self) -> bool {
        // A rank of a team may have none of its own, but then there is no mechanism.
        self.mechanism.is_empty() || self.space.mesh().n_cells() > 0
    }

    /// How many ways the mechanism of rigid bodies and joints can move where it is drawn.
    pub fn mobility(&self) -> Mobility {
        self.mechanism.mobility(self.space.inactive())
    }

    /// Number of the nodes that follow others, by ties or in a rigid body.
    pub fn n_followers(&self) -> usize {
        self.space.ties().followers().len()
    }

    /// The rigid body that a node of the mesh belongs to.
    pub fn rigid_body_of(&self, node: u32) -> Option<&str> {
        self.space.ties().body_of(node)
    }

    /// The nodes that a tied node follows, with their weights.
    #[doc(hidden)]
    pub fn leaders_of(&self, node: u32) -> Option<&[(u32, f64)]> {
        self.space.ties().leaders_of(node)
    }

    /// Sets nodal vectors at tied nodes to those of the nodes that they follow, `[k][n_nodes][3]`: displacements, rates
    /// and velocities, for a scheme from outside. Forces, masses and momenta there are zero.
    pub fn follow(&self, vectors: &mut [f64]) {
        self.space.follow(vectors);
    }

    /// The constraints of the motion beside supports.
    pub(crate) fn constraints(&self) -> &Constraints {
        &self.mechanism.constraints
    }

    /// Checks that the body has neither constraints nor joints, for a computation without them.
    ///
    /// # Errors
    /// [`Error::Constrained`].
    pub(crate) fn check_unconstrained(&self, what: &'static str) -> Result<()> {
        if self.mechanism.is_empty() { Ok(()) } else { Err(Error::Constrained { what }) }
    }

    /// Number of degrees of freedom that are not given.
    pub fn n_free_dofs(&self) -> usize {
        self.fixed().iter().filter(|fixed| !**fixed).count()
    }

    /// Which degrees of freedom are given: fixed at rest, driven, or tied, `[n_nodes][3]`.
    pub fn fixed(&self) -> &[bool] {
        self.space.fixed()
    }

    /// Whether supports hold nodes of a component; planes of plane strain do not count.
    pub(crate) fn holds(&self, component: &Component) -> bool {
        let is_held = |dof: &usize| self.fixed()[*dof] && !(self.space.has_plane_cells() && dof % 3 == 2);
        let leads = |node: &usize| self.space.ties().leaders_of(*node as u32).is_none();
        component.nodes().filter(leads).any(|node| nodal::dofs(node).any(|dof| is_held(&dof)))
    }

    /// Whether some degrees of freedom have a given motion.
    pub fn is_driven(&self) -> bool {
        self.space.is_driven()
    }

    /// Groups with supports or springs to the ground, in the order of the supports and then of the springs. A degree of
    /// freedom that two groups hold counts for the first; a group keeps its place after its release.
    pub fn supported_groups(&self) -> impl ExactSizeIterator<Item = &str> {
        self.space.supported_groups()
    }

    /// Moment `sum_A q_A x v_A` about the origin of a nodal vector at a displacement, both `[n_nodes][3]`.
    pub fn moment(&self, displacement: &[f64], vector: &[f64]) -> [f64; 3] {
        self.space.moment(displacement, vector)
    }

    /// Volume, mass, centre and inertia of each region, then of each group of point masses (no cells, no volume).
    pub fn regions(&self) -> &[RegionSummary] {
        &self.regions
    }

    /// Region of each cell.
    pub fn region_of_cell(&self) -> &[u32] {
        &self.region_of_cell
    }

    /// Couplings of the nodes.
    #[doc(hidden)]
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Consistent mass matrix M_AB, one number per coupling of the pattern \[mass\].
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// The consistent mass with the carriers of directions that are free along an axis.
    pub(crate) fn carried_mass_along(&self, axis: usize) -> Cow<'_, [f64]> {
        let is_free = |carrier: &Carrier| carrier.is_free(axis, |dof| self.fixed()[dof]);
        let carriers = &self.mechanism.carriers;
        if carriers.iter().all(is_free) {
            return Cow::Borrowed(&self.carried_mass);
        }
        let mut mass = self.mass.to_vec();
        carriers
            .iter()
            .filter(|own| is_free(own))
            .for_each(|carrier| carrier.add_to(&self.pattern, &mut mass));
        Cow::Owned(mass)
    }

    /// The consistent mass for factorisations: positive definite, with carriers in the directions of rigid bodies that
    /// have no mass.
    pub(crate) fn carried_mass(&self) -> &[f64] {
        &self.carried_mass
    }

    /// Lumped mass, one number per node \[mass\].
    ///
    /// Row sums of the consistent mass for linear cells. Row sums of quadratic cells are negative at corners; there the
    /// diagonal of a cell's consistent mass is scaled to the mass of the cell (Hinton, Rock and Zienkiewicz 1976):
    ///
    /// ```math
    /// m_A = sum_cells m_cell M_AA / sum_B M_BB
    /// ```
    pub fn lumped_mass(&self) -> &[f64] {
        &self.lumped_mass
    }

    /// The body as central differences move it: accelerations, body forces and attractions act on the lumped mass, like
    /// the inertia. It is the same body unless it has such loads on quadratic cells, whose row sums are no lumped
    /// masses.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = || Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    /// let weight = || Load::acceleration([0.0, 0.0, -10.0]);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber()).load(weight()).build()?;
    /// assert!(std::ptr::eq(body.lumped(), &body));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// An equilibrium from which central differences start is one of this body
    /// ([`Equilibrium::new`](crate::equilibrium::Equilibrium::new)).
    pub fn lumped(&self) -> &Body {
        self.lumped.as_deref().unwrap_or(self)
    }

    /// Memory for the condensation of the internal nodes of cells, with a mass of each coupling; `None` if there are
    /// none.
    pub(crate) fn condensation(&self, mass: &[f64]) -> Option<Condensation> {
        let condensation = || Condensation::new(&self.pattern, mass).on(self.space.shared().cloned());
        self.space.has_internal_nodes().then(condensation)
    }

    /// Fill-reducing order of the nodes, `order[new] = old`, computed on first use: explicit methods need none.
    ///
    /// # Errors
    /// [`crate::Error::Linear`] if there is not enough memory for it.
    #[doc(hidden)]
    pub fn node_order(&self) -> Result<&[usize]> {
        match self.node_order.get_or_init(|| nested_dissection(&self.pattern)) {
            Ok(order) => Ok(order),
            Err(error) => Err(error.clone()),
        }
    }

    /// Whether any region has a viscosity.
    pub fn is_viscous(&self) -> bool {
        self.viscosities().any(|viscosity| !viscosity.is_zero())
    }

    /// Equivalent stiffness-proportional damping time, averaged over the cells \[time\].
    pub(crate) fn viscous_time(&self) -> f64 {
        self.viscous_time
    }

    /// Whether the viscosities in a kept stiffness are no multiple of that at rest: some parts have others or none, or
    /// there are dampers.
    pub(crate) fn has_uneven_viscosity(&self) -> bool {
        let is_multiple = |viscosity: &Viscosity| viscosity.shear == 0.0 && viscosity.bulk == 0.0;
        let first = self.viscosities().next();
        let is_even = self.viscosities().all(|own| is_multiple(own) && Some(own) == first);
        self.is_viscous() && !(is_even && self.stores_energy_in_cells_alone())
            || self.constraints().is_empty() && self.has_dampers()
    }

    /// Viscosity of each region.
    pub fn viscosities(&self) -> impl Iterator<Item = &Viscosity> {
        self.made_of.iter().map(|region| &region.viscosity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::NeoHooke;
    use crate::mesh::block;

    #[test]
    fn nodes_are_ordered_when_somebody_asks_for_it() {
        let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
        let body = Body::builder(block([1.0; 3], [2; 3]).unwrap()).region(rubber).build().unwrap();
        assert!(body.node_order.get().is_none());
        let mut order = body.node_order().unwrap().to_vec();
        order.sort_unstable();
        assert_eq!(order, (0..27).collect::<Vec<_>>());
        assert!(body.clone().node_order.get().is_some());
    }
}
