//! The body: its tables, and the assembly of stage forces and matrix.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use crate::average::Request;
use crate::error::Result;
use crate::force::pressures::PressureResults;
use crate::force::term::Terms;
use crate::force::{FieldLoad, LoadVector, Pressure, Scratch, StepDamping, StepInput, Term};
use crate::input::{Region, Viscosity};
use crate::mass::RegionSummary;
use crate::mesh::Mesh;
use crate::space::InternalNodes;
use crate::space::drive::Drive;
use crate::space::supports::SupportedGroup;
use crate::sparse::{Pattern, RowPart, StageMatrix, nested_dissection};
use crate::team::Subdomain;

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
    pub(super) mesh: Arc<Mesh>,
    pub(super) internal: Arc<InternalNodes>,
    pub(super) regions: Vec<RegionSummary>,
    pub(super) region_of_cell: Vec<u32>,
    /// The regions as they were given.
    pub(super) made_of: Arc<Vec<Region>>,
    /// Terms of the cells, made on first use.
    pub(super) terms: Arc<OnceLock<Terms>>,
    /// Whether some cell, of any rank, has pressures.
    pub(super) has_pressures: bool,
    /// Whether some cell, of any rank, is plane.
    pub(super) has_plane_cells: bool,
    /// Number of degrees of freedom on all ranks.
    pub(super) n_dofs_of_ranks: usize,
    /// The part of this rank; `None`: the whole body is here.
    pub(super) subdomain: Option<Arc<Subdomain>>,
    /// Terms of the ground: external in the momentum balances.
    pub(super) ground: Arc<Vec<Box<dyn Term>>>,
    pub(super) pattern: Arc<Pattern>,
    pub(super) parts: Vec<Range<usize>>,
    /// Computed on first use.
    pub(super) node_order: Arc<OnceLock<Result<Vec<usize>>>>,
    pub(super) mass: Arc<Vec<f64>>,
    /// Rate of the mass-proportional damping.
    pub(super) drag: f64,
    pub(super) viscous_time: f64,
    pub(super) lumped_mass: Vec<f64>,
    pub(super) fixed: Vec<bool>,
    /// Fixed degrees of freedom, and those of guests.
    pub(super) inactive: Vec<bool>,
    /// Axes along which some node is fixed.
    pub(super) held_axes: [bool; 3],
    pub(super) drives: Vec<Drive>,
    pub(super) supported: Vec<SupportedGroup>,
    pub(super) loads: Arc<Vec<LoadVector>>,
    pub(super) fields: Arc<Vec<FieldLoad>>,
    pub(super) pressures: Arc<Vec<Pressure>>,
    /// The body with loads and ground that act on the lumped mass, if that makes a difference.
    pub(super) lumped: Option<Box<Body>>,
    /// When the first support is released, and the body afterwards.
    pub(super) release: Option<(f64, Box<Body>)>,
}

impl Body {
    /// When the next support is released, and the body afterwards.
    pub fn release(&self) -> Option<(f64, &Body)> {
        self.release.as_ref().map(|(time, body)| (*time, &**body))
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
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
        self.internal.dofs().end
    }

