//! The body: the semidiscrete Hamiltonian system of section 2. Terms, mass, loads, supports, invariants.

#![allow(non_snake_case)]

mod batches;
mod damping;
mod drive;
mod facets;
mod field;
pub mod fields;
mod geometry;
mod history;
mod input;
mod integral;
mod invariants;
mod loads;
mod mass;
mod nodal;
mod pressure;
mod regions;
mod signal;
mod solid;
mod supports;
mod symmetry;
mod term;
mod viscosity;

use std::ops::Range;
use std::sync::{Arc, OnceLock};

pub use field::Field;
pub use geometry::CellTable;
pub use history::History;
pub use input::{
    GroundAttraction, GroundSpring, InitialVelocity, Load, LoadKind, Nodal, PointMass, Region, Rotation,
    Support,
};
pub use integral::Scratch;
pub use invariants::sum;
pub use loads::LoadResultant;
pub use mass::MassSolver;
pub use regions::RegionSummary;
pub use signal::{Signal, SignalTarget};
pub use symmetry::symmetry_axis;
pub use term::{Custom, Solid, StepDamping, StepInput, Strained, Term};
pub use viscosity::Viscosity;

use drive::Drive;
use field::FieldLoad;
use loads::LoadVector;
use pressure::Pressure;
use rayon::prelude::*;
use regions::RegionOfCell;
use supports::Given;

use crate::average::Want;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::sparse::{Pattern, StageMatrix, nested_dissection};

/// An elastic body, discretised in space: everything but its state of motion.
///
/// ```
/// use emmy::{body::{Body, Region}, material::NeoHooke, mesh};
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let body = Body::new(mesh::l_block(1.0)?, vec![Region::new(None, 0.5, rubber)], &[], &[])?;
/// assert!((body.regions()[0].mass - 0.5 * 117.0).abs() < 1e-12);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Body {
    mesh: Arc<Mesh>,
    regions: Vec<RegionSummary>,
    region_of_cell: Vec<u32>,
    /// The regions as they were given.
    made_of: Arc<Vec<Region>>,
    terms: Arc<Vec<Box<dyn Term>>>,
    /// Terms that pull the body towards the ground: external to its momenta.
    ground: Arc<Vec<Box<dyn Term>>>,
    pattern: Arc<Pattern>,
    parts: Vec<Range<usize>>,
    /// Found when it is first asked for.
    node_order: Arc<OnceLock<Result<Vec<usize>>>>,
    mass: Arc<Vec<f64>>,
    /// Rate of the mass-proportional damping.
    drag: f64,
    viscous_time: f64,
    lumped_mass: Vec<f64>,
    fixed: Vec<bool>,
    drives: Vec<Drive>,
    loads: Arc<Vec<LoadVector>>,
    fields: Arc<Vec<FieldLoad>>,
    pressures: Arc<Vec<Pressure>>,
    /// When the first support is released, and the body from then on.
    release: Option<(f64, Box<Body>)>,
}

impl Body {
    /// The body of a mesh. Nodes of plane cells are fixed along z.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::RegionCover`] if the regions do not cover the cells, [`Error::NotPositive`]
    /// for a density, [`Error::InvertedCell`], [`Error::NotFinite`] for a load, [`Error::Support`].
    pub fn new(mesh: Mesh, regions: Vec<Region>, supports: &[Support], loads: &[Load]) -> Result<Self> {
        Body::with_nodal(mesh, regions, &Nodal::default(), supports, loads)
    }

    /// The body of a mesh with masses and forces at single nodes.
    ///
    /// # Errors
    /// Those of [`Body::new`], and [`Error::NoMass`] for a node without mass that is free to move.
    pub fn with_nodal(
        mesh: Mesh,
        regions: Vec<Region>,
        nodal: &Nodal,
        supports: &[Support],
        loads: &[Load],
    ) -> Result<Self> {
        let of_cell = RegionOfCell::new(&mesh, &regions)?;
        let section = of_cell.sections(&mesh, &regions);
        let density_of_cell = of_cell.densities(&mesh, &regions);
        let point_masses = nodal::point_masses(&mesh, &nodal.masses)?;
        let mut lumped_mass = regions::lumped_mass(&mesh, &density_of_cell);
        lumped_mass.iter_mut().zip(&point_masses).for_each(|(sum, mass)| *sum += mass);
        let mut terms = regions::terms(&mesh, &regions, &of_cell)?;
        let mut ground = nodal::ground_terms(&mesh, nodal, &section, &lumped_mass)?;
        let couplings = terms.iter().flat_map(|term| {
            let (nodes, length) = term.couplings();
            nodes.chunks_exact(length)
        });
        let pattern = Pattern::new(mesh.n_nodes(), couplings);
        // One part a thread; fewer where there is too little to share.
        let n_parts = rayon::current_num_threads().min(mesh.n_nodes() / 64).max(1);
        let parts = pattern.divided(n_parts);
        terms.iter_mut().chain(&mut ground).for_each(|term| term.attach(&pattern, &parts));
        let mut regions_and_masses = regions::summaries(&mesh, &regions, &of_cell);
        for mass in &nodal.masses {
            regions_and_masses.push(nodal::summary(&mesh, mass)?);
        }
        let (mut vectors, mut fields, mut pressures) = (Vec::new(), Vec::new(), Vec::new());
        for (index, load) in loads.iter().enumerate() {
            vectors.extend(LoadVector::new(&mesh, index, load, &section, &density_of_cell, &point_masses)?);
            fields.extend(FieldLoad::new(&mesh, index, load, &section)?);
            pressures.extend(Pressure::new(&mesh, &pattern, index, load, &section)?);
        }
        let given = Given::new(&mesh, supports.iter())?;
        nodal::check_masses(&mesh, &lumped_mass, &given.fixed)?;
        let body = Body {
            loads: Arc::new(vectors),
            fields: Arc::new(fields),
            pressures: Arc::new(pressures),
            release: None,
            drag: 0.0,
            viscous_time: term::viscous_time(&terms),
            fixed: given.fixed,
            drives: given.drives,
            mass: Arc::new(regions::mass(&mesh, &pattern, &density_of_cell, &point_masses)),
            lumped_mass,
            regions: regions_and_masses,
            region_of_cell: of_cell.into_indices(),
            made_of: Arc::new(regions),
            node_order: Arc::new(OnceLock::new()),
            terms: Arc::new(terms),
            ground: Arc::new(ground),
            pattern: Arc::new(pattern),
            parts,
            mesh: Arc::new(mesh),
        };
        body.with_releases(supports)
    }

    /// The body with those that it is after each release of a support; they share their tables.
    fn with_releases(self, supports: &[Support]) -> Result<Self> {
        let mut times: Vec<f64> = supports.iter().filter_map(|support| support.until).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let mut release = None;
        for &time in times.iter().rev() {
            let holds = |support: &&Support| support.until.is_none_or(|until| until > time);
            let Given { fixed, drives } = Given::new(&self.mesh, supports.iter().filter(holds))?;
            nodal::check_masses(&self.mesh, &self.lumped_mass, &fixed)?;
            release = Some((time, Box::new(Body { fixed, drives, release, ..self.clone() })));
        }
        Ok(Body { release, ..self })
    }