    /// The degrees of freedom of incompatible modes: at the end, without mass.
    pub(crate) fn internal_dofs(&self) -> Range<usize> {
        self.internal.dofs()
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

    /// Sets a nodal field, `[n_nodes][3]`, without modes: at internal nodes the mean over the corners of their cells.
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

    /// Sets a velocity at the nodes without mass to the end of the polynomial of its rates, `sum_j weights_j x_j / h` with
    /// the basis at the end of the step as weights; `rates: [k][n_nodes][3]`. No momentum determines it, and nothing but
    /// predictions and estimates of errors depends on it.
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

    /// Number of degrees of freedom that are neither fixed nor driven.
    pub fn n_free_dofs(&self) -> usize {
        self.fixed.iter().filter(|fixed| !**fixed).count()
    }

    /// Which degrees of freedom are fixed, at rest or driven, `[n_nodes][3]`.
    pub fn fixed(&self) -> &[bool] {
        &self.fixed
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

    /// The body as central differences move it: accelerations, body forces and attractions act on the lumped mass, like the
    /// inertia. It is the same body unless it has such loads on quadratic cells, whose row sums are no lumped masses.
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

    /// Memory for the assembly with time elements of a degree.
    #[doc(hidden)]
    pub fn assembly(&self, degree: usize) -> Assembly {
        let terms = || self.terms().iter().chain(self.ground.iter());
        let n_nodes = terms().map(|term| term.couplings().1).max().unwrap_or(0);
        let n_points = terms().map(|term| term.n_points()).max().unwrap_or(0);
        let n_pressure_terms = self.terms().iter().filter(|term| term.pressure_cells().is_some()).count();
        let scratch = || Scratch::new(degree, n_nodes, n_points, n_pressure_terms);
        let part = || Part { scratch: scratch(), outcome: Ok(()) };
        Assembly {
            matrix: StageMatrix::new(&self.pattern, &self.parts, degree),
            parts: self.parts.iter().map(|_| part()).collect(),
        }
    }

    /// Stage averages of the internal force; with [`Request::Tangent`] also the stage matrix
    /// `mass_coefficients_ij M + tangent_factor df_i/dx_j`.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`] if a cell is inverted.
    #[doc(hidden)]
    pub fn assemble(
        &self,
        step: &StepInput<'_>,
        request: Request,
        mass_coefficients: &[f64],
        assembly: &mut Assembly,
    ) -> Result<()> {
        let rows = assembly.matrix.parts_mut();
        // Springs to the ground have no strain rates and no damping.
        let ground = StepInput { damping: StepDamping::default(), ..*step };
        let work = |(index, (sink, part)): (usize, (&mut RowPart, &mut Part))| {
            sink.clear_force();
            if request == Request::Tangent {
                sink.set_blocks(&self.mass, mass_coefficients);
            }
            let terms = self.terms().iter().map(|term| (term, step));
            let mut terms = terms.chain(self.ground.iter().map(|term| (term, &ground)));
            part.outcome = terms
                .try_for_each(|(term, step)| term.assemble(step, request, index, &mut part.scratch, sink));
        };
        if rows.len() == 1 {
            rows.iter_mut().zip(&mut assembly.parts).enumerate().for_each(work);
        } else {
            rows.par_iter_mut().zip(&mut assembly.parts).enumerate().for_each(work);
        }
        self.agree(assembly.parts.iter().try_for_each(|part| part.outcome.clone()))
    }

    /// Rate of the drag \[1/time\].
    pub fn drag(&self) -> f64 {
        self.drag
    }

    /// Whether any region has a viscosity.
    pub fn is_viscous(&self) -> bool {
        self.viscosities().any(|viscosity| !viscosity.is_zero())
    }

    /// Equivalent stiffness-proportional damping time, averaged over the cells \[time\].
    pub(crate) fn viscous_time(&self) -> f64 {
        self.viscous_time
    }

    /// Viscosity of each region.
    pub fn viscosities(&self) -> impl Iterator<Item = &Viscosity> {
        self.made_of.iter().map(|region| &region.viscosity)
    }

    /// Energy that viscosity and the scheme dissipate through strain rates in a step \[energy\].
    ///
    /// ```math
    /// sum_i b_i integral S_i : E'_i dV
    /// ```
    pub(crate) fn dissipated(&self, step: &StepInput<'_>, assembly: &mut Assembly) -> f64 {
        let scratch = &mut assembly.parts[0].scratch;
        let mut sum = [self.counted_terms().map(|term| term.dissipated(step, scratch)).sum()];
        self.sum_ranks("dissipated energy", &mut sum);
        sum[0]
    }

    /// Product of adjoint vectors with the derivatives of the stage averages by the displacement at the start of the
    /// step, at fixed rates; `adjoint: [k][n_nodes][3]`, `gradient: [n_nodes][3]`. Loads are not included.
    ///
    /// ```math
    /// sum_i (df_i/du_1)^T mu_i
    /// ```
    pub(crate) fn start_gradient(&self, step: &StepInput<'_>, adjoint: &[f64], gradient: &mut [f64]) {
        gradient.fill(0.0);
        let terms = self.terms().iter().chain(self.ground.iter());
        terms.for_each(|term| term.add_start_gradient(step, adjoint, gradient));
    }

    /// Whether springs or attractions connect the body to the ground.
    pub(crate) fn has_ground(&self) -> bool {
        !self.ground.is_empty()
    }

    /// Whether the body is free: no supports, no springs and attractions to the ground.
    pub(crate) fn is_free(&self) -> bool {
        self.ground.is_empty() && self.held_axes == [false; 3]
    }

    /// Stage averages of the force of the body on the ground through springs and attractions, `force: [k][n_nodes][3]`.
    /// Its negative is an external force in the momentum balances.
    ///
    /// # Errors
    /// As [`Body::assemble`].
    pub(crate) fn ground_force(
        &self,
        step: &StepInput<'_>,
        assembly: &mut Assembly,
        force: &mut [f64],
    ) -> Result<()> {
        let rows = assembly.matrix.parts_mut().iter_mut().zip(&mut assembly.parts);
        for (index, (sink, part)) in rows.enumerate() {
            sink.clear_force();
            let mut terms = self.ground.iter();
            let step = &StepInput { damping: StepDamping::default(), ..*step };
            terms
                .try_for_each(|term| term.assemble(step, Request::Stress, index, &mut part.scratch, sink))?;
        }
        assembly.matrix.copy_force(force);
        Ok(())
    }
}

/// Stage forces and matrix of a body, with the working memory of their assembly.
#[derive(Debug)]
pub struct Assembly {
    /// Forces and matrix.
    pub matrix: StageMatrix,
    parts: Vec<Part>,
}

impl Assembly {
    /// Results of the cells of a term with pressures, part by part.
    pub(super) fn pressure_results(&self, term: usize) -> impl Iterator<Item = &PressureResults> {
        self.parts.iter().map(move |part| &part.scratch.pressures[term])
    }
}

#[derive(Debug)]
struct Part {
    scratch: Scratch,
    outcome: Result<()>,
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