    /// When a support is released next, and the body from then on.
    pub fn release(&self) -> Option<(f64, &Body)> {
        self.release.as_ref().map(|(time, body)| (*time, &**body))
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Number of degrees of freedom, fixed ones included.
    pub fn n_dofs(&self) -> usize {
        self.mesh.n_dofs()
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

    /// Couplings between nodes.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Consistent mass matrix M_AB, one number a coupling of the pattern \[mass\].
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// Lumped mass, one number a node \[mass\].
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

    /// Fill-reducing order of the nodes, `order[new] = old`. It is found when it is first asked for, so that what solves no linear
    /// system does without.
    ///
    /// # Errors
    /// [`Error::Linear`] if there is not enough memory for it.
    pub fn node_order(&self) -> Result<&[usize]> {
        match self.node_order.get_or_init(|| nested_dissection(&self.pattern)) {
            Ok(order) => Ok(order),
            Err(error) => Err(error.clone()),
        }
    }

    /// Memory for the assembly with time elements of a degree.
    pub fn assembly(&self, degree: usize) -> Assembly {
        let n_nodes = self.mesh.cells().map(|cell| cell.nodes.len()).max().unwrap_or(0);
        let terms = self.terms.iter().chain(self.ground.iter());
        let n_points = terms.map(|term| term.n_points()).max().unwrap_or(0);
        let part = || Part { scratch: Scratch::new(degree, n_nodes, n_points), outcome: Ok(()) };
        Assembly {
            matrix: StageMatrix::new(&self.pattern, &self.parts, degree),
            parts: self.parts.iter().map(|_| part()).collect(),
        }
    }

    /// Stage averages of the internal force; with [`Want::Tangent`] also the stage matrix
    /// `mass_coefficients_ij M + tangent_factor df_i/dx_j`.
    ///
    /// # Errors
    /// [`Error::Inverted`] if a cell is turned inside out.
    pub fn assemble(
        &self,
        step: &StepInput<'_>,
        want: Want,
        mass_coefficients: &[f64],
        assembly: &mut Assembly,
    ) -> Result<()> {
        let rows = assembly.matrix.parts_mut();
        // Springs of the ground neither store strains nor lose any.
        let ground = StepInput { damping: StepDamping::default(), ..*step };
        let work = |(index, (sink, part)): (usize, (&mut crate::sparse::RowPart, &mut Part))| {
            sink.clear_force();
            if want == Want::Tangent {
                sink.set_blocks(&self.mass, mass_coefficients);
            }
            let terms = self.terms.iter().map(|term| (term, step));
            let mut terms = terms.chain(self.ground.iter().map(|term| (term, &ground)));
            part.outcome =
                terms.try_for_each(|(term, step)| term.assemble(step, want, index, &mut part.scratch, sink));
        };
        if rows.len() == 1 {
            rows.iter_mut().zip(&mut assembly.parts).enumerate().for_each(work);
        } else {
            rows.par_iter_mut().zip(&mut assembly.parts).enumerate().for_each(work);
        }
        assembly.parts.iter().try_for_each(|part| part.outcome.clone())
    }

    /// The body in a medium that brakes it in proportion to mass and velocity, `f = -rate M v`: an external force. Alone it lets velocities decay
    /// like `exp(-rate t)`.
    ///
    /// # Errors
    /// [`Error::Viscosity`] unless the rate \[1/time\] is finite and not negative.
    pub fn with_drag(self, rate: f64) -> Result<Self> {
        if !(rate >= 0.0 && rate.is_finite()) {
            return Err(Error::Viscosity { name: "drag", value: rate });
        }
        let release =
            self.release.map(|(time, body)| -> Result<_> { Ok((time, Box::new(body.with_drag(rate)?))) });
        Ok(Body { drag: rate, release: release.transpose()?, ..self })
    }

    /// Rate of the drag \[1/time\].
    pub fn drag(&self) -> f64 {
        self.drag
    }

    /// Whether any region has a viscosity.
    pub fn is_viscous(&self) -> bool {
        self.viscosities().any(|viscosity| !viscosity.is_zero())
    }

    /// Time by which the stiffness at rest would have to be multiplied to be the viscosity, on the average over the cells \[time\].
    pub fn viscous_time(&self) -> f64 {
        self.viscous_time
    }

    /// Viscosity of each region.
    pub fn viscosities(&self) -> impl Iterator<Item = &Viscosity> {
        self.made_of.iter().map(|region| &region.viscosity)
    }

    /// What viscosity and a scheme's dissipation take out of the body in a step, by the strains \[energy\].
    ///
    /// ```math
    /// sum_i b_i integral S_i : E'_i dV
    /// ```
    pub fn dissipated(&self, step: &StepInput<'_>, assembly: &mut Assembly) -> f64 {
        let scratch = &mut assembly.parts[0].scratch;
        self.terms.iter().map(|term| term.dissipated(step, scratch)).sum()
    }

    /// Product of adjoint vectors with the derivatives of the stage averages by the displacement at the start of the step, its
    /// rates being fixed; `adjoint: [k][n_nodes][3]`, `gradient: [n_nodes][3]`. Loads have no part in it.
    ///
    /// ```math
    /// sum_i (df_i/du_1)^T mu_i
    /// ```
    pub fn start_gradient(&self, step: &StepInput<'_>, adjoint: &[f64], gradient: &mut [f64]) {
        gradient.fill(0.0);
        let terms = self.terms.iter().chain(self.ground.iter());
        terms.for_each(|term| term.add_start_gradient(step, adjoint, gradient));
    }

    /// Whether springs or attractions pull the body towards the ground.
    pub fn has_ground(&self) -> bool {
        !self.ground.is_empty()
    }

    /// Whether nothing holds the body: neither supports nor springs and attractions to the ground.
    pub fn is_free(&self) -> bool {
        self.ground.is_empty() && !self.fixed.contains(&true)
    }

    /// Stage averages of the part of the internal force with which the body pulls at the ground, `force: [k][n_nodes][3]`: its
    /// negative is external to the momenta of the body.
    ///
    /// # Errors
    /// Those of [`Body::assemble`].
    pub fn ground_force(
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
            terms.try_for_each(|term| term.assemble(step, Want::Stress, index, &mut part.scratch, sink))?;
        }
        assembly.matrix.copy_force(force);
        Ok(())
    }

    /// Momentum and velocity of an initial velocity field at a time: `(p, v)`, both `[n_nodes][3]`; fixed components do not
    /// move, driven ones as they are driven.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::NotFinite`], [`Error::DrivenStart`] if a driven node is displaced then.
    pub fn initial_motion(&self, time: f64, fields: &[InitialVelocity]) -> Result<(Vec<f64>, Vec<f64>)> {
        self.check_start(time)?;
        let mut velocity = vec![0.0; self.n_dofs()];
        for field in fields {
            let nodes = match &field.group {
                Some(name) => self.mesh.group_nodes(name)?,
                None => (0..self.mesh.n_nodes() as u32).collect(),
            };
            for node in nodes {
                let v = field.at(self.mesh.points()[node as usize]);
                if let Some(&value) = v.iter().find(|value| !value.is_finite()) {
                    return Err(Error::NotFinite { what: "initial velocity".into(), value });
                }
                velocity[3 * node as usize..3 * node as usize + 3].copy_from_slice(&v);
            }
        }
        self.set_given_velocity(time, 0.0, &mut velocity);
        let mut momentum = vec![0.0; self.n_dofs()];
        self.mass_product(&velocity, &mut momentum);
        Ok((momentum, velocity))
    }

    /// The body is undeformed at the start: driven nodes must be where they are.
    fn check_start(&self, time: f64) -> Result<()> {
        let distance = self.driven_distance(time);
        let size = self.mesh.points().iter().flatten().fold(0.0, |size: f64, x| size.max(x.abs()));
        // Rounding of an expression that is zero in mathematics is not a displacement.
        if distance <= 1e-12 * size {
            return Ok(());
        }
        Err(Error::DrivenStart { time, distance })
    }
}

/// Stage forces and matrix of a body, with the working memory of their assembly.
#[derive(Debug)]
pub struct Assembly {
    /// Forces and matrix.
    pub matrix: StageMatrix,
    parts: Vec<Part>,
}

#[derive(Debug)]
struct Part {
    scratch: Scratch,
    outcome: Result<()>,
}
